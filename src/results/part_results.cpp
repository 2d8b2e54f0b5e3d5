#include "src/results/part_results.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "src/base/decompositions.h"
#include "src/base/numbers.h"
#include "src/results/fields.h"
#include "src/results/percentile.h"

namespace dea {

namespace {

/// `shear`: what of the last three stands in the matrix, 1 for stresses, a half for strains as angles.
Eigen::Matrix3d as_matrix(const Vector6d& t, double shear) {
  Eigen::Matrix3d m;
  m << t[0], shear * t[3], shear * t[5], shear * t[3], t[1], shear * t[4], shear * t[5], shear * t[4], t[2];
  return m;
}

SymmetricTensor as_tensor(const Eigen::Matrix3d& m) { return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(1, 2), m(0, 2)}; }

/// By how much a body turns that goes along with an element's nodes as nearly as it can.
double turn_of(const std::vector<Vector3d>& from, const std::vector<Vector3d>& to) {
  Vector3d a = Vector3d::Zero(), b = a;
  for (std::size_t k = 0; k < from.size(); ++k) {
    a += from[k] / static_cast<double>(from.size());
    b += to[k] / static_cast<double>(from.size());
  }
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < from.size(); ++k) cross += (to[k] - b) * (from[k] - a).transpose();
  const SingularValues svd = whole_svd(cross);
  const Eigen::Matrix3d R = svd.U * svd.V.transpose();
  return std::abs(Eigen::AngleAxisd(R.determinant() > 0 ? R : Eigen::Matrix3d(-R)).angle());
}

PartNumber number_of(const std::vector<double>& values, const std::vector<double>& weights) {
  if (values.empty()) return {};
  return {weighted_percentile(values, weights, 0.99), *std::max_element(values.begin(), values.end())};
}

}  // namespace

std::vector<PartStress> part_stress(const Joint& joint, const Equilibrium& e) {
  std::vector<PartStress> parts(joint.parts.size());
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const PartMesh& mesh = joint.parts[k].mesh;
    const Eigen::MatrixX3d* motion = part_motion(joint, e, static_cast<int>(k));
    if (motion == nullptr) continue;
    PartStress& part = parts[k];
    const Eigen::Matrix3d turn = e.poses[at(joint.parts[k].body)].rotation;
    std::vector<double> volumes, principal, along, of_fibres;
    for (int i = 0; i < mesh.elements(); ++i) {
      const std::vector<Vector3d> nodes = mesh.corners(i);
      Eigen::VectorXd u(3 * nodes.size());
      std::vector<Vector3d> moved = nodes;
      for (std::size_t n = 0; n < nodes.size(); ++n) {
        const Vector3d by = motion->row(mesh.element_node[at(mesh.begin[at(i)]) + n]).transpose();
        u.segment<3>(3 * static_cast<Eigen::Index>(n)) = by;
        moved[n] += by;
      }
      Vector6d strain = Vector6d::Zero();
      double volume = 0.0;
      for (const ElementPoint& p : element_points(mesh.shape[at(i)], nodes)) {
        strain += p.volume * (p.strain * u);
        volume += p.volume;
      }
      strain /= volume;
      const Eigen::Matrix3d stress = as_matrix(mesh.stiffness(i) * strain, 1.0), strained = as_matrix(strain, 0.5);
      volumes.push_back(volume);
      principal.push_back(symmetric_eigenvalues_3(stress).maxCoeff());
      part.largest_strain = std::max(part.largest_strain, symmetric_eigenvalues_3(strained).cwiseAbs().maxCoeff());
      part.largest_turn = std::max(part.largest_turn, turn_of(nodes, moved));
      if (!mesh.fibre.empty() && !mesh.fibre[at(i)].isZero(0)) {
        along.push_back(mesh.fibre[at(i)].dot(stress * mesh.fibre[at(i)]));
        of_fibres.push_back(volume);
      }
      part.stress.push_back(as_tensor(turn * stress * turn.transpose()));
      part.strain.push_back(as_tensor(strained));
    }
    part.principal = number_of(principal, volumes);
    part.fibre = number_of(along, of_fibres);
    for (const Vector3d& u : part_displacements(joint, e, static_cast<int>(k)))
      part.largest_displacement = std::max(part.largest_displacement, u.norm());
  }
  return parts;
}

std::vector<InsideDomain> with_parts(const JointModel& model, const Joint& joint, const std::vector<PartStress>& parts,
                                     std::vector<InsideDomain> inside) {
  for (std::size_t k = 0; k < parts.size(); ++k)
    for (std::size_t i = 0; i < parts[k].stress.size(); ++i) {
      const PartElement& of = joint.parts[k].elements[i];
      auto domain =
          std::find_if(inside.begin(), inside.end(), [&](const InsideDomain& d) { return d.domain == of.domain; });
      if (domain == inside.end()) {
        const std::size_t count = model.domains[at(of.domain)].element_ids.size();
        domain = inside.insert(inside.end(), {of.domain, std::vector<SymmetricTensor>(count, SymmetricTensor{}),
                                              std::vector<SymmetricTensor>(count, SymmetricTensor{})});
      }
      domain->stress[at(of.place)] = parts[k].stress[i];
      domain->strain[at(of.place)] = parts[k].strain[i];
    }
  return inside;
}

}  // namespace dea
