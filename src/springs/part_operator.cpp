#include "src/springs/part_operator.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "src/base/decompositions.h"
#include "src/base/numbers.h"
#include "src/geometry/pose.h"

namespace dea {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// How a point moves by the six rigid motions about a centre: translations, rotations.
Eigen::Matrix<double, 3, 6> rigid_motion(const Vector3d& arm) {
  Eigen::Matrix<double, 3, 6> R;
  R << Eigen::Matrix3d::Identity(), -skew(arm);
  return R;
}

std::vector<std::array<int, 2>> node_pairs(const PartMesh& mesh) {
  std::vector<std::array<int, 2>> pairs;
  for (int e = 0; e < mesh.elements(); ++e)
    for (int i = mesh.begin[at(e)]; i < mesh.begin[at(e) + 1]; ++i)
      for (int j = mesh.begin[at(e)]; j < i; ++j) pairs.push_back({mesh.element_node[at(i)], mesh.element_node[at(j)]});
  return pairs;
}

/// Tetrahedra of four nodes have one dilatation each, and there are five times as many of them as nodes: where the
/// material hardly changes its volume nothing could move. So that part of their stiffness acts on the mean dilatation
/// around each node (Bonet and Burton 1998, Commun Numer Meth Eng 14:437).
struct NodeDilatation {
  double volume = 0.0, modulus = 0.0;    // sum of V/4, of V/4 times what is left out of D
  std::map<int, Eigen::RowVector3d> of;  // per node of the elements around: integral of the dilatation per displacement
};

/// What of D acts on the dilatation alone and can be taken out of it: all but two thirds of the least shear modulus, as
/// lambda is of K.
double dilatation_modulus(const Matrix6d& D) {
  Vector6d m;
  m << 1, 1, 1, 0, 0, 0;
  const double bulk = 1 / m.dot(D.inverse() * m), shear = D.diagonal().tail<3>().minCoeff();
  return std::max(0.0, bulk - 2.0 / 3 * shear);
}

/// Calls `add(a, b, k)` with the stiffness between nodes a and b, both ways round, element by element.
template <class Add>
void for_each_stiffness(const PartMesh& mesh, std::vector<double>& volume, const Add& add) {
  std::map<std::pair<int, int>, NodeDilatation> dilatations;  // by material, node
  for (int e = 0; e < mesh.elements(); ++e) {
    const std::vector<ElementPoint> points = element_points(mesh.shape[at(e)], mesh.corners(e));
    const bool simple = mesh.shape[at(e)] == ElementShape::Tet4;
    const double of_volume = simple ? dilatation_modulus(mesh.stiffness(e)) : 0.0;
    const MatrixXd K = element_stiffness(points, mesh.stiffness(e), of_volume);
    const int* nodes = mesh.element_node.data() + mesh.begin[at(e)];
    const int n = mesh.begin[at(e) + 1] - mesh.begin[at(e)];
    double all = 0.0;
    for (const ElementPoint& p : points) all += p.volume;
    for (int i = 0; i < n; ++i) {
      volume[at(nodes[i])] += all / n;
      for (int j = 0; j < n; ++j) add(nodes[i], nodes[j], Eigen::Matrix3d(K.block<3, 3>(3 * i, 3 * j)));
    }
    if (!simple || !(of_volume > 0)) continue;
    const Eigen::RowVectorXd theta = points.front().strain.topRows<3>().colwise().sum();
    for (int i = 0; i < n; ++i) {
      NodeDilatation& d = dilatations[{mesh.material[at(e)], nodes[i]}];
      d.volume += all / 4;
      d.modulus += all / 4 * of_volume;
      for (int j = 0; j < n; ++j) {
        const auto place = d.of.emplace(nodes[j], Eigen::RowVector3d::Zero()).first;
        place->second += all / 4 * theta.segment<3>(3 * j);
      }
    }
  }
  for (const auto& entry : dilatations) {
    const NodeDilatation& d = entry.second;
    for (const auto& a : d.of)
      for (const auto& b : d.of)
        add(a.first, b.first, Eigen::Matrix3d(d.modulus / (d.volume * d.volume) * a.second.transpose() * b.second));
  }
}

/// Pairs of nodes that tetrahedra's dilatations join beyond the elements.
void add_dilatation_pairs(const PartMesh& mesh, std::vector<std::array<int, 2>>& pairs) {
  std::map<std::pair<int, int>, std::vector<int>> around;  // by material, node
  for (int e = 0; e < mesh.elements(); ++e) {
    if (mesh.shape[at(e)] != ElementShape::Tet4) continue;
    const int* nodes = mesh.element_node.data() + mesh.begin[at(e)];
    for (int i = 0; i < 4; ++i)
      around[{mesh.material[at(e)], nodes[i]}].insert(around[{mesh.material[at(e)], nodes[i]}].end(), nodes, nodes + 4);
  }
  for (auto& entry : around) {
    std::vector<int>& nodes = entry.second;
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) pairs.push_back({nodes[i], nodes[j]});
  }
}

