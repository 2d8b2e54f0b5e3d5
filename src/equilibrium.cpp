#include "equilibrium.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace dea {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Matrix3d = Eigen::Matrix3d;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Rotation by the vector w (angle times axis).
Matrix3d rotation(const Vector3d& w) {
  const double angle = w.norm();
  if (angle < 1e-300) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

/// Keeps a rotation a rotation after many products.
Matrix3d orthonormal(const Matrix3d& r) { return Eigen::Quaterniond(r).normalized().toRotationMatrix(); }

// ---- forces at one set of poses ---------------------------------------------------------------------------------

/// Everything known at one set of poses. Vectors over all dofs of all bodies, 6 per body; forces are those ON the
/// bodies.
struct Evaluation {
  std::vector<Pose> poses;
  std::vector<SpringStates> springs;       // per contact
  std::vector<Vector6> contact_on_target;  // per contact
  std::vector<double> ligament_force;
  VectorXd contact, ligaments, external;  // 6 per body
  MatrixXd derivative;                    // of their sum
  double normal_force = 0.0;              // sum of p A over all contacts
  double load = 0.0;                      // scale of all forces: the largest of external, ligament, contact
  VectorXd residual() const { return contact + ligaments + external; }
};

struct Problem {
  const Joint& joint;
  const SpringBeds& beds;
  const LoadCase& conditions;
  std::vector<int> free;  // dof numbers 6 * body + k
  VectorXd scale;         // per free dof: 1 for translations, length for rotations
  VectorXd offset;        // per dof: part of the load held back (continuation)
  int casts = 0;
};

/// Line spring between two bodies: force on A towards B when stretched, k (1 - L0/L) c, and its derivative.
void add_ligament(const Ligament& l, const Joint& joint, Evaluation& e, std::size_t index) {
  const Pose &A = e.poses[at(l.body_a)], &B = e.poses[at(l.body_b)];
  const Vector3d arm_a = A.rotation * (l.point_a - joint.bodies[at(l.body_a)].center_of_mass);
  const Vector3d arm_b = B.rotation * (l.point_b - joint.bodies[at(l.body_b)].center_of_mass);
  const Vector3d c = B.center + arm_b - A.center - arm_a;
  const double L = c.norm();
  if (L <= 0) return;
  if (l.tension_only && L <= l.free_length) return;
  const Vector3d f = l.stiffness * (1 - l.free_length / L) * c;  // on A
  e.ligament_force[index] = l.stiffness * (L - l.free_length);
  const int a = 6 * l.body_a, b = 6 * l.body_b;
  e.ligaments.segment<3>(a) += f;
  e.ligaments.segment<3>(a + 3) += arm_a.cross(f);
  e.ligaments.segment<3>(b) -= f;
  e.ligaments.segment<3>(b + 3) -= arm_b.cross(f);
  const Matrix3d K =
      l.stiffness * ((1 - l.free_length / L) * Matrix3d::Identity() + l.free_length / (L * L * L) * c * c.transpose());
  // dc = dv_b - [arm_b]x w_b - dv_a + [arm_a]x w_a
  Eigen::Matrix<double, 3, 12> dc;
  dc << -Matrix3d::Identity(), skew(arm_a), Matrix3d::Identity(), -skew(arm_b);
  const Eigen::Matrix<double, 3, 12> df = K * dc;
  const auto add = [&](int row, const Eigen::Matrix<double, 3, 12>& block) {
    e.derivative.block<3, 6>(row, a) += block.leftCols<6>();
    e.derivative.block<3, 6>(row, b) += block.rightCols<6>();
  };
  add(a, df);
  add(b, -df);
  Eigen::Matrix<double, 3, 12> moment = skew(arm_a) * df;
  moment.block<3, 3>(0, 3) += skew(f) * skew(arm_a);  // (w x arm) x f
  add(a + 3, moment);
  moment = -skew(arm_b) * df;
  moment.block<3, 3>(0, 9) -= skew(f) * skew(arm_b);
  add(b + 3, moment);
}

Evaluation evaluate(Problem& problem, std::vector<Pose> poses) {
  const Joint& joint = problem.joint;
  const int n = 6 * static_cast<int>(joint.bodies.size());
  Evaluation e;
  e.poses = std::move(poses);
  e.contact = e.ligaments = e.external = VectorXd::Zero(n);
  e.derivative = MatrixXd::Zero(n, n);
  ++problem.casts;
  for (std::size_t i = 0; i < problem.beds.beds.size(); ++i) {
    const SpringBed& bed = problem.beds.beds[i];
    if (!problem.conditions.contact_active[i]) {
      e.springs.emplace_back();
      e.contact_on_target.push_back(Vector6::Zero());
      continue;
    }
    const Pose &source = e.poses[at(bed.source_body)], &target = e.poses[at(bed.target_body)];
    e.springs.push_back(project_springs(bed, source, target));
    const ContactWrench w = contact_wrench(e.springs.back(), source, target);
    const int t = 6 * bed.target_body, s = 6 * bed.source_body;
    e.contact.segment<6>(t) += w.wrench.head<6>();
    e.contact.segment<6>(s) += w.wrench.tail<6>();
    e.derivative.block<6, 6>(t, t) += w.derivative.block<6, 6>(0, 0);
    e.derivative.block<6, 6>(t, s) += w.derivative.block<6, 6>(0, 6);
    e.derivative.block<6, 6>(s, t) += w.derivative.block<6, 6>(6, 0);
    e.derivative.block<6, 6>(s, s) += w.derivative.block<6, 6>(6, 6);
    e.contact_on_target.push_back(w.wrench.head<6>());
    e.normal_force += w.normal_force;
  }
  e.ligament_force.assign(joint.ligaments.size(), 0.0);
  for (std::size_t i = 0; i < joint.ligaments.size(); ++i)
    if (problem.conditions.ligament_active[i]) add_ligament(joint.ligaments[i], joint, e, i);
  e.load = e.normal_force;
  for (double f : e.ligament_force) e.load = std::max(e.load, std::abs(f));
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodyConditions& c = problem.conditions.bodies[b];
    const int k = 6 * static_cast<int>(b);
    const Matrix3d& R = e.poses[b].rotation;
    const Vector3d arm = R * c.arm, follower = R * c.follower.head<3>();
    const Vector3d force = c.dead.head<3>() + follower;
    e.external.segment<3>(k) = force;
    e.external.segment<3>(k + 3) = c.dead.tail<3>() + R * c.follower.tail<3>() + arm.cross(force);
    e.derivative.block<3, 3>(k, k + 3) -= skew(follower);
    e.derivative.block<3, 3>(k + 3, k + 3) +=
        skew(force) * skew(arm) - skew(arm) * skew(follower) - skew(R * c.follower.tail<3>());
    // what pulls at a held body is no measure of the balance of the others
    if (std::count(c.dofs.begin(), c.dofs.end(), DofState::Free) > 0)
      e.load = std::max({e.load, force.norm(), e.external.segment<3>(k + 3).norm() / problem.beds.length});
  }
  return e;
}

