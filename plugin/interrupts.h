// plugin/interrupts.h – Ctrl-C while the task works.
#pragma once
#include "src/base/stop.h"

namespace dea {

/// For as long as it lives SIGINT (Ctrl-C) and SIGTERM set a flag, and a second one ends the program at once, without
/// unfinished files. FEBio's own handler of SIGINT only makes a note for FEBio's solve, which a task has no part in; it
/// is back afterwards.
class Interrupts {
 public:
  Interrupts();
  ~Interrupts();
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

  const StopFlag* stop() const;

 private:
  using Handler = void (*)(int);
  Handler before_[2];
};

}  // namespace dea
