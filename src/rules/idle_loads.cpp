#include "src/rules/idle_loads.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/equilibrium/load_case.h"
#include "src/equilibrium/times.h"
#include "src/joint/placing.h"
#include "src/model/load_curve.h"

namespace dea {

namespace {

constexpr double kNone = 1e-6;     // of the whole force or moment: digits of turned axes
constexpr std::size_t kRows = 50;  // of a table that are looked at, spread evenly

bool is_free(const BodyConditions& body, int dof) { return body.dofs[at(dof)] == DofState::Free; }

/// The force along axis k moves the body, or turns it.
bool force_acts(const BodyConditions& body, int k) {
  if (is_free(body, k)) return true;
  const Vector3d moment = body.arm.cross(Vector3d::Unit(k));
  for (int j = 0; j < 3; ++j)
    if (is_free(body, 3 + j) && std::abs(moment[j]) > kNone * body.arm.norm()) return true;
  return false;
}

/// Adds what one load case loses.
void add_lost(const BodyConditions& body, const Vector6& load, IdleLoad& idle) {
  for (int k = 0; k < kDofs; ++k) {
    const double whole = k < 3 ? load.head<3>().norm() : load.tail<3>().norm();
    if (!(std::abs(load[k]) > kNone * whole)) continue;
    const bool effect = k < 3 ? force_acts(body, k) : is_free(body, k);
    idle.all = idle.all && !effect;
    idle.lost[at(k)] = idle.lost[at(k)] || !effect;
  }
}

bool loses(const IdleLoad& load) { return std::find(load.lost.begin(), load.lost.end(), true) != load.lost.end(); }

std::string axes_of(const IdleLoad& load, int begin) {
  std::string axes;
  for (int k = 0; k < 3; ++k)
    if (load.lost[at(begin + k)]) axes += fmt::format("{}{}", axes.empty() ? "" : ", ", "xyz"[k]);
  return axes;
}

/// Of steps, spread evenly.
std::vector<LoadCase> ends_of_steps(const JointModel& model, const Joint& joint, const Settings& settings) {
  const std::vector<double> starts = step_starts(model);
  const std::size_t steps = model.steps.size(), count = std::min(steps, kRows);
  std::vector<LoadCase> ends;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t s = count > 1 ? i * (steps - 1) / (count - 1) : 0;
    ends.push_back(make_load_case(model, joint, settings, static_cast<int>(s), starts[s + 1]));
  }
  return ends;
}

/// One of two opposite moments: a joint, or a user, puts one on each of two bodies.
bool of_pair(const JointModel& model, const RigidLoad& load) {
  return std::any_of(model.rigid_loads.begin(), model.rigid_loads.end(), [&](const RigidLoad& other) {
    return other.dof == load.dof && other.material != load.material && other.step == load.step &&
           other.value.factor == -load.value.factor && other.value.controller == load.value.controller;
  });
}

/// The settings load this body by a table.
bool loads_by_table(const JointModel& model, const Joint& joint, const Settings& settings, int body) {
  return !settings.loads.time.empty() && joint.find_body(model, settings.loads.body) == body;
}

/// The settings give a force on this body, or load it by a table.
bool loads_by_settings(const JointModel& model, const Joint& joint, const Settings& settings, int body) {
  return std::any_of(settings.force.begin(), settings.force.end(),
                     [&](const auto& given) { return joint.find_body(model, given.first) == body; }) ||
         loads_by_table(model, joint, settings, body);
}

bool turns(const JointModel& model, const Joint& joint, const Settings& settings, int body) {
  const auto is_it = [&](const std::string& name) { return !name.empty() && joint.find_body(model, name) == body; };
  return (settings.motion.turns && is_it(settings.motion.body)) ||
         std::any_of(settings.placements.begin(), settings.placements.end(),
                     [&](const Placement& p) { return p.kind == Placement::Kind::Rotate && is_it(p.body); });
}

}  // namespace