/// A scaled motion of the free dofs as a motion of all dofs, 6 per body, unscaled.
VectorXd on_all_dofs(const Problem& problem, const VectorXd& motion) {
  VectorXd all = VectorXd::Zero(6 * static_cast<Eigen::Index>(problem.joint.bodies.size()));
  for (std::size_t i = 0; i < problem.free.size(); ++i)
    all[problem.free[i]] = motion[static_cast<Eigen::Index>(i)] / problem.scale[static_cast<Eigen::Index>(i)];
  return all;
}

/// Forces and moments on all dofs as those on the free dofs, moments divided by the length.
VectorXd on_free_dofs(const Problem& problem, const VectorXd& all) {
  VectorXd r(problem.free.size());
  for (std::size_t i = 0; i < problem.free.size(); ++i)
    r[static_cast<Eigen::Index>(i)] = all[problem.free[i]] / problem.scale[static_cast<Eigen::Index>(i)];
  return r;
}

/// Residual over the free dofs, moments divided by the length: all in units of force.
VectorXd scaled_residual(const Problem& problem, const Evaluation& e) {
  return on_free_dofs(problem, e.residual() - problem.offset);
}

/// Stiffness K = -dr/du over the free dofs; rotations times length.
MatrixXd scaled_stiffness(const Problem& problem, const Evaluation& e) {
  const auto n = static_cast<Eigen::Index>(problem.free.size());
  MatrixXd K(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      K(i, j) = -e.derivative(problem.free[static_cast<std::size_t>(i)], problem.free[static_cast<std::size_t>(j)]) /
                (problem.scale[i] * problem.scale[j]);
  return K;
}

/// Poses after a small motion of the free dofs (scaled).
std::vector<Pose> moved(const Problem& problem, const std::vector<Pose>& poses, const VectorXd& motion) {
  const VectorXd all = on_all_dofs(problem, motion);
  std::vector<Pose> result = poses;
  for (std::size_t b = 0; b < poses.size(); ++b) {
    const auto k = 6 * static_cast<Eigen::Index>(b);
    result[b].center += all.segment<3>(k);
    const Vector3d w = all.segment<3>(k + 3);
    if (w.squaredNorm() > 0) result[b].rotation = orthonormal(rotation(w) * poses[b].rotation);
  }
  return result;
}

/// The farthest any articular surface moves by a motion of the free dofs, to first order.
double surface_motion(const Problem& problem, const VectorXd& motion) {
  double largest = 0.0;
  std::vector<double> v2(problem.joint.bodies.size(), 0.0), w2(problem.joint.bodies.size(), 0.0);
  for (std::size_t i = 0; i < problem.free.size(); ++i) {
    const double x = motion[static_cast<Eigen::Index>(i)] / problem.scale[static_cast<Eigen::Index>(i)];
    (problem.free[i] % 6 < 3 ? v2 : w2)[at(problem.free[i] / 6)] += x * x;
  }
  for (std::size_t b = 0; b < v2.size(); ++b)
    largest = std::max(largest, std::sqrt(v2[b]) + std::sqrt(w2[b]) * problem.beds.reach);
  return largest;
}

// ---- flat directions ---------------------------------------------------------------------------------------------

/// How much of the stiffness and of the force that a direction of motion feels is only the roughness of the facets:
/// with the normals in use against normals averaged at the vertices (E6).
struct FacetNoise {
  double stiffness = 0.0;
  double force = 0.0;
};

FacetNoise facet_noise(const Problem& problem, const Evaluation& e, const VectorXd& direction) {
  const VectorXd all = on_all_dofs(problem, direction);
  double products = 0.0, crossed = 0.0, sum = 0.0, sum2 = 0.0;
  for (std::size_t c = 0; c < e.springs.size(); ++c) {
    const SpringStates& s = e.springs[c];
    const SpringBed& bed = problem.beds.beds[c];
    if (s.size() == 0) continue;
    const Pose &source = e.poses[at(bed.source_body)], &target = e.poses[at(bed.target_body)];
    const Vector3d v_t = all.segment<3>(6 * bed.target_body), w_t = all.segment<3>(6 * bed.target_body + 3);
    const Vector3d v_s = all.segment<3>(6 * bed.source_body), w_s = all.segment<3>(6 * bed.source_body + 3);
    const SurfaceMesh &mesh_s = bed.pair->source_layer().spring_surface(), &mesh_t = bed.target.mesh();
    for (int i = 0; i < s.size(); ++i) {
      const auto k = at(i);
      if (s.pressure[k] <= 0 || s.area[k] <= 0) continue;
      const auto& tri_s = mesh_s.triangles[at(bed.springs.surface_triangle[k])];
      const auto& tri_t = mesh_t.triangles[at(s.triangle[k])];
      Vector3d n = Vector3d::Zero(), m = Vector3d::Zero();
      for (std::size_t j = 0; j < 3; ++j) {
        n += (bed.springs.weights[k][0][j] + bed.springs.weights[k][1][j] + bed.springs.weights[k][2][j]) / 3.0 *
             mesh_s.vertex_normals[at(tri_s[j])];
        m += s.end_weights[k][j] * mesh_t.vertex_normals[at(tri_t[j])];
      }
      n = source.rotation * n.normalized();
      m = target.rotation * m.normalized();
      const Vector3d relative = v_t + w_t.cross(s.foot[k] - target.center) - v_s - w_s.cross(s.foot[k] - source.center);
      // the normal that the gap's derivative sees: of the facet, or of the smooth surface it stands for
      const Vector3d seen =
          (s.normal[k] - target.rotation * bulge_gradient(mesh_t, s.triangle[k], s.end_weights[k])).normalized();
      const double smooth_force = n.dot(relative), rough_force = s.direction[k].dot(relative) - smooth_force;
      const double smooth_rate = m.dot(relative), rough_rate = seen.dot(relative) - smooth_rate;
      const double stiffness = s.per_overlap[k] * s.area[k];
      products += stiffness * std::abs(rough_force * rough_rate);
      crossed += stiffness * (rough_force * smooth_rate + smooth_force * rough_rate);
      const double f = s.pressure[k] * s.area[k] * rough_force;
      sum += f;
      sum2 += f * f;
    }
  }
  return {products + std::abs(crossed), std::abs(sum) + 3.0 * std::sqrt(sum2)};
}

std::string direction_in_words(const Problem& problem, const VectorXd& direction) {
  std::string text;
  for (std::size_t b = 0; b < problem.joint.bodies.size(); ++b) {
    Vector6 u = Vector6::Zero();
    for (std::size_t i = 0; i < problem.free.size(); ++i)
      if (at(problem.free[i] / 6) == b) u[problem.free[i] % 6] = direction[static_cast<Eigen::Index>(i)];
    if (u.norm() < 0.3) continue;
    const Vector3d v = u.head<3>(), w = u.tail<3>();
    if (!text.empty()) text += " with ";
    if (w.norm() > 0.3)
      text += fmt::format("rotation of \"{}\" about ({:.3f}, {:.3f}, {:.3f})", problem.joint.bodies[b].name,
                          w.x() / w.norm(), w.y() / w.norm(), w.z() / w.norm());
    if (v.norm() > 0.3)
      text += fmt::format("{} of \"{}\" along ({:.3f}, {:.3f}, {:.3f})",
                          w.norm() > 0.3 ? " and translation" : "translation", problem.joint.bodies[b].name,
                          v.x() / v.norm(), v.y() / v.norm(), v.z() / v.norm());
  }
  return text.empty() ? "a combined motion" : text;
}

/// The stiffness taken apart: stiff directions to be solved, flat ones that nothing resists.
struct Directions {
  VectorXd newton;             // step over the stiff directions
  VectorXd drift;              // residual along the flat directions that are loaded
  VectorXd residual;           // residual without the flat directions that are held
  std::vector<VectorXd> held;  // flat, and their residual about zero
  MatrixXd
      given_up;  // orthonormal: the components of the residual that are not asked to vanish, one per held direction
  double least_stiffness = kNaN;
};

/// `patience` >= 1 widens what counts as facet noise, so that a direction at its edge does not change sides for ever.
Directions take_apart(const Problem& problem, const Evaluation& e, const VectorXd& r, double patience) {
  const MatrixXd K = scaled_stiffness(problem, e);
  const Eigen::Index n = K.rows();
  Directions d;
  d.newton = d.drift = VectorXd::Zero(n);
  d.residual = r;
  // Singular values, not dof by dof: a ball joint is free about axes that are no dof's.
  VectorXd sigma;
  MatrixXd U, V;
  if (n <= 24) {
    Eigen::JacobiSVD<MatrixXd> svd(K, Eigen::ComputeFullU | Eigen::ComputeFullV);
    sigma = svd.singularValues();
    U = svd.matrixU();
    V = svd.matrixV();
  } else {
    Eigen::BDCSVD<MatrixXd> svd(K, Eigen::ComputeFullU | Eigen::ComputeFullV);
    sigma = svd.singularValues();
    U = svd.matrixU();
    V = svd.matrixV();
  }
  MatrixXd stiff(n, 0), given_up(n, 0);
  const auto append = [n](MatrixXd& columns, const VectorXd& column) {
    columns.conservativeResize(n, columns.cols() + 1);
    columns.col(columns.cols() - 1) = column;
  };
  for (Eigen::Index k = 0; k < n; ++k) {
    const VectorXd u = U.col(k), v = V.col(k);
    bool flat = sigma[k] <= 1e-10 * sigma[0] || sigma[0] == 0.0;
    FacetNoise noise;
    if (sigma[k] < 0.1 * sigma[0] || flat) {
      noise = facet_noise(problem, e, v);
      flat = flat || sigma[k] <= 2.0 * patience * noise.stiffness;
    }
    if (!flat) {
      append(stiff, v);
      continue;
    }
    const double along = v.dot(r);
    if (std::abs(along) <= std::max(1e-7 * e.load, patience * noise.force)) {
      d.held.push_back(v);
      // A rotation about a point off the centre of mass has a translation in it. Give up the moment alone, so that
      // forces balance to the last digit.
      VectorXd moment = u;
      for (Eigen::Index i = 0; i < n; ++i)
        if (problem.free[static_cast<std::size_t>(i)] % 6 < 3) moment[i] = 0.0;
      append(given_up, moment.norm() > 0.3 ? VectorXd(moment.normalized()) : u);
    } else {
      d.drift += v * along;
      append(given_up, u);
    }
  }
  const Eigen::Index lost = given_up.cols();
  MatrixXd test = MatrixXd::Identity(n, n);
  if (lost > 0) {
    const Eigen::HouseholderQR<MatrixXd> qr(given_up);
    const MatrixXd q = qr.householderQ();
    test = q.rightCols(n - lost);
    d.given_up = q.leftCols(lost);
    if (d.drift.squaredNorm() == 0.0) d.residual -= d.given_up * (d.given_up.transpose() * r);
  } else {
    d.given_up.resize(n, 0);
  }
  if (stiff.cols() > 0) d.newton = stiff * (test.transpose() * K * stiff).fullPivLu().solve(test.transpose() * r);
  if (stiff.cols() > 0) {
    const MatrixXd projected = stiff.transpose() * K * stiff;
    const MatrixXd symmetric = 0.5 * (projected + projected.transpose());
    d.least_stiffness = Eigen::SelfAdjointEigenSolver<MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues()[0];
  }
  return d;
}

// ---- moving until something touches ------------------------------------------------------------------------------

/// Force of springs that had a target and have none (or are passed too deep) after a step: such a loss is no progress.
double lost_force(const Evaluation& before, const Evaluation& after) {
  double lost = 0.0;
  for (std::size_t c = 0; c < before.springs.size(); ++c) {
    const SpringStates &a = before.springs[c], &b = after.springs[c];
    for (int i = 0; i < a.size(); ++i) {
      const auto k = at(i);
      if (a.pressure[k] > 0 && (b.triangle[k] < 0 || b.too_deep[k])) lost += a.pressure[k] * a.area[k];
    }
  }
  return lost;
}

bool touching(const Evaluation& e) { return e.normal_force > 0.0; }

double too_deep_area(const Problem& problem, const Evaluation& e) {
  double area = 0.0;
  for (std::size_t c = 0; c < e.springs.size(); ++c)
    for (int i = 0; i < e.springs[c].size(); ++i)
      if (e.springs[c].too_deep[at(i)]) area += problem.beds.beds[c].springs.area[at(i)];
  return area;
}

/// How far along `direction` (scaled motion of the free dofs) the first spring closes, to first order: infinity if none
/// does.
double first_touch(const Problem& problem, const Evaluation& e, const VectorXd& direction) {
  const VectorXd all = on_all_dofs(problem, direction);
  double first = kInfinity;
  for (std::size_t c = 0; c < e.springs.size(); ++c) {
    const SpringStates& s = e.springs[c];
    const SpringBed& bed = problem.beds.beds[c];
    if (s.size() == 0) continue;
    const Pose &source = e.poses[at(bed.source_body)], &target = e.poses[at(bed.target_body)];
    const Vector3d v_t = all.segment<3>(6 * bed.target_body), w_t = all.segment<3>(6 * bed.target_body + 3);
    const Vector3d v_s = all.segment<3>(6 * bed.source_body), w_s = all.segment<3>(6 * bed.source_body + 3);
    for (int i = 0; i < s.size(); ++i) {
      const auto k = at(i);
      if (s.triangle[k] < 0 || s.coverage[k] <= 0) continue;
      const Vector3d relative = v_t + w_t.cross(s.end[k] - target.center) - v_s - w_s.cross(s.end[k] - source.center);
      const double rate = s.normal[k].dot(relative) / s.normal[k].dot(s.direction[k]);  // dg per unit of direction (E2)
      if (rate < 0) first = std::min(first, std::max(0.0, s.gap[k]) / -rate);
    }
  }
  return first;
}

struct Search {
  bool found = false;
  Evaluation at;
};

/// Separated surfaces: along the load to first touch, and on until the contact carries most of it.
Search advance(Problem& problem, Evaluation e, VectorXd direction) {
  const double unit = surface_motion(problem, direction);
  if (unit <= 0) return {false, std::move(e)};
  direction /= unit;
  const double cap = 0.5 * problem.beds.least_thickness;
  for (int i = 0; i < 20 && !touching(e); ++i) {
    const double gap = first_touch(problem, e, direction);
    if (!std::isfinite(gap)) return {false, std::move(e)};
    e = evaluate(problem, moved(problem, e.poses, (gap + 1e-3 * cap) * direction));
    if (too_deep_area(problem, e) > 0) break;
  }
  if (!touching(e)) return {false, std::move(e)};
  // The contact's force grows about like the square of the depth: a few steps bring it near the load.
  const double driving = direction.dot(scaled_residual(problem, e));
  double depth = 1e-3 * cap;
  for (int i = 0; i < 12; ++i) {
    const VectorXd contact = on_free_dofs(problem, e.contact);
    const double resisting = -direction.dot(contact);
    const double left = direction.dot(scaled_residual(problem, e));
    if (left <= 0.3 * (left + resisting) || driving <= 0) break;
    const double ratio = resisting > 0 ? (left + resisting) / resisting : 1e4;
    const double step = std::min(cap, depth * (std::sqrt(ratio) - 1.0));
    Evaluation next = evaluate(problem, moved(problem, e.poses, step * direction));
    if (lost_force(e, next) > 0.5 * e.normal_force || too_deep_area(problem, next) > 0) break;
    e = std::move(next);
    depth += step;
  }
  return {true, std::move(e)};
}

/// Surfaces passed through each other: back along the normals of the springs that are too deep.
Search back_out(Problem& problem, Evaluation e) {
  for (int i = 0; i < 40 && too_deep_area(problem, e) > 0; ++i) {
    VectorXd push = VectorXd::Zero(6 * static_cast<Eigen::Index>(e.poses.size()));
    double depth = 0.0;
    for (std::size_t c = 0; c < e.springs.size(); ++c) {
      const SpringStates& s = e.springs[c];
      const SpringBed& bed = problem.beds.beds[c];
      for (int k = 0; k < s.size(); ++k) {
        if (!s.too_deep[at(k)]) continue;
        const Vector3d f = bed.springs.area[at(k)] * s.direction[at(k)];
        const Vector3d arm_t = s.foot[at(k)] - e.poses[at(bed.target_body)].center,
                       arm_s = s.foot[at(k)] - e.poses[at(bed.source_body)].center;
        push.segment<3>(6 * bed.target_body) += f;
        push.segment<3>(6 * bed.target_body + 3) += arm_t.cross(f);
        push.segment<3>(6 * bed.source_body) -= f;
        push.segment<3>(6 * bed.source_body + 3) -= arm_s.cross(f);
        depth = std::max(depth, -s.gap[at(k)]);
      }
    }
    const VectorXd direction = on_free_dofs(problem, push);
    const double unit = surface_motion(problem, direction);
    if (unit <= 0) break;
    e = evaluate(problem, moved(problem, e.poses, (0.5 * depth / unit) * direction));
  }
  const bool found = too_deep_area(problem, e) == 0;
  return {found, std::move(e)};
}

// ---- Newton ------------------------------------------------------------------------------------------------------

struct Solution {
  Outcome outcome = Outcome::NotConverged;
  std::string message;
  Evaluation at;
  Directions directions;
  std::vector<double> history;
  int iterations = 0;
};

double largest_spring_force(const Evaluation& e) {
  double largest = 0.0;
  for (const SpringStates& s : e.springs)
    for (int i = 0; i < s.size(); ++i) largest = std::max(largest, s.pressure[at(i)] * s.area[at(i)]);
  return largest;
}

/// A residual that cannot fall below what one spring carries, because that spring jumps on and off a rim.
bool to_one_spring(const Evaluation& e, double size, Solution& solution) {
  const double one = largest_spring_force(e);
  if (!(size <= one && size <= 0.01 * e.load)) return false;
  solution.outcome = Outcome::BalancedToOneSpring;
  solution.message = fmt::format(
      "unbalanced force is {:.2e} of the load, less than one spring carries ({:.2e}); it cannot fall further on this "
      "mesh",
      size / e.load, one / e.load);
  return true;
}

Solution newton(Problem& problem, Evaluation e, const EquilibriumOptions& options) {
  Solution solution;
  const double cap = 0.5 * problem.beds.least_thickness;
  const std::vector<Pose> started = e.poses;
  int drifts = 0, advances = 0;
  const auto travelled = [&](const Evaluation& now) {
    double largest = 0.0;
    for (std::size_t b = 0; b < started.size(); ++b)
      largest = std::max(largest, (now.poses[b].center - started[b].center).norm());
    return largest;
  };
  for (;;) {
    const VectorXd r = scaled_residual(problem, e);
    const double patience = 1.0 + 0.1 * std::max(0, solution.iterations - 12);
    Directions d = take_apart(problem, e, r, patience);
    const double size = d.residual.norm();
    solution.history.push_back(e.load > 0 ? size / e.load : 0.0);
    if (size <= options.tolerance * e.load) {
      solution.outcome = Outcome::Balanced;
      solution.message = fmt::format("balanced to {:.1e} of the load in {} iterations",
                                     e.load > 0 ? size / e.load : 0.0, solution.iterations);
      solution.at = std::move(e);
      solution.directions = std::move(d);
      return solution;
    }
    if (solution.iterations >= options.max_iterations) {
      if (to_one_spring(e, size, solution)) break;
      solution.message =
          fmt::format("unbalanced force is {:.2e} of the load after {} iterations", size / e.load, solution.iterations);
      break;
    }
    ++solution.iterations;

    const double drift = d.drift.norm();
    if (drift > options.tolerance * e.load && drift >= 0.5 * size) {
      // Nothing resists the load in some direction: without contact go to first touch, with contact follow it for a
      // while.
      if (!touching(e)) {
        Search s = advances++ < 3 ? advance(problem, std::move(e), d.drift) : Search{false, std::move(e)};
        e = std::move(s.at);
        if (s.found) continue;
        solution.outcome = Outcome::SurfacesApart;
        solution.message = fmt::format(
            "the load moves the surfaces apart: no spring closes along it (moved {:.3g} so far)", travelled(e));
        break;
      }
      if (++drifts > 45) {
        solution.outcome = Outcome::NoEquilibrium;
        solution.message =
            fmt::format("{:.3g} of the load acts along {}, which nothing resists (moved {:.3g} along it)",
                        drift / e.load, direction_in_words(problem, d.drift / drift), travelled(e));
        break;
      }
      VectorXd step = d.newton;
      const double stiff = surface_motion(problem, step);
      if (stiff > cap) step *= cap / stiff;
      step += d.drift * (cap / surface_motion(problem, d.drift));
      e = evaluate(problem, moved(problem, e.poses, step));
      continue;
    }

    // A Newton step, shortened until the residual falls; springs that lose their target count as residual.
    const auto try_step = [&](VectorXd step) -> bool {
      const double motion = surface_motion(problem, step);
      if (!(motion > 0) || !std::isfinite(motion)) return false;
      if (motion > cap) step *= cap / motion;
      for (int halving = 0; halving < 6; ++halving, step *= 0.5) {
        Evaluation trial = evaluate(problem, moved(problem, e.poses, step));
        VectorXd trial_r = scaled_residual(problem, trial);
        if (!d.held.empty()) trial_r -= d.given_up * (d.given_up.transpose() * trial_r);
        if (trial_r.norm() + lost_force(e, trial) < size) {
          e = std::move(trial);
          return true;
        }
      }
      return false;
    };
    if (try_step(d.newton)) continue;
    // Regularised steps turn from Newton's direction towards the force itself.
    const MatrixXd K = scaled_stiffness(problem, e);
    const double stiffest = K.norm();
    bool moved_on = false;
    for (double lambda = 1e-3; lambda <= 10.0 && !moved_on; lambda *= 10.0) {
      const MatrixXd regular = K + lambda * stiffest * MatrixXd::Identity(K.rows(), K.cols());
      moved_on = try_step(regular.partialPivLu().solve(d.residual));
    }
    if (moved_on) continue;
    if (!to_one_spring(e, size, solution))
      solution.message = fmt::format("unbalanced force is {:.2e} of the load after {} iterations and no step lowers it",
                                     size / e.load, solution.iterations);
    break;
  }
  solution.directions =
      take_apart(problem, e, scaled_residual(problem, e), 1.0 + 0.1 * std::max(0, solution.iterations - 12));
  solution.at = std::move(e);
  return solution;
}

/// The whole search for one load case from one start.
Solution solve(Problem& problem, const std::vector<Pose>& start, const EquilibriumOptions& options) {
  Evaluation e = evaluate(problem, start);
  if (too_deep_area(problem, e) > 0) {
    Search out = back_out(problem, e);
    if (out.found) e = std::move(out.at);
  }
  const std::vector<Pose> poses = e.poses;
  Solution direct = newton(problem, std::move(e), options);
  if (direct.outcome != Outcome::NotConverged) return direct;
  // Continuation: what is out of balance at the start is held back and released piece by piece.
  Evaluation from =
      evaluate(problem, poses);  // a copy, kept for this rare case, would be as large as the springs' states
  const VectorXd all = from.residual();
  double done = 0.0, piece = 0.25;
  int iterations = direct.iterations;
  while (done < 1.0 && piece > 1.0 / 128) {
    const double next = std::min(1.0, done + piece);
    problem.offset = (1.0 - next) * all;
    Solution part = newton(problem, from, options);
    iterations += part.iterations;
    if (part.outcome == Outcome::Balanced || part.outcome == Outcome::BalancedToOneSpring) {
      done = next;
      if (done >= 1.0) {
        problem.offset.setZero();
        part.iterations = iterations;
        return part;
      }
      from = std::move(part.at);
      piece *= 1.5;
    } else {
      piece *= 0.5;
    }
  }
  problem.offset.setZero();
  direct.iterations = iterations;
  return direct;
}

void fill(Equilibrium& result, const Problem& problem, Evaluation e) {
  const VectorXd total = e.residual();
  double force2 = 0.0, moment2 = 0.0;
  bool any_force = false, any_moment = false;
  for (int dof : problem.free) {
    (dof % 6 < 3 ? any_force : any_moment) = true;
    (dof % 6 < 3 ? force2 : moment2) += total[dof] * total[dof];
  }
  result.residual_force = any_force ? std::sqrt(force2) : kNaN;
  result.residual_moment = any_moment ? std::sqrt(moment2) : kNaN;
  result.load = e.load;
  for (std::size_t b = 0; b < e.poses.size(); ++b)
    result.reaction.push_back(-(e.contact + e.ligaments).segment<6>(6 * static_cast<Eigen::Index>(b)));
  result.poses = std::move(e.poses);
  result.springs = std::move(e.springs);
  result.contact_on_target = std::move(e.contact_on_target);
  result.ligament_force = std::move(e.ligament_force);
  result.casts = problem.casts;
  // A law stretched beyond where it means anything is no answer, however well it balances.
  int beyond = 0;
  double largest = 0.0;
  for (const SpringStates& s : result.springs) {
    const SpringDepth depth = spring_depth(s);  // a spring that is through has no strain
    beyond += depth.strained + depth.through;
    largest = std::max({largest, depth.largest, depth.through > 0 ? 1.0 : 0.0});
  }
  for (const SpringStates& s : result.springs) {
    if (s.complementary || !solved(result.outcome)) continue;
    result.outcome = Outcome::NotConverged;
    result.message = fmt::format("the layers' pressures are known to {:.1e} only", s.complementarity);
  }
  if (beyond > 0 && solved(result.outcome)) {
    result.outcome = Outcome::BeyondStrainLimit;
    result.message =
        fmt::format("{} springs are strained beyond {} (largest {}{:.3g}): the surfaces pass too far into each other",
                    beyond, kStrainLimit, largest >= 1 ? "at least " : "", largest);
  }
}

Problem make_problem(const Joint& joint, const SpringBeds& beds, const LoadCase& conditions) {
  Problem problem{joint, beds, conditions, {}, {}, {}, 0};
  problem.offset = VectorXd::Zero(6 * static_cast<Eigen::Index>(joint.bodies.size()));
  return problem;
}

}  // namespace

