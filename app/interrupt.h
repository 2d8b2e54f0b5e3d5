// app/interrupt.h – Ctrl-C: a search and the writing of results end in order, all else ends at once.
#pragma once
#include "src/base/stop.h"

namespace dea {

/// What an interrupt finds under way.
enum class UnderWay {
  NothingToLose,  ///< reading, recognising, placing springs: the program ends at once
  Search,         ///< the stop flag is set, and looked at again and again
  Cases,          ///< the stop flag is set, and looked at; cases that are done are in the study's file
  Writing         ///< the stop flag is set, and looked at between files
};

/// From here on SIGINT, SIGQUIT, SIGTERM and SIGHUP end the program as UnderWay says; a second one ends it at once,
/// whatever is under way. A signal that the program was started without (nohup) stays ignored.
void watch_interrupts();

/// Throws Stopped if a stop was asked for in what was under way until now.
void now_under_way(UnderWay what);

/// Set by the first interrupt. Lives as long as the program.
const StopFlag* stop_flag();

/// One line for standard error about a stop in order, and the exit code: 128 + signal, 130 for Ctrl-C.
const char* stopped_line();
int stopped_code();

}  // namespace dea
