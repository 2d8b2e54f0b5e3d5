// src/base/parallel.h – work spread over the cores. The one file, with parallel.cpp, that knows the thread library.
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace dea {

/// Calls `body(begin, end)` with ranges that together are 0 to `count`, in any order, on any of the cores; none is cut
/// below `grain`. Results do not depend on the number of threads if each index writes to its own place only. What one
/// range throws is thrown here, after those at work have ended.
void parallel_ranges(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

/// Calls `body(i)` with each index below `count`, as parallel_ranges does.
template <class Index, class Body>
void parallel_for(Index count, const Body& body, std::size_t grain = 1) {
  if (!(count > 0)) return;
  parallel_ranges(static_cast<std::size_t>(count), grain, [&body](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(static_cast<Index>(i));
  });
}

/// Calls both functions, side by side where a core is free.
template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
  parallel_for(2, [&](int i) { i == 0 ? first() : second(); });
}

/// No more than `threads` work in this process for as long as the result lives.
[[nodiscard]] std::shared_ptr<void> limit_threads(int threads);

/// How many threads can work at a time on the cores that this process may use.
int core_count();

/// "TBB 2021.8"
std::string thread_library_version();

}  // namespace dea
