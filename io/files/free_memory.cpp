#include "io/files/free_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "io/files/job_limits.h"
#include "io/files/system.h"
#include "src/base/error.h"
#include "src/base/numbers.h"

namespace dea {

namespace {

constexpr double kBytesOfKilobyte = 1024;

/// What the address space still has room for.
double free_addresses() {
  const double taken = number_after("/proc/self/status", "VmSize:") * kBytesOfKilobyte;
  return std::max(0.0, address_limit() - (taken < kInfinity ? taken : 0.0));
}

/// What Slurm's job may still take on this node, where all of it is this process.
double free_of_job() {
  const double taken = number_after("/proc/self/status", "VmRSS:") * kBytesOfKilobyte;
  return std::max(0.0, memory_of_job() - (taken < kInfinity ? taken : 0.0));
}

}  // namespace

double free_memory() {
  return std::min({number_after("/proc/meminfo", "MemAvailable:") * kBytesOfKilobyte,
                   free_of_groups("/proc/self/cgroup", "/sys/fs/cgroup"), free_of_job(), free_addresses()});
}

std::string gigabytes(double bytes) {
  return bytes < 1e10 ? fmt::format("{:.2g} GB", bytes / 1e9) : fmt::format("{:.0f} GB", bytes / 1e9);
}

void need_memory(const std::string& path, double bytes) {
  if (bytes <= kLittleMemory) return;
  const double free = free_memory();
  if (bytes > free)
    throw InputError(
        fmt::format("{}: to read it needs about {} of memory, and {} are free: take a smaller file, or a machine with "
                    "more memory",
                    path, gigabytes(bytes), gigabytes(free)));
}

std::optional<std::string> whole_file(const std::string& path, double memory_per_byte) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return std::nullopt;
  std::ifstream in(path, std::ios::binary);
  if (!in) return std::nullopt;
  const bool has_size = std::filesystem::is_regular_file(path, error);
  std::string text;
  if (has_size) {
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) return std::nullopt;
    need_memory(path, memory_per_byte * static_cast<double>(size));
    text.reserve(static_cast<std::size_t>(size));
  }
  std::string buffer(1 << 18, '\0');
  while (in) {
    in.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    text.append(buffer, 0, static_cast<std::size_t>(in.gcount()));
    if (!has_size && static_cast<double>(text.size()) > kMostOfPipe)
      throw InputError(fmt::format("{}: found more than {} in something that is no file, expected less: save it as one",
                                   path, gigabytes(kMostOfPipe)));
  }
  if (in.bad()) return std::nullopt;
  return text;
}

}  // namespace dea