/// Six components of three nodes far apart, that leave no rigid motion: 3 per node, true: held.
std::vector<char> pins(const PartMesh& mesh) {
  std::vector<char> held(3 * mesh.nodes.size(), 0);
  const auto farthest = [&](const auto& distance) {
    int best = 0;
    double most = -1.0;
    for (int i = 0; i < mesh.size(); ++i)
      if (const double d = distance(mesh.nodes[at(i)]); d > most) {
        most = d;
        best = i;
      }
    return best;
  };
  const int first = farthest([&](const Vector3d& x) { return (x - mesh.nodes.front()).norm(); });
  const Vector3d a = mesh.nodes[at(first)];
  const int second = farthest([&](const Vector3d& x) { return (x - a).norm(); });
  const Vector3d along = mesh.nodes[at(second)] - a;
  const int third = farthest([&](const Vector3d& x) { return along.cross(x - a).norm(); });
  const Vector3d around = along.cross(mesh.nodes[at(third)] - a);
  Index axis = 0, turned = 0;
  along.cwiseAbs().maxCoeff(&axis);
  around.cwiseAbs().maxCoeff(&turned);
  for (int k = 0; k < 3; ++k) {
    held[at(3 * first + k)] = 1;
    held[at(3 * second + k)] = k != axis;
  }
  held[at(3 * third + turned)] = 1;
  return held;
}

/// Numbers the components that nothing holds, in an order that leaves the factor sparse.
void number_unknowns(PartOperator& part, const std::vector<std::array<int, 2>>& pairs, const std::vector<char>& held) {
  const std::vector<int> place = sparse_order(make_pattern(part.mesh.size(), pairs));
  std::vector<int> node_at(place.size());
  for (int i = 0; i < part.mesh.size(); ++i) node_at[at(place[at(i)])] = i;
  part.unknown.assign(3 * place.size(), -1);
  int count = 0;
  for (const int node : node_at)
    for (int k = 0; k < 3; ++k)
      if (!held[at(3 * node + k)]) part.unknown[at(3 * node + k)] = count++;
}

int unknowns_of(const PartOperator& part) {
  return static_cast<int>(std::count_if(part.unknown.begin(), part.unknown.end(), [](int u) { return u >= 0; }));
}

SymmetricPattern pattern_of(const PartOperator& part, const std::vector<std::array<int, 2>>& pairs) {
  std::vector<std::array<int, 2>> of_unknowns;
  const auto add = [&](int a, int b) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < (a == b ? i : 3); ++j) {
        const int row = part.unknown[at(3 * a + i)], column = part.unknown[at(3 * b + j)];
        if (row >= 0 && column >= 0) of_unknowns.push_back({row, column});
      }
  };
  for (int node = 0; node < part.mesh.size(); ++node) add(node, node);
  for (const auto& pair : pairs) add(pair[0], pair[1]);
  return make_pattern(unknowns_of(part), of_unknowns);
}

