#include "plugin/interrupts.h"

#include <csignal>
#include <cstdlib>

#include "io/files/output.h"
#include "io/files/system.h"

namespace dea {

namespace {

constexpr int kSignals[2] = {SIGINT, SIGTERM};
StopFlag stop_asked = false;
static_assert(StopFlag::is_always_lock_free);  // a handler may set nothing else

void on_signal(int signal) {
  std::signal(signal, on_signal);
  if (!stop_asked.exchange(true)) return;
  remove_unfinished();
  write_all(kStandardError, "dea: stopped\n");
  std::_Exit(128 + signal);
}

}  // namespace

Interrupts::Interrupts() {
  stop_asked = false;
  for (int i = 0; i < 2; ++i) {
    before_[i] = std::signal(kSignals[i], on_signal);
    if (before_[i] == SIG_IGN) std::signal(kSignals[i], SIG_IGN);
  }
}

Interrupts::~Interrupts() {
  for (int i = 0; i < 2; ++i) std::signal(kSignals[i], before_[i] == SIG_ERR ? SIG_DFL : before_[i]);
}

const StopFlag* Interrupts::stop() const { return &stop_asked; }

}  // namespace dea
