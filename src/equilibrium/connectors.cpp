#include "src/equilibrium/connectors.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "src/base/decompositions.h"
#include "src/base/disjoint_sets.h"
#include "src/base/numbers.h"
#include "src/base/rotations.h"
#include "src/base/say.h"
#include "src/joint/placing.h"

namespace dea {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Matrix3d = Eigen::Matrix3d;
using Motion = RigidJoint::Motion;

/// A connector at a pose. Columns of a and b: its axes as A and B carry them; d: from its point on A to that on B.
struct Frame {
  Matrix3d a, b;
  Vector3d arm_a, arm_b, d;
};

Frame frame_of(const Joint& joint, const Connector& c, const std::vector<Pose>& poses) {
  const Pose &A = poses[at(c.body_a)], &B = poses[at(c.body_b)];
  Frame f;
  f.a = A.rotation * c.axes;
  f.b = B.rotation * c.axes;
  f.arm_a = A.rotation * (c.joint_origin - joint.bodies[at(c.body_a)].center_of_mass);
  f.arm_b = B.rotation * (c.joint_origin - joint.bodies[at(c.body_b)].center_of_mass);
  f.d = B.center + f.arm_b - A.center - f.arm_a;
  return f;
}

/// A unit force along the direction on B at the joint's point on B, and its opposite on A at the same point.
Vector12 force_wrench(const Frame& f, const Vector3d& direction) {
  Vector12 w;
  w << -direction, -(f.arm_a + f.d).cross(direction), direction, f.arm_b.cross(direction);
  return w;
}
Vector12 moment_wrench(const Vector3d& moment) {
  Vector12 w;
  w << Vector3d::Zero(), -moment, Vector3d::Zero(), moment;
  return w;
}

bool of_connector(const Joint& joint, const ConnectorRow& row) { return at(row.link) < joint.connectors.size(); }

/// How the rotations of a connector are held (J2).
enum class Turning {
  Full,  ///< all three given: the rotation vector of what is left to turn
  Axes   ///< one or two given: a_i . b_j = -sin(value) for the axes i, j that make the turn from i to j positive
};
Turning turning(const Connector& c) {
  const auto free = std::count(c.motion.begin() + 3, c.motion.end(), Motion::Free);
  return free == 0 ? Turning::Full : Turning::Axes;
}

/// Axes i of A and j of B whose product tells the turn about axis k, FEBio's choice. With exactly one free axis f and
/// the others held both conditions ask where B's axis f points: a_i . b_f, which stays well posed however far B has
/// turned.
struct AxisPair {
  int i, j;
  double sign;  ///< of the angle: a_i . b_j = sign * sin(angle)
};
AxisPair axis_pair(const Connector& c, int k) {
  int free_axis = -1, free_count = 0;
  bool prescribed = false;
  for (int m = 0; m < 3; ++m) {
    prescribed = prescribed || c.motion[at(3 + m)] == Motion::Prescribed;
    if (c.motion[at(3 + m)] != Motion::Free) continue;
    free_axis = m;
    ++free_count;
  }
  const int next = (k + 1) % 3, after = (k + 2) % 3;
  if (free_count != 1 || prescribed) return {next, after, -1.0};
  // a turn by t about k carries b_after to -sin t along a_next, b_next to +sin t along a_after
  return free_axis == after ? AxisPair{next, after, -1.0} : AxisPair{after, next, 1.0};
}

/// The moment of a unit multiplier of an axis condition, on B.
Vector3d axis_moment(const Frame& f, const AxisPair& p) {
  return p.sign * f.b.col(p.j).cross(f.a.col(p.i));  // d(a_i . b_j) = (w_B - w_A) . (b_j x a_i)
}

}  // namespace

Vector6 connector_motion(const Joint& joint, const Connector& c, const std::vector<Pose>& poses) {
  const Frame f = frame_of(joint, c, poses);
  Vector6 motion;
  motion << f.a.transpose() * f.d, rotation_vector(f.a.transpose() * f.b);
  return motion;
}

