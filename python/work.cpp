#include <febiodea/python/work.h>

#include <chrono>
#include <set>
#include <thread>

namespace dea::python {

namespace {

using std::chrono::milliseconds;
constexpr milliseconds kLook{50};      // between looks for Ctrl-C
constexpr milliseconds kGrace{500};    // for work that was told to end

/// Never destroyed: threads may outlive this library's statics.
struct AllWork {
  std::mutex mutex;
  std::condition_variable changed;
  std::set<std::shared_ptr<Work>> under_way;
};
AllWork& all_work() {
  static AllWork* const all = new AllWork;
  return *all;
}

void begin_work(const std::shared_ptr<Work>& work) {
  AllWork& all = all_work();
  const std::lock_guard<std::mutex> lock(all.mutex);
  all.under_way.insert(work);
}

void end_work(const std::shared_ptr<Work>& work) {
  AllWork& all = all_work();
  const std::lock_guard<std::mutex> lock(all.mutex);
  all.under_way.erase(work);
  all.changed.notify_all();
}

void do_work(const std::shared_ptr<Work>& work, std::function<void(Work&)> job) {
  std::exception_ptr failure;
  try {
    job(*work);
  } catch (...) {
    failure = std::current_exception();
  }
  job = nullptr;  // what it owns goes before its end is told
  const std::lock_guard<std::mutex> lock(work->mutex);
  work->failure = failure;
  work->ended = true;
  work->changed.notify_all();
}

/// Tells the callback. False: Ctrl-C, or it raised; Python's error is set.
bool listen(const py::object& progress, std::vector<Progress>& told) {
  if (PyErr_CheckSignals() != 0) return false;
  try {
    if (!progress.is_none())
      for (Progress& p : told) progress(std::move(p));
  } catch (py::error_already_set& raised) {
    raised.restore();
    return false;
  }
  told.clear();
  return true;
}

/// Ends the work, or leaves it to itself.
void give_up(std::thread& worker, const std::shared_ptr<Work>& work) {
  const py::gil_scoped_release unlocked;
  work->stop = true;
  std::unique_lock<std::mutex> lock(work->mutex);
  const bool ended = work->changed.wait_for(lock, kGrace, [&] { return work->ended; });
  lock.unlock();
  if (ended)
    worker.join();
  else
    worker.detach();
}

}  // namespace

void Work::tell(Progress progress) {
  const std::lock_guard<std::mutex> lock(mutex);
  if (!listened_to) return;
  told.push_back(std::move(progress));
  changed.notify_all();
}

void run_work(const std::function<void(Work&)>& job, const py::object& progress) {
  const auto work = std::make_shared<Work>();
  work->listened_to = !progress.is_none();
  begin_work(work);
  std::thread worker;
  try {
    worker = std::thread([work, job]() mutable {
      do_work(work, std::move(job));
      end_work(work);
    });
  } catch (...) {
    end_work(work);
    throw;
  }
  for (bool ended = false; !ended;) {
    std::vector<Progress> told;
    {
      const py::gil_scoped_release unlocked;
      std::unique_lock<std::mutex> lock(work->mutex);
      work->changed.wait_for(lock, kLook, [&] { return work->ended || !work->told.empty(); });
      told.swap(work->told);
      ended = work->ended;
    }
    if (listen(progress, told)) continue;
    const py::error_already_set raised;
    give_up(worker, work);
    throw raised;
  }
  {
    const py::gil_scoped_release unlocked;
    worker.join();
  }
  if (work->failure) std::rethrow_exception(work->failure);
}

void end_all_work() {
  const py::gil_scoped_release unlocked;
  AllWork& all = all_work();
  std::unique_lock<std::mutex> lock(all.mutex);
  for (const std::shared_ptr<Work>& work : all.under_way) work->stop = true;
  all.changed.wait(lock, [&] { return all.under_way.empty(); });
}

}  // namespace dea::python
