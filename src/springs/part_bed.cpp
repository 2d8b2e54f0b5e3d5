#include "src/springs/part_bed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <utility>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/springs/gaps.h"

namespace dea {

namespace {

/// A point of what of a triangle a foot stands on, in the triangle's barycentric weights; shares add up to 1.
struct FootPoint {
  Barycentric place;
  double share;
};

/// `corners`: of a convex polygon in the triangle. Exact for polynomials of degree 4.
std::vector<FootPoint> points_of(const Barycentric* corners, int count) {
  struct Rule {
    double near, share;  // three points near the middles of the edges, three near the corners
  };
  constexpr std::array<Rule, 2> rules = {
      {{0.445948490915965, 0.223381589678011}, {0.091576213509771, 0.109951743655322}}};
  std::vector<FootPoint> points;
  double all = 0.0;
  for (int k = 1; k + 1 < count; ++k) {  // a fan of triangles
    const std::array<const Barycentric*, 3> of = {&corners[0], &corners[k], &corners[k + 1]};
    const Barycentric &a = *of[0], &b = *of[1], &c = *of[2];
    const double area = std::abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    all += area;
    for (const Rule& rule : rules)
      for (std::size_t far = 0; far < 3; ++far) {
        FootPoint point{{0, 0, 0}, area * rule.share};
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = 0; j < 3; ++j)
            point.place[i] += (j == far ? 1 - 2 * rule.near : rule.near) * (*of[j])[i];
        points.push_back(point);
      }
  }
  for (FootPoint& point : points) point.share /= all;
  return points;
}

/// The facet of an element that a triangle of a surface is cut out of (split_facet), whose displacements are told by
/// its vertices. Of facets with seven or nine vertices the triangle itself.
struct PartFacet {
  int count = 3;
  std::array<int, 8> vertex = {};              ///< corners, middles of the edges from each on
  std::array<Eigen::Vector2d, 3> corner = {};  ///< of the triangle: in that of (0, 0), (1, 0), (0, 1), or in [-1, 1]^2
};

/// Where the vertices of a facet lie in it.
Eigen::Vector2d place_in_facet(int count, int k) {
  static const std::array<Eigen::Vector2d, 6> triangle = {{{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}}};
  static const std::array<Eigen::Vector2d, 8> square = {
      {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}}};
  return count % 3 == 0 ? triangle[at(k)] : square[at(k)];
}

PartFacet facet_of(const SurfaceMesh& mesh, int t) {
  int first = t, end = t + 1;
  while (first > 0 && mesh.facet[at(first - 1)] == mesh.facet[at(t)]) --first;
  while (end < mesh.size() && mesh.facet[at(end)] == mesh.facet[at(t)]) ++end;
  const auto corner = [&](int triangle, int k) { return mesh.triangles[at(first + triangle)][at(k)]; };
  PartFacet facet;
  const auto take = [&](std::initializer_list<int> vertices) {
    facet.count = static_cast<int>(vertices.size());
    std::copy(vertices.begin(), vertices.end(), facet.vertex.begin());
  };
  take({mesh.triangles[at(t)][0], mesh.triangles[at(t)][1], mesh.triangles[at(t)][2]});
  if (end - first == 2) {
    for (int k = 0; k < 3; ++k)  // the diagonal
      if (const int other = mesh.neighbours[at(first)][at(k)]; other == first + 1)
        for (const int beyond : mesh.triangles[at(other)])
          if (beyond != corner(0, k) && beyond != corner(0, (k + 1) % 3))
            take({corner(0, (k + 2) % 3), corner(0, k), beyond, corner(0, (k + 1) % 3)});
  } else if (end - first == 4) {
    take({corner(0, 0), corner(1, 1), corner(2, 2), corner(0, 1), corner(1, 2), corner(0, 2)});
  } else if (end - first == 6 && corner(0, 2) != corner(1, 2)) {  // else of seven vertices
    take({corner(0, 0), corner(1, 0), corner(2, 0), corner(3, 0), corner(0, 1), corner(1, 1), corner(2, 1),
          corner(3, 1)});
  }
  for (std::size_t c = 0; c < 3; ++c)
    for (int k = 0; k < facet.count; ++k)
      if (facet.vertex[at(k)] == mesh.triangles[at(t)][c]) facet.corner[c] = place_in_facet(facet.count, k);
  return facet;
}