namespace {

/// Of the points that stay where they are. Link: the body's.
void add_held_points(const Joint& joint, const LoadCase& load_case, const std::vector<Pose>& poses,
                     std::vector<ConnectorRow>& rows) {
  for (std::size_t b = 0; b < load_case.bodies.size(); ++b)
    for (const HeldPoint& p : load_case.bodies[b].held_points) {
      ConnectorRow row;
      row.link = static_cast<int>(joint.connectors.size() + b);
      row.dof = p.component;
      row.arm = poses[b].rotation * p.arm;
      row.gap = poses[b].center[p.component] + row.arm[p.component] - p.place;
      const Vector3d axis = Vector3d::Unit(p.component);
      row.wrench << Vector6::Zero(), axis, row.arm.cross(axis);
      rows.push_back(row);
    }
}

}  // namespace

std::vector<ConnectorRow> connector_rows(const Joint& joint, const LoadCase& load_case,
                                         const std::vector<Pose>& poses) {
  std::vector<ConnectorRow> rows;
  for (std::size_t n = 0; n < joint.connectors.size(); ++n) {
    if (!load_case.connector_active[n]) continue;
    const Connector& c = joint.connectors[n];
    const auto& value = load_case.connector_value[n];
    const Frame f = frame_of(joint, c, poses);
    const auto wanted = [&](int k) { return c.motion[at(k)] == Motion::Prescribed ? value[at(k)] : 0.0; };
    for (int k = 0; k < 3; ++k) {
      if (c.motion[at(k)] == Motion::Free) continue;
      const Vector3d axis = f.a.col(k);
      rows.push_back({static_cast<int>(n), k, axis.dot(f.d) - wanted(k), force_wrench(f, axis), Vector3d::Zero()});
    }
    if (turning(c) == Turning::Full) {
      const Matrix3d target = rotation({wanted(3), wanted(4), wanted(5)});
      const Vector3d left = rotation_vector(f.a.transpose() * f.b * target.transpose());
      for (int k = 0; k < 3; ++k)
        rows.push_back({static_cast<int>(n), 3 + k, left[k], moment_wrench(f.a.col(k)), Vector3d::Zero()});
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      if (c.motion[at(3 + k)] == Motion::Free) continue;
      const AxisPair p = axis_pair(c, k);
      const double gap = p.sign * f.a.col(p.i).dot(f.b.col(p.j)) - std::sin(wanted(3 + k));
      rows.push_back({static_cast<int>(n), 3 + k, gap, moment_wrench(axis_moment(f, p)), Vector3d::Zero()});
    }
  }
  add_held_points(joint, load_case, poses, rows);
  return rows;
}

namespace {

/// Adds a multiple of the wrench of a row, or of a given force or moment along a free motion of the same form.
/// The derivative: directions turn with A (forces, full rotations) or with both (axis conditions); the force's point is
/// B's.
void add_force(const Connector& c, const Frame& f, const Vector3d& force, BodyForces& forces) {
  const Vector12 w = force_wrench(f, force);
  forces.value.segment<6>(6 * c.body_a) += w.head<6>();
  forces.value.segment<6>(6 * c.body_b) += w.tail<6>();
  // d force = w_A x force; on B about its centre: arm_b turns with B; on A: lever r = arm_a + d, dr = dv_B + w_B x
  // arm_b - dv_A
  Matrix12 D = Matrix12::Zero();
  const Vector3d r = f.arm_a + f.d;
  const Matrix3d turn = -skew(force);
  D.block<3, 3>(0, 3) = -turn;
  D.block<3, 3>(6, 3) = turn;
  D.block<3, 3>(9, 3) = skew(f.arm_b) * turn;
  D.block<3, 3>(9, 9) = skew(force) * skew(f.arm_b);
  D.block<3, 3>(3, 3) = -skew(r) * turn;
  D.block<3, 3>(3, 0) = -skew(force);  // -(dr x force) = force x dr
  D.block<3, 3>(3, 6) = skew(force);
  D.block<3, 3>(3, 9) = -skew(force) * skew(f.arm_b);
  forces.derivative.add(c.body_a, c.body_b, D);
}

/// A moment on B and its opposite on A; `turn_a`, `turn_b`: its derivative by the rotations of A and B.
void add_moment(const Connector& c, const Vector3d& moment, const Matrix3d& turn_a, const Matrix3d& turn_b,
                BodyForces& forces) {
  forces.value.segment<3>(6 * c.body_a + 3) -= moment;
  forces.value.segment<3>(6 * c.body_b + 3) += moment;
  Matrix12 D = Matrix12::Zero();
  D.block<3, 3>(3, 3) = -turn_a;
  D.block<3, 3>(3, 9) = -turn_b;
  D.block<3, 3>(9, 3) = turn_a;
  D.block<3, 3>(9, 9) = turn_b;
  forces.derivative.add(c.body_a, c.body_b, D);
}

/// Force along a_k, or moment about it, by `size` on B.
void add_along(const Connector& c, const Frame& f, int k, double size, BodyForces& forces) {
  if (size == 0.0) return;
  const Vector3d v = size * f.a.col(k % 3);
  if (k < 3)
    add_force(c, f, v, forces);
  else
    add_moment(c, v, -skew(v), Matrix3d::Zero(), forces);
}

}  // namespace