std::vector<IdleLoad> idle_loads(const JointModel& model, const Joint& joint, const Settings& settings) {
  std::vector<IdleLoad> found;
  const LoadTable& table = settings.loads;
  if (settings.force.empty() && table.time.empty()) return found;
  const std::vector<Pose> start = starting_poses(model, joint, settings);
  const std::size_t rows = row_count(settings);
  const auto row_case = [&](std::size_t row) {
    return make_row_case(model, joint, settings, static_cast<int>(row), start, start);
  };
  const LoadCase end = rows > 0 ? row_case(rows - 1)
                                : make_load_case(model, joint, settings, static_cast<int>(model.steps.size()) - 1,
                                                 step_starts(model).back());
  for (const auto& entry : settings.force) {
    const BodyConditions& body = end.bodies[at(joint.find_body(model, entry.first))];
    Vector6 load = Vector6::Zero();
    load.head<3>() = global_force(settings, entry.first);
    IdleLoad idle{.given = NamedSetting{.setting = "force", .of = entry.first, .bare = true}, .body = entry.first};
    add_lost(body, load, idle);
    if (loses(idle)) found.push_back(std::move(idle));
  }
  if (table.time.empty()) return found;
  const std::size_t b = at(joint.find_body(model, table.body)), count = std::min(rows, kRows);
  IdleLoad idle{.given = NamedSetting{.setting = "loads", .value = table.file, .bare = true}, .body = table.body};
  for (std::size_t i = 0; i < count; ++i) {
    const LoadCase c = row_case(count > 1 ? i * (rows - 1) / (count - 1) : 0);
    const BodyConditions& body = c.bodies[b];
    const Eigen::Matrix3d turned = start[b].rotation;  // loads along the body's own axes
    Vector6 load = body.dead;
    load.head<3>() += turned * body.follower.head<3>();
    load.tail<3>() += turned * body.follower.tail<3>();
    add_lost(body, load, idle);
  }
  if (loses(idle)) found.push_back(std::move(idle));
  return found;
}

Findings idle_model_loads(const JointModel& model, const Joint& joint, const Settings& settings) {
  Findings always, held;  // told always, told where nothing acts
  if (model.rigid_loads.empty()) return held;
  const std::vector<LoadCase> ends = ends_of_steps(model, joint, settings);
  bool acts = !model.rigid_followers.empty() || !joint.point_loads.empty();  // another load presses
  for (const RigidLoad& load : model.rigid_loads) {
    const int b = joint.body_of(load.material);
    if (b < 0) continue;
    bool idle = true, any = false;
    for (const LoadCase& end : ends) {
      if (!load.acts(end.step)) continue;
      const BodyConditions& body = end.bodies[at(b)];
      any = any || value(model, load.value, end.time) != 0;
      idle = idle && !(load.dof < 3 ? force_acts(body, load.dof) : is_free(body, load.dof));
    }
    acts = acts || (any && !idle);
    const bool moment = load.dof >= 3;
    const bool replaced =
        moment ? loads_by_table(model, joint, settings, b) : loads_by_settings(model, joint, settings, b);
    if (!any || !idle || replaced || load.kind != RigidLoad::Kind::Dead || load.relative) continue;
    if (moment && of_pair(model, load)) continue;
    const bool moved = ends.back().bodies[at(b)].dofs[at(load.dof)] == DofState::Prescribed;
    (moved || moment ? always : held)
        .push_back({"idle-model-load",
                    {.body = joint.bodies[at(b)].name},
                    {{"load", load.name.empty() ? "" : fmt::format(" \"{}\"", load.name)},
                     {"axis", "xyz"[load.dof % 3]},
                     {"by", !moved   ? "held"
                            : moment ? "turned as prescribed"
                                     : "moved as prescribed"}},
                    moment ? 1 : 0});
  }
  if (!acts && settings.force.empty() && settings.loads.time.empty())
    always.insert(always.end(), held.begin(), held.end());
  return always;
}

