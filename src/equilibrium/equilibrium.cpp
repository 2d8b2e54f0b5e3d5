#include <febiodea/equilibrium/equilibrium.h>

#include <Eigen/Dense>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include <febiodea/base/error.h>
#include <febiodea/base/numbers.h>
#include <febiodea/base/rotations.h>
#include <febiodea/base/say.h>
#include <febiodea/equilibrium/connectors.h>
#include <febiodea/equilibrium/singular_parts.h>
#include <febiodea/springs/place.h>
#include <febiodea/springs/press.h>
#include <febiodea/springs/spring_law.h>
#include <febiodea/springs/wrench.h>

namespace dea {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Matrix3d = Eigen::Matrix3d;

using Sparse = Eigen::SparseMatrix<double>;

constexpr double kRateTolerance = 1e-4;  // the derivative only directs the next step
constexpr int kDenseUnknowns = 60;       // about ten bodies: measured, above it the sparse way is the faster one

// ---- forces at one set of poses ---------------------------------------------------------------------------------

/// Everything known at one set of poses. Vectors over all dofs of all bodies, 6 per body; forces are those ON the
/// bodies.
struct Evaluation {
  std::vector<Pose> poses;
  std::vector<SpringStates> springs;       // per contact
  std::vector<Vector6> contact_on_target;  // per contact
  std::vector<double> ligament_force;
  VectorXd contact, ligaments, external;  // 6 per body; `ligaments`: cables and the connectors' loads too
  BlockMatrix derivative;                 // of their sum and of the reactions
  double normal_force = 0.0;              // sum of p A over all contacts
  double load = 0.0;                      // scale of all forces: the largest of external, ligament, contact
  double tolerance = 0.0;                 // of the layers' pressures; 0: exact
  VectorXd residual() const { return contact + ligaments + external + reactions; }
  // connectors: their conditions, what these transmit, and the motions they leave
  std::vector<ConnectorRow> rows;
  Tangent tangent;
  VectorXd reactions;
};

struct Problem {
  const Joint& joint;
  const SpringBeds& beds;
  const LoadCase& conditions;
  std::vector<int> free;             // dof numbers 6 * body + k
  VectorXd scale;                    // per free dof: 1 for translations, length for rotations
  VectorXd offset;                   // per dof: part of the load held back (continuation)
  std::vector<PressMemory>& memory;  // per contact: where searches for pressures start
  int casts = 0;
  double tolerance = kPressureTolerance;  // of the layers' pressures at the next poses
  std::string undefined;                  // why a step was refused, if a ligament's force had no value where it led
  ConnectorGroups connectors;
  SearchStatus status = {};
  const std::function<void(const SearchStatus&)>* watch = nullptr;
  bool joined() const { return !connectors.groups.empty(); }
};

/// Forces over all dofs as those on the free dofs, moments divided by the length.
VectorXd free_part(const Problem& problem, const VectorXd& all) {
  VectorXd r(static_cast<Eigen::Index>(problem.free.size()));
  for (std::size_t i = 0; i < problem.free.size(); ++i)
    r[static_cast<Eigen::Index>(i)] = all[problem.free[i]] / problem.scale[static_cast<Eigen::Index>(i)];
  return r;
}

/// The relative motions of a contact's bodies that the unknowns can bring about.
Motions free_motions(const Problem& problem, const SpringBed& bed) {
  if (problem.joined()) return kAllMotions;
  Motions motions = {};
  for (const int dof : problem.free) {
    const int body = dof / 6, k = dof % 6;
    if (body != bed.source_body && body != bed.target_body) continue;
    motions[at(k)] = true;
    // the source turns about its own centre, not the target's
    if (body == bed.source_body && k >= 3) motions[0] = motions[1] = motions[2] = true;
  }
  return motions;
}

Evaluation evaluate(Problem& problem, std::vector<Pose> poses) {
  const Joint& joint = problem.joint;
  const LoadCase& conditions = problem.conditions;
  const auto n = 6 * static_cast<Eigen::Index>(joint.bodies.size());
  Evaluation e;
  e.poses = std::move(poses);
  e.contact = e.reactions = VectorXd::Zero(n);
  problem.status.casts = ++problem.casts;
  if (problem.watch != nullptr && *problem.watch) (*problem.watch)(problem.status);
  for (std::size_t i = 0; i < problem.beds.beds.size(); ++i) {
    const SpringBed& bed = problem.beds.beds[i];
    if (!conditions.contact_active[i]) {
      e.springs.emplace_back();
      e.contact_on_target.push_back(Vector6::Zero());
      continue;
    }
    const Pose &source = e.poses[at(bed.source_body)], &target = e.poses[at(bed.target_body)];
    e.springs.push_back(press_springs(
        bed, source, target, {free_motions(problem, bed), problem.tolerance, kRateTolerance}, &problem.memory[i]));
    if (bed.layers) e.tolerance = problem.tolerance;
    const ContactWrench w = contact_wrench(e.springs.back(), source, target);
    e.contact.segment<6>(6 * bed.target_body) += w.wrench.head<6>();
    e.contact.segment<6>(6 * bed.source_body) += w.wrench.tail<6>();
    e.derivative.add(bed.target_body, bed.source_body, w.derivative);
    e.contact_on_target.push_back(w.wrench.head<6>());
    e.normal_force += w.normal_force;
  }
  e.load = e.normal_force;
  BodyForces inner(joint.bodies.size());
  e.ligament_force.assign(joint.ligaments.size(), 0.0);
  for (std::size_t i = 0; i < joint.ligaments.size(); ++i) {
    if (!conditions.ligament_active[i]) continue;
    const double scale = i < conditions.ligament_scale.size() ? conditions.ligament_scale[i] : 1.0;
    e.ligament_force[i] = add_ligament(joint, joint.ligaments[i], scale, e.poses, inner);
    e.load = std::max(e.load, std::abs(e.ligament_force[i]));
  }
  for (std::size_t i = 0; i < conditions.cable_force.size(); ++i) {
    if (conditions.cable_force[i] == 0.0) continue;
    add_cable(joint, joint.cables[i], conditions.cable_force[i], e.poses, inner);
    e.load = std::max(e.load, std::abs(conditions.cable_force[i]));
  }
  if (!conditions.connector_active.empty())
    e.load = std::max(e.load, add_connector_loads(joint, conditions, problem.beds.length, e.poses, inner));
  e.ligaments = inner.value;
  BodyForces outer(joint.bodies.size());
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodyConditions& c = conditions.bodies[b];
    const double scale = add_loads(c, static_cast<int>(b), e.poses[b], problem.beds.length, outer);
    // what pulls at a held body is no measure of the balance of the others
    if (std::count(c.dofs.begin(), c.dofs.end(), DofState::Free) > 0) e.load = std::max(e.load, scale);
  }
  e.external = outer.value;
  auto& blocks = e.derivative.blocks;
  blocks.insert(blocks.end(), inner.derivative.blocks.begin(), inner.derivative.blocks.end());
  blocks.insert(blocks.end(), outer.derivative.blocks.begin(), outer.derivative.blocks.end());
  if (problem.joined()) {
    e.rows = connector_rows(joint, conditions, e.poses);
    e.tangent = tangent_of(problem.connectors, e.rows,
                           free_part(problem, e.contact + e.ligaments + e.external - problem.offset));
    BodyForces held(joint.bodies.size());
    add_reactions(joint, e.rows, e.tangent.multipliers, e.poses, held);
    e.reactions = held.value;
    blocks.insert(blocks.end(), held.derivative.blocks.begin(), held.derivative.blocks.end());
  }
  return e;
}