void add_reactions(const Joint& joint, const std::vector<ConnectorRow>& rows, const VectorXd& multipliers,
                   const std::vector<Pose>& poses, BodyForces& forces) {
  for (std::size_t i = 0; i < rows.size() && of_connector(joint, rows[i]); ++i) {
    const Connector& c = joint.connectors[at(rows[i].link)];
    const double size = multipliers[static_cast<Eigen::Index>(i)];
    if (size == 0.0) continue;
    const Frame f = frame_of(joint, c, poses);
    if (rows[i].dof < 3 || turning(c) == Turning::Full) {
      add_along(c, f, rows[i].dof, size, forces);
      continue;
    }
    const AxisPair p = axis_pair(c, rows[i].dof - 3);
    const Vector3d a = f.a.col(p.i), b = f.b.col(p.j);
    // m = s b x a;  dm = s ((w_B x b) x a + b x (w_A x a))
    const double s = p.sign * size;
    add_moment(c, size * axis_moment(f, p), -s * skew(b) * skew(a), s * skew(a) * skew(b), forces);
  }
}

void add_hold_reactions(const Joint& joint, const std::vector<ConnectorRow>& rows, const VectorXd& multipliers,
                        BodyForces& forces) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (of_connector(joint, rows[i])) continue;
    const int body = rows[i].link - static_cast<int>(joint.connectors.size());
    const Vector6 wrench = multipliers[static_cast<Eigen::Index>(i)] * rows[i].wrench.tail<6>();
    forces.value.segment<6>(6 * body) += wrench;
    Matrix6 D = Matrix6::Zero();  // d(arm x f) = (w x arm) x f
    D.block<3, 3>(3, 3) = skew(wrench.head<3>()) * skew(rows[i].arm);
    forces.derivative.add(body, D);
  }
}

double add_connector_loads(const Joint& joint, const LoadCase& load_case, double length, const std::vector<Pose>& poses,
                           BodyForces& forces) {
  double largest = 0.0;
  for (std::size_t n = 0; n < joint.connectors.size(); ++n) {
    if (!load_case.connector_active[n]) continue;
    const Connector& c = joint.connectors[n];
    const Frame f = frame_of(joint, c, poses);
    for (int k = 0; k < kDofs; ++k) {
      if (c.motion[at(k)] != Motion::Free) continue;
      const double load = load_case.connector_value[n][at(k)];
      add_along(c, f, k, -load, forces);
      largest = std::max(largest, std::abs(load) / (k < 3 ? 1.0 : length));
    }
  }
  return largest;
}