Findings idle_load_points(const JointModel& model, const Joint& joint, const Settings& settings) {
  Findings idle;
  if (settings.load_at.empty()) return idle;
  const std::vector<LoadCase> ends = ends_of_steps(model, joint, settings);
  for (const auto& [name, point] : settings.load_at) {
    const int b = joint.find_body(model, name);
    const bool force = loads_by_settings(model, joint, settings, b) ||
                       std::any_of(model.rigid_loads.begin(), model.rigid_loads.end(), [&](const RigidLoad& load) {
                         return load.dof < 3 && joint.body_of(load.material) == b;
                       });
    const bool turns = std::any_of(ends.begin(), ends.end(), [&](const LoadCase& end) {
      const BodyConditions& body = end.bodies[at(b)];
      return is_free(body, 3) || is_free(body, 4) || is_free(body, 5);
    });
    const NamedSetting given{.setting = "load-at", .of = name, .bare = true};
    if (!force || !turns)
      idle.push_back({"idle-load-point",
                      {.body = joint.bodies[at(b)].name},
                      {{"given", given}, {"give", NamedSetting{"force", name, "x,y,z"}}},
                      force ? 1 : 0});
  }
  return idle;
}

Sentence instead_of(const IdleLoad& load) {
  const bool moment = load.lost[3] || load.lost[4] || load.lost[5];
  return say("load another body, or let it move ({})",
             NamedSetting{.setting = "free", .of = load.body, .value = moment ? "x,y,z,Ru,Rv,Rw" : "x,y,z"});
}

std::string idle_in_words(const IdleLoad& load) {
  const std::string along = axes_of(load, 0), about = axes_of(load, 3);
  const std::string ways =
      fmt::format("{}{}{}", along.empty() ? "" : "move along " + along, along.empty() || about.empty() ? "" : " or ",
                  about.empty() ? "" : "turn about " + about);
  std::string what;
  if (load.all)
    what = "this load has no effect";
  else if (about.empty())
    what = "this part of the force has no effect";
  else
    what = "these parts of the load have no effect";
  return fmt::format("body \"{}\" is not free to {} at the end of the last step; {}", load.body, ways, what);
}

Findings idle_findings(const std::vector<IdleLoad>& loads) {
  Findings found;
  for (IdleLoad load : loads) {
    if (!load.all) std::fill(load.lost.begin() + 3, load.lost.end(), false);
    if (loses(load))
      found.push_back({"idle-load", {.body = load.body}, {{"given", load.given}, {"why", idle_in_words(load)}}});
  }
  return found;
}

Findings idle_settings(const JointModel& model, const Joint& joint, const Settings& settings) {
  std::set<std::string> sliding;  // surfaces, also of contacts that the settings leave out
  for (const Contact& c : model.contacts)
    if (c.kind == Contact::Kind::Sliding)
      for (const int surface : {c.primary, c.secondary}) sliding.insert(model.surfaces[at(surface)].name);
  Findings idle;
  const auto look_at = [&](const char* setting, const auto& by_surface) {
    for (const auto& entry : by_surface)
      if (!entry.first.empty() && sliding.count(entry.first) == 0)
        idle.push_back({"idle-setting",
                        {.surface = entry.first},
                        {{"given", NamedSetting{.setting = setting, .of = entry.first, .bare = true}}}});
  };
  look_at("attach", settings.attach);
  look_at("bone", settings.bone);
  look_at("thickness", settings.thickness);
  look_at("thickness-from", settings.thickness_from);
  look_at("thickness-scale", settings.thickness_scale);
  look_at("E", settings.E);
  look_at("nu", settings.nu);
  for (const auto& entry : settings.rotate_about)
    if (!turns(model, joint, settings, joint.find_body(model, entry.first)))
      idle.push_back({"idle-setting",
                      {.body = entry.first},
                      {{"given", NamedSetting{.setting = "rotate-about", .of = entry.first, .bare = true}},
                       {"turn", NamedSetting{"rotate", entry.first, "x,y,z,DEGREES"}}},
                      1});
  return idle;
}

}  // namespace dea