const char* name(Outcome outcome) {
  switch (outcome) {
    case Outcome::Prescribed:
      return "Prescribed";
    case Outcome::Balanced:
      return "Balanced";
    case Outcome::BalancedToOneSpring:
      return "BalancedToOneSpring";
    case Outcome::SurfacesApart:
      return "SurfacesApart";
    case Outcome::NoEquilibrium:
      return "NoEquilibrium";
    case Outcome::NotConverged:
      return "NotConverged";
    case Outcome::BeyondStrainLimit:
      return "BeyondStrainLimit";
  }
  assert(false);
  return "";
}

bool solved(Outcome outcome) {
  return outcome == Outcome::Prescribed || outcome == Outcome::Balanced || outcome == Outcome::BalancedToOneSpring;
}

SpringBeds make_spring_beds(const Joint& joint) {
  SpringBeds beds;
  beds.least_thickness = kInfinity;
  double area = 0.0, inertia = 0.0;
  beds.reach = 0.0;
  for (const ContactPair& pair : joint.contacts) {
    beds.beds.push_back(make_spring_bed(joint, pair));
    for (const Layer& layer : pair.layers) {
      const SurfaceExtent extent = surface_extent(layer.articular);
      area += extent.area;
      inertia += extent.area * extent.radius_of_gyration * extent.radius_of_gyration;
      for (const Vector3d& x : layer.articular.vertices)
        beds.reach = std::max(beds.reach, (x - joint.bodies[at(layer.body)].center_of_mass).norm());
      // a feather edge must not bring the steps to a halt
      if (!layer.rigid)
        beds.least_thickness =
            std::min(beds.least_thickness, std::max(layer.min_thickness(), 0.1 * layer.mean_thickness()));
    }
  }
  beds.length = area > 0 ? std::sqrt(inertia / area) : 1.0;
  return beds;
}

