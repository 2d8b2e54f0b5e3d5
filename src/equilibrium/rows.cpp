#include "src/equilibrium/rows.h"

#include <fmt/format.h>

#include <cmath>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/base/time_text.h"
#include "src/equilibrium/equilibrium.h"
#include "src/equilibrium/load_case.h"
#include "src/equilibrium/times.h"
#include "src/joint/placing.h"

namespace dea {

namespace {

void refuse_ground(const Joint& joint, const JointModel& model, const char* setting, const std::string& name) {
  if (joint.bodies[at(joint.find_body(model, name))].ground)
    throw wrong_setting(setting, name, "the ground never moves;", "name a rigid body");
}

bool loads_given(const Settings& s) { return !s.loads.time.empty(); }
bool motion_given(const Settings& s) { return !s.motion.time.empty(); }

/// The first row from the starting poses. Throws where a frame of the table cannot be followed.
LoadCase first_row(const JointModel& model, const Joint& joint, const Settings& s) {
  const std::vector<Pose> start = starting_poses(model, joint, s);
  return make_row_case(model, joint, s, 0, start, start);
}

std::string frame_words(const TableFrame& frame) {
  std::string words;
  if (frame.kind == TableFrame::Kind::Named) words = fmt::format("; axes of frame \"{}\"", frame.frame);
  if (frame.kind == TableFrame::Kind::Named && !frame.body.empty())
    words += fmt::format(", turned with body \"{}\" to where it starts", frame.body);
  if (frame.kind == TableFrame::Kind::Body) words = fmt::format("; axes of body \"{}\" where it starts", frame.body);
  return words;
}

}  // namespace

void check_rows(const JointModel& model, const Joint& joint, const Settings& s) {
  if (s.loads.load.size() != s.loads.time.size() || (loads_given(s) && s.loads.body.empty()))
    throw wrong_setting("loads", s.loads.file, "its times, rows and body do not go together;", "give all of them");
  if (s.motion.motion.size() != s.motion.time.size() || (motion_given(s) && s.motion.body.empty()))
    throw wrong_setting("motion", s.motion.file, "its times, rows and body do not go together;", "give all of them");
  if (loads_given(s)) {
    refuse_ground(joint, model, "load-body", s.loads.body);
    const int body = joint.find_body(model, s.loads.body);
    for (const auto& entry : s.force)
      if (joint.find_body(model, entry.first) == body)
        throw UsageError(Fault{.given = NamedSetting{"force", entry.first},
                               .found = "the table of loads acts on this body too;",
                               .expected = "leave one of them out"});
  }
  if (motion_given(s)) refuse_ground(joint, model, "motion-body", s.motion.body);
  if (loads_given(s) && motion_given(s)) {
    const auto& a = s.loads.time;
    const auto& b = s.motion.time;
    bool same = a.size() == b.size();
    for (std::size_t r = 0; same && r < a.size(); ++r)
      same = std::abs(a[r] - b[r]) <= 1e-6 * std::max({std::abs(a.front()), std::abs(a.back()), 1e-300});
    if (!same)
      throw wrong_setting(
          "motion", s.motion.file,
          say("its rows ({}, {} to {}) are not at the times of the loads' ({}, {} to {});", b.size(),
              time_text(b.front()), time_text(b.back()), a.size(), time_text(a.front()), time_text(a.back())),
          "give both tables the same times");
  }
  if (row_count(s) > 0) first_row(model, joint, s);
}

Findings row_findings(const JointModel& model, const Joint& joint, const Settings& s) {
  Findings found;
  const int from = s.skip_steps ? 1 : 0;
  if (loads_given(s)) {
    const LoadCase first = first_row(model, joint, s);
    const std::size_t b = at(joint.find_body(model, s.loads.body));
    const BodyConditions& body = first.bodies[b];
    const Eigen::Matrix3d turned = prescribed_poses(joint, first, first.start, first.start)[b].rotation;
    const Vector3d force = body.dead.head<3>() + turned * body.follower.head<3>(),
                   moment = body.dead.tail<3>() + turned * body.follower.tail<3>(),
                   point = joint.bodies[b].center_of_mass + body.arm;
    const Subject subject = {.body = s.loads.body};
    found.push_back({"loads-table", subject, {{"table", s.loads.words.empty() ? "a table" : s.loads.words}}, from});
    if (!s.loads.doubt.empty())
      found.push_back(
          {"body-weight", subject, {{"weight", s.loads.body_weight.value_or(0.0)}, {"doubt", s.loads.doubt}}});
    found.push_back({"loads-first-row",
                     subject,
                     {{"force_x", force.x()},
                      {"force_y", force.y()},
                      {"force_z", force.z()},
                      {"moment_x", moment.x()},
                      {"moment_y", moment.y()},
                      {"moment_z", moment.z()},
                      {"x", point.x()},
                      {"y", point.y()},
                      {"z", point.z()},
                      {"axes", frame_words(s.loads.frame)}},
                     s.load_at.count(s.loads.body) ? 1 : 0});
    int free = 0;
    for (DofState d : body.dofs) free += d == DofState::Free;
    if (free == 0) found.push_back({"table-without-effect", subject});
    const bool moments = std::any_of(s.loads.load.begin(), s.loads.load.end(),
                                     [](const Vector6& load) { return !load.tail<3>().isZero(0); });
    if (free > 0 && moments && std::count(body.dofs.begin() + 3, body.dofs.end(), DofState::Free) == 0)
      found.push_back({"table-without-effect", subject, {}, 1});
  }
  if (motion_given(s))
    found.push_back({"motion-table",
                     {.body = s.motion.body},
                     {{"table", s.motion.words.empty() ? "a table" : s.motion.words},
                      {"rotations", !s.motion.turns         ? ", translations alone"
                                    : s.motion.about_origin ? ""
                                    : s.motion.rotation == "vector"
                                        ? ", rotation vectors"
                                        : fmt::format(", angles about x, y and z in the order {}", s.motion.rotation)},
                      {"center", !s.motion.turns || s.motion.about_origin  ? ""
                                 : s.rotate_about.count(s.motion.body) > 0 ? ", about the point it is turned about"
                                                                           : ", about its centre of mass"}},
                     from});
  if (motion_given(s)) add_once(found, matrix_units(s.motion, {"motion-units", "", "m"}));
  if (row_count(s) == 0 && s.skip_steps) found.push_back({"steps-skipped", {.time = step_starts(model).back()}});
  return found;
}

Findings matrix_units(const MotionTable& motion, const NamedSetting& give) {
  if (motion.doubt.empty()) return {};
  NamedSetting stays = give;
  stays.value = "mm";
  return {{"matrix-units",
           {.body = motion.body},
           {{"file", motion.file}, {"doubt", motion.doubt}, {"give", give}, {"stays", stays}}}};
}

Findings seating_steps(const JointModel& model, const Joint& joint, const Settings& s) {
  if (s.skip_steps || model.steps.size() < 2) return {};
  const std::vector<double> starts = step_starts(model);
  std::vector<LoadCase> ends;
  for (int step = 0; step < static_cast<int>(model.steps.size()); ++step)
    ends.push_back(make_load_case(model, joint, s, step, starts[at(step) + 1]));
  for (std::size_t b = 0; b < joint.bodies.size(); ++b)
    for (std::size_t step = 0; step + 1 < ends.size(); ++step) {
      bool moved = false, let_go = false;
      for (std::size_t k = 0; k < kDofs; ++k) {
        const bool driven = ends[step].bodies[b].dofs[k] == DofState::Prescribed &&
                            ends[step].bodies[b].value[static_cast<Eigen::Index>(k)] != 0.0;
        moved = moved || driven;
        let_go = let_go || (driven && ends.back().bodies[b].dofs[k] == DofState::Free);
      }
      if (moved && let_go)
        return {{"step-seats-bones",
                 {.body = joint.bodies[b].name},
                 {{"step", step + 1}, {"skip", NamedSetting{"skip-steps"}}}}};
    }
  return {};
}

}  // namespace dea
