#include "src/build/free_dofs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/base/numbers.h"
#include "src/base/rotations.h"

namespace dea {

namespace {

using Eigen::Vector3d;

Vector3d middle_of(const BuiltLayer& layer) { return surface_extent(mesh_of(layer.face())).centroid; }

/// The middles of its two contacts with one bone that lie farthest apart; zero: it has no two with any.
Vector3d between_compartments(const BuiltJoint& joint, int body) {
  Vector3d widest = Vector3d::Zero();
  const auto other_layer = [&](const BuiltContact& c) {
    if (joint.layers[at(c.primary)].body == body) return c.secondary;
    return joint.layers[at(c.secondary)].body == body ? c.primary : -1;
  };
  for (std::size_t a = 0; a < joint.contacts.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const int one = other_layer(joint.contacts[a]), two = other_layer(joint.contacts[b]);
      if (one < 0 || two < 0 || joint.layers[at(one)].body != joint.layers[at(two)].body) continue;
      // of the two layers of a contact the primary is the smaller: where the compartment is
      const Vector3d apart = middle_of(joint.layers[at(joint.contacts[a].primary)]) -
                             middle_of(joint.layers[at(joint.contacts[b].primary)]);
      if (apart.norm() > widest.norm()) widest = apart;
    }
  return widest;
}

int nearest_axis(const Vector3d& direction) {
  int axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  return axis;
}

struct Choice {
  DofFlags held = {false, false, false, true, true, true};
  std::string why;
};

Choice choice_for(const BuildRequest& request, const BuiltJoint& joint, int body) {
  const BuiltBody& b = joint.bodies[at(body)];
  Choice choice;
  if (b.ball) {
    choice.why = "a ball turns without resistance";
    return choice;
  }
  const Vector3d apart = between_compartments(joint, body);
  if (apart.isZero(0)) {
    choice.why = "one compartment alone does not say how it turns";
    return choice;
  }
  const int flexion = nearest_axis(apart);
  const double off = std::acos(std::min(1.0, std::abs(apart[flexion]) / apart.norm())) * kDegreesPerRadian;
  const auto on_it = [&](const BuiltLigament& l) { return l.bone_a == body || l.bone_b == body; };
  if (std::any_of(joint.ligaments.begin(), joint.ligaments.end(), on_it)) {
    choice.held = {};
    choice.held[at(3 + flexion)] = true;
    choice.why = fmt::format(
        "two compartments and ligaments; flexion, about {}, is held: the compartments lie {:.1f} "
        "degrees off that axis",
        "xyz"[flexion], off);
    return choice;
  }
  const int load = nearest_axis(b.force), varus = load == flexion ? -1 : 3 - flexion - load;
  choice.why = "two compartments and no ligaments: nothing keeps it from sliding off";
  if (varus < 0) return choice;
  const std::string two = fmt::format("{},{}", "xyz"[load], kDofNames[3 + varus]);
  choice.why += fmt::format(", give them ({}) or leave it the load's direction and varus-valgus alone ({})",
                            request.wording({.setting = "ligaments", .value = "FILE"}),
                            request.wording({.setting = "free", .of = b.name, .value = two, .bare = true}));
  return choice;
}

}  // namespace

std::string dof_names(const DofFlags& flags) {
  std::string names;
  for (std::size_t k = 0; k < kDofs; ++k)
    if (flags[k]) names += fmt::format("{}{}", names.empty() ? "" : ", ", kDofNames[k]);
  return names.empty() ? "none" : names;
}

void count_motion_from_centers(BuiltJoint& joint) {
  for (BuiltBody& body : joint.bodies) {
    if (!body.about_origin) continue;
    for (auto& row : body.motion) row.head<3>() += rotation(Vector3d(row.tail<3>())) * body.center - body.center;
    body.about_origin = false;
  }
}

void choose_dofs(const BuildRequest& request, BuiltJoint& joint, BuildReport& report) {
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    BuiltBody& body = joint.bodies[b];
    const BoneRequest& asked = request.bones[b];
    if (body.fixed) continue;
    Choice choice{body.held, "as given"};
    if (!asked.dofs_given) choice = choice_for(request, joint, static_cast<int>(b));
    DofFlags free = {}, by_user = {};
    for (std::size_t k = 0; k < kDofs; ++k) {
      by_user[k] = asked.hold[k] && !body.moved[k];
      body.held[k] = choice.held[k] || by_user[k];
      free[k] = body.free(k);
    }
    if (!asked.dofs_given && by_user != DofFlags{}) choice.why += fmt::format("; {} held as given", dof_names(by_user));
    const std::string moved =
        body.motion.empty() ? "" : fmt::format("moved in {} by the table of motion", dof_names(body.moved));
    const bool table_alone = !moved.empty() && free == DofFlags{};
    report.findings.push_back(fmt::format("{}: {}{}: {}{}", body.name,
                                          table_alone ? "" : fmt::format("free in {}", dof_names(free)),
                                          moved.empty() || table_alone ? moved : ", " + moved, choice.why,
                                          asked.dofs_given ? "" : fmt::format(" ({})", request.wording({"free"}))));
    if (body.moments.empty() || body.turns_freely()) continue;
    body.moments.clear();
    report.findings.push_back(
        fmt::format("{}: the table's moments have no effect, for the bone does not turn", body.name));
  }
}

}  // namespace dea
