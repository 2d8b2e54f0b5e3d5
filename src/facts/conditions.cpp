#include "src/facts/conditions.h"

#include <algorithm>
#include <cmath>

#include "src/base/decompositions.h"
#include "src/base/numbers.h"
#include "src/facts/parts.h"

namespace dea {

using Eigen::MatrixXd;

Vector6 condition(const NodeRow& row, double length) {
  Vector6 result;
  result << Vector3d::Unit(row.component), row.arm.cross(Vector3d::Unit(row.component)) / length;
  return result;
}

RowSpan span_of(const std::vector<NodeRow>& rows, double length, const std::vector<double>& values) {
  Eigen::Matrix<double, 6, 6> gram = Eigen::Matrix<double, 6, 6>::Zero();
  Vector6 right = Vector6::Zero();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Vector6 row = condition(rows[i], length);
    gram += row * row.transpose();
    if (!values.empty()) right += row * values[i];
  }
  RowSpan span;
  const Eigenvalues eigen = symmetric_eigen(gram);
  const double least = 1e-8 * eigen.values[5];  // rounding is 1e-16, the smallest real lever squared far more
  for (int i = 0; i < 6; ++i) {
    if (eigen.values[i] <= least) {
      for (int dof = 0; dof < kDofs; ++dof) span.free_part[dof] += std::pow(eigen.vectors(dof, i), 2);
      continue;
    }
    ++span.conditions;
    span.motion += eigen.vectors.col(i) * (eigen.vectors.col(i).dot(right) / eigen.values[i]);
  }
  return span;
}

