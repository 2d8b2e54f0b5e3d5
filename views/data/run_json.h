// views/data/run_json.h – settings, what was recognised in a model, runs and convergence studies as JSON. Undefined
// numbers are null.
#pragma once
#include <functional>

#include "src/run/analysis.h"
#include "src/run/check.h"
#include "src/run/convergence.h"
#include "views/data/json.h"

namespace dea {

/// Where the time of a run went, in seconds.
struct Timings {
  double read = 0.0, joint = 0.0, solve = 0.0, write = 0.0, total = 0.0;
};

Json settings_json(const Settings& settings);
Json info_json(const JointModel& model, const Settings& settings, const JointCheck& check);
/// One state, and one contact in it, as run_json has them.
Json state_json(const JointModel& model, const Joint& joint, const StateResult& state);
Json contact_json(const JointModel& model, const Joint& joint, const ContactPair& pair,
                  const ContactStatistics& statistics, const ContactFields& fields);
Json run_json(const JointModel& model, const Settings& settings, const Analysis& analysis, const Timings& timings);
/// The text of run_json in pieces, with one state at a time in memory.
void put_run_json(const JointModel& model, const Settings& settings, const Analysis& analysis, const Timings& timings,
                  const std::function<void(const std::string& piece)>& put);
Json converge_json(const JointModel& model, const Settings& settings, const std::vector<Convergence>& studies,
                   double target, int max_springs);

}  // namespace dea
