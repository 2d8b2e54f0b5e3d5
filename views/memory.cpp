#include <febiodea/views/memory.h>

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <string>

#include <febiodea/base/error.h>
#include <febiodea/base/numbers.h>
#include <febiodea/base/say.h>
#include <febiodea/run/cost.h>
#include <febiodea/views/job_limits.h>

namespace dea {

namespace {

constexpr double kMany = 1e6;       // springs or layer triangles
constexpr double kNothing = 256e6;  // bytes that no one is asked about
constexpr double kBytesOfKilobyte = 1024;

/// The number behind a word at the start of a line of a file of the kernel's; infinity: none.
double kernel_number(const char* path, const std::string& word) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(word, 0) != 0) continue;
    try {
      return std::stod(line.substr(word.size()));
    } catch (const std::exception&) {  // "max": no limit
    }
  }
  return kInfinity;
}

/// What the address space still has room for.
double free_addresses() {
  rlimit limit = {};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kInfinity;
  const double taken = kernel_number("/proc/self/status", "VmSize:") * kBytesOfKilobyte;
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - (taken < kInfinity ? taken : 0.0));
}

/// What Slurm's job may still take on this node, where all of it is this process.
double free_of_job() {
  const double taken = kernel_number("/proc/self/status", "VmRSS:") * kBytesOfKilobyte;
  return std::max(0.0, memory_of_job() - (taken < kInfinity ? taken : 0.0));
}

std::string gigabytes(double bytes) {
  return bytes < 1e10 ? fmt::format("{:.2g} GB", bytes / 1e9) : fmt::format("{:.0f} GB", bytes / 1e9);
}

}  // namespace

double free_memory() {
  return std::min({kernel_number("/proc/meminfo", "MemAvailable:") * kBytesOfKilobyte,
                   free_of_groups("/proc/self/cgroup", "/sys/fs/cgroup"), free_of_job(), free_addresses()});
}

std::string spring_cost_note(const Recognition& r, const Wording& wording) {
  int refine = 1;
  for (const ContactPair& pair : r.joint.contacts) refine = std::max(refine, pair.refine);
  if (!r.recognised || refine == 1) return "";
  const SpringCost cost = spring_cost(r.joint);
  const NamedSetting given{"refine", "", std::to_string(refine)};
  const double free = free_memory();
  if (cost.bytes > kNothing && cost.bytes > free) {
    const int fits = largest_refine(r.joint, free);
    throw UsageError(Fault{
        .given = given,
        .found = fmt::format("{:.0f} springs need about {} of memory, and {} are free;", cost.springs,
                             gigabytes(cost.bytes), gigabytes(free)),
        .expected = fits > 0 ? say("{} is the largest that fits", NamedSetting{"refine", "", std::to_string(fits)})
                             : Sentence("no division fits")});
  }
  if (std::max(cost.springs, cost.layer_triangles) <= kMany) return "";
  const std::string layers =
      cost.layer_triangles > 0 ? fmt::format(" and {:.0f} triangles of the layers", cost.layer_triangles) : "";
  return fmt::format(
      "note: {5}: {1:.0f} springs ({2:.0f} triangles, each divided into {0} x {0}){3}, about {4} "
      "of memory",
      refine, cost.springs, spring_cost(r.joint, 1).springs, layers, gigabytes(cost.bytes), wording(given));
}

}  // namespace dea
