#include "io/files/free_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "io/files/system.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"

namespace dea {

namespace {

namespace fs = std::filesystem;

constexpr double kBytesOfKilobyte = 1024, kMegabyte = 1024.0 * 1024.0;

/// What Slurm's job has beside what is taken.
double left_of_job() {
  const double taken = number_after("/proc/self/status", "VmRSS:") * kBytesOfKilobyte;
  return std::max(0.0, memory_of_job() - (taken < kInfinity ? taken : 0.0));
}

/// Where the kernel says how much memory a group may take, and how much its processes hold: version 2, version 1.
struct GroupFiles {
  const char *limit, *held;
};
constexpr GroupFiles kUnified{"memory.max", "anon "}, kMemory{"memory.limit_in_bytes", "total_rss "};

/// Of a group and all above it, up to the mount. A group that is not below the mount (of a container) is passed over.
double free_of_branch(const fs::path& mount, std::string group, const GroupFiles& files) {
  double least = kInfinity;
  for (;;) {
    const fs::path folder = mount / fs::path(group).relative_path();
    const double most = number_after((folder / files.limit).string(), ""),
                 held = number_after((folder / "memory.stat").string(), files.held);
    if (std::isfinite(most) && std::isfinite(held)) least = std::min(least, std::max(0.0, most - held));
    if (group.empty() || group == "/") return least;
    group = fs::path(group).parent_path().string();
  }
}

std::string environment(const char* name) {
  const char* text = std::getenv(name);
  return text == nullptr ? "" : text;
}

/// A whole number >= 0 at the start of a text; -1: none.
int number_at(const std::string& text) {
  char* end = nullptr;
  const long value = std::strtol(text.c_str(), &end, 10);
  return end == text.c_str() || value < 0 || value > 1'000'000'000 ? -1 : static_cast<int>(value);
}

/// The entry of a node in Slurm's way of counting, "4(x3),2": four on each of three nodes, two on the last; -1: none.
int of_node(const std::string& counts, int node) {
  for (const std::string& entry : split(counts, ',')) {
    const std::size_t times = entry.find("(x");
    const int nodes = times == entry.npos ? 1 : number_at(entry.substr(times + 2));
    if (nodes < 1) return -1;
    if (node < nodes) return number_at(entry);
    node -= nodes;
  }
  return -1;
}

}  // namespace

double free_memory() {
  return std::min({number_after("/proc/meminfo", "MemAvailable:") * kBytesOfKilobyte,
                   free_of_groups("/proc/self/cgroup", "/sys/fs/cgroup"), left_of_job(), memory_left()});
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
  if (fs::is_directory(path, error)) return std::nullopt;
  std::ifstream in(path, std::ios::binary);
  if (!in) return std::nullopt;
  const bool has_size = fs::is_regular_file(path, error);
  std::string text;
  if (has_size) {
    const std::uintmax_t size = fs::file_size(path, error);
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

double number_after(const std::string& path, const std::string& word) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(word, 0) != 0) continue;
    try {
      return std::stod(line.substr(word.size()));
    } catch (const std::exception&) {
    }
  }
  return kInfinity;
}

double free_of_groups(const std::string& memberships, const std::string& root) {
  double least = std::min(free_of_branch(root, "", kUnified), free_of_branch(fs::path(root) / "memory", "", kMemory));
  std::ifstream in(memberships);
  for (std::string line; std::getline(in, line);) {  // "4:memory:/job_7", version 2: "0::/job_7"
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == line.npos || second == line.npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",",
                      group = line.substr(second + 1);
    if (controllers == ",,")
      least = std::min(least, free_of_branch(root, group, kUnified));
    else if (controllers.find(",memory,") != controllers.npos)
      least = std::min(least, free_of_branch(fs::path(root) / "memory", group, kMemory));
  }
  return least;
}

double memory_of_job() {
  const int of_node = number_at(environment("SLURM_MEM_PER_NODE"));  // 0: all that the node has
  if (of_node > 0) return of_node * kMegabyte;
  const int of_processor = number_at(environment("SLURM_MEM_PER_CPU")),
            processors = number_at(environment("SLURM_CPUS_ON_NODE"));
  return of_processor > 0 && processors > 0 ? kMegabyte * of_processor * processors : kInfinity;
}

int tasks_on_node() {
  const int slurm =
      of_node(environment("SLURM_STEP_TASKS_PER_NODE"), std::max(0, number_at(environment("SLURM_NODEID"))));
  for (const int tasks :
       {slurm, number_at(environment("OMPI_COMM_WORLD_LOCAL_SIZE")), number_at(environment("MPI_LOCALNRANKS"))})
    if (tasks > 0) return tasks;
  return 1;
}

int processors_of_task() {
  const int of_task = number_at(environment("SLURM_CPUS_PER_TASK"));
  if (of_task > 0) return of_task;
  const int on_node = number_at(environment("SLURM_CPUS_ON_NODE"));
  return on_node > 0 ? std::max(1, on_node / tasks_on_node()) : 0;
}

}  // namespace dea