std::vector<Pose> reference_poses(const Joint& joint) {
  std::vector<Pose> poses;
  for (const Body& b : joint.bodies) poses.push_back({b.center_of_mass, Matrix3d::Identity()});
  return poses;
}

Equilibrium state_at(const Joint& joint, const SpringBeds& beds, const LoadCase& conditions,
                     const std::vector<Pose>& poses) {
  Problem problem = make_problem(joint, beds, conditions);
  Equilibrium result;
  result.outcome = Outcome::Prescribed;
  result.message = "motion given";
  result.least_stiffness = kNaN;
  fill(result, problem, evaluate(problem, poses));
  return result;
}

Equilibrium solve_equilibrium(const Joint& joint, const SpringBeds& beds, const LoadCase& conditions,
                              const std::vector<Pose>& start, const std::vector<Pose>& step_start,
                              const EquilibriumOptions& options) {
  std::vector<Pose> poses = start;
  Problem problem = make_problem(joint, beds, conditions);
  for (int b = 0; b < static_cast<int>(joint.bodies.size()); ++b) {
    const BodyConditions& c = conditions.bodies[at(b)];
    Pose& pose = poses[at(b)];
    for (int k = 0; k < 3; ++k) {
      if (c.dofs[at(k)] != DofState::Prescribed) continue;
      pose.center[k] =
          (c.relative[at(k)] ? step_start[at(b)].center[k] : joint.bodies[at(b)].center_of_mass[k]) + c.value[k];
    }
    const auto prescribed = std::find(c.dofs.begin() + 3, c.dofs.end(), DofState::Prescribed);
    if (prescribed != c.dofs.end()) {
      const bool relative = c.relative[static_cast<std::size_t>(prescribed - c.dofs.begin())];
      pose.rotation =
          relative ? Matrix3d(rotation(c.value.tail<3>()) * step_start[at(b)].rotation) : rotation(c.value.tail<3>());
    }
    for (int k = 0; k < kDofs; ++k)
      if (c.dofs[at(k)] == DofState::Free) problem.free.push_back(6 * b + k);
  }
  problem.scale.resize(static_cast<Eigen::Index>(problem.free.size()));
  for (std::size_t i = 0; i < problem.free.size(); ++i)
    problem.scale[static_cast<Eigen::Index>(i)] = problem.free[i] % 6 < 3 ? 1.0 : beds.length;

  Equilibrium result;
  if (problem.free.empty()) {
    result = state_at(joint, beds, conditions, poses);
    return result;
  }
  Solution s = solve(problem, poses, options);
  result.outcome = s.outcome;
  result.message = s.message;
  result.iterations = s.iterations;
  result.history = s.history;
  result.least_stiffness = s.directions.least_stiffness;
  const bool loose = !touching(s.at);
  const VectorXd r = scaled_residual(problem, s.at);
  for (const VectorXd& v : s.directions.held) {
    // a body that is neither loaded nor touched simply stays: said once by the caller
    if (loose && s.at.load == 0.0) continue;
    const double along = s.at.load > 0 ? std::abs(v.dot(r)) / s.at.load : 0.0;
    result.held.push_back(
        direction_in_words(problem, v) +
        (along > 1e-6 ? fmt::format(" ({:.1e} of the load left along it: the facets' roughness)", along) : ""));
  }
  fill(result, problem, std::move(s.at));
  return result;
}

}  // namespace dea
