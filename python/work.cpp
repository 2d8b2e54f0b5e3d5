#include "python/work.h"

#include <atomic>
#include <chrono>
#include <set>
#include <thread>

#include "io/files/system.h"

namespace dea::python {

namespace {

using std::chrono::milliseconds;
constexpr milliseconds kLook{50};  // between looks for Ctrl-C

/// A thread that does one piece of work after the other. Threads are used again, for libraries below keep something for
/// each that ever was.
struct Worker {
  std::mutex mutex;
  std::condition_variable given;
  std::function<void()> job;
};

/// All workers of this process. Never destroyed: threads may outlive this library's statics.
struct Workshop {
  int process = process_id();
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::shared_ptr<Worker>> idle;
  std::set<std::shared_ptr<Work>> under_way;
};

/// A process that was forked has none of its parent's threads: it gets a workshop of its own.
Workshop& workshop() {
  static std::atomic<Workshop*> current = new Workshop;
  Workshop* shop = current.load();
  if (shop->process == process_id()) return *shop;
  Workshop* own = new Workshop;
  if (current.compare_exchange_strong(shop, own)) return *own;
  delete own;
  return *current.load();
}

void work_for_ever(const std::shared_ptr<Worker>& worker) {
  for (;;) {
    std::unique_lock<std::mutex> lock(worker->mutex);
    worker->given.wait(lock, [&] { return worker->job != nullptr; });
    const std::function<void()> job = std::move(worker->job);
    worker->job = nullptr;
    lock.unlock();
    job();
  }
}

std::shared_ptr<Worker> idle_worker(Workshop& shop) {
  {
    const std::lock_guard<std::mutex> lock(shop.mutex);
    if (!shop.idle.empty()) {
      std::shared_ptr<Worker> worker = std::move(shop.idle.back());
      shop.idle.pop_back();
      return worker;
    }
  }
  auto worker = std::make_shared<Worker>();
  std::thread(work_for_ever, worker).detach();
  return worker;
}

void do_work(Workshop& shop, const std::shared_ptr<Worker>& worker, const std::shared_ptr<Work>& work,
             std::function<void(Work&)>& job) {
  std::exception_ptr failure;
  try {
    job(*work);
  } catch (...) {
    failure = std::current_exception();
  }
  job = nullptr;  // what it owns goes before its end is told
  {
    const std::lock_guard<std::mutex> lock(shop.mutex);
    shop.idle.push_back(worker);
    shop.under_way.erase(work);
    shop.changed.notify_all();
  }
  const std::lock_guard<std::mutex> lock(work->mutex);
  work->failure = failure;
  work->ended = true;
  work->changed.notify_all();
}

void begin_work(const std::shared_ptr<Work>& work, const std::function<void(Work&)>& job) {
  Workshop& shop = workshop();
  const std::shared_ptr<Worker> worker = idle_worker(shop);
  {
    const std::lock_guard<std::mutex> lock(shop.mutex);
    shop.under_way.insert(work);
  }
  const std::lock_guard<std::mutex> lock(worker->mutex);
  worker->job = [&shop, worker, work, own = std::function<void(Work&)>(job)]() mutable {
    do_work(shop, worker, work, own);
  };
  worker->given.notify_one();
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

/// Waits a little for the work to end; else it is left to itself.
void give_up(const std::shared_ptr<Work>& work, milliseconds grace) {
  const py::gil_scoped_release unlocked;
  work->stop = true;
  std::unique_lock<std::mutex> lock(work->mutex);
  work->changed.wait_for(lock, grace, [&] { return work->ended; });
}

}  // namespace

void Work::tell(Progress progress) {
  const std::lock_guard<std::mutex> lock(mutex);
  if (!listened_to) return;
  told.push_back(std::move(progress));
  changed.notify_all();
}

void run_work(const std::function<void(Work&)>& job, const py::object& progress, milliseconds grace) {
  const auto work = std::make_shared<Work>();
  work->listened_to = !progress.is_none();
  begin_work(work, job);
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
    const std::exception_ptr raised = std::make_exception_ptr(py::error_already_set());
    give_up(work, grace);
    std::rethrow_exception(raised);
  }
  if (work->failure) std::rethrow_exception(work->failure);
}

void end_all_work() {
  const py::gil_scoped_release unlocked;
  Workshop& shop = workshop();
  std::unique_lock<std::mutex> lock(shop.mutex);
  for (const std::shared_ptr<Work>& work : shop.under_way) work->stop = true;
  shop.changed.wait(lock, [&] { return shop.under_way.empty(); });
}

}  // namespace dea::python