namespace {

/// Bodies of a model in one of its steps.
struct StatedStep {
  const JointModel& model;
  const Bodies& bodies;
  const std::vector<int>& node_body;
  const std::vector<char>& of_bone;  // per node
  int step;
  int body_of(int material) const { return material < 0 ? -1 : bodies.of_material[at(material)]; }
};

/// Per node: is it of elements that the user takes as rigid, and not of a rigid body of the model, whose fixed nodes
/// FEBio passes over?
std::vector<char> nodes_of_bones(const JointModel& model, const Bodies& bodies) {
  std::vector<char> bone(model.nodes.size(), 0);
  for (const bool rigid : {false, true})
    for (const Domain& d : model.domains)
      if (d.material >= 0 && bodies.of_material[at(d.material)] >= 0 && model.materials[at(d.material)].rigid == rigid)
        for (const int node : d.nodes) bone[at(node)] = !rigid;
  for (const RigidNodes& set : model.rigid_nodes)
    for (const int node : set.nodes) bone[at(node)] = 0;
  return bone;
}

GivenMotion motion_of(const PrescribedNodes& p) { return {p.name, p.origin, -1, p.value, p.relative, p.step >= 0}; }

void fix_dofs(const StatedStep& now, std::vector<BodyHolds>& all) {
  all[at(now.bodies.ground())].dofs.fill({DofState::Held, HeldBy::Body, {}, {}});
  for (const RigidFixed& f : now.model.rigid_fixed) {
    const int b = now.body_of(f.material);
    if (!f.acts(now.step) || b < 0) continue;
    for (std::size_t k = 0; k < kDofs; ++k) {
      if (!f.dofs[k]) continue;
      BodyDof& dof = all[at(b)].dofs[k];
      dof.state = DofState::Held;
      dof.by = HeldBy::Body;
      dof.fixed.push_back({f.name, f.material});
    }
  }
}

void move_dofs(const StatedStep& now, std::vector<BodyHolds>& all) {
  for (const RigidPrescribed& p : now.model.rigid_prescribed) {
    const int b = now.body_of(p.material);
    if (!p.acts(now.step) || b < 0) continue;
    BodyDof& dof = all[at(b)].dofs[at(p.dof)];
    if (dof.by != HeldBy::Body) dof.motions.clear();  // of nodes
    dof.state = DofState::Prescribed;
    dof.by = HeldBy::Body;
    dof.motions.push_back({p.name, p.origin, p.material, p.value, p.relative, p.step >= 0});
  }
}

/// Of a bone that the user takes as rigid. `back`: some are fixed later than moved or free, and FEBio puts such nodes
/// back to where they were in the reference.
NodeRows rows_of_nodes(const StatedStep& now, int body, bool& back) {
  NodeRows found;
  double longest = 0.0;
  const auto add = [&](const std::vector<int>& nodes, int component, int motion) {
    const std::size_t before = found.rows.size();
    for (const int node : nodes) {
      if (now.node_body[at(node)] != body) continue;
      const Vector3d arm = now.model.nodes[at(node)] - now.bodies.bodies[at(body)].center_of_mass;
      found.rows.push_back({component, arm, motion, now.of_bone[at(node)] != 0});
      longest = std::max(longest, arm.norm());
    }
    return found.rows.size() > before;
  };
  const auto on_this_body = [&](const std::vector<int>& nodes) {
    return std::any_of(nodes.begin(), nodes.end(), [&](int node) { return now.node_body[at(node)] == body; });
  };
  for (const FixedNodes& f : now.model.fixed_nodes) {
    for (int k = 0; k < 3; ++k)
      if (f.acts(now.step) && f.xyz[at(k)]) add(f.nodes, k, -1);
    back = back || (f.step > 0 && on_this_body(f.nodes));
  }
  for (const PrescribedNodes& p : now.model.prescribed_nodes) {
    if (!p.acts(now.step)) {
      back = back || on_this_body(p.nodes);
      continue;
    }
    if (!add(p.nodes, p.component, static_cast<int>(found.motions.size()))) continue;
    found.motions.push_back(motion_of(p));
    int& relative = found.relative[at(p.component)];
    const int counts = found.motions.back().from_step_start();
    found.agree = found.agree && (relative < 0 || relative == counts);
    relative = counts;
  }
  if (longest > 0) found.length = longest;
  return found;
}

/// Every dof whose unit vector is in the span of the nodes' rows has no freedom left.
void hold_by_nodes(const StatedStep& now, int body, BodyHolds& holds) {
  bool back = false;
  holds.nodes = rows_of_nodes(now, body, back);
  const bool moved = !holds.nodes.motions.empty();
  const RowSpan span = span_of(holds.nodes.rows, holds.nodes.length);
  for (int k = 0; k < kDofs; ++k) {
    if (!span.holds(k)) continue;
    BodyDof& dof = holds.dofs[at(k)];
    if (dof.state == DofState::Free) dof = {DofState::Held, HeldBy::Nodes, {}, {}};
    if (k < 3 && (moved || back)) {
      dof.state = DofState::Prescribed;
      dof.by = HeldBy::Nodes;
    }
  }
}

/// A bone that the model leaves out, moved by the nodes it would carry.
void move_by_nodes(const StatedStep& now, const Body& body, BodyHolds& holds) {
  if (!body.moved_by.empty()) holds.dofs.fill({DofState::Held, HeldBy::Nodes, {}, {}});
  for (const int i : body.moved_by) {
    const PrescribedNodes& p = now.model.prescribed_nodes[at(i)];
    BodyDof& dof = holds.dofs[at(p.component)];
    dof.state = DofState::Prescribed;  // fixed in this step: at the reference, wherever the nodes were before
    if (p.acts(now.step)) dof.motions.push_back(motion_of(p));
  }
}

/// As many rows as are independent. The others follow from them: at every pose in a hinge, a pin or a guided end, to
/// first order where only the second holds them (two nodes at the ends of a rod that is to tilt, one of them a pin).
std::vector<NodeRow> independent_rows(const std::vector<NodeRow>& rows, double length) {
  constexpr double kLever = 1e-4;  // as in span_of: less is the rounding of coordinates, and would lock a hinge
  MatrixXd conditions(6, static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    conditions.col(static_cast<Eigen::Index>(i)) = condition(rows[i], length);
  const PivotedQr qr = pivoted_qr(conditions, kLever);
  std::vector<NodeRow> kept;
  for (Eigen::Index i = 0; i < qr.rank; ++i) kept.push_back(rows[static_cast<std::size_t>(qr.order[i])]);
  return kept;
}

/// Fixed nodes that couple dofs which are free otherwise.
void couple_by_nodes(const StatedStep& now, int body, BodyHolds& holds) {
  constexpr double kLeast = 1e-3;  // as little as RowSpan::holds takes for held
  const NodeRows& nodes = holds.nodes;
  std::vector<NodeRow> own, others;  // of the bone; of its layers, and of rigid bodies of the model
  bool couples = false;
  for (const NodeRow& row : nodes.rows) {
    (row.of_bone ? own : others).push_back(row);
    const Vector6 seen = condition(row, nodes.length);
    for (int dof = 0; dof < kDofs && row.of_bone; ++dof)
      couples = couples || (holds.dofs[at(dof)].state == DofState::Free && std::abs(seen[dof]) > kLeast);
  }
  if (!couples || !nodes.motions.empty()) return;
  const RowSpan by_others = span_of(others, nodes.length);
  holds.coupled = independent_rows(own, nodes.length);
  for (int dof = 0; dof < kDofs; ++dof)
    holds.coupled_dofs[at(dof)] = holds.dofs[at(dof)].by == HeldBy::Nodes && !by_others.holds(dof);
  for (const FixedNodes& f : now.model.fixed_nodes)
    if (holds.first_coupled < 0 && f.acts(now.step) && std::any_of(f.nodes.begin(), f.nodes.end(), [&](int node) {
          return now.of_bone[at(node)] != 0 && now.node_body[at(node)] == body;
        }))
      holds.first_coupled = static_cast<int>(&f - now.model.fixed_nodes.data());
}

}  // namespace

Conditions find_conditions(const JointModel& model, const Bodies& bodies, const std::vector<int>& node_body) {
  const std::vector<char> of_bone = nodes_of_bones(model, bodies);
  Conditions conditions;
  for (int s = 0; s < static_cast<int>(model.steps.size()); ++s) {
    const StatedStep now{model, bodies, node_body, of_bone, s};
    std::vector<BodyHolds>& all = conditions.steps.emplace_back(bodies.bodies.size());
    const auto each_bone = [&](const auto& use) {
      for (std::size_t b = 0; b < all.size(); ++b)
        if (taken_as_rigid(model, bodies.bodies[b])) use(now, static_cast<int>(b), all[b]);
    };
    fix_dofs(now, all);
    each_bone(hold_by_nodes);
    for (std::size_t b = 0; b < all.size(); ++b) move_by_nodes(now, bodies.bodies[b], all[b]);
    move_dofs(now, all);
    each_bone(couple_by_nodes);
    for (BodyHolds& holds : all)
      if (holds.nodes.motions.empty()) holds.nodes.rows.clear();  // said by the dofs
  }
  return conditions;
}

BodyHolds with_settings(BodyHolds holds, const JointModel& model, const std::vector<Body>& bodies, int body,
                        const Settings& settings) {
  bool told = names_body(model, bodies, settings.motion.body, body);
  for (const auto& [name, free] : settings.free) {
    if (!names_body(model, bodies, name, body)) continue;
    told = true;
    for (std::size_t k = 0; k < kDofs; ++k) {
      BodyDof& dof = holds.dofs[k];
      if (dof.state == DofState::Prescribed) continue;
      dof.state = free[k] ? DofState::Free : DofState::Held;
      dof.by = HeldBy::Settings;
    }
  }
  if (told) holds.coupled.clear();
  for (std::size_t k = 0; k < kDofs && !holds.coupled.empty(); ++k)
    if (holds.coupled_dofs[k]) holds.dofs[k] = {};
  return holds;
}

}  // namespace dea