/// Far from balance the layers' pressures need not be known closely: to a hundredth of what the next step leaves.
/// `residual`: unbalanced / load at the pose it starts from.
double tolerance_after(double residual) {
  constexpr double kCoarsest = 1e-4;
  return std::clamp(0.01 * residual * std::min(1.0, 10.0 * residual), kPressureTolerance, kCoarsest);
}

// The unknowns at a pose: the free dofs, rotations times length; where there are connectors, the motions they leave.

/// A motion of the unknowns as one of the free dofs (scaled).
VectorXd as_free(const Problem& problem, const Evaluation& e, const VectorXd& motion) {
  return problem.joined() ? VectorXd(e.tangent.basis * motion) : motion;
}

/// A motion of the unknowns as a motion of all dofs, 6 per body, unscaled.
VectorXd on_all_dofs(const Problem& problem, const Evaluation& e, const VectorXd& motion) {
  const VectorXd free = as_free(problem, e, motion);
  VectorXd all = VectorXd::Zero(6 * static_cast<Eigen::Index>(problem.joint.bodies.size()));
  for (std::size_t i = 0; i < problem.free.size(); ++i)
    all[problem.free[i]] = free[static_cast<Eigen::Index>(i)] / problem.scale[static_cast<Eigen::Index>(i)];
  return all;
}

/// Forces and moments on all dofs as those on the unknowns: all in units of force.
VectorXd on_unknowns(const Problem& problem, const Evaluation& e, const VectorXd& all) {
  const VectorXd r = free_part(problem, all);
  return problem.joined() ? VectorXd(e.tangent.basis.transpose() * r) : r;
}

VectorXd scaled_residual(const Problem& problem, const Evaluation& e) {
  return on_unknowns(problem, e, e.residual() - problem.offset);
}

/// Stiffness K = -dr/du over the unknowns.
Sparse scaled_stiffness(const Problem& problem, const Evaluation& e) {
  const auto n = static_cast<Eigen::Index>(problem.free.size());
  std::vector<int> place(6 * problem.joint.bodies.size(), -1);
  for (std::size_t i = 0; i < problem.free.size(); ++i) place[at(problem.free[i])] = static_cast<int>(i);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(36 * e.derivative.blocks.size());
  for (const BlockMatrix::Block& block : e.derivative.blocks) {
    for (int i = 0; i < 6; ++i) {
      const int row = place[at(6 * block.row + i)];
      if (row < 0) continue;
      for (int j = 0; j < 6; ++j) {
        const int column = place[at(6 * block.column + j)];
        if (column >= 0)
          entries.emplace_back(row, column, -block.value(i, j) / (problem.scale[row] * problem.scale[column]));
      }
    }
  }
  Sparse K(n, n);
  K.setFromTriplets(entries.begin(), entries.end());
  if (problem.joined()) K = Sparse(e.tangent.basis.transpose() * K * e.tangent.basis);
  return K;
}

/// Poses after a small motion of the unknowns; connectors closed again. Nothing: they cannot be.
std::optional<std::vector<Pose>> moved(Problem& problem, const Evaluation& e, const VectorXd& motion) {
  std::vector<Pose> result = e.poses;
  move_bodies(result, on_all_dofs(problem, e, motion));
  if (problem.joined() && !close_connectors(problem.joint, problem.conditions, problem.connectors, result))
    return std::nullopt;
  if (std::string fault = undefined_force(problem.joint, problem.conditions, result); !fault.empty()) {
    problem.undefined = std::move(fault);
    return std::nullopt;
  }
  return result;
}

/// The farthest any articular surface moves on its partner by a motion of the unknowns, to first order.
double surface_motion(const Problem& problem, const Evaluation& e, const VectorXd& motion) {
  const VectorXd all = on_all_dofs(problem, e, motion);
  double largest = 0.0;
  const auto reach = [&](const Vector3d& v, const Vector3d& w) {
    const double reached = v.norm() + w.norm() * problem.beds.reach;
    if (!(reached <= largest)) largest = reached;  // NaN stays
  };
  std::vector<char> in_contact(problem.joint.bodies.size(), 0);
  for (std::size_t c = 0; c < problem.beds.beds.size(); ++c) {
    if (!problem.conditions.contact_active[c]) continue;
    // one body as the other sees it: rows of bones may move together
    int a = problem.beds.beds[c].source_body, b = problem.beds.beds[c].target_body;
    in_contact[at(a)] = in_contact[at(b)] = 1;
    if (all.segment<6>(6 * a).isZero(0.0)) std::swap(a, b);
    const Vector3d w_b = all.segment<3>(6 * b + 3), v_a = all.segment<3>(6 * a), w_a = all.segment<3>(6 * a + 3);
    const Vector3d v_b = all.segment<3>(6 * b) + w_b.cross(e.poses[at(a)].center - e.poses[at(b)].center);
    reach(v_a - v_b, w_a - w_b);
  }
  for (std::size_t b = 0; b < in_contact.size(); ++b)
    if (!in_contact[b])
      reach(all.segment<3>(6 * static_cast<Eigen::Index>(b)), all.segment<3>(6 * static_cast<Eigen::Index>(b) + 3));
  return largest;
}

// ---- flat directions ---------------------------------------------------------------------------------------------

/// How much of the stiffness and of the force that a direction of motion feels is only the roughness of the facets:
/// with the normals in use against normals averaged at the vertices (E6).
struct FacetNoise {
  double stiffness = 0.0;
  double force = 0.0;
};

/// A spring's normals: those in use, and what they differ from those averaged at the vertices.
struct SpringNormals {
  Vector3d smooth_force, rough_force;  // of the source: direction of the force
  Vector3d smooth_rate, rough_rate;    // of the target: change of the gap
};

SpringNormals normals_of(const SpringBed& bed, const SpringStates& s, std::size_t k, const Pose& source,
                         const Pose& target) {
  const SurfaceMesh &mesh_s = bed.pair.source_layer().spring_surface(), &mesh_t = bed.target.mesh();
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
  // the normal that the gap's derivative sees: of the facet, or of the smooth surface it stands for
  const Vector3d seen =
      (s.normal[k] - target.rotation * bulge_gradient(mesh_t, s.triangle[k], s.end_weights[k])).normalized();
  return {n, s.direction[k] - n, m, seen - m};
}

