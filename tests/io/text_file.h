// A file of a test with this text.
#pragma once
#include <fstream>
#include <string>

#include "tests/program.h"

namespace dea::test {

/// Its path, byte by byte as `text` is. It lies in a folder of this process alone, since tests that run side by side
/// may give their files the same names; the folder vanishes at the end.
inline std::string file(const std::string& name, const std::string& text) {
  static const TemporaryFolder folder;
  const std::string path = (folder.path / name).string();
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

}  // namespace dea::test