/// Solves for all unknowns.
MatrixXd solve_all(const PartOperator& part, const MatrixXd& b) {
  std::vector<int> columns(at(part.factor.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = static_cast<int>(i);
  Nodal x = b;
  solve(part.factor, columns, x);
  return x;
}

/// The inverse on what strains the part: of a piece of one or two nodes, some turns do not.
Matrix6d inverse_without_null(const Matrix6d& S) {
  const VectorXd scale = S.diagonal().cwiseMax(1e-12 * S.diagonal().maxCoeff()).cwiseSqrt().cwiseInverse();
  const Eigenvalues e = symmetric_eigen(scale.asDiagonal() * S * scale.asDiagonal());
  const VectorXd inverse = e.values.unaryExpr([](double v) { return v > 1e-9 ? 1 / v : 0.0; });
  return scale.asDiagonal() * e.vectors * inverse.asDiagonal() * e.vectors.transpose() * scale.asDiagonal();
}

/// Rows of one node in a matrix over the unknowns; zero where it is held.
template <class Rows>
Eigen::Matrix<double, 3, Eigen::Dynamic> at_node(const PartOperator& part, int node, const Rows& values) {
  Eigen::Matrix<double, 3, Eigen::Dynamic> of = Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, values.cols());
  for (int k = 0; k < 3; ++k)
    if (const int row = part.unknown[at(3 * node + k)]; row >= 0) of.row(k) = values.row(row);
  return of;
}

}  // namespace

PartOperator make_part_operator(PartMesh mesh, std::vector<PartHold> hold,
                                const std::vector<unsigned char>& held_along) {
  PartOperator part;
  part.mesh = std::move(mesh);
  part.hold = std::move(hold);
  const int n = part.mesh.size();
  for (const Matrix6d& D : part.mesh.elastic)
    part.softness = std::max(part.softness, D.inverse().diagonal().head<3>().minCoeff());
  part.free = std::all_of(part.hold.begin(), part.hold.end(), [](PartHold h) { return h == PartHold::None; }) &&
              std::all_of(held_along.begin(), held_along.end(), [](unsigned char along) { return along == 0; });
  const auto on_other = std::count(part.hold.begin(), part.hold.end(), PartHold::Other);
  for (int i = 0; i < n && on_other > 0; ++i)
    if (part.hold[at(i)] == PartHold::Other) part.center += part.mesh.nodes[at(i)] / static_cast<double>(on_other);
  std::vector<std::array<int, 2>> pairs = node_pairs(part.mesh);
  add_dilatation_pairs(part.mesh, pairs);
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<char> held(3 * at(n), 0);
  if (part.free)
    held = pins(part.mesh);
  else
    for (int i = 0; i < 3 * n; ++i)
      held[at(i)] =
          part.hold[at(i / 3)] != PartHold::None || (!held_along.empty() && (held_along[at(i / 3)] >> i % 3 & 1) != 0);
  number_unknowns(part, pairs, held);
  const SymmetricPattern pattern = pattern_of(part, pairs);
  std::vector<double> values(at(pattern.entries()), 0.0);
  part.volume.assign(at(n), 0.0);
  const int unknowns = pattern.size();
  MatrixXd T = MatrixXd::Zero(unknowns, 6);  // K_fh R_h
  Matrix6d S = Matrix6d::Zero();             // R_h^T K_hh R_h
  for_each_stiffness(part.mesh, part.volume, [&](int a, int b, const Eigen::Matrix3d& k) {
    const bool b_other = part.hold[at(b)] == PartHold::Other;
    Eigen::Matrix<double, 3, 6> moved;
    if (b_other) moved = k * rigid_motion(part.mesh.nodes[at(b)] - part.center);
    if (b_other && part.hold[at(a)] == PartHold::Other)
      S += rigid_motion(part.mesh.nodes[at(a)] - part.center).transpose() * moved;
    for (int i = 0; i < 3; ++i) {
      const int row = part.unknown[at(3 * a + i)];
      if (row < 0) continue;
      if (b_other) T.row(row) += moved.row(i);
      for (int j = 0; j < 3; ++j)
        if (const int column = part.unknown[at(3 * b + j)]; column >= 0 && column <= row)
          values[at(pattern.find(row, column))] += k(i, j);
    }
  });
  part.factor = factorise(pattern, values);
  if (on_other > 0) {
    part.W = -solve_all(part, T);
    part.S = S + T.transpose() * part.W;
    part.S_inverse = inverse_without_null(part.S);
  }
  if (!part.free) return part;
  double all = 0.0;
  Vector3d sum = Vector3d::Zero();
  for (int i = 0; i < n; ++i) {
    all += part.volume[at(i)];
    sum += part.volume[at(i)] * part.mesh.nodes[at(i)];
  }
  part.center = sum / all;
  MatrixXd MR = MatrixXd::Zero(unknowns, 6);
  Matrix6d G = Matrix6d::Zero();
  for (int i = 0; i < n; ++i) {
    const Eigen::Matrix<double, 3, 6> R = rigid_motion(part.mesh.nodes[at(i)] - part.center);
    G += part.volume[at(i)] * R.transpose() * R;
    for (int k = 0; k < 3; ++k)
      if (const int row = part.unknown[at(3 * i + k)]; row >= 0) MR.row(row) = part.volume[at(i)] * R.row(k);
  }
  part.G_inverse = G.inverse();
  part.Z = solve_all(part, MR);
  part.S = part.Z.transpose() * MR;
  return part;
}

