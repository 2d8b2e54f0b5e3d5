// python/work.h – long work while Python goes on: without its lock, ended by Ctrl-C, told of on the way.
#pragma once
#include <pybind11/pybind11.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "src/base/stop.h"
#include "src/run/analysis.h"

namespace dea::python {

namespace py = pybind11;

/// What a callback is told.
struct Progress {
  std::string stage;         ///< "joint", "springs", "state"; of studies "case"
  std::size_t state = 0;     ///< from 1 on; 0: none yet; of studies: cases that are done
  std::size_t states = 0;    ///< of so many
  int iterations = 0;        ///< of the search in this state
  double residual = kNaN;    ///< unbalanced / applied force; NaN: none is known yet
  std::string outcome = {};  ///< of a state that ended; else empty
  double time = kNaN;        ///< of the model, of a state that ended
};

/// Between the thread that works and the one of Python that waits for it.
struct Work {
  StopFlag stop = false;
  std::mutex mutex;
  std::condition_variable changed;
  bool ended = false;
  bool listened_to = false;
  std::vector<Progress> told;
  std::exception_ptr failure;
  void tell(Progress progress);  ///< for the thread that works
};

/// Runs `job` in another thread, and waits for it without Python's lock. Ctrl-C and a callback that raises set the
/// flag; work that does not see it for half a second (a matrix that is being factorised) is left to itself, ends when
/// it does, and what it makes is dropped. `job` owns all that it uses, and no Python object. `progress`: a callable, or
/// None; called in the thread that waits. Throws what `job` throws.
/// `grace`: how long work that was told to end is waited for.
void run_work(const std::function<void(Work&)>& job, const py::object& progress = py::none(),
              std::chrono::milliseconds grace = std::chrono::milliseconds(500));

/// The same for work with a result.
template <class Make>
auto result_of(const Make& make, const py::object& progress = py::none()) {
  const auto slot = std::make_shared<std::optional<decltype(make(std::declval<Work&>()))>>();
  run_work([slot, make](Work& work) { slot->emplace(make(work)); }, progress);
  return std::move(**slot);
}

/// Short work that touches nothing of Python's: other threads go on meanwhile.
template <class Short>
auto unlocked(const Short& work) {
  const py::gil_scoped_release released;
  return work();
}

/// Tells all work that is under way to end, and waits for it: before the process takes its libraries down.
void end_all_work();

}  // namespace dea::python
