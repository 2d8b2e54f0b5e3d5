// Under the thread sanitizer TBB, which is not built with it, runs each caller's work in the caller's own thread: what
// is left to find are races between callers.
#ifdef DEA_SANITIZE_THREAD
#include <tbb/global_control.h>

namespace {
const tbb::global_control one_thread_per_arena(tbb::global_control::max_allowed_parallelism, 1);
}
#endif