namespace {

/// Is there more to a part's displacements than K^-1 f?
bool has_rest(const PartOperator& part) { return part.free || part.W.size() > 0; }

/// Z or W at a node; the nodes that the second body holds move as one piece.
Eigen::Matrix<double, 3, 6> rest_at(const PartOperator& part, int node) {
  if (part.hold[at(node)] == PartHold::Other) return rigid_motion(part.mesh.nodes[at(node)] - part.center);
  return at_node(part, node, part.free ? part.Z : part.W);
}

/// What of displacements is no K^-1 f. Of a free part Z c + R mean, which takes out its mean motion (P2); of one that
/// two bodies hold W c, by what the piece that the second holds moves (P3).
struct Rest {
  MatrixXd c, mean;
  /// Z^T f or W^T f, and R^T f of a free part.
  Rest(const PartOperator& part, const MatrixXd& on_rest, const MatrixXd& wrench)
      : c(part.free ? MatrixXd(-part.G_inverse * wrench) : MatrixXd(part.S_inverse * on_rest)) {
    if (part.free) mean = -part.G_inverse * (on_rest + part.S * c);
  }
};

}  // namespace

void set_reach(PartFeet& feet, const PartOperator& part) {
  std::vector<int> unknowns;
  for (const int node : feet.node)
    for (int k = 0; k < 3; ++k)
      if (const int u = part.unknown[at(3 * node + k)]; u >= 0) unknowns.push_back(u);
  std::sort(unknowns.begin(), unknowns.end());
  unknowns.erase(std::unique(unknowns.begin(), unknowns.end()), unknowns.end());
  feet.columns = columns_for(part.factor, unknowns);
  if (!has_rest(part)) return;
  feet.on_rest = MatrixXd::Zero(feet.size(), 6);
  feet.wrench = MatrixXd::Zero(part.free ? feet.size() : 0, 6);
  for (int i = 0; i < feet.size(); ++i)
    for (int j = feet.begin[at(i)]; j < feet.begin[at(i) + 1]; ++j) {
      const int node = feet.node[at(j)];
      feet.on_rest.row(i) += feet.weight[at(j)].transpose() * rest_at(part, node);
      if (part.free)
        feet.wrench.row(i) += feet.weight[at(j)].transpose() * rigid_motion(part.mesh.nodes[at(node)] - part.center);
    }
}

MatrixXd sinking(const PartOperator& part, const PartFeet& feet, const MatrixXd& pressure) {
  Nodal b = Nodal::Zero(part.factor.size(), pressure.cols());
  for (int i = 0; i < feet.size(); ++i)
    for (int j = feet.begin[at(i)]; j < feet.begin[at(i) + 1]; ++j)
      for (int k = 0; k < 3; ++k)
        if (const int row = part.unknown[at(3 * feet.node[at(j)] + k)]; row >= 0)
          b.row(row) += feet.weight[at(j)][k] * pressure.row(i);
  solve(part.factor, feet.columns, b);
  MatrixXd w = MatrixXd::Zero(feet.size(), pressure.cols());
  if (has_rest(part)) {
    const MatrixXd wrench = part.free ? MatrixXd(feet.wrench.transpose() * pressure) : MatrixXd();
    const Rest rest(part, feet.on_rest.transpose() * pressure, wrench);
    w = feet.on_rest * rest.c;
    if (part.free) w += feet.wrench * rest.mean;
  }
  for (int i = 0; i < feet.size(); ++i) {
    for (int j = feet.begin[at(i)]; j < feet.begin[at(i) + 1]; ++j)
      for (int k = 0; k < 3; ++k)
        if (const int row = part.unknown[at(3 * feet.node[at(j)] + k)]; row >= 0)
          w.row(i) += feet.weight[at(j)][k] * b.row(row);
    w.row(i) *= feet.area[at(i)] > 0 ? 1 / feet.area[at(i)] : 0.0;
  }
  return w;
}

