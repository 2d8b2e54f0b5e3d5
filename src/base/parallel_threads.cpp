// src/base/parallel.h by the standard library's threads, for programs that are linked without TBB; where none can be
// started (WebAssembly), the caller does all the work.
#include "src/base/parallel.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <set>
#include <system_error>
#include <thread>
#include <vector>

namespace dea {

namespace {

/// One call of parallel_ranges. It lives with its caller, who leaves only when nobody works on it.
struct Job {
  std::size_t count, range;  // indices; how many at a time
  const std::function<void(std::size_t, std::size_t)>& body;
  std::size_t next = 0;  // under the crew's mutex, as what follows
  int at_work = 0;
  std::exception_ptr fault = nullptr;
};

/// The threads of this process, started when they are first needed.
class Crew {
 public:
  ~Crew() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      ended_ = true;
    }
    wake_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }

  void run(Job& job) {
    std::unique_lock<std::mutex> lock(mutex_);
    const bool shared = helpers() > 0;
    if (shared) {
      jobs_.push_back(&job);
      wake_.notify_all();
    }
    while (job.next < job.count) work_on(job, lock);
    if (shared) jobs_.erase(std::find(jobs_.begin(), jobs_.end(), &job));
    done_.wait(lock, [&job] { return job.at_work == 0; });
    if (job.fault) std::rethrow_exception(job.fault);
  }

  std::multiset<int>::iterator add_limit(int threads) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return limits_.insert(threads);
  }
  void remove_limit(std::multiset<int>::iterator limit) {
    const std::lock_guard<std::mutex> lock(mutex_);
    limits_.erase(limit);
    wake_.notify_all();
  }
  std::size_t threads_allowed() {
    const std::lock_guard<std::mutex> lock(mutex_);
    start_threads();
    return helpers() + 1;
  }

 private:
  /// How many may work beside the callers.
  std::size_t helpers() const {
    return limits_.empty() ? threads_.size()
                           : std::min(threads_.size(), static_cast<std::size_t>(std::max(1, *limits_.begin()) - 1));
  }

  void start_threads() {
    if (started_) return;
    started_ = true;
    try {
      for (int i = 1; i < core_count(); ++i)
        threads_.emplace_back([this, me = static_cast<std::size_t>(i)] { live(me); });
    } catch (const std::system_error&) {  // no more are to be had
    }
  }

  void live(std::size_t me) {
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
      wake_.wait(lock, [&] { return ended_ || (me <= helpers() && open_job() != nullptr); });
      if (ended_) return;
      work_on(*open_job(), lock);
    }
  }

  /// The one begun last: what others wait for within their own.
  Job* open_job() const {
    const auto job = std::find_if(jobs_.rbegin(), jobs_.rend(), [](const Job* j) { return j->next < j->count; });
    return job == jobs_.rend() ? nullptr : *job;
  }

  /// The job's next range; the lock is free meanwhile. What it throws ends the job.
  void work_on(Job& job, std::unique_lock<std::mutex>& lock) {
    const std::size_t begin = job.next, end = begin + std::min(job.range, job.count - begin);
    job.next = end;
    ++job.at_work;
    lock.unlock();
    std::exception_ptr fault;
    try {
      job.body(begin, end);
    } catch (...) {
      fault = std::current_exception();
    }
    lock.lock();
    --job.at_work;
    if (fault) {
      job.next = job.count;
      if (!job.fault) job.fault = fault;
    }
    if (job.at_work == 0 && job.next >= job.count) done_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable wake_, done_;
  std::vector<Job*> jobs_;  // begun and not ended
  std::vector<std::thread> threads_;
  std::multiset<int> limits_;
  bool started_ = false, ended_ = false;
};

Crew& crew() {
  static Crew one;
  return one;
}

}  // namespace

void parallel_ranges(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  grain = std::max<std::size_t>(1, grain);
  const std::size_t threads = count <= grain ? 1 : crew().threads_allowed();
  if (threads == 1) return body(0, count);
  constexpr std::size_t kEach = 4;  // so that a thread whose ranges are done soon takes one of another's
  const std::size_t ranges = kEach * threads;
  Job job{count, std::max(grain, (count + ranges - 1) / ranges), body};
  crew().run(job);
}

std::shared_ptr<void> limit_threads(int threads) {
  const auto limit = crew().add_limit(threads);
  return {nullptr, [limit](void*) { crew().remove_limit(limit); }};
}

int core_count() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

std::string thread_library_version() { return "threads of C++"; }

}  // namespace dea