/// How far a facet's point goes with each of its vertices.
std::array<double, 8> shape_functions(int count, const Eigen::Vector2d& x) {
  std::array<double, 8> N = {};
  if (count % 3 == 0) {
    const std::array<double, 3> L = {1 - x[0] - x[1], x[0], x[1]};
    for (std::size_t k = 0; k < 3; ++k) {
      N[k] = count == 3 ? L[k] : L[k] * (2 * L[k] - 1);
      if (count == 6) N[3 + k] = 4 * L[k] * L[(k + 1) % 3];
    }
    return N;
  }
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector2d of = place_in_facet(count, k);
    const double u = 1 + of[0] * x[0], v = 1 + of[1] * x[1];
    if (k < 4)
      N[at(k)] = 0.25 * u * v * (count == 4 ? 1.0 : u + v - 3);
    else
      N[at(k)] = 0.5 * (of[0] == 0 ? (1 - x[0] * x[0]) * v : (1 - x[1] * x[1]) * u);
  }
  return N;
}

/// Adds an even traction's forces on nodes, as the work of the facet's displacements shares them.
void add_force(PartFeet& feet, const BedLayer& of, const SurfaceMesh& mesh, int t, const std::vector<FootPoint>& points,
               const Vector3d& force) {
  const PartFacet facet = facet_of(mesh, t);
  std::array<double, 8> share = {};
  for (const FootPoint& point : points) {
    Eigen::Vector2d x = Eigen::Vector2d::Zero();
    for (std::size_t c = 0; c < 3; ++c) x += point.place[c] * facet.corner[c];
    const std::array<double, 8> N = shape_functions(facet.count, x);
    for (std::size_t k = 0; k < 8; ++k) share[k] += point.share * N[k];
  }
  for (int k = 0; k < facet.count; ++k) {
    feet.node.push_back(of.part_node[at(facet.vertex[at(k)])]);
    feet.weight.push_back(share[at(k)] * force);
  }
}

void end_foot(PartFeet& feet, double area, double soft) {
  feet.begin.push_back(static_cast<int>(feet.node.size()));
  feet.area.push_back(area);
  feet.scale.push_back(area > 0 ? 0.5 * soft * std::sqrt(area) : 0.0);  // a half-space under a square: 0.56 (1 - nu^2)
}

}  // namespace

