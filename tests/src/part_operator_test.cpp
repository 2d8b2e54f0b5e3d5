// A deformable part as an operator (P1)-(P3), against answers on paper: uniform stress, bars, rigid motions, work.
#include "src/springs/part_operator.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "src/base/numbers.h"
#include "tests/src/part_meshes.h"

namespace dea::part_operator_test {
namespace {

using test::block_of;

/// Moves nodes inside the block and leaves its faces in their planes.
Vector3d uneven(const Vector3d& x) {
  const double bump = x[0] * (2 - x[0]) * x[1] * (3 - x[1]) * x[2] * (4 - x[2]);
  return x + 0.05 * bump * Vector3d(1, -0.7, 0.5);
}

std::string name_of(ElementShape shape) { return element_type(shape).name; }

/// Forces on the nodes that an even traction on the faces z = `z` makes, exact for a linear field of displacements:
/// from the elements themselves, as the internal forces of an even stress.
Eigen::MatrixX3d forces_of_stress(const PartMesh& mesh, const Vector6d& stress) {
  Eigen::MatrixX3d force = Eigen::MatrixX3d::Zero(mesh.size(), 3);
  for (int e = 0; e < mesh.elements(); ++e)
    for (const ElementPoint& p : element_points(mesh.shape[at(e)], mesh.corners(e))) {
      const Eigen::VectorXd f = p.volume * p.strain.transpose() * stress;
      for (int i = 0; i < f.size() / 3; ++i)
        force.row(mesh.element_node[at(mesh.begin[at(e)] + i)]) += f.segment<3>(3 * i).transpose();
    }
  return force;
}

/// An even stress puts no force on nodes inside, and stretches a free part evenly, whatever its elements: the patch
/// test, the volume and the average over the part in one.
TEST(PartOperator, EvenStressStretchesEvenly) {
  const double E = 20, nu = 0.3;
  const Matrix6d D = isotropic_stiffness(E, nu);
  Vector6d stress;
  stress << 0.2, -0.1, -3, 0.4, 0.3, -0.2;
  const Vector6d strain = D.ldlt().solve(stress);
  Eigen::Matrix3d gradient;
  gradient << strain[0], strain[3] / 2, strain[5] / 2, strain[3] / 2, strain[1], strain[4] / 2, strain[5] / 2,
      strain[4] / 2, strain[2];
  for (ElementShape shape : test::stiff_shapes()) {
    SCOPED_TRACE(name_of(shape));
    const PartMesh mesh = block_of(shape, {2, 3, 2}, {2, 3, 4}, D, uneven);
    const Eigen::MatrixX3d force = forces_of_stress(mesh, stress);
    for (int i = 0; i < mesh.size(); ++i) {
      const Vector3d& x = mesh.nodes[at(i)];
      const bool inside =
          x[0] > 1e-9 && x[0] < 2 - 1e-9 && x[1] > 1e-9 && x[1] < 3 - 1e-9 && x[2] > 1e-9 && x[2] < 4 - 1e-9;
      EXPECT_LT(inside ? force.row(i).norm() : 0.0, 1e-12);
    }
    const PartOperator part = make_part_operator(mesh, std::vector<PartHold>(at(mesh.size()), PartHold::None));
    EXPECT_TRUE(part.free);
    double volume = 0;
    for (double v : part.volume) volume += v;
    EXPECT_NEAR(volume, 24, 1e-10);
    const Eigen::MatrixX3d u = displacements(part, force);
    // what turns without stress is taken out: on average, by volume, the part stays where it is
    Vector3d mean = Vector3d::Zero(), turn = Vector3d::Zero(), off = Vector3d::Zero();
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    for (int i = 0; i < mesh.size(); ++i) {
      const Vector3d arm = mesh.nodes[at(i)] - part.center;
      mean += part.volume[at(i)] * u.row(i).transpose() / volume;
      turn += part.volume[at(i)] * arm.cross(Vector3d(u.row(i).transpose()));
      off += part.volume[at(i)] * arm.cross(Vector3d(gradient * arm));
      inertia += part.volume[at(i)] * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
    }
    EXPECT_LT(mean.norm(), 1e-12);
    EXPECT_LT(turn.norm(), 1e-10);
    const Vector3d rest = inertia.inverse() * off;
    for (int i = 0; i < mesh.size(); ++i) {
      const Vector3d arm = mesh.nodes[at(i)] - part.center;
      EXPECT_LT((u.row(i).transpose() - (gradient * arm - rest.cross(arm))).norm(), 1e-11);
    }
  }
}

/// A bar between two bodies, no sideways strain (nu = 0): the piece that the second holds goes and turns as the end of
/// a beam under a force on it (Timoshenko, 6/5 over a square for nu = 0), and under one half-way.
TEST(PartOperator, BarBetweenTwoBodies) {
  const double E = 12, L = 4;
  const PartMesh mesh = block_of(ElementShape::Hex20, {2, 2, 6}, {1, 1, L}, isotropic_stiffness(E, 0.0));
  std::vector<PartHold> hold(at(mesh.size()), PartHold::None);
  int end = -1, corner = -1;
  for (int i = 0; i < mesh.size(); ++i) {
    const Vector3d& x = mesh.nodes[at(i)];
    if (x[2] < 1e-9) hold[at(i)] = PartHold::Frame;
    if (x[2] > L - 1e-9) hold[at(i)] = PartHold::Other;
    if ((x - Vector3d(0.5, 0.5, L)).norm() < 1e-9) end = i;
    if ((x - Vector3d(1, 0.5, L)).norm() < 1e-9) corner = i;
  }
  const PartOperator part = make_part_operator(mesh, hold);
  const auto moved = [&](int node, const Vector3d& force) {
    Eigen::MatrixX3d on = Eigen::MatrixX3d::Zero(mesh.size(), 3);
    on.row(node) = force.transpose();
    return displacements(part, on);
  };
  Eigen::MatrixX3d u = moved(end, {0, 0, 0.03});
  for (int i = 0; i < mesh.size(); ++i) EXPECT_NEAR(u(i, 2), 0.03 / E * mesh.nodes[at(i)][2], 1e-12);
  const double I = 1.0 / 12, G = E / 2;
  u = moved(end, {0.001, 0, 0});
  EXPECT_NEAR(u(end, 0) / 0.001 / (L * L * L / (3 * E * I) + 6.0 / 5 * L / G), 1, 0.01);
  EXPECT_NEAR((u(end, 2) - u(corner, 2)) / 0.5 / 0.001 / (L * L / (2 * E * I)), 1, 0.01);
  EXPECT_NEAR(u(end, 0), u(corner, 0), 1e-12) << "one rigid piece";
  Eigen::MatrixX3d middle = Eigen::MatrixX3d::Zero(mesh.size(), 3);
  for (int i = 0; i < mesh.size(); ++i)
    if (std::abs(mesh.nodes[at(i)][2] - L / 2) < 1e-9) middle(i, 0) = 0.0001;
  const double all = middle.sum(), a = L / 2;
  u = displacements(part, middle);
  EXPECT_NEAR(u(end, 0) / all / (a * a * (3 * L - a) / (6 * E * I) + 6.0 / 5 * a / G), 1, 0.01);
}

/// Feet on the top of a block, one per facet's half, with uneven directions.
PartFeet feet_on_top(const PartMesh& mesh, double z) {
  PartFeet feet;
  for (int e = 0; e < mesh.elements(); ++e) {
    std::vector<int> top;
    for (int i = mesh.begin[at(e)]; i < mesh.begin[at(e) + 1]; ++i)
      if (std::abs(mesh.nodes[at(mesh.element_node[at(i)])][2] - z) < 1e-9) top.push_back(mesh.element_node[at(i)]);
    if (top.size() < 3) continue;
    const Vector3d direction = Vector3d(0.1 * std::sin(e), 0.2 * std::cos(e), -1).normalized();
    const double area = 0.5 + 0.1 * std::sin(3.0 * e);
    for (std::size_t k = 0; k < 3; ++k) {
      feet.node.push_back(top[k]);
      feet.weight.push_back(area * (k == 0 ? 0.5 : 0.25) * direction);
    }
    feet.begin.push_back(static_cast<int>(feet.node.size()));
    feet.area.push_back(area);
  }
  feet.scale.assign(feet.area.size(), 1.0);
  return feet;
}

/// p^T A w = u^T K u, A_i dw_i/dp_j = A_j dw_j/dp_i, and sinking() is what displacements() says, for parts that are
/// held by one body or two, and free.
TEST(PartOperator, WorkOfTheFeetIsTheEnergyStored) {
  for (ElementShape shape : {ElementShape::Hex8, ElementShape::Tet4, ElementShape::Tet10})
    for (const int holders : {0, 1, 2}) {
      SCOPED_TRACE(name_of(shape) + ", held by " + std::to_string(holders));
      const Matrix6d D = isotropic_stiffness(7, 0.49);
      const PartMesh mesh = block_of(shape, {3, 3, 2}, {2, 3, 4}, D, uneven);
      std::vector<PartHold> hold(at(mesh.size()), PartHold::None);
      for (int i = 0; i < mesh.size(); ++i) {
        if (holders > 0 && mesh.nodes[at(i)][2] < 1e-9) hold[at(i)] = PartHold::Frame;
        if (holders > 1 && mesh.nodes[at(i)][0] > 2 - 1e-9) hold[at(i)] = PartHold::Other;
      }
      const PartOperator part = make_part_operator(mesh, hold);
      PartFeet feet = feet_on_top(mesh, 4);
      set_reach(feet, part);
      const Eigen::MatrixXd w = sinking(part, feet, Eigen::MatrixXd::Identity(feet.size(), feet.size()));
      for (int i = 0; i < feet.size(); ++i)
        for (int j = 0; j < i; ++j)
          EXPECT_NEAR(feet.area[at(i)] * w(i, j), feet.area[at(j)] * w(j, i), 1e-10 * w.cwiseAbs().maxCoeff());
      Eigen::VectorXd p(feet.size());
      for (int i = 0; i < feet.size(); ++i) p[i] = 1 + std::sin(1.7 * i);
      const Eigen::MatrixX3d force = by_node(nodal_forces(part, feet, p)), u = displacements(part, force);
      const Eigen::VectorXd sunk = sinking(part, feet, p).col(0);
      double work = 0;
      for (int i = 0; i < feet.size(); ++i) {
        double along = 0;
        for (int j = feet.begin[at(i)]; j < feet.begin[at(i) + 1]; ++j)
          along += feet.weight[at(j)].dot(u.row(feet.node[at(j)]).transpose());
        EXPECT_NEAR(sunk[i], along / feet.area[at(i)], 1e-11);
        work += p[i] * feet.area[at(i)] * sunk[i];
      }
      if (shape == ElementShape::Tet4) continue;  // the energy of its dilatations is at the nodes
      double stored = 0;
      for (int e = 0; e < mesh.elements(); ++e) {
        const Eigen::MatrixXd K = element_stiffness(element_points(shape, mesh.corners(e)), D);
        Eigen::VectorXd of(K.rows());
        for (int i = 0; i < K.rows() / 3; ++i)
          of.segment<3>(3 * i) = u.row(mesh.element_node[at(mesh.begin[at(e)] + i)]);
        stored += of.dot(K * of);
      }
      EXPECT_NEAR(work, stored, 1e-9 * stored);
    }
}

/// The same part turned by a right angle with its forces: the same displacements, turned.
TEST(PartOperator, TurnsWithItsForces) {
  const Matrix6d D = isotropic_stiffness(7, 0.45);
  const PartMesh mesh = block_of(ElementShape::Hex8, {2, 3, 2}, {2, 3, 4}, D, uneven);
  Eigen::Matrix3d turn;
  turn << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  PartMesh turned = mesh;
  for (Vector3d& x : turned.nodes) x = turn * x;
  const std::vector<PartHold> hold(at(mesh.size()), PartHold::None);
  Eigen::MatrixX3d force = Eigen::MatrixX3d::Zero(mesh.size(), 3);
  for (int i = 0; i < mesh.size(); ++i) force.row(i) << std::sin(i), std::cos(2 * i), std::sin(3 * i + 1);
  const Eigen::MatrixX3d u = displacements(make_part_operator(mesh, hold), force),
                         v = displacements(make_part_operator(turned, hold),
                                           Eigen::MatrixX3d(force * turn.transpose()));
  EXPECT_LT((v - u * turn.transpose()).cwiseAbs().maxCoeff(), 1e-10 * u.cwiseAbs().maxCoeff());
}

/// A block bonded below and pressed evenly above, cut out of a wide layer by walls it cannot pass: it must not lock
/// where it hardly changes its volume. Against quadratic elements on a fine mesh; the mean sinking.
TEST(PartOperator, HardlyLocksWhereVolumeStays) {
  const auto sunk = [](ElementShape shape, int n, double nu) {
    const PartMesh mesh = block_of(shape, {2 * n, 2 * n, n}, {4, 4, 2}, isotropic_stiffness(1, nu));
    std::vector<PartHold> hold(at(mesh.size()), PartHold::None);
    for (int i = 0; i < mesh.size(); ++i)
      if (mesh.nodes[at(i)][2] < 1e-9) hold[at(i)] = PartHold::Frame;
    const PartOperator part = make_part_operator(mesh, hold);
    Vector6d stress = Vector6d::Zero();
    stress[2] = -1;
    Eigen::MatrixX3d force = forces_of_stress(mesh, stress);
    for (int i = 0; i < mesh.size(); ++i)
      if (mesh.nodes[at(i)][2] < 1) force.row(i).setZero();
    const Eigen::MatrixX3d u = displacements(part, force);
    double sum = 0;
    for (int i = 0; i < mesh.size(); ++i) sum += force(i, 2) * u(i, 2);
    return sum / 16;
  };
  for (const double nu : {0.3, 0.49, 0.499}) {
    const double fine = sunk(ElementShape::Hex27, 4, nu);
    for (ElementShape shape : test::stiff_shapes())
      EXPECT_NEAR(sunk(shape, 3, nu) / fine, 1, shape == ElementShape::Tet4 ? 0.11 : 0.04)
          << name_of(shape) << ", " << nu;
  }
}

}  // namespace
}  // namespace dea::part_operator_test
