#include <febiodea/run/recognise.h>

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <chrono>

#include <febiodea/base/names.h>
#include <febiodea/base/numbers.h>
#include <febiodea/equilibrium/load_case.h>
#include <febiodea/equilibrium/times.h>
#include <febiodea/joint/bodies.h>

namespace dea {

namespace {

/// Each once. A line begins with its place, if it has one: "hip.feb:214: ".
void add(std::vector<Fault>& faults, const InputError& error) {
  std::vector<std::string> lines = error.others;
  lines.insert(lines.begin(), error.what());
  for (const std::string& text : lines) {
    Fault fault;
    fault.text = text;
    if (text == error.what() && !error.place.empty() && text.rfind(error.place + ": ", 0) == 0)
      fault = {error.place, text.substr(error.place.size() + 2)};
    if (std::none_of(faults.begin(), faults.end(), [&](const Fault& f) { return line(f) == line(fault); }))
      faults.push_back(std::move(fault));
  }
}

/// No rigid body, where nothing else than --rigid could give one: empty if there is one, or nodes that are moved.
std::string no_rigid_body(const JointModel& model, const Settings& settings) {
  const std::vector<char> rigid = rigid_materials(model, settings);
  if (std::find(rigid.begin(), rigid.end(), 1) != rigid.end() || !model.prescribed_nodes.empty()) return "";
  std::vector<std::string> names;
  for (const Material& m : model.materials) names.push_back(m.name);
  if (names.size() == 1)  // it is the cartilage's, or there is none
    return where(model, {0, 0}) +
           fmt::format(
               "no rigid body in the model, whose only material is {}; DEA presses cartilage between two bones, which "
               "are "
               "rigid bodies: add them to the model, each with a material of type \"rigid body\"",
               name_list(names));
  return where(model, {0, 0}) +
         fmt::format(
             "no rigid body in the model; DEA needs the bones as rigid bodies, and cartilage on them: give a bone a "
             "material of type \"rigid body\", or take its material as rigid with --rigid \"MATERIAL\" (materials: {})",
             name_list(names));
}

}  // namespace

std::string unsupported_line(const JointModel& model, const Remark& r) {
  return fmt::format("{}{}{} is not supported and would change the result: {}", where(model, r.origin), r.what,
                     r.count > 1 ? fmt::format(" ({} times)", r.count) : "",
                     r.advice.empty() ? "take it out, or use what DEA supports (docs/formats.md)" : r.advice);
}

void refuse_unsupported(const JointModel& model) {
  std::vector<std::string> lines;
  for (const Remark& r : model.unsupported) lines.push_back(unsupported_line(model, r));
  if (lines.empty()) return;
  InputError error(lines.front());
  error.others.assign(lines.begin() + 1, lines.end());
  throw error;
}

std::string line(const Fault& fault) { return fault.place.empty() ? fault.text : fault.place + ": " + fault.text; }

InputError as_error(const Recognition& recognition) {
  assert(!recognition.faults.empty());
  InputError error(line(recognition.faults.front()));
  for (std::size_t i = 1; i < recognition.faults.size(); ++i) error.others.push_back(line(recognition.faults[i]));
  return error;
}

Recognition recognise(JointModel given, Settings settings, bool all_states) {
  const auto start = std::chrono::steady_clock::now();
  Recognition r;
  r.model = std::move(given);
  r.settings = std::move(settings);
  const JointModel& model = r.model;
  const auto try_to = [&](const auto& step) {
    try {
      step();
      return true;
    } catch (const InputError& error) {
      add(r.faults, error);
      return false;
    }
  };
  const bool sliding = std::any_of(model.contacts.begin(), model.contacts.end(),
                                   [](const Contact& c) { return c.kind == Contact::Kind::Sliding; });
  if (!sliding) add(r.faults, InputError(no_sliding_contact(model)));
  const std::string no_body = no_rigid_body(model, r.settings);
  if (!no_body.empty()) add(r.faults, InputError(no_body));
  try_to([&] { refuse_unsupported(model); });
  if (sliding && no_body.empty()) r.recognised = try_to([&] { r.joint = make_joint(model, r.settings); });
  // the value of a controller that cannot be evaluated is asked for by no one
  const bool controllers = std::all_of(model.controllers.begin(), model.controllers.end(),
                                       [](const LoadController& c) { return c.unsupported.empty(); });
  if (r.recognised && controllers) {
    const std::vector<double> starts = step_starts(model);
    for (int s = 0; s < static_cast<int>(model.steps.size()); ++s)
      try_to([&] { make_load_case(model, r.joint, r.settings, s, starts[at(s) + 1]); });
  }
  try_to([&] { model_times(model, !all_states); });
  r.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return r;
}

}  // namespace dea
