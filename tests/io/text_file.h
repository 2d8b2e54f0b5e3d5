// A file of a test with this text.
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace dea::test {

/// Its path, in the folder for tests; byte by byte as `text` is.
inline std::string file(const std::string& name, const std::string& text) {
  const std::string path = (std::filesystem::path(::testing::TempDir()) / name).string();
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

}  // namespace dea::test
