#include <febiodea/run/refusals.h>

#include <fmt/format.h>

#include <algorithm>

#include <febiodea/base/names.h>
#include <febiodea/base/numbers.h>
#include <febiodea/equilibrium/conditions.h>
#include <febiodea/joint/bodies.h>
#include <febiodea/joint/joint.h>
#include <febiodea/run/analysis.h>

namespace dea {

namespace {

void add_once(std::vector<std::string>& lines, const std::string& line) {
  if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
}

void add(std::vector<std::string>& lines, const InputError& error) {
  add_once(lines, error.what());
  for (const std::string& other : error.others) add_once(lines, other);
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

std::vector<std::string> refusals(const JointModel& model, const Settings& settings, bool all_states) {
  std::vector<std::string> lines;
  const bool sliding = std::any_of(model.contacts.begin(), model.contacts.end(),
                                   [](const Contact& c) { return c.kind == Contact::Kind::Sliding; });
  if (!sliding) lines.push_back(no_sliding_contact(model));
  const std::string no_body = no_rigid_body(model, settings);
  if (!no_body.empty()) lines.push_back(no_body);
  try {
    refuse_unsupported(model);
  } catch (const InputError& error) {
    add(lines, error);
  }
  Joint joint;
  bool recognised = false;
  if (sliding && no_body.empty()) {
    try {
      joint = make_joint(model, settings);
      recognised = true;
    } catch (const InputError& error) {
      add(lines, error);
    }
  }
  // the value of a controller that cannot be evaluated is asked for by no one
  const bool controllers = std::all_of(model.controllers.begin(), model.controllers.end(),
                                       [](const LoadController& c) { return c.unsupported.empty(); });
  if (recognised && controllers) {
    const std::vector<double> starts = step_starts(model);
    for (int s = 0; s < static_cast<int>(model.steps.size()); ++s) {
      try {
        make_load_case(model, joint, settings, s, starts[at(s) + 1]);
      } catch (const InputError& error) {
        add(lines, error);
      }
    }
  }
  try {
    model_times(model, !all_states);
  } catch (const InputError& error) {
    add(lines, error);
  }
  return lines;
}

InputError all_refusals(const JointModel& model, const Settings& settings, const InputError& found, bool all_states) {
  std::vector<std::string> lines = refusals(model, settings, all_states);
  if (lines.empty()) add(lines, found);  // found while solving
  InputError error(lines.front());
  error.others.assign(lines.begin() + 1, lines.end());
  return error;
}

}  // namespace dea