std::vector<Vector6> connector_forces(const Joint& joint, const LoadCase& load_case,
                                      const std::vector<ConnectorRow>& rows, const VectorXd& multipliers,
                                      const std::vector<Pose>& poses) {
  std::vector<Vector6> result(joint.connectors.size(), Vector6::Zero());
  const auto can_move = [&](int body) {
    const auto& dofs = load_case.bodies[at(body)].dofs;
    return std::count(dofs.begin(), dofs.end(), DofState::Free) > 0;
  };
  for (std::size_t n = 0; n < joint.connectors.size(); ++n) {
    if (!load_case.connector_active[n]) continue;
    const Connector& c = joint.connectors[n];
    const Frame f = frame_of(joint, c, poses);
    for (int k = 0; k < kDofs; ++k)
      if (c.motion[at(k)] == Motion::Free)
        result[n].segment<3>(k < 3 ? 0 : 3) -= load_case.connector_value[n][at(k)] * f.a.col(k % 3);
    if (!can_move(c.body_a) && !can_move(c.body_b)) result[n].setConstant(kNaN);
  }
  for (std::size_t i = 0; i < rows.size() && of_connector(joint, rows[i]); ++i) {
    const Connector& c = joint.connectors[at(rows[i].link)];
    const Frame f = frame_of(joint, c, poses);
    const double size = multipliers[static_cast<Eigen::Index>(i)];
    Vector6& r = result[at(rows[i].link)];
    r.head<3>() += size * rows[i].wrench.segment<3>(6);
    r.tail<3>() += size * (rows[i].wrench.segment<3>(9) - f.arm_b.cross(Vector3d(rows[i].wrench.segment<3>(6))));
  }
  return result;
}

namespace {

/// The conditions' derivatives by the free dofs of a group, transposed: free dofs x rows; and which rows those are.
struct GroupRows {
  MatrixXd transposed;
  std::vector<int> rows;
};

GroupRows rows_of(const ConnectorGroups& all, const ConnectorGroups::Group& group,
                  const std::vector<ConnectorRow>& rows) {
  GroupRows result;
  std::vector<char> member(all.sides_a.size(), 0);
  for (int link : group.links) member[at(link)] = 1;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (member[at(rows[i].link)]) result.rows.push_back(static_cast<int>(i));
  result.transposed.setZero(static_cast<Eigen::Index>(group.free.size()),
                            static_cast<Eigen::Index>(result.rows.size()));
  // dofs of a body lie together in `free`: find where each body's begin
  std::map<int, std::vector<Eigen::Index>> places;
  for (std::size_t j = 0; j < group.free.size(); ++j)
    places[all.free[at(group.free[j])] / 6].push_back(static_cast<Eigen::Index>(j));
  for (std::size_t i = 0; i < result.rows.size(); ++i) {
    const ConnectorRow& row = rows[at(result.rows[i])];
    const double unit = row.dof < 3 ? 1.0 : all.length;  // angles times length, so that all gaps compare
    for (int side = 0; side < 2; ++side) {
      const auto found = places.find(side == 0 ? all.sides_a[at(row.link)] : all.sides_b[at(row.link)]);
      if (found == places.end()) continue;
      for (Eigen::Index j : found->second) {
        const int position = group.free[static_cast<std::size_t>(j)];
        result.transposed(j, static_cast<Eigen::Index>(i)) +=
            unit * row.wrench[6 * side + all.free[at(position)] % 6] / all.scale[position];
      }
    }
  }
  return result;
}

constexpr double kRankTolerance = 1e-8;  // rounding of coordinates against their arms; real levers are far larger

Eigen::Index rank_of(const PivotedQr& qr, int cap) { return cap >= 0 ? std::min<Eigen::Index>(qr.rank, cap) : qr.rank; }

}  // namespace

