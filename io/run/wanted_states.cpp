#include "io/run/wanted_states.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/xplt/xplt.h"
#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/base/say.h"
#include "src/base/time_text.h"

namespace dea {

States wanted_states(const JointModel& model, const Settings& settings, const OutputSettings& outputs,
                     const std::string& times_from) {
  const std::string &states = outputs.states, &option = outputs.states_given;
  StatesAsked asked;
  try {
    asked = parse_states(states);
  } catch (const BadValue& bad) {
    throw UsageError(fmt::format("{}: {}", option, bad.what()));
  }
  if (row_count(settings) > 0 || settings.skip_steps) {
    if (!times_from.empty())
      throw UsageError(Fault{.given = NamedSetting{"times-from", "", times_from},
                             .found = say("found {} beside it,",
                                          settings.skip_steps ? say("{}", NamedSetting{"skip-steps", "", "", "", true})
                                                              : Sentence("a table of loads or motion")),
                             .expected = "expected the model's own steps"});
    return row_states(model, settings, asked, option);
  }
  ResultTimes times;
  if (times_from.empty()) {
    times.times = model_times(model, states != "all");
  } else {
    const XpltFile file = read_xplt(times_from);
    if (file.states.empty())
      throw InputError(times_from + ": found no complete state, expected the times of at least one");
    std::vector<double> found;
    for (const XpltState& state : file.states) found.push_back(state.time);
    times = times_of_result(model, found, times_from);
  }
  if (asked.all && times_from.empty()) return all_states(std::move(times.times));
  std::vector<double> own = times.of_result, chosen = asked.times;
  if (own.empty())
    for (const TimePoint& p : times.times) own.push_back(p.time);
  for (double t : own)
    if (asked.all || asks_for(asked, t)) chosen.push_back(t);
  if (asked.last) chosen.push_back(*std::max_element(own.begin(), own.end()));
  if (chosen.empty())
    throw UsageError(fmt::format("{}: found no state of the model in this range, expected times from {} to {}", option,
                                 time_text(own.front()), time_text(own.back())));
  return choose_states(model, std::move(times.times), chosen, option);
}

Findings findings_of_states(const JointModel& model, const OutputSettings& outputs, const std::string& times_from,
                            const States& states) {
  const std::string& asked = outputs.states;
  if (!times_from.empty() || asked == "all" || states.times.back().row >= 0) return {};
  if (asked.empty() && very_many_time_steps(model)) return {states_thinned(model, states.times.size())};
  if (!asked.empty() && many_states_left_out(model, states.times)) return {states_left_out(model, states.times.size())};
  return {};
}

bool wants_all_states(const OutputSettings& outputs, const std::string& times_from) {
  return outputs.states == "all" && times_from.empty();
}

}  // namespace dea
