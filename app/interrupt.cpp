#include "app/interrupt.h"

#include <cstdlib>

#include "app/process.h"
#include "io/files/output.h"
#include "io/files/system.h"

namespace dea {

namespace {

// A handler may read and write nothing else.
StopFlag stop = false;
std::atomic<UnderWay> under_way = UnderWay::NothingToLose;
std::atomic<int> received = 0;
std::atomic<bool> terminal = false;
static_assert(StopFlag::is_always_lock_free && std::atomic<UnderWay>::is_always_lock_free);

void on_signal(int signal) {
  received = signal;
  const bool again = stop.exchange(true);
  if (!again && under_way != UnderWay::NothingToLose) return;
  kill_group();
  remove_unfinished();
  if (terminal) write_all(kStandardError, "\r\033[K");  // half a line of progress may be there
  write_all(kStandardError, "dea: stopped\n");
  std::_Exit(128 + signal);
}

}  // namespace

void watch_interrupts() {
  terminal = stderr_is_terminal();
  handle_interrupts(on_signal);
}

void now_under_way(UnderWay what) {
  end_if_stopped(&stop);
  under_way = what;
  end_if_stopped(&stop);  // asked for in between
}

const StopFlag* stop_flag() { return &stop; }

const char* stopped_line() {
  const UnderWay what = under_way;
  if (what == UnderWay::Cases) return "dea: stopped; cases that are done are in the file, the same command goes on";
  return what == UnderWay::Writing ? "dea: stopped before all files were written" : "dea: stopped, nothing was written";
}

int stopped_code() { return 128 + received; }

}  // namespace dea
