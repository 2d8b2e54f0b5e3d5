// src/base/stop.h – asking work under way to end.
#pragma once
#include <atomic>
#include <stdexcept>

namespace dea {

/// Set by another thread, a callback or a signal handler; whoever works for long looks at it again and again.
using StopFlag = std::atomic<bool>;

/// Work that ended because its flag was set: neither a result nor a fault.
struct Stopped : std::runtime_error {
  Stopped() : std::runtime_error("stopped") {}
};

/// Throws Stopped if the flag is there and set.
inline void end_if_stopped(const StopFlag* stop) {
  if (stop != nullptr && stop->load(std::memory_order_relaxed)) throw Stopped();
}

}  // namespace dea
