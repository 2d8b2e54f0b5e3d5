#include "src/joint/compartments.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "src/base/disjoint_sets.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/geometry/coincident.h"
#include "src/geometry/ray_caster.h"

namespace dea {

namespace {

constexpr double kLeastShare = 0.01;  // of the surface: a smaller piece is no compartment

/// Per triangle the piece it belongs to, counted from 0 in the order of the first triangles.
std::vector<int> pieces_of(const SurfaceMesh& mesh) {
  DisjointSets sets(mesh.triangles.size());
  std::vector<int> first(mesh.vertices.size(), -1);  // triangle at each vertex
  for (int t = 0; t < mesh.size(); ++t)
    for (int v : mesh.triangles[at(t)]) {
      if (first[at(v)] < 0) first[at(v)] = t;
      sets.join(first[at(v)], t);
    }
  return sets.numbers();
}

/// By the model's part under each; empty: they do not tell them apart.
std::vector<std::string> names_of_parts(const JointModel& model, const CarriedSurface& carried, const SurfaceMesh& mesh,
                                        const std::vector<int>& of_triangle, int count) {
  std::vector<std::string> names(at(count));
  for (int t = 0; t < mesh.size(); ++t) {
    if (of_triangle[at(t)] >= count) continue;
    const std::string& part = model.domains[at(carried.carriers[at(mesh.facet[at(t)])].domain)].name;
    std::string& name = names[at(of_triangle[at(t)])];
    if (part.empty() || (!name.empty() && name != part)) return {};
    name = part;
  }
  const std::set<std::string> different(names.begin(), names.end());
  return different.size() == names.size() ? names : std::vector<std::string>();
}

/// "-x", "+x"; empty: no axis sets the two clearly apart.
std::vector<std::string> names_of_sides(const SurfaceMesh& mesh, const std::vector<int>& of_triangle) {
  Vector3d centroid[2] = {Vector3d::Zero(), Vector3d::Zero()};
  double area[2] = {0.0, 0.0};
  for (int t = 0; t < mesh.size(); ++t) {
    const int piece = of_triangle[at(t)];
    if (piece > 1) continue;
    centroid[piece] += mesh.areas[at(t)] * mesh.centroid(t);
    area[piece] += mesh.areas[at(t)];
  }
  const Vector3d apart = centroid[1] / area[1] - centroid[0] / area[0];
  int axis = 0;
  apart.cwiseAbs().maxCoeff(&axis);
  if (std::abs(apart[axis]) < 0.9 * apart.norm()) return {};
  const std::string name(1, "xyz"[axis]);
  return apart[axis] > 0 ? std::vector<std::string>{"-" + name, "+" + name}
                         : std::vector<std::string>{"+" + name, "-" + name};
}

}  // namespace

Compartments find_compartments(const JointModel& model, const CarriedSurface& carried, const SurfaceMesh& articular) {
  const std::vector<int> piece = pieces_of(articular);
  std::vector<double> area;
  for (int t = 0; t < articular.size(); ++t) {
    area.resize(std::max(area.size(), at(piece[at(t)]) + 1), 0.0);
    area[at(piece[at(t)])] += articular.areas[at(t)];
  }
  const double least = kLeastShare * std::accumulate(area.begin(), area.end(), 0.0);
  const int count = static_cast<int>(std::count_if(area.begin(), area.end(), [&](double a) { return a >= least; }));
  Compartments found;
  if (count < 2) return found;
  std::vector<int> number(area.size(), count);  // "rest"
  for (std::size_t p = 0, next = 0; p < area.size(); ++p)
    if (area[p] >= least) number[p] = static_cast<int>(next++);
  for (int p : piece) found.of_triangle.push_back(number[at(p)]);
  found.names = names_of_parts(model, carried, articular, found.of_triangle, count);
  if (found.names.empty() && count == 2) found.names = names_of_sides(articular, found.of_triangle);
  for (int i = 1; static_cast<int>(found.names.size()) < count; ++i) found.names.push_back(std::to_string(i));
  if (count < static_cast<int>(area.size())) found.names.push_back("rest");
  return found;
}

namespace {

/// Two nodes of different deformable parts at one place, as the file numbers them.
std::optional<std::array<int, 2>> nodes_at_one_place(const ModelParts& parts, const Layer& layer, double tolerance) {
  for (const auto& pair : coincident_nodes(layer.region_nodes, parts.model.nodes, tolerance))
    if (parts.region[at(pair.first)] != parts.region[at(pair.second)]) return {{pair.first, pair.second}};
  return std::nullopt;
}

/// The triangles of a surface that lie on one deformable part.
SurfaceMesh surface_on(const ModelParts& parts, const SurfaceMesh& mesh, int region, bool others) {
  std::vector<int> begin = {0}, nodes;
  for (const std::array<int, 3>& t : mesh.triangles) {
    const int node = mesh.model_nodes[at(t[0])];
    if ((parts.region[at(node)] == region) == others) continue;
    for (int corner : t) nodes.push_back(mesh.model_nodes[at(corner)]);
    begin.push_back(static_cast<int>(nodes.size()));
  }
  return make_surface_mesh(begin, nodes, parts.model.nodes);
}

/// Least distance between the articular surface of one part and that of the others.
double gap_beside(const ModelParts& parts, const SurfaceMesh& mesh, int region) {
  const SurfaceMesh own = surface_on(parts, mesh, region, false), others = surface_on(parts, mesh, region, true);
  if (own.size() == 0 || others.size() == 0) return kInfinity;
  const RayCaster caster(others);
  double least = kInfinity;
  for (const Vector3d& x : own.vertices) least = std::min(least, (position(others, caster.closest(x)) - x).norm());
  return least;
}

}  // namespace

void refuse_touching_parts(const ContactSide& in, const Layer& layer) {
  std::set<int> regions;
  for (int node : layer.region_nodes) regions.insert(in.parts.region[at(node)]);
  if (regions.size() < 2) return;
  const SurfaceMesh& mesh = layer.articular;
  const double tolerance = 0.01 * std::sqrt(2 * mean_area(mesh));  // of a facet's size
  const auto pair = nodes_at_one_place(in.parts, layer, tolerance);
  bool touch = pair.has_value();
  for (auto region = regions.begin(); !touch && region != regions.end(); ++region)
    touch = gap_beside(in.parts, mesh, *region) < tolerance;
  if (!touch) return;
  const std::vector<int>& ids = in.parts.model.node_ids;
  const std::string where =
      pair ? fmt::format(", as nodes {} and {} do", ids[at((*pair)[0])], ids[at((*pair)[1])]) : "";
  throw refusal_of(in,
                   say("lies on {} deformable parts that touch{}, but share no nodes: they slide past each other, and "
                       "nothing that is squeezed flows from one to the other;",
                       regions.size(), where),
                   "merge their nodes where they are one cartilage, or keep them apart");
}

}  // namespace dea