VectorXd along_forces(const PartFeet& feet, const Eigen::MatrixX3d& motion) {
  VectorXd along = VectorXd::Zero(feet.size());
  for (int i = 0; i < feet.size(); ++i)
    for (int j = feet.begin[at(i)]; j < feet.begin[at(i) + 1] && feet.area[at(i)] > 0; ++j)
      along[i] += feet.weight[at(j)].dot(motion.row(feet.node[at(j)]).transpose()) / feet.area[at(i)];
  return along;
}

Nodal along_forces(const PartFeet& feet, const Nodal& motions) {
  Nodal along = Nodal::Zero(feet.size(), motions.cols());
  for (int i = 0; i < feet.size(); ++i)
    for (int j = feet.begin[at(i)]; j < feet.begin[at(i) + 1] && feet.area[at(i)] > 0; ++j)
      along.row(i) += (feet.weight[at(j)].transpose() / feet.area[at(i)]) * motions.middleRows<3>(3 * feet.node[at(j)]);
  return along;
}

Nodal nodal_forces(const PartOperator& part, const PartFeet& feet, const MatrixXd& pressure) {
  Nodal force = Nodal::Zero(3 * part.mesh.size(), pressure.cols());
  for (int i = 0; i < feet.size(); ++i)
    for (int j = feet.begin[at(i)]; j < feet.begin[at(i) + 1]; ++j)
      force.middleRows<3>(3 * feet.node[at(j)]) += feet.weight[at(j)] * pressure.row(i);
  return force;
}

Eigen::MatrixX3d by_node(const Nodal& column) { return column.reshaped(3, column.rows() / 3).transpose(); }

namespace {

Nodal on_unknowns(const PartOperator& part, const Nodal& force) {
  Nodal b(part.factor.size(), force.cols());
  for (Index i = 0; i < force.rows(); ++i)
    if (const int row = part.unknown[at(static_cast<int>(i))]; row >= 0) b.row(row) = force.row(i);
  return b;
}

/// nodes x 3, as 3 per node.
Nodal as_column(const Eigen::MatrixX3d& of) { return Nodal(of.transpose().reshaped()); }

}  // namespace

Nodal displacements(const PartOperator& part, const Nodal& force) {
  const Nodal b = on_unknowns(part, force), x = solve_all(part, b);
  Nodal u(force.rows(), force.cols());
  for (int i = 0; i < part.mesh.size(); ++i) u.middleRows<3>(3 * i) = at_node(part, i, x);
  if (!has_rest(part)) return u;
  MatrixXd on_rest = MatrixXd::Zero(6, force.cols()), wrench = on_rest;
  const auto arm = [&part](int node) { return Vector3d(part.mesh.nodes[at(node)] - part.center); };
  for (int i = 0; i < part.mesh.size(); ++i) {
    on_rest += rest_at(part, i).transpose() * force.middleRows<3>(3 * i);
    wrench += rigid_motion(arm(i)).transpose() * force.middleRows<3>(3 * i);
  }
  const Rest rest(part, on_rest, wrench);
  for (int i = 0; i < part.mesh.size(); ++i) {
    u.middleRows<3>(3 * i) += rest_at(part, i) * rest.c;
    if (part.free) u.middleRows<3>(3 * i) += rigid_motion(arm(i)) * rest.mean;
  }
  return u;
}

Eigen::MatrixX3d displacements(const PartOperator& part, const Eigen::MatrixX3d& force) {
  return by_node(displacements(part, as_column(force)));
}

void learn_soft(PartOperator& part, const Nodal& forces) {
  part.soft = displacements(part, forces);
  const MatrixXd energy = forces.transpose() * part.soft;
  const Eigenvalues e = symmetric_eigen(0.5 * (energy + energy.transpose()));
  const double least = 1e-10 * e.values.maxCoeff();
  const VectorXd scale = e.values.unaryExpr([&](double v) { return v > least ? 1 / std::sqrt(v) : 0.0; });
  part.soft = part.soft * (e.vectors * scale.asDiagonal());
}

}  // namespace dea
