// io/study/run_study.h – the cases of a plan solved, several at a time.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "io/settings/settings_xml.h"
#include "src/base/stop.h"
#include "src/study/case.h"
#include "src/study/plan.h"

namespace dea {

class ReadyJoints;

struct StudyOptions {
  std::string states;             ///< as --states; empty: all
  std::string settings_file;      ///< as --settings; empty: none
  int workers = 1;                ///< cases solved at a time
  double memory = 2e9;            ///< bytes that prepared joints may take together; the least recently used go first
  ReadyJoints* joints = nullptr;  ///< kept from one call to the next, with its own limit; nullptr: of this call
  bool keep_fields = false;       ///< CaseState::fields, CaseResult::surfaces
  std::string plot_folder;        ///< a plot file per case goes there; empty: none
  const StopFlag* stop = nullptr;
  /// A case is done. Called by one thread at a time, in the order in which cases end.
  std::function<void(CaseResult&&)> done;
};

/// Solves the cases of these indices in plan.cases. What a case can be refused for is its result; the rest of the study
/// goes on. The same case gives the same bits, whatever others are solved beside it, before it, or not at all. Throws
/// what `done` throws, after the cases at work have ended, and Stopped.
void run_study(const Plan& plan, const std::vector<std::size_t>& cases, const StudyOptions& options);

}  // namespace dea
