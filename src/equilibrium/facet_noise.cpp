#include "src/equilibrium/facet_noise.h"

#include <cmath>

#include "src/base/numbers.h"
#include "src/equilibrium/unknowns.h"

namespace dea {

using Eigen::VectorXd;

namespace {

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

}  // namespace

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

NoiseBound::NoiseBound(const Problem& problem, const Evaluation& e) {
  for (std::size_t c = 0; c < e.springs.size(); ++c) {
    products.push_back(Matrix12::Zero());
    crossed.push_back(Matrix12::Zero());
    const SpringStates& s = e.springs[c];
    const SpringBed& bed = problem.beds.beds[c];
    if (s.size() == 0) continue;
    const Pose &source = e.poses[at(bed.source_body)], &target = e.poses[at(bed.target_body)];
    for (int i = 0; i < s.size(); ++i) {
      const auto k = at(i);
      if (s.pressure[k] <= 0 || s.area[k] <= 0) continue;
      const SpringNormals normals = normals_of(bed, s, k, source, target);
      const double stiffness = s.per_overlap[k] * s.area[k];
      const auto line = [&](const Vector3d& n) { return unit_wrench(s.foot[k], n, source, target); };
      const Vector12 a = line(normals.rough_force), b = line(normals.rough_rate);
      products.back() += 0.5 * stiffness * (a * a.transpose() + b * b.transpose());
      crossed.back() +=
          stiffness * (a * line(normals.smooth_rate).transpose() + line(normals.smooth_force) * b.transpose());
    }
  }
}

double NoiseBound::operator()(const Problem& problem, const Evaluation& e, const VectorXd& direction) const {
  const VectorXd all = on_all_dofs(problem, e, direction);
  double bound = 0.0;
  for (std::size_t c = 0; c < products.size(); ++c) {
    const SpringBed& bed = problem.beds.beds[c];
    Vector12 u;
    u << all.segment<6>(6 * bed.target_body), all.segment<6>(6 * bed.source_body);
    bound += u.dot(products[c] * u) + std::abs(u.dot(crossed[c] * u));
  }
  return bound;
}

}  // namespace dea