ConnectorGroups make_groups(const Joint& joint, const LoadCase& load_case, const std::vector<int>& free, double length,
                            double size, const std::vector<Pose>& poses) {
  ConnectorGroups result;
  result.free = free;
  result.length = length;
  result.size = size;
  result.scale.resize(static_cast<Eigen::Index>(free.size()));
  for (std::size_t i = 0; i < free.size(); ++i)
    result.scale[static_cast<Eigen::Index>(i)] = free[i] % 6 < 3 ? 1.0 : length;
  std::vector<char> active = load_case.connector_active;
  for (const Connector& c : joint.connectors) {
    result.sides_a.push_back(c.body_a);
    result.sides_b.push_back(c.body_b);
  }
  for (std::size_t b = 0; b < load_case.bodies.size(); ++b) {
    active.push_back(!load_case.bodies[b].held_points.empty());
    for (std::vector<int>* side : {&result.sides_a, &result.sides_b}) side->push_back(static_cast<int>(b));
  }
  DisjointSets joined(joint.bodies.size());
  std::vector<char> movable(joint.bodies.size(), 0);
  for (int dof : free) movable[at(dof / 6)] = 1;
  for (std::size_t n = 0; n < active.size(); ++n) {
    const int a = result.sides_a[n], b = result.sides_b[n];
    if (active[n] && movable[at(a)] && movable[at(b)]) joined.join(a, b);
  }
  std::map<int, int> number;  // root body -> group
  for (std::size_t n = 0; n < active.size(); ++n) {
    if (!active[n]) continue;
    const int body = movable[at(result.sides_a[n])] ? result.sides_a[n] : result.sides_b[n];
    if (!movable[at(body)]) continue;
    const auto [place, is_new] = number.try_emplace(joined.root(body), static_cast<int>(result.groups.size()));
    if (is_new) result.groups.emplace_back();
    result.groups[at(place->second)].links.push_back(static_cast<int>(n));
  }
  for (std::size_t i = 0; i < free.size(); ++i) {
    const auto found = number.find(joined.root(free[i] / 6));
    if (found != number.end()) result.groups[at(found->second)].free.push_back(static_cast<int>(i));
  }
  if (!result.groups.empty()) {
    const std::vector<ConnectorRow> rows = connector_rows(joint, load_case, poses);
    for (ConnectorGroups::Group& g : result.groups)
      g.rank = static_cast<int>(pivoted_qr(rows_of(result, g, rows).transposed, kRankTolerance).rank);
  }
  return result;
}

Tangent tangent_of(const ConnectorGroups& all, const std::vector<ConnectorRow>& rows, const VectorXd& unbalanced) {
  Tangent result;
  result.multipliers = VectorXd::Zero(static_cast<Eigen::Index>(rows.size()));
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<char> grouped(all.free.size(), 0);
  Eigen::Index column = 0;
  for (const ConnectorGroups::Group& g : all.groups) {
    const GroupRows mine = rows_of(all, g, rows);
    const Eigen::Index n = mine.transposed.rows(), m = mine.transposed.cols();
    for (int i : g.free) grouped[at(i)] = 1;
    const PivotedQr qr = pivoted_qr(mine.transposed, kRankTolerance);
    const MatrixXd& Q = qr.Q;
    const Eigen::Index rank = rank_of(qr, g.rank);
    for (Eigen::Index k = rank; k < n; ++k, ++column)
      for (Eigen::Index i = 0; i < n; ++i)
        if (Q(i, k) != 0.0)
          entries.emplace_back(g.free[static_cast<std::size_t>(i)], static_cast<int>(column), Q(i, k));
    if (rank == 0 || m == 0) continue;
    // J^T x = -r in the least squares sense; of all such x the smallest: R x = -Q1^T r with R of full row rank
    const MatrixXd R = qr.R.topRows(rank);
    const VectorXd r = unbalanced(g.free), rhs = -(Q.leftCols(rank).transpose() * r);
    const VectorXd x =
        rank == m ? solve_upper(R, rhs) : VectorXd(R.transpose() * solve_regular(R * R.transpose(), rhs));
    for (Eigen::Index i = 0; i < m; ++i) {
      const int row = mine.rows[static_cast<std::size_t>(qr.order[i])];
      result.multipliers[row] = x[i] * (rows[at(row)].dof < 3 ? 1.0 : all.length);
    }
  }
  for (std::size_t i = 0; i < all.free.size(); ++i)
    if (!grouped[i]) entries.emplace_back(static_cast<int>(i), static_cast<int>(column++), 1.0);
  result.basis.resize(static_cast<Eigen::Index>(all.free.size()), column);
  result.basis.setFromTriplets(entries.begin(), entries.end());
  return result;
}

void move_bodies(std::vector<Pose>& poses, const VectorXd& motion) {
  for (std::size_t b = 0; b < poses.size(); ++b) {
    const auto k = 6 * static_cast<Eigen::Index>(b);
    poses[b].center += motion.segment<3>(k);
    const Vector3d w = motion.segment<3>(k + 3);
    // keeps a rotation a rotation after many products
    if (w.squaredNorm() > 0)
      poses[b].rotation = Eigen::Quaterniond(rotation(w) * poses[b].rotation).normalized().toRotationMatrix();
  }
}

