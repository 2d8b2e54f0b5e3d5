// fuzz/fuzz.h – what the targets share: bytes as a file, and the faults that a file may cause.
#pragma once
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "src/base/error.h"
#include "src/base/parse.h"

namespace dea::fuzz {

/// A file of this process with these bytes, in memory where the system has such a folder. `ending`: ".feb".
inline std::string file_of(const std::uint8_t* data, std::size_t size, const std::string& ending) {
  static const std::string folder = [] {
    const bool memory = std::filesystem::is_directory("/dev/shm");
    std::string name = (memory ? "/dev/shm" : std::filesystem::temp_directory_path().string()) + "/dea_fuzz_XXXXXX";
    if (::mkdtemp(name.data()) == nullptr) std::abort();
    static std::string made = name;
    std::atexit([] { std::filesystem::remove_all(made); });
    return name;
  }();
  const std::string path = folder + "/input" + ending;
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  return path;
}

/// Runs it. A refusal is an answer; all else that is thrown is a find.
template <class Read>
void answer_or_refusal(Read read) {
  try {
    read();
  } catch (const InputError&) {
  } catch (const UsageError&) {
  } catch (const BadValue&) {
  }
}

}  // namespace dea::fuzz
