#include "src/run/recognise.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/equilibrium/connectors.h"
#include "src/equilibrium/load_case.h"
#include "src/equilibrium/rows.h"
#include "src/equilibrium/times.h"
#include "src/facts/bodies.h"
#include "src/facts/left_out.h"
#include "src/facts/node_holds.h"
#include "src/facts/split_surfaces.h"
#include "src/joint/placing.h"
#include "src/joint/surface_names.h"
#include "src/model/load_curve.h"
#include "src/model/sound_mesh.h"
#include "src/results/inside_fields.h"

namespace dea {

namespace {

template <class Step>
void try_to(std::vector<Fault>& faults, const Step& step) {
  try {
    step();
  } catch (const InputError& error) {
    add_once(faults, error);
  }
}

/// No rigid body, where only a material taken as rigid could give one; nothing, if there is one, or nodes that are
/// moved.
std::optional<Fault> no_rigid_body(const JointModel& model, const Settings& settings) {
  const std::vector<char> rigid = rigid_materials(model, settings);
  if (std::find(rigid.begin(), rigid.end(), 1) != rigid.end() || moves_nodes(model)) return std::nullopt;
  const std::vector<std::string> names = every_name(model.materials);
  if (names.size() == 1)  // it is the cartilage's, or there is none
    return make_fault(model, {0, 0}, say("no rigid body in the model, whose only material is {};", name_list(names)),
                      "DEA presses cartilage between two bones, which are rigid bodies: add them to the model, each "
                      "with a material of type \"rigid body\"");
  return make_fault(model, {0, 0}, "no rigid body in the model;",
                    say("DEA needs the bones as rigid bodies, and cartilage on them: give a bone a material of type "
                        "\"rigid body\", or take its material as rigid with {} (materials: {})",
                        NamedSetting{"rigid", "", "MATERIAL"}, name_list(names)));
}

std::vector<Fault> unsupported_faults(const JointModel& model) {
  std::vector<Fault> faults;
  for (const Remark& r : model.unsupported)
    faults.push_back(
        make_fault(model, r.origin,
                   say("{}{} is not supported and would change the result:", r.what,
                       r.count > 1 ? fmt::format(" ({} times)", r.count) : ""),
                   r.advice.empty() ? "take it out, or use what DEA supports (docs/formats.md)" : r.advice));
  return faults;
}

/// The frames that other settings name. Throws UsageError: one of them is not there.
Findings frame_findings(const Settings& settings) {
  std::vector<std::string> named;
  const auto add_name = [&](const std::string& frame) {
    if (!frame.empty() && std::find(named.begin(), named.end(), frame) == named.end()) named.push_back(frame);
  };
  for (const Placement& p : settings.placements) {
    global_vector(settings, p);
    add_name(p.frame);
  }
  for (const auto& entry : settings.force) {
    global_force(settings, entry.first);
    const auto frame = settings.force_frame.find(entry.first);
    if (frame != settings.force_frame.end()) add_name(frame->second);
  }
  const TableFrame& table = settings.loads.frame;
  if (table.kind == TableFrame::Kind::Named) {
    frame_axes(settings, table.frame, {"load-frame", "", "frame:" + table.frame});
    add_name(table.frame);
  }
  Findings found;
  for (const std::string& frame : named) {
    const Eigen::Matrix3d axes = settings.frames.at(frame);
    const auto axis = [&](int k) {
      return fmt::format("{} ({:.4f}, {:.4f}, {:.4f})", std::string(1, "xyz"[k]), axes(0, k) + 0.0, axes(1, k) + 0.0,
                         axes(2, k) + 0.0);
    };
    found.push_back({"frame", {}, {{"frame", frame}, {"x", axis(0)}, {"y", axis(1)}, {"z", axis(2)}}});
  }
  return found;
}

}  // namespace

void refuse_unsupported(const JointModel& model) { throw_if_any(unsupported_faults(model)); }

Loading check_loading(const JointModel& model, const Joint& joint, const Settings& settings) {
  check_inside(joint, settings);
  Loading loading;
  add_once(loading.findings, frame_findings(settings));
  if (!settings.placements.empty()) {
    add_once(loading.findings, placement_findings(model, joint, settings));
    add_once(loading.faults, broken_connectors(model, joint, starting_poses(model, joint, settings)));
  }
  // what has no value (a controller with a misspelt word) is a fault found elsewhere: here none is asked for one
  if (controllers_have_values(model)) {
    const std::vector<double> starts = step_starts(model);
    for (int s = 0; s < static_cast<int>(model.steps.size()); ++s)
      try_to(loading.faults, [&] { make_load_case(model, joint, settings, s, starts[at(s) + 1]); });
  }
  if (!loading.faults.empty() || !controllers_have_values(model)) return loading;
  check_rows(model, joint, settings);
  add_once(loading.findings, row_findings(model, joint, settings));
  add_once(loading.findings, seating_steps(model, joint, settings));
  return loading;
}

Recognition recognise_joint(JointModel given, Settings settings) {
  const auto start = std::chrono::steady_clock::now();
  Recognition r;
  r.model = std::move(given);
  r.settings = std::move(settings);
  const Findings left_out = leave_out(r.model, r.settings);
  const JointModel& model = r.model;
  const bool sliding = std::any_of(model.contacts.begin(), model.contacts.end(),
                                   [](const Contact& c) { return c.kind == Contact::Kind::Sliding; });
  if (!sliding) r.faults.push_back(no_sliding_contact(model));
  const std::optional<Fault> no_body = no_rigid_body(model, r.settings);
  if (no_body) r.faults.push_back(*no_body);
  add_once(r.faults, unsupported_faults(model));
  if (sliding && !no_body) {
    Findings naming = left_out;
    r.settings = name_surfaces(model, r.settings, naming);
    JointFound found = find_joint(model, r.settings);
    if (!found.faults.empty() && mesh_faults(model).empty())
      if (const Findings divided = split_surfaces(r.model, r.settings); !divided.empty()) {
        add_once(naming, divided);
        found = find_joint(model, r.settings);
      }
    add_once(naming, found.joint.findings);
    found.joint.findings = std::move(naming);
    add_once(r.faults, found.faults);
    r.recognised = found.faults.empty();
    if (r.recognised) r.joint = std::move(found.joint);
  }
  r.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return r;
}

Recognition recognise(JointModel given, Settings settings, bool all_states) {
  const auto start = std::chrono::steady_clock::now();
  Recognition r = recognise_joint(std::move(given), std::move(settings));
  const JointModel& model = r.model;
  if (r.recognised) {
    Loading loading = check_loading(model, r.joint, r.settings);
    add_once(r.faults, loading.faults);
    add_once(r.joint.findings, loading.findings);
  }
  if (row_count(r.settings) == 0) try_to(r.faults, [&] { model_times(model, !all_states); });
  r.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return r;
}

}  // namespace dea