namespace {

/// Of so many patches of about the same size, the one each triangle is in: around triangles as far from each other as
/// can be.
std::vector<int> patches_of(const SurfaceMesh& mesh, int count) {
  std::vector<int> patch(at(mesh.size()), 0);
  std::vector<double> distance(patch.size(), kInfinity);
  const auto middle = [&](int t) { return Vector3d((mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3); };
  int seed = 0;
  for (int p = 0; p < std::min(count, mesh.size()); ++p) {
    const Vector3d from = middle(seed);
    for (int t = 0; t < mesh.size(); ++t)
      if (const double d = (middle(t) - from).squaredNorm(); d < distance[at(t)]) {
        distance[at(t)] = d;
        patch[at(t)] = p;
      }
    seed = static_cast<int>(std::max_element(distance.begin(), distance.end()) - distance.begin());
  }
  return patch;
}

/// Forces on the nodes of a part that are like those of contacts: pressures on patches of its surfaces, and smooth
/// forces on all of it.
std::vector<Eigen::VectorXd> forces_like_contact(const Joint& joint, const SoftPart& of,
                                                 const std::vector<double>& volume) {
  constexpr int kPatches = 100;  // less often the search is led too far, more each step costs
  const int n = of.mesh.size();
  double area = 0.0;
  std::vector<const SurfaceMesh*> surfaces;
  for (const ContactPair& pair : joint.contacts)
    for (const Layer& layer : pair.layers)
      if (layer.part >= 0 && &joint.parts[at(layer.part)] == &of) {
        surfaces.push_back(&layer.spring_surface());
        area += surface_extent(*surfaces.back()).area;
      }
  std::vector<Eigen::VectorXd> forces;
  for (const SurfaceMesh* mesh : surfaces) {
    const int count = static_cast<int>(std::ceil(kPatches * surface_extent(*mesh).area / area));
    const std::vector<int> patch = patches_of(*mesh, count);
    const std::size_t first = forces.size();
    forces.resize(first + at(count), Eigen::VectorXd::Zero(3 * n));
    for (int t = 0; t < mesh->size(); ++t)
      for (const int v : mesh->triangles[at(t)])
        forces[first + at(patch[at(t)])].segment<3>(3 * of.node_of(mesh->model_nodes[at(v)])) -=
            mesh->areas[at(t)] / 3 * mesh->normals[at(t)];
  }
  Vector3d middle = Vector3d::Zero(), size = Vector3d::Constant(1e-300);
  for (const Vector3d& x : of.mesh.nodes) middle += x / n;
  for (const Vector3d& x : of.mesh.nodes) size = size.cwiseMax((x - middle).cwiseAbs());
  for (int m = 0; m < 12; ++m) {
    forces.emplace_back(Eigen::VectorXd::Zero(3 * n));
    for (int i = 0; i < n; ++i) {
      const Vector3d x = (of.mesh.nodes[at(i)] - middle).cwiseQuotient(size);
      forces.back()[3 * i + m % 3] = volume[at(i)] * (m < 3 ? 1.0 : x[m / 3 - 1]);
    }
  }
  return forces;
}

/// Forces on its nodes that ligaments and holds exert, at each node as many directions as they differ in.
std::vector<Eigen::VectorXd> forces_like_ties(const Joint& joint, const SoftPart& of,
                                              const std::vector<PartTie>& holds) {
  constexpr std::size_t kMost = 100;  // more are like their neighbours
  std::vector<std::pair<int, Vector3d>> ties;
  for (const PartTie& hold : holds) ties.emplace_back(hold.source_node, Vector3d::Unit(hold.axis));
  std::vector<std::pair<int, Vector3d>> lines;
  for (const Ligament& l : joint.ligaments)
    for (const int end : l.part_node)
      if (const int node = end < 0 ? -1 : of.node_of(end); node >= 0)
        lines.emplace_back(node, (l.point_b - l.point_a).normalized());
  const std::size_t stride = lines.size() / kMost + 1;
  for (std::size_t k = 0; k < lines.size(); k += stride) ties.push_back(lines[k]);
  std::vector<Eigen::VectorXd> forces;
  std::map<int, std::vector<Vector3d>> known;  // per node, across each other
  for (const auto& [node, direction] : ties) {
    Vector3d other = direction;
    for (const Vector3d& d : known[node]) other -= other.dot(d) * d;
    if (!(other.norm() > 0.3)) continue;
    known[node].push_back(other.normalized());
    forces.emplace_back(Eigen::VectorXd::Zero(3 * of.mesh.size()));
    forces.back().segment<3>(3 * node) = other;
  }
  return forces;
}

}  // namespace

std::shared_ptr<const PartOperator> make_part(const Joint& joint, const SoftPart& of) {
  std::vector<PartHold> hold;
  for (const int body : of.holder)
    hold.push_back(body < 0 ? PartHold::None : body == of.body ? PartHold::Frame : PartHold::Other);
  PartOperator part;
  try {
    part = make_part_operator(of.mesh, std::move(hold), of.held);
  } catch (const std::runtime_error&) {  // what a count of what holds it does not see
    throw InputError(Fault{
        .found =
            say("pieces of part \"{}\" hang together, or on what holds it, by an edge or a corner alone;", of.name),
        .expected =
            say("join them by faces, or take the part as rigid with {}", NamedSetting{"rigid", "", of.material})});
  }
  const std::vector<Eigen::VectorXd> contact = forces_like_contact(joint, of, part.volume),
                                     ties = forces_like_ties(joint, of, part_holds(of, part));
  Nodal forces(3 * of.mesh.size(), static_cast<Eigen::Index>(contact.size() + ties.size()));
  Eigen::Index k = 0;
  for (const auto* all : {&contact, &ties})
    for (const Eigen::VectorXd& force : *all) forces.col(k++) = force / std::max(1e-300, force.norm());
  learn_soft(part, forces);
  return std::make_shared<const PartOperator>(std::move(part));
}

std::vector<PartTie> part_holds(const SoftPart& of, const PartOperator& made) {
  constexpr std::size_t kNodes = 4;
  constexpr double kStiff = 1e4;
  std::vector<PartTie> holds;
  std::vector<double> distance(at(of.mesh.size()), -1.0);
  for (int i = 0; i < of.mesh.size() && of.other >= 0; ++i)
    if (made.hold[at(i)] == PartHold::Other) distance[at(i)] = (of.mesh.nodes[at(i)] - made.center).norm();
  for (std::size_t k = 0; k < kNodes; ++k) {
    const auto far = std::max_element(distance.begin(), distance.end());
    if (!(*far > (k == 0 ? -1.0 : 0.0))) break;
    const auto node = static_cast<int>(far - distance.begin());
    const Vector3d& x = of.mesh.nodes[at(node)];
    for (int axis = 0; axis < 3; ++axis)
      holds.push_back({-1, x, x, node, -1, axis, kStiff * made.S.diagonal().head<3>().maxCoeff()});
    for (int i = 0; i < of.mesh.size(); ++i)
      if (double& d = distance[at(i)]; d >= 0)
        d = k == 0 ? (of.mesh.nodes[at(i)] - x).norm() : std::min(d, (of.mesh.nodes[at(i)] - x).norm());
  }
  return holds;
}

namespace {

void add_parts(const SpringBed& bed, std::vector<const PartOperator*>& parts) {
  if (!bed.layers) return;
  for (const BedLayer* of : {&bed.layers->source, &bed.layers->target})
    if (of->part && std::find(parts.begin(), parts.end(), of->part.get()) == parts.end())
      parts.push_back(of->part.get());
}

}  // namespace

std::vector<const PartOperator*> parts_of(const SpringBed& bed) {
  std::vector<const PartOperator*> parts;
  add_parts(bed, parts);
  return parts;
}

std::vector<const PartOperator*> parts_of(const std::vector<PosedBed>& beds) {
  std::vector<const PartOperator*> parts;
  for (const PosedBed& posed : beds) add_parts(*posed.bed, parts);
  return parts;
}

SpringStates tie_states(const SpringBed& bed, const Pose& source, const Pose& target, const TieLaw& law) {
  SpringStates s = empty_states(bed.ties.size());
  double soft = 0.0;
  for (const PartOperator* part : parts_of(bed)) soft = std::max(soft, part->softness);
  const double least = 1e-9 * std::sqrt(bed.tie_area) / soft;  // slope of what has none: nothing beside the part's own
  const Eigen::Matrix3d& axes = (bed.layers->source.part ? source : target).rotation;
  for (std::size_t k = 0; k < bed.ties.size(); ++k) {
    const PartTie& tie = bed.ties[k];
    s.foot[k] = source.center + source.rotation * (tie.source - bed.source_center);
    s.end[k] = target.center + target.rotation * (tie.target - bed.target_center);
    const Vector3d line = s.foot[k] - s.end[k];
    const double length = line.norm();
    std::optional<Tension> t;
    if (bed.holds()) {
      s.direction[k] = axes.col(tie.axis);
      t = Tension{tie.stiffness * s.direction[k].dot(line), tie.stiffness};
    } else {
      s.direction[k] = length > 0 ? Vector3d(line / length) : Vector3d(Vector3d::UnitZ());
      if (length > 0) t = law(tie.ligament, length);
    }
    s.triangle[k] = t ? 0 : -1;
    s.normal[k] = -s.direction[k];
    s.gap[k] = kInfinity;
    if (!t) continue;
    const double slope = std::max(t->slope, least);
    s.area[k] = s.carrying[k] = bed.tie_area;
    s.coverage[k] = 1.0;
    s.gap[k] = -t->force / slope;
    s.per_overlap[k] = slope / bed.tie_area;
    s.per_motion[k] = -s.direction[k];
  }
  return s;
}

void add_feet(const SpringBed& bed, const SpringStates& s, const Pose& source, const Pose& target,
              const PartOperator& part, PartFeet& feet) {
  const bool on_source = bed.layers->source.part.get() == &part, on_target = bed.layers->target.part.get() == &part;
  const RelativePose relative = relative_pose(source, bed.source_center, target, bed.target_center);
  const SurfaceMesh &from = bed.pair.source_layer().spring_surface(), &to = bed.target.mesh();
  for (int i = 0; i < s.size(); ++i) {
    const auto k = at(i);
    if (!bed.ties.empty()) {  // pulls at a node, or at one of either side
      const PartTie& tie = bed.ties[k];
      for (const bool of_target : {false, true}) {
        const int node = of_target ? tie.target_node : tie.source_node;
        if (!(of_target ? on_target : on_source) || node < 0) continue;
        feet.node.push_back(node);
        feet.weight.push_back((of_target ? target : source).rotation.transpose() *
                              ((of_target ? s.area[k] : -s.area[k]) * s.direction[k]));
      }
      end_foot(feet, s.area[k], part.softness);
      continue;
    }
    const double area = (on_source || on_target) && s.triangle[k] >= 0 ? s.area[k] : 0.0;
    if (on_source && area > 0) {
      const int t = bed.springs.surface_triangle[k];
      const Vector3d foot = bed.source_center + source.rotation.transpose() * (s.foot[k] - source.center);
      const std::vector<FootPoint> points =
          s.coverage[k] < 1
              ? std::vector<FootPoint>{{weights_in({from.corner(t, 0), from.corner(t, 1), from.corner(t, 2)}, foot),
                                        1.0}}
              : points_of(bed.springs.weights[k].data(), 3);
      add_force(feet, bed.layers->source, from, t, points, -area * bed.springs.direction[k]);
    }
    if (on_target && area > 0) {
      const std::vector<SurfacePart> under = parts_under_spring(bed, relative, to, s, i, s.triangle[k], to.size());
      double covered = 0.0;
      for (const SurfacePart& p : under) covered += p.area;
      const Vector3d n = relative.rotation * bed.springs.direction[k];
      for (const SurfacePart& p : under)
        if (covered > 0)
          add_force(feet, bed.layers->target, to, p.triangle, points_of(p.corner.data(), p.corners),
                    area * p.area / covered * n);
    }
    end_foot(feet, area, part.softness);
  }
}

std::vector<FootPair> foot_pairs(const Springs& s, const LayerBed& layers) {
  std::vector<FootPair> pairs;
  double soft = 0.0;
  for (const BedLayer* of : {&layers.source, &layers.target}) {
    if (of->layer) return pairs;
    if (of->part) soft += of->part->softness;
  }
  if (!(soft > 0) || s.size() == 0) return pairs;
  // springs that share an edge: parts of one triangle, and of its neighbour; by where their corners are
  using Place = std::array<std::int64_t, 3>;
  std::map<std::array<Place, 2>, int> edges;
  const double grain = 1e-6 * std::sqrt(*std::min_element(s.area.begin(), s.area.end()));
  const auto place = [&](const Vector3d& x) {
    return Place{std::llround(x[0] / grain), std::llround(x[1] / grain), std::llround(x[2] / grain)};
  };
  for (int i = 0; i < s.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      Place a = place(s.triangle[at(i)][c]), b = place(s.triangle[at(i)][(c + 1) % 3]);
      if (b < a) std::swap(a, b);
      const auto known = edges.emplace(std::array<Place, 2>{a, b}, i);
      if (known.second) continue;
      const int j = known.first->second;
      const double area = 0.5 * (s.area[at(i)] + s.area[at(j)]);
      pairs.push_back({j, i, kPairCompliance * soft * area * std::sqrt(area)});
    }
  return pairs;
}

}  // namespace dea
