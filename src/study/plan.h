// febiodea/study/plan.h – a study: which models are solved with which options, as cases in order.
#pragma once
#include <string>
#include <vector>

#include <febiodea/study/sampling.h>

namespace dea {

/// One option of `dea run` that differs from case to case: "tilt: rotate pelvis=0,1,0,{-20:20:5}".
struct Factor {
  std::string name;           ///< of its column in cases, CSV, Python and pages: "tilt"
  std::string option;         ///< without dashes: "rotate"
  std::string before, after;  ///< the option's text around the value: "pelvis=0,1,0,", ""
  std::vector<std::string> values;  ///< of {START:STOP:STEP} or {a|b|c}; empty: `spread`, or from a table of cases ({})
  Spread spread;                    ///< of {uniform(8,16)} and its like; kind None: not sampled
};

/// One option of the line.
struct PlanOption {
  std::string name;  ///< of a setting, without dashes
  std::string text;  ///< its value; empty where `factor` has it
  int factor = -1;   ///< index; -1: the same in every case
};

/// A case: one model with one value of every factor. It depends on nothing but these and the plan's options.
struct PlannedCase {
  int model = 0;                    ///< index
  std::vector<std::string> values;  ///< one per factor
};

struct Plan {
  std::vector<std::string> models;  ///< paths, as they were given
  std::vector<PlanOption> options;  ///< of every case, in the order of the line: placements act in it
  std::vector<Factor> factors;
  std::vector<PlannedCase> cases;  ///< number of a case: its index + 1. Models are the slowest to change, then the
                                   ///< factors in their order
};

/// The option of a case as it stands on the line: name and whole text.
struct CaseOption {
  std::string name, text;
};
/// All options of a case, in the order of the line.
std::vector<CaseOption> options_of(const Plan& plan, const PlannedCase& c);

}  // namespace dea
