// Under the thread sanitizer TBB, which is not built with it, runs each caller's work in the caller's own thread: what
// is left to find are races between callers.
#ifdef DEA_SANITIZE_THREAD
#include "src/base/parallel.h"

namespace {
const auto one_thread_per_arena = limit_threads(1);
}
#endif
