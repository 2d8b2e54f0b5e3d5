#include "src/base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/version.h>

namespace dea {

void parallel_ranges(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&body](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); });
}

std::shared_ptr<void> limit_threads(int threads) {
  return std::make_shared<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                               static_cast<std::size_t>(threads));
}

int core_count() { return tbb::info::default_concurrency(); }

std::string thread_library_version() { return std::string("TBB ") + TBB_runtime_version(); }

}  // namespace dea