FacetNoise facet_noise(const Problem& problem, const Evaluation& e, const VectorXd& direction) {
  const VectorXd all = on_all_dofs(problem, e, direction);
  double products = 0.0, crossed = 0.0, sum = 0.0, sum2 = 0.0;
  for (std::size_t c = 0; c < e.springs.size(); ++c) {
    const SpringStates& s = e.springs[c];
    const SpringBed& bed = problem.beds.beds[c];
    if (s.size() == 0) continue;
    const Vector6 u_t = all.segment<6>(6 * bed.target_body), u_s = all.segment<6>(6 * bed.source_body);
    if (u_t.isZero(0.0) && u_s.isZero(0.0)) continue;
    const Pose &source = e.poses[at(bed.source_body)], &target = e.poses[at(bed.target_body)];
    const Vector3d v_t = u_t.head<3>(), w_t = u_t.tail<3>(), v_s = u_s.head<3>(), w_s = u_s.tail<3>();
    for (int i = 0; i < s.size(); ++i) {
      const auto k = at(i);
      if (s.pressure[k] <= 0 || s.area[k] <= 0) continue;
      const SpringNormals normals = normals_of(bed, s, k, source, target);
      const Vector3d relative = v_t + w_t.cross(s.foot[k] - target.center) - v_s - w_s.cross(s.foot[k] - source.center);
      const double smooth_force = normals.smooth_force.dot(relative), rough_force = normals.rough_force.dot(relative);
      const double smooth_rate = normals.smooth_rate.dot(relative), rough_rate = normals.rough_rate.dot(relative);
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

/// FacetNoise::stiffness from above for any direction, by one pass over the springs: |ab| <= (a^2 + b^2)/2 makes the
/// products of (E6) a quadratic form.
struct NoiseBound {
  std::vector<Eigen::Matrix<double, 12, 12>> products, crossed;  // per contact: target, source

  NoiseBound(const Problem& problem, const Evaluation& e) {
    for (std::size_t c = 0; c < e.springs.size(); ++c) {
      products.push_back(Eigen::Matrix<double, 12, 12>::Zero());
      crossed.push_back(Eigen::Matrix<double, 12, 12>::Zero());
      const SpringStates& s = e.springs[c];
      const SpringBed& bed = problem.beds.beds[c];
      if (s.size() == 0) continue;
      const Pose &source = e.poses[at(bed.source_body)], &target = e.poses[at(bed.target_body)];
      for (int i = 0; i < s.size(); ++i) {
        const auto k = at(i);
        if (s.pressure[k] <= 0 || s.area[k] <= 0) continue;
        const SpringNormals normals = normals_of(bed, s, k, source, target);
        const double stiffness = s.per_overlap[k] * s.area[k];
        const auto line = [&](const Vector3d& n) {
          Eigen::Matrix<double, 12, 1> h;
          h << n, (s.foot[k] - target.center).cross(n), -n, -(s.foot[k] - source.center).cross(n);
          return h;
        };
        const Eigen::Matrix<double, 12, 1> a = line(normals.rough_force), b = line(normals.rough_rate);
        products.back() += 0.5 * stiffness * (a * a.transpose() + b * b.transpose());
        crossed.back() +=
            stiffness * (a * line(normals.smooth_rate).transpose() + line(normals.smooth_force) * b.transpose());
      }
    }
  }

  double operator()(const Problem& problem, const Evaluation& e, const VectorXd& direction) const {
    const VectorXd all = on_all_dofs(problem, e, direction);
    double bound = 0.0;
    for (std::size_t c = 0; c < products.size(); ++c) {
      const SpringBed& bed = problem.beds.beds[c];
      Eigen::Matrix<double, 12, 1> u;
      u << all.segment<6>(6 * bed.target_body), all.segment<6>(6 * bed.source_body);
      bound += u.dot(products[c] * u) + std::abs(u.dot(crossed[c] * u));
    }
    return bound;
  }
};

std::string direction_in_words(const Problem& problem, const Evaluation& e, const VectorXd& direction) {
  const VectorXd scaled = as_free(problem, e, direction);
  std::string text;
  for (std::size_t b = 0; b < problem.joint.bodies.size(); ++b) {
    Vector6 u = Vector6::Zero();
    for (std::size_t i = 0; i < problem.free.size(); ++i)
      if (at(problem.free[i] / 6) == b) u[problem.free[i] % 6] = scaled[static_cast<Eigen::Index>(i)];
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

/// The flat direction's share of the residual that is given up: of a rotation about a point off the centre of mass,
/// which has a translation in it, the moment alone, so that forces balance to the last digit.
VectorXd moment_of(const Problem& problem, const Evaluation& e, const VectorXd& u) {
  VectorXd moment = as_free(problem, e, u);
  for (Eigen::Index i = 0; i < moment.size(); ++i)
    if (problem.free[static_cast<std::size_t>(i)] % 6 < 3) moment[i] = 0.0;
  if (problem.joined()) moment = e.tangent.basis.transpose() * moment;
  return moment.norm() > 0.3 ? VectorXd(moment.normalized()) : u;
}

/// Newton's step where the columns of `held` are kept still and those of `given_up` need not balance:
/// K x + given_up y = r, held^T x = 0.
VectorXd bordered_step(const Sparse& K, const MatrixXd& given_up, const MatrixXd& held, const VectorXd& r) {
  const Eigen::Index n = K.rows(), lost = held.cols();
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < K.outerSize(); ++k)
    for (Sparse::InnerIterator it(K, k); it; ++it) entries.emplace_back(it.row(), it.col(), it.value());
  const double unit = K.norm() / std::sqrt(static_cast<double>(n)) + 1e-300;  // so that pivots compare
  for (Eigen::Index j = 0; j < lost; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) {
      if (given_up(i, j) != 0.0) entries.emplace_back(i, n + j, unit * given_up(i, j));
      if (held(i, j) != 0.0) entries.emplace_back(n + j, i, unit * held(i, j));
    }
  }
  Sparse bordered(n + lost, n + lost);
  bordered.setFromTriplets(entries.begin(), entries.end());
  bordered.makeCompressed();
  Eigen::SparseLU<Sparse> lu(bordered);
  VectorXd rhs = VectorXd::Zero(n + lost);
  rhs.head(n) = r;
  if (lu.info() != Eigen::Success) return VectorXd::Zero(n);  // no step: the caller regularises
  const VectorXd x = lu.solve(rhs);
  return x.head(n);
}

/// `patience` >= 1 widens what counts as facet noise, so that a direction at its edge does not change sides for ever.
Directions take_apart(const Problem& problem, const Evaluation& e, const VectorXd& r, double patience) {
  const Sparse K = scaled_stiffness(problem, e);
  const Eigen::Index n = K.rows();
  Directions d;
  d.newton = d.drift = VectorXd::Zero(n);
  d.residual = r;
  d.given_up.resize(n, 0);
  if (n == 0) return d;
  const bool dense = n <= kDenseUnknowns;
  std::optional<NoiseBound> bound;  // where there are many directions to be asked
  const auto noise_of = [&](double sigma, double largest, const VectorXd& v) {
    FacetNoise noise;
    const bool nothing = sigma <= 1e-10 * largest || largest == 0.0;
    if (sigma >= 0.1 * largest && !nothing) return std::make_pair(false, noise);
    if (!nothing && n > 12) {
      if (!bound) bound.emplace(problem, e);
      if (sigma > 2.0 * patience * (*bound)(problem, e, v)) return std::make_pair(false, noise);
    }
    noise = facet_noise(problem, e, v);
    return std::make_pair(nothing || sigma <= 2.0 * patience * noise.stiffness, noise);
  };
  // Singular values, not dof by dof: a ball joint is free about axes that are no dof's.
  SingularParts parts;
  if (dense) {
    parts = all_singular_parts(MatrixXd(K));
  } else {
    const double largest = K.norm();  // from above: asks a few more than needed
    parts = small_singular_parts(
        K, [&](double sigma, const VectorXd& v) { return noise_of(sigma, largest, v).first; }, kDenseUnknowns);
  }
  const Eigen::Index found = parts.sigma.size();
  MatrixXd flat(n, found), given_up(n, found), stiff(n, dense ? n : 0);
  Eigen::Index lost = 0, kept = 0;
  for (Eigen::Index k = 0; k < found; ++k) {
    const VectorXd u = parts.U.col(k), v = parts.V.col(k);
    const auto [is_flat, noise] = noise_of(parts.sigma[k], parts.largest, v);
    if (!is_flat) {
      if (dense) stiff.col(kept++) = v;
      continue;
    }
    flat.col(lost) = v;
    const double along = v.dot(r);
    if (std::abs(along) <= std::max(1e-7 * e.load, patience * noise.force)) {
      d.held.push_back(v);
      given_up.col(lost) = moment_of(problem, e, u);
    } else {
      d.drift += v * along;
      given_up.col(lost) = u;
    }
    ++lost;
  }
  given_up.conservativeResize(n, lost);
  flat.conservativeResize(n, lost);
  stiff.conservativeResize(n, kept);
  MatrixXd test;
  if (lost > 0) {
    const Eigen::HouseholderQR<MatrixXd> qr(given_up);
    if (dense) {
      const MatrixXd q = qr.householderQ();
      test = q.rightCols(n - lost);
      d.given_up = q.leftCols(lost);
    } else {
      d.given_up = qr.householderQ() * MatrixXd::Identity(n, lost);
    }
    if (d.drift.squaredNorm() == 0.0) d.residual -= d.given_up * (d.given_up.transpose() * r);
  } else if (dense) {
    test = MatrixXd::Identity(n, n);
  }
  if (!dense) {
    d.newton = bordered_step(K, d.given_up, flat, r);
    d.least_stiffness = least_symmetric_eigenvalue(K, flat, kDenseUnknowns);
  } else if (kept > 0) {
    d.newton = stiff * (test.transpose() * K * stiff).fullPivLu().solve(test.transpose() * r);
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

/// By a motion of all dofs, to first order (E2): how the gap of each spring of a contact changes. Zero for those that
/// face nothing.
std::vector<double> gap_motions(const Problem& problem, const Evaluation& e, std::size_t contact, const VectorXd& all) {
  const SpringStates& s = e.springs[contact];
  const SpringBed& bed = problem.beds.beds[contact];
  const Pose &source = e.poses[at(bed.source_body)], &target = e.poses[at(bed.target_body)];
  const Vector3d v_t = all.segment<3>(6 * bed.target_body), w_t = all.segment<3>(6 * bed.target_body + 3);
  const Vector3d v_s = all.segment<3>(6 * bed.source_body), w_s = all.segment<3>(6 * bed.source_body + 3);
  std::vector<double> opened(at(s.size()), 0.0);
  for (std::size_t k = 0; k < opened.size(); ++k) {
    if (s.triangle[k] < 0) continue;
    const Vector3d relative = v_t + w_t.cross(s.end[k] - target.center) - v_s - w_s.cross(s.end[k] - source.center);
    opened[k] = s.normal[k].dot(relative) / s.normal[k].dot(s.direction[k]);
  }
  return opened;
}

/// How far along `direction` (a motion of the unknowns) the first spring closes, to first order: infinity if none does.
double first_touch(const Problem& problem, const Evaluation& e, const VectorXd& direction) {
  const VectorXd all = on_all_dofs(problem, e, direction);
  double first = kInfinity;
  for (std::size_t c = 0; c < e.springs.size(); ++c) {
    const SpringStates& s = e.springs[c];
    const std::vector<double> opened = gap_motions(problem, e, c, all);
    for (std::size_t k = 0; k < opened.size(); ++k)
      if (s.coverage[k] > 0 && opened[k] < 0) first = std::min(first, std::max(0.0, s.gap[k]) / -opened[k]);
  }
  return first;
}

/// The most that any spring under pressure closes or opens by a motion of the unknowns, to first order.
double closing_motion(const Problem& problem, const Evaluation& e, const VectorXd& motion) {
  const VectorXd all = on_all_dofs(problem, e, motion);
  double largest = 0.0;
  for (std::size_t c = 0; c < e.springs.size(); ++c) {
    const SpringStates& s = e.springs[c];
    const std::vector<double> opened = gap_motions(problem, e, c, all);
    for (std::size_t k = 0; k < opened.size(); ++k)
      if (s.pressure[k] > 0) largest = std::max(largest, std::abs(opened[k]));
  }
  return largest;
}

struct Search {
  bool found = false;
  Evaluation at;
};

/// A motion of all dofs as one of the unknowns at another pose: connectors leave other motions there.
VectorXd along_again(const Problem& problem, const Evaluation& e, const VectorXd& all) {
  VectorXd free(static_cast<Eigen::Index>(problem.free.size()));
  for (std::size_t i = 0; i < problem.free.size(); ++i)
    free[static_cast<Eigen::Index>(i)] = all[problem.free[i]] * problem.scale[static_cast<Eigen::Index>(i)];
  return problem.joined() ? VectorXd(e.tangent.basis.transpose() * free) : free;
}

/// Separated surfaces: along the load to first touch, and on until the contact carries most of it.
Search advance(Problem& problem, Evaluation e, VectorXd direction) {
  const double unit = surface_motion(problem, e, direction);
  if (unit <= 0) return {false, std::move(e)};
  direction /= unit;
  const double cap = 0.5 * problem.beds.least_thickness;
  for (int i = 0; i < 20 && !touching(e); ++i) {
    const double gap = first_touch(problem, e, direction);
    if (!std::isfinite(gap)) return {false, std::move(e)};
    auto poses = moved(problem, e, (gap + 1e-3 * cap) * direction);
    if (!poses) break;
    const VectorXd all = on_all_dofs(problem, e, direction);
    e = evaluate(problem, std::move(*poses));
    direction = along_again(problem, e, all);
    if (too_deep_area(problem, e) > 0) break;
  }
  if (!touching(e)) return {false, std::move(e)};
  // The contact's force grows about like the square of the depth: a few steps bring it near the load.
  const double driving = direction.dot(scaled_residual(problem, e));
  double depth = 1e-3 * cap;
  for (int i = 0; i < 12; ++i) {
    const VectorXd contact = on_unknowns(problem, e, e.contact);
    const double resisting = -direction.dot(contact);
    const double left = direction.dot(scaled_residual(problem, e));
    if (left <= 0.3 * (left + resisting) || driving <= 0) break;
    const double ratio = resisting > 0 ? (left + resisting) / resisting : 1e4;
    const double step = std::min(cap, depth * (std::sqrt(ratio) - 1.0));
    auto poses = moved(problem, e, step * direction);
    if (!poses) break;
    const VectorXd all = on_all_dofs(problem, e, direction);
    Evaluation next = evaluate(problem, std::move(*poses));
    if (lost_force(e, next) > 0.5 * e.normal_force || too_deep_area(problem, next) > 0) break;
    e = std::move(next);
    direction = along_again(problem, e, all);
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
    const VectorXd direction = on_unknowns(problem, e, push);
    const double unit = surface_motion(problem, e, direction);
    if (unit <= 0) break;
    auto poses = moved(problem, e, (0.5 * depth / unit) * direction);
    if (!poses) break;
    e = evaluate(problem, std::move(*poses));
  }
  const bool found = too_deep_area(problem, e) == 0;
  return {found, std::move(e)};
}

// ---- Newton ------------------------------------------------------------------------------------------------------

struct Solution {
  Outcome outcome = Outcome::NotConverged;
  std::string message;
  Sentence advice;
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

bool within_one_spring(const Evaluation& e, double size) {
  return size <= 0.01 * e.load && size <= largest_spring_force(e);
}

/// A residual that cannot fall below what one spring carries, because that spring jumps on and off a rim.
bool to_one_spring(const Evaluation& e, double size, Solution& solution) {
  if (!within_one_spring(e, size)) return false;
  const double one = largest_spring_force(e);
  solution.outcome = Outcome::BalancedToOneSpring;
  solution.message = fmt::format(
      "unbalanced force is {:.2e} of the load, less than one spring carries ({:.2e}); it cannot fall further on this "
      "mesh",
      size / e.load, one / e.load);
  return true;
}

/// What a search may still cost. Every pose tried is paid for, every halving of the residual earns some of it back: a
/// search that comes nearer to balance goes on, one that only travels ends.
struct Patience {
  double most = 0.0, left = 0.0;
  double best = kInfinity;  // residual / load
  int paid = 0;             // poses paid for
  int far = 0, near = 0;    // since the best: poses from iterates that saw balance beyond the next step, and others
  bool out() const { return left < 0.0; }
  /// More of `tried` poses are spent; `beyond`: in a step that was cut short.
  void pay(int tried, bool beyond) {
    (beyond ? far : near) += tried - paid;
    left -= std::min(tried - paid, 8);  // one step that is hard to find is no reason to give up
    paid = tried;
  }
  void earn(double residual) {
    constexpr double kPerHalving = 200.0;  // a ball rolling down a groove needs as many: by 7% in 20 poses
    if (!(residual < best)) return;
    if (best < kInfinity && residual > 0.0) left = std::min(most, left + kPerHalving * std::log2(best / residual));
    if (residual < 0.98 * best) far = near = 0;
    best = residual;
  }
};

/// The part of the residual along motions that are too soft to balance it within two thicknesses, and the motion that
/// would (scaled, to first order). Nothing where the springs' stiffness answers the most of it.
std::optional<VectorXd> soft_motion(const Problem& problem, const Evaluation& e, const VectorXd& r) {
  if (r.size() == 0 || r.size() > kDenseUnknowns) return std::nullopt;
  const SingularParts parts = all_singular_parts(MatrixXd(scaled_stiffness(problem, e)));
  VectorXd motion = VectorXd::Zero(r.size());
  double soft = 0.0;
  for (Eigen::Index k = 0; k < parts.sigma.size(); ++k) {
    const VectorXd v = parts.V.col(k);
    const double along = parts.U.col(k).dot(r), stiffness = std::max(parts.sigma[k], 1e-12 * parts.largest);
    if (std::abs(along) * surface_motion(problem, e, v) <= 2.0 * problem.beds.least_thickness * stiffness) continue;
    soft += along * along;
    motion += along * v;
  }
  if (!(soft >= 0.25 * r.squaredNorm()) || !(motion.norm() > 0)) return std::nullopt;
  return motion;
}

constexpr int kMostStride = 8;  // steps that only slide may be so much longer

/// How far the search has taken the body it moved most, and which way.
struct Travel {
  double reached = 0.0;  // of a point of its articular surface, at most
  std::string words;
};

Travel travel(const Problem& problem, const std::vector<Pose>& from, const std::vector<Pose>& to) {
  Travel result;
  for (std::size_t b = 0; b < from.size(); ++b) {
    const Eigen::AngleAxisd turn(Matrix3d(to[b].rotation * from[b].rotation.transpose()));
    const Vector3d slide = to[b].center - from[b].center;
    const double turned = turn.angle() * problem.beds.length, slid = slide.norm();
    if (!(turned + slid > result.reached)) continue;
    result.reached = turned + slid;
    const std::string& name = problem.joint.bodies[b].name;
    result.words.clear();
    if (turned > 0.3 * slid)
      result.words = fmt::format("rotation of \"{}\" about ({:.3f}, {:.3f}, {:.3f}), turned {:.3g} degrees", name,
                                 turn.axis().x(), turn.axis().y(), turn.axis().z(), turn.angle() * 180.0 / M_PI);
    if (slid > 0.3 * turned)
      result.words += fmt::format("{}translation of \"{}\" along ({:.3f}, {:.3f}, {:.3f}), moved {:.3g}",
                                  result.words.empty() ? "" : ", and ", name, slide.x() / slid, slide.y() / slid,
                                  slide.z() / slid, slid);
  }
  return result;
}

/// Nothing resists a motion: which one, how far it was followed.
std::string says_nothing_resists(const Problem& problem, const std::vector<Pose>& started, const Evaluation& e,
                                 const VectorXd& motion, double unbalanced) {
  const Travel gone = travel(problem, started, e.poses);
  const double cap = 0.5 * problem.beds.least_thickness;
  return fmt::format(
      "{:.2g} of the load acts along a motion that nothing resists: {}; no nearer to balance after {} poses;",
      unbalanced,
      gone.reached > 2.0 * cap
          ? gone.words
          : fmt::format("{}, followed for {:.3g}", direction_in_words(problem, e, motion.normalized()), gone.reached),
      problem.casts);
}

Sentence against_free_motion() {
  return say("hold this motion ({}), add what resists it, or check where the load acts", NamedSetting{"free"});
}

Solution newton(Problem& problem, Evaluation e, const EquilibriumOptions& options) {
  Solution solution;
  const double cap = 0.5 * problem.beds.least_thickness;
  const std::vector<Pose> started = e.poses;
  int advances = 0;
  Patience patient{static_cast<double>(options.patience), static_cast<double>(options.patience)};
  patient.paid = problem.casts;
  bool beyond = false;  // balance is farther than the step from the last iterate
  int full = 0;         // steps in a row that were cut to the cap and taken
  double stride = 1.0;  // of the cap, for steps along which no spring closes by more than the cap
  VectorXd last_drift;  // over all dofs
  for (;;) {
    const VectorXd r = scaled_residual(problem, e);
    // a direction at the edge of the facets' noise must not change sides for ever
    const double patience = 1.0 + 0.1 * std::max(0, solution.iterations - 12);
    Directions d = take_apart(problem, e, r, patience);
    const double size = d.residual.norm();
    // what is left may be the pressures' own error
    if (e.tolerance > kPressureTolerance && size <= 100.0 * e.tolerance * e.load) {
      problem.tolerance = tolerance_after(e.load > 0 ? size / e.load : 0.0);
      if (problem.tolerance > 0.1 * e.tolerance) problem.tolerance = kPressureTolerance;
      e = evaluate(problem, std::move(e.poses));
      continue;
    }
    solution.history.push_back(e.load > 0 ? size / e.load : 0.0);
    problem.status.residual = solution.history.back();
    problem.tolerance = tolerance_after(solution.history.back());
    if (!std::isfinite(size)) {
      solution.message = "a force is no finite number at this pose";
      break;
    }
    if (size <= options.tolerance * e.load) {
      solution.outcome = Outcome::Balanced;
      solution.message = fmt::format("balanced to {:.1e} of the load in {} iterations",
                                     e.load > 0 ? size / e.load : 0.0, solution.iterations);
      solution.at = std::move(e);
      solution.directions = std::move(d);
      return solution;
    }
    patient.pay(problem.casts, beyond);
    patient.earn(solution.history.back());
    const bool loose = 3 * patient.far > patient.near;
    constexpr int kFar = 8;  // poses; a turn of 30 degrees, or a slide of half the articular surface's radius
    const bool wandered =
        loose && patient.far > kFar && travel(problem, started, e.poses).reached > 0.5 * problem.beds.length;
    if ((wandered || patient.out()) && !within_one_spring(e, size)) {
      const std::optional<VectorXd> soft = soft_motion(problem, e, r);
      if (loose || soft) {
        solution.outcome = Outcome::NoEquilibrium;
        solution.message =
            says_nothing_resists(problem, started, e, soft ? *soft : VectorXd(d.newton + d.drift), size / e.load);
        solution.advice = against_free_motion();
      } else {
        solution.message = fmt::format(
            "unbalanced force is {:.2e} of the load after {} iterations and {} poses tried, and falls no more",
            size / e.load, solution.iterations, problem.casts);
      }
      break;
    }
    if (loose && patient.left < -0.5 * patient.most && to_one_spring(e, size, solution)) break;
    if (solution.iterations >= options.max_iterations || problem.casts >= options.max_casts) {
      if (to_one_spring(e, size, solution)) break;
      solution.message = fmt::format("unbalanced force is {:.2e} of the load after {} iterations and {} poses tried",
                                     size / e.load, solution.iterations, problem.casts);
      break;
    }
    ++solution.iterations;
    ++problem.status.iterations;

    const double drift = d.drift.norm();
    if (drift > options.tolerance * e.load && drift >= 0.5 * size) {
      // Nothing resists the load in some direction: without contact go to first touch, with contact follow it for a
      // while.
      if (!touching(e)) {
        Search s = advances++ < 3 ? advance(problem, std::move(e), d.drift) : Search{false, std::move(e)};
        e = std::move(s.at);
        if (s.found) continue;
        solution.outcome = Outcome::SurfacesApart;
        const std::string way = travel(problem, started, e.poses).words;  // empty: there was none to go
        solution.message = fmt::format("the load moves the surfaces apart: no spring closes along it ({})",
                                       way.empty() ? direction_in_words(problem, e, d.drift.normalized()) : way);
        break;
      }
      beyond = true;
      VectorXd step = d.newton;
      const double stiff = surface_motion(problem, e, step);
      if (stiff > cap) step *= cap / stiff;
      const VectorXd way = on_all_dofs(problem, e, d.drift);
      const bool same_way =
          last_drift.size() == way.size() && last_drift.dot(way) > 0.7 * last_drift.norm() * way.norm();
      full = same_way ? full + 1 : 0;
      if (!same_way) stride = 1.0;
      if (full >= 3) stride = std::min<double>(kMostStride, 2.0 * stride);
      last_drift = way;
      const VectorXd drift_step = d.drift * (cap / surface_motion(problem, e, d.drift));
      std::optional<Evaluation> next;
      for (;; stride = 1.0, full = 0) {
        const double closing = closing_motion(problem, e, drift_step);
        stride = std::max(1.0, std::min(stride, closing > 0 ? cap / closing : stride));
        auto poses = moved(problem, e, step + stride * drift_step);
        next.reset();
        if (poses) next = evaluate(problem, std::move(*poses));
        if (stride <= 1.0 || (next && lost_force(e, *next) < 0.5 * e.normal_force &&
                              scaled_residual(problem, *next).norm() < 4.0 * size))
          break;
      }
      if (!next) {
        solution.message =
            "a loaded motion that nothing resists ends where joints lock or a spring's force is undefined";
        break;
      }
      e = std::move(*next);
      continue;
    }
    // the next step is cut short, and not because springs close: balance is far along a motion that little resists
    const double predicted = surface_motion(problem, e, d.newton);
    beyond = predicted > cap && closing_motion(problem, e, d.newton) < 0.5 * predicted;

    // A Newton step, shortened until the residual falls; springs that lose their target count as residual.
    const auto try_step = [&](VectorXd step) -> bool {
      const double motion = surface_motion(problem, e, step);
      if (!(motion > 0) || !std::isfinite(motion)) return false;
      double most = cap;
      if (stride > 1.0) {
        const double closing = closing_motion(problem, e, step) / motion;  // per unit of motion
        most = cap * std::max(1.0, std::min(stride, closing > 0 ? 1.0 / closing : stride));
      }
      const bool cut = motion > most;
      if (cut) step *= most / motion;
      const double whole = std::min(motion, most);
      for (double length = whole; length > std::min(whole, cap) / 33.0; length *= 0.5, step *= 0.5) {
        if (problem.casts >= options.max_casts || problem.casts - patient.paid >= 2.0 * patient.most) return false;
        auto poses = moved(problem, e, step);
        if (!poses) continue;
        Evaluation trial = evaluate(problem, std::move(*poses));
        VectorXd trial_r = scaled_residual(problem, trial);
        if (!d.held.empty()) {
          MatrixXd given_up = d.given_up;
          if (problem.joined()) {  // the same directions, among the motions left at the new pose
            given_up = trial.tangent.basis.transpose() * (e.tangent.basis * given_up);
            const Eigen::HouseholderQR<MatrixXd> qr(given_up);
            given_up = qr.householderQ() * MatrixXd::Identity(given_up.rows(), given_up.cols());
          }
          trial_r -= given_up * (given_up.transpose() * trial_r);
        }
        if (trial_r.norm() + lost_force(e, trial) < size) {
          const bool at_once = length == whole;
          full = cut && at_once ? full + 1 : 0;
          if (full >= 3)
            stride = std::min<double>(kMostStride, 2.0 * stride);
          else if (full == 0)
            stride = 1.0;
          e = std::move(trial);
          return true;
        }
      }
      return false;
    };
    if (try_step(d.newton)) continue;
    // Regularised steps turn from Newton's direction towards the force itself.
    const Sparse K = scaled_stiffness(problem, e);
    const double stiffest = K.norm();
    Sparse one(K.rows(), K.cols());
    one.setIdentity();
    bool moved_on = false;
    for (double lambda = 1e-3; lambda <= 10.0 && !moved_on; lambda *= 10.0) {
      const Sparse regular = K + lambda * stiffest * one;
      if (K.rows() <= kDenseUnknowns) {
        moved_on = try_step(MatrixXd(regular).partialPivLu().solve(d.residual));
      } else {
        const Eigen::SparseLU<Sparse> lu(regular);
        moved_on = lu.info() == Eigen::Success && try_step(lu.solve(d.residual));
      }
    }
    if (moved_on) continue;
    patient.pay(problem.casts, beyond);
    if (patient.out() && !within_one_spring(e, size)) {
      solution.history.pop_back();  // the same iterate again, to be given up
      continue;
    }
    if (!to_one_spring(e, size, solution))
      solution.message = fmt::format(
          "unbalanced force is {:.2e} of the load after {} iterations and no step lowers it{}", size / e.load,
          solution.iterations, problem.undefined.empty() ? "" : "; steps were refused: " + problem.undefined);
    break;
  }
  solution.directions =
      take_apart(problem, e, scaled_residual(problem, e), 1.0 + 0.1 * std::max(0, solution.iterations - 12));
  solution.at = std::move(e);
  return solution;
}

/// Springs strained beyond the law's limit, or through.
int beyond_limit(const Evaluation& e) {
  int count = 0;
  for (const SpringStates& s : e.springs) {
    const SpringDepth depth = spring_depth(s);
    count += depth.strained + depth.through;
  }
  return count;
}

/// Where pressures on the surfaces, however they were spread, could not balance the load at this pose: how much of the
/// load is left at best, and whether the motion that then follows opens the contact (E8).
struct Separation {
  double left = 0.0;     ///< of what is to be balanced
  double opening = 0.0;  ///< mean over the springs of the cosine between that motion and the spring's push
};

Separation separation(const Problem& problem, const Evaluation& e) {
  // the pushes of unit spring forces on the unknowns, as columns
  constexpr int kMostColumns = 2000;  // a sample is enough to span what all can do
  int facing = 0;
  for (const SpringStates& s : e.springs)
    for (int i = 0; i < s.size(); ++i) facing += s.triangle[at(i)] >= 0 && s.coverage[at(i)] > 0;
  const VectorXd load = on_unknowns(problem, e, e.ligaments + e.external - problem.offset);
  if (facing == 0 || !(load.norm() > 0)) return {1.0, load.norm() > 0 ? 1.0 : 0.0};
  const int stride = (facing + kMostColumns - 1) / kMostColumns;
  MatrixXd push(load.size(), (facing + stride - 1) / stride);
  Eigen::Index columns = 0;
  int seen = 0;
  for (std::size_t c = 0; c < e.springs.size(); ++c) {
    const SpringStates& s = e.springs[c];
    const SpringBed& bed = problem.beds.beds[c];
    for (int i = 0; i < s.size(); ++i) {
      if (s.triangle[at(i)] < 0 || s.coverage[at(i)] <= 0 || seen++ % stride != 0) continue;
      const Vector3d n = s.direction[at(i)];
      VectorXd all = VectorXd::Zero(6 * static_cast<Eigen::Index>(e.poses.size()));
      all.segment<3>(6 * bed.target_body) = n;
      all.segment<3>(6 * bed.target_body + 3) = (s.foot[at(i)] - e.poses[at(bed.target_body)].center).cross(n);
      all.segment<3>(6 * bed.source_body) = -n;
      all.segment<3>(6 * bed.source_body + 3) = -(s.foot[at(i)] - e.poses[at(bed.source_body)].center).cross(n);
      push.col(columns++) = on_unknowns(problem, e, all);
    }
  }
  push.conservativeResize(load.size(), columns);
  // Least squares with forces >= 0: Lawson and Hanson (1974), chapter 23
  std::vector<Eigen::Index> active;
  VectorXd force = VectorXd::Zero(columns), left = load;
  for (int i = 0; i < 20 + 4 * static_cast<int>(load.size()); ++i) {
    Eigen::Index best = -1;
    const double most = -(push.transpose() * left).minCoeff(&best);
    if (!(most > 1e-9 * load.norm()) || std::find(active.begin(), active.end(), best) != active.end()) break;
    active.push_back(best);
    for (;;) {
      MatrixXd A(load.size(), static_cast<Eigen::Index>(active.size()));
      for (std::size_t k = 0; k < active.size(); ++k) A.col(static_cast<Eigen::Index>(k)) = push.col(active[k]);
      const VectorXd x = A.completeOrthogonalDecomposition().solve(-load);
      double part = 1.0;
      for (std::size_t k = 0; k < active.size(); ++k) {
        const double old = force[active[k]], now = x[static_cast<Eigen::Index>(k)];
        if (now <= 0) part = std::min(part, old / std::max(old - now, 1e-300));
      }
      std::vector<Eigen::Index> kept;
      for (std::size_t k = 0; k < active.size(); ++k) {
        double& f = force[active[k]];
        f += part * (x[static_cast<Eigen::Index>(k)] - f);
        if (f > 1e-12 * load.norm())
          kept.push_back(active[k]);
        else
          f = 0.0;
      }
      if (part >= 1.0 || kept.size() == active.size() || kept.empty()) {
        active = std::move(kept);
        break;
      }
      active = std::move(kept);
    }
    left = load + push * force;
  }
  Separation result;
  result.left = left.norm() / load.norm();
  if (!(left.norm() > 0)) return result;
  for (Eigen::Index k = 0; k < columns; ++k)
    result.opening +=
        push.col(k).dot(left) / (push.col(k).norm() * left.norm() + 1e-300) / static_cast<double>(columns);
  return result;
}

/// The whole search for one load case from one start.
Solution solve(Problem& problem, const std::vector<Pose>& start, const EquilibriumOptions& options) {
  problem.tolerance = tolerance_after(1.0);
  Evaluation e = evaluate(problem, start);
  if (too_deep_area(problem, e) > 0) {
    Search out = back_out(problem, e);
    if (out.found) e = std::move(out.at);
  }
  const std::vector<Pose> poses = e.poses;
  Solution direct = newton(problem, std::move(e), options);
  const bool given_up = direct.outcome == Outcome::NoEquilibrium;
  if ((direct.outcome != Outcome::NotConverged && !given_up) || !direct.at.contact.allFinite()) return direct;
  // Continuation: what is out of balance at the start is held back and released piece by piece.
  Evaluation from =
      evaluate(problem, poses);  // a copy, kept for this rare case, would be as large as the springs' states
  const auto opens = [&](const Evaluation& e, double* left) {
    const Separation apart = separation(problem, e);
    *left = apart.left;
    return apart.left > 0.05 && apart.opening > 0.1;  // far above what facets' normals are uncertain by
  };
  double left_at_start = 0.0, left_at_end = 0.0;
  if (opens(from, &left_at_start) && opens(direct.at, &left_at_end)) {
    direct.outcome = Outcome::SurfacesApart;
    direct.advice = {};
    direct.message = fmt::format(
        "the load moves the surfaces apart: pressures on them, however spread, leave {:.2g} of it unbalanced",
        std::min(left_at_start, left_at_end));
    return direct;
  }
  if (given_up && beyond_limit(direct.at) == 0) return direct;
  const VectorXd all = from.residual();
  double done = 0.0, piece = 0.25;
  int iterations = direct.iterations;
  EquilibriumOptions pieces = options;
  pieces.patience = (options.patience + 1) / 2;
  int lost = 0;  // poses of pieces that failed: all together what one search may lose
  while (done < 1.0 && piece > 1.0 / 128 && lost < options.patience && problem.casts < options.max_casts) {
    const int before = problem.casts;
    const double next = std::min(1.0, done + piece);
    problem.offset = (1.0 - next) * all;
    Solution part = newton(problem, from, pieces);
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
      if (beyond_limit(part.at) > 0) break;  // more pieces would press through all the same
      lost += problem.casts - before;
      piece *= 0.5;
    }
  }
  problem.offset.setZero();
  direct.iterations = iterations;
  if (const int beyond = beyond_limit(direct.at); beyond > 0) {
    direct.outcome = Outcome::BeyondStrainLimit;
    direct.advice = {};
    direct.message = fmt::format(
        "no balance: {:.3g}% of the load is not carried when {} springs are strained beyond {}: the layers are too "
        "thin or "
        "too soft for it",
        100.0 * (direct.history.empty() ? 1.0 : direct.history.back()), beyond, kStrainLimit);
  } else if (const auto soft = soft_motion(problem, direct.at, scaled_residual(problem, direct.at))) {
    direct.outcome = Outcome::NoEquilibrium;
    direct.message =
        says_nothing_resists(problem, poses, direct.at, *soft, direct.history.empty() ? 1.0 : direct.history.back());
    direct.advice = against_free_motion();
  }
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
    result.reaction.push_back(-(e.contact + e.ligaments + e.reactions).segment<6>(6 * static_cast<Eigen::Index>(b)));
  result.cable_force = problem.conditions.cable_force;
  if (!problem.conditions.connector_active.empty()) {
    if (problem.joined())
      result.connector_force =
          connector_forces(problem.joint, problem.conditions, e.rows, e.tangent.multipliers, e.poses);
    else  // nothing has been solved, or nothing can move
      result.connector_force.assign(problem.joint.connectors.size(), Vector6::Constant(kNaN));
    for (const Connector& c : problem.joint.connectors)
      result.connector_motion.push_back(connector_motion(problem.joint, c, e.poses));
  }
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

Problem make_problem(const Joint& joint, const SpringBeds& beds, const LoadCase& conditions,
                     std::vector<PressMemory>& memory) {
  memory.resize(beds.beds.size());
  Problem problem{joint, beds, conditions, {}, {}, {}, memory, 0, kPressureTolerance, {}, {}, {}, nullptr};
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
    beds.beds.push_back(place_springs(joint, pair));
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

BodyForces forces_at(const Joint& joint, const SpringBeds& beds, const LoadCase& conditions,
                     const std::vector<Pose>& poses) {
  std::vector<PressMemory> memory;
  Problem problem = make_problem(joint, beds, conditions, memory);
  Evaluation e = evaluate(problem, poses);
  BodyForces forces(joint.bodies.size());
  forces.value = e.residual();
  forces.derivative = std::move(e.derivative);
  return forces;
}

Equilibrium state_at(const Joint& joint, const SpringBeds& beds, const LoadCase& conditions,
                     const std::vector<Pose>& poses, std::vector<PressMemory>* memory) {
  std::vector<PressMemory> own;
  if (const std::string fault = undefined_force(joint, conditions, poses); !fault.empty()) throw InputError(fault);
  Problem problem = make_problem(joint, beds, conditions, memory ? *memory : own);
  problem.tolerance = kGivenPoseTolerance;
  Equilibrium result;
  result.outcome = Outcome::Prescribed;
  result.message = "motion given";
  result.least_stiffness = kNaN;
  fill(result, problem, evaluate(problem, poses));
  return result;
}

Equilibrium solve_equilibrium(const Joint& joint, const SpringBeds& beds, const LoadCase& conditions,
                              const std::vector<Pose>& start, const std::vector<Pose>& step_start,
                              const EquilibriumOptions& options, std::vector<PressMemory>* memory) {
  std::vector<Pose> poses = start;
  std::vector<PressMemory> own;
  Problem problem = make_problem(joint, beds, conditions, memory ? *memory : own);
  problem.watch = &options.watch;
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
  if (joint.connectors.size() > 0 && conditions.connector_active.size() == joint.connectors.size()) {
    const double size = beds.length + beds.reach;
    problem.connectors = make_groups(joint, conditions, problem.free, beds.length, size, start);
    ConnectorRow worst;
    std::vector<Pose> closed = poses;
    if (!close_connectors(joint, conditions, problem.connectors, closed, &worst)) {
      result = state_at(joint, beds, conditions, poses, &problem.memory);
      result.outcome = Outcome::NoEquilibrium;
      const Connector& c = joint.connectors[at(worst.connector)];
      result.message = fmt::format(
          "joint \"{}\" cannot be held together with the other joints and with what is fixed or prescribed: a gap of "
          "{:.3g}{} is left {} its axis {}; free a motion or take a joint out",
          c.name, std::abs(worst.gap), worst.dof < 3 ? "" : " rad", worst.dof < 3 ? "along" : "about",
          worst.dof % 3 + 1);
      return result;
    }
    poses = std::move(closed);
  }
  if (problem.free.empty()) {
    result = state_at(joint, beds, conditions, poses, &problem.memory);
    return result;
  }
  if (const std::string fault = undefined_force(joint, conditions, poses); !fault.empty()) throw InputError(fault);
  Solution s = solve(problem, poses, options);
  if (s.at.tolerance > kPressureTolerance) {  // a search that ended far from balance
    problem.tolerance = kPressureTolerance;
    s.at = evaluate(problem, std::move(s.at.poses));
  }
  result.outcome = s.outcome;
  result.message = s.message;
  result.advice = s.advice;
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
        direction_in_words(problem, s.at, v) +
        (along > 1e-6 ? fmt::format(" ({:.1e} of the load left along it: the facets' roughness)", along) : ""));
  }
  fill(result, problem, std::move(s.at));
  return result;
}

}  // namespace dea