bool close_connectors(const Joint& joint, const LoadCase& load_case, const ConnectorGroups& all,
                      std::vector<Pose>& poses, ConnectorRow* worst) {
  const auto gap_of = [&](const ConnectorRow& row) { return std::abs(row.gap) * (row.dof < 3 ? 1.0 : all.length); };
  const auto largest_of = [&](const std::vector<ConnectorRow>& rows) {
    double largest = 0.0;
    for (const ConnectorRow& row : rows) {
      if (gap_of(row) > largest && worst) *worst = row;
      largest = std::max(largest, gap_of(row));
    }
    return largest;
  };
  constexpr int kMost = 60;
  double before = kInfinity;
  bool all_rows = false;  // first the conditions that were independent at the start, then whatever is left
  int idle = 0;
  for (int i = 0; i < kMost; ++i) {
    const std::vector<ConnectorRow> rows = connector_rows(joint, load_case, poses);
    const double largest = largest_of(rows);
    if (!std::isfinite(largest)) return false;
    if (largest <= 1e-13 * all.size) return true;
    idle = largest > 0.5 * before ? idle + 1 : 0;
    if (idle >= 3) {  // rounding, or conditions that do not agree
      if (largest <= 1e-10 * all.size) return true;
      if (all_rows) return false;
      all_rows = true;
      idle = 0;
    }
    before = largest;
    VectorXd motion = VectorXd::Zero(6 * static_cast<Eigen::Index>(poses.size()));
    double farthest = 0.0;
    for (const ConnectorGroups::Group& g : all.groups) {
      const GroupRows mine = rows_of(all, g, rows);
      const PivotedQr qr = pivoted_qr(mine.transposed, kRankTolerance);
      const Eigen::Index rank = rank_of(qr, all_rows ? -1 : g.rank), n = mine.transposed.rows();
      if (rank == 0) continue;
      VectorXd gap(mine.rows.size());
      for (std::size_t k = 0; k < mine.rows.size(); ++k) {
        const ConnectorRow& row = rows[at(mine.rows[k])];
        gap[static_cast<Eigen::Index>(k)] = row.gap * (row.dof < 3 ? 1.0 : all.length);
      }
      // R11^T y = P^T gap over the independent rows; the least motion is -Q1 y
      const VectorXd ordered = gap(qr.order.head(rank));
      const VectorXd u = -(qr.Q.leftCols(rank) * solve_upper_transposed(qr.R.topLeftCorner(rank, rank), ordered));
      for (Eigen::Index k = 0; k < n; ++k) {
        const int position = g.free[static_cast<std::size_t>(k)];
        motion[all.free[at(position)]] = u[k] / all.scale[position];
        farthest = std::max(farthest, std::abs(u[k]));
      }
    }
    const double most = 0.5 * all.length;  // turns of more than half a radian at once are no small motions
    if (farthest > most) motion *= most / farthest;
    move_bodies(poses, motion);
  }
  return largest_of(connector_rows(joint, load_case, poses)) <= 1e-10 * all.size;
}

std::vector<Fault> broken_connectors(const JointModel& model, const Joint& joint, const std::vector<Pose>& start) {
  std::vector<Fault> faults;
  double size = 0.0;
  for (const Body& body : joint.bodies) size = std::max(size, body.center_of_mass.norm());
  for (const Connector& c : joint.connectors) {
    const Vector6 motion = connector_motion(joint, c, start),
                  before = connector_motion(joint, c, reference_poses(joint));
    const double length = size + c.joint_origin.norm();
    for (int k = 0; k < kDofs; ++k) {
      const double gap = std::abs(motion[k] - before[k]);
      if (c.motion[at(k)] == RigidJoint::Motion::Free || gap <= (k < 3 ? 1e-6 * length : 1e-6)) continue;
      faults.push_back(make_fault(
          model, c.origin,
          say("joint \"{}\" {} its two bodies, and as these are placed they are {:.3g}{} apart {} its axis {};", c.name,
              c.motion[at(k)] == RigidJoint::Motion::Held ? "holds together" : "says how to move", gap,
              k < 3 ? "" : " rad", k < 3 ? "along" : "about", k % 3 + 1),
          "place both bodies alike, or only along the motion that the joint leaves free"));
      break;
    }
  }
  return faults;
}

}  // namespace dea
