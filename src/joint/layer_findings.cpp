#include "src/joint/layer_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "src/base/numbers.h"

namespace dea {

namespace {

/// A plane across an axis in which nodes of a layer are held, but not those of all edges of its face that lie there.
struct HalfHeldPlane : SymmetryPlane {
  int edges = 0, unheld = 0;  // of the face's rim in that plane; of these, those that are free edges for it
};

/// Two or more, and a fifth of the layer's nodes in a plane, those of its bone aside: the bone holds them.
bool nodes_held_in(const ModelParts& parts, const Layer& layer, const SymmetryPlane& plane) {
  int all = 0, held = 0;
  for (int node : layer.region_nodes.empty() ? layer.face.mesh.model_nodes : layer.region_nodes) {
    if (parts.bodies.of_node[at(node)] >= 0 ||
        !(std::abs(parts.model.nodes[at(node)][plane.axis] - plane.at) <= parts.holders.same_plane))
      continue;
    ++all;
    held += (parts.holders.held_components[at(node)] >> plane.axis & 1) != 0;
  }
  return held > 1 && 5 * held >= all;
}

std::vector<HalfHeldPlane> half_held_planes(const ModelParts& parts, const Layer& layer) {
  const SurfaceMesh& mesh = layer.face.mesh;
  const double tolerance = parts.holders.same_plane;
  std::vector<HalfHeldPlane> planes;
  for (const LayerFace::Edge& e : layer.face.edges) {
    const Vector3d &a = mesh.corner(e.triangle, e.edge), &b = mesh.corner(e.triangle, (e.edge + 1) % 3);
    const Vector3d out = outward_at(mesh, e.triangle, e.edge);
    for (int k = 0; k < 3; ++k) {
      if (!(std::abs(out[k]) > kIntoPlane) || !(std::abs(a[k] - b[k]) <= tolerance)) continue;
      HalfHeldPlane* plane = nullptr;
      for (HalfHeldPlane& p : planes)
        if (p.axis == k && std::abs(p.at - a[k]) <= tolerance) plane = &p;
      if (plane == nullptr) {
        planes.push_back({{k, a[k]}, 0, 0});
        plane = &planes.back();
      }
      ++plane->edges;
      plane->unheld += e.rim == Rim::Free;
    }
  }
  std::erase_if(planes, [&](const HalfHeldPlane& p) { return p.unheld == 0 || !nodes_held_in(parts, layer, p); });
  return planes;
}

/// As the model numbers them.
std::vector<int> node_numbers(const ModelParts& parts, const std::vector<int>& nodes) {
  std::vector<int> numbers;
  for (const int node : nodes) numbers.push_back(parts.model.node_ids[at(node)]);
  return numbers;
}

/// `half_held`, `ends`: where another finding tells of held nodes.
Findings held_in_no_plane(const ModelParts& parts, const Layer& layer, const std::vector<HalfHeldPlane>& half_held,
                          const std::vector<PartEnd>& ends) {
  const double near_by = 2 * parts.holders.same_plane;
  Findings found;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> told;  // where another finding, or the mechanics itself, has these nodes
    for (const SymmetryPlane& plane : layer.planes)
      if (plane.axis == k) told.push_back(plane.at);
    for (const HalfHeldPlane& plane : half_held)
      if (plane.axis == k) told.push_back(plane.at);
    for (const LayerFace::Edge& e : layer.face.edges)
      if (e.rim == Rim::Wall && std::abs(outward_at(layer.face.mesh, e.triangle, e.edge)[k]) > kIntoPlane)
        told.push_back(layer.face.mesh.corner(e.triangle, e.edge)[k]);
    std::vector<int> held;
    for (const int node : layer.region_nodes) {
      if (parts.bodies.of_node[at(node)] >= 0 || !parts.holders.of_node[at(node)].empty()) continue;
      if ((parts.holders.held_components[at(node)] >> k & 1) == 0) continue;
      const Vector3d& x = parts.model.nodes[at(node)];
      const bool known =
          std::any_of(told.begin(), told.end(), [&](double at) { return std::abs(x[k] - at) <= near_by; }) ||
          std::any_of(ends.begin(), ends.end(), [&](const PartEnd& end) {
            return end.instead == k && std::abs(x[end.plane.axis] - end.plane.at) <= near_by;
          });
      if (!known) held.push_back(node);
    }
    if (!held.empty())
      found.push_back({"held-in-no-plane",
                       {.surface = parts.model.surfaces[at(layer.surface)].name},
                       {{"nodes", node_numbers(parts, held)}, {"component", "xyz"[k]}}});
  }
  return found;
}

Findings held_in_layer(const ModelParts& parts, const Layer& layer) {
  constexpr double kCartilage = 0.1;  // of the mean thickness: thinner, the layer runs out to its bone
  const auto holders_of = [&](int node) {
    std::set<int> bodies(parts.holders.of_node[at(node)].begin(), parts.holders.of_node[at(node)].end());
    if (parts.bodies.of_node[at(node)] >= 0) bodies.insert(parts.bodies.of_node[at(node)]);
    return bodies;
  };
  const std::string& own = parts.bodies.bodies[at(layer.body)].name;
  Findings found;
  const auto tell = [&](const std::vector<int>& nodes, int body, int form) {
    if (nodes.empty()) return;
    found.push_back({"held-in-layer",
                     {.surface = parts.model.surfaces[at(layer.surface)].name, .body = own},
                     {{"nodes", node_numbers(parts, nodes)}, {"holder", parts.bodies.bodies[at(body)].name}},
                     form});
  };
  const SurfaceMesh& mesh = layer.articular;
  if (layer.thickness.size() == mesh.vertices.size() && !layer.region_nodes.empty()) {
    const std::vector<char> on_rim = rim_vertices(mesh);
    const double thick = kCartilage * layer.mean_thickness();
    std::vector<int> on_face;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      if (!on_rim[v] && layer.thickness[v] > thick && holders_of(mesh.model_nodes[v]).count(layer.body) > 0)
        on_face.push_back(mesh.model_nodes[v]);
    tell(on_face, layer.body, 0);
  }
  std::map<int, std::vector<int>> by_others;
  for (const int node : layer.region_nodes) {
    const std::set<int> bodies = holders_of(node);
    if (bodies.count(layer.body) > 0) continue;
    for (const int body : bodies) by_others[body].push_back(node);
  }
  for (const auto& [body, nodes] : by_others) tell(nodes, body, 1);
  return found;
}

/// Planes of symmetry that the model holds otherwise than it may have meant.
Findings odd_ends(const ModelParts& parts, const Subject& surface, const std::vector<PartEnd>& ends) {
  Findings found;
  for (const PartEnd& end : ends) {
    const std::vector<NamedValue> plane = {{"axis", "xyz"[end.plane.axis]}, {"at", end.plane.at}};
    const auto tell = [&](const char* code, std::vector<NamedValue> values, int form = 0) {
      values.insert(values.end(), plane.begin(), plane.end());
      found.push_back({code, surface, std::move(values), form});
    };
    if (end.instead >= 0) tell("plane-held-across", {{"instead", "xyz"[end.instead]}});
    if (!end.forgotten.empty())
      tell("plane-node-forgotten",
           {{"forgotten", end.forgotten.size()}, {"of", end.nodes}, {"nodes", node_numbers(parts, end.forgotten)}});
    if (end.is_plane && end.steps.size() < parts.model.steps.size()) {
      std::vector<std::string> steps;
      for (const int step : end.steps) steps.push_back(std::to_string(step + 1));
      tell("plane-in-some-steps", {{"held", steps}, {"steps", parts.model.steps.size()}}, steps.empty() ? 1 : 0);
    }
  }
  return found;
}

/// How the model holds a layer's nodes otherwise than its user may have meant: `ends`, those of its deformable part.
/// Planes across an axis in which at least a fifth of the layer's nodes are held along that axis, and its face ends
/// there in edges that are not (plane-half-held). Ends held across another axis, with nodes forgotten, in some steps
/// (plane-held-across, plane-node-forgotten, plane-in-some-steps). Nodes that the ground holds in a component without a
/// plane of symmetry across it, of which the layer's law knows nothing (held-in-no-plane). Nodes of the pressed face,
/// inside its rim, that its own body holds though cartilage lies under them, and nodes anywhere in it that another body
/// holds, a user's choice where several do (held-in-layer).
Findings held_findings(const ModelParts& parts, const Layer& layer, const std::vector<PartEnd>& ends) {
  const Subject surface = {.surface = parts.model.surfaces[at(layer.surface)].name};
  const std::vector<HalfHeldPlane> half_held = half_held_planes(parts, layer);
  Findings found;
  for (const HalfHeldPlane& plane : half_held)
    found.push_back(
        {"plane-half-held",
         surface,
         {{"unheld", plane.unheld}, {"edges", plane.edges}, {"axis", "xyz"[plane.axis]}, {"at", plane.at + 0.0}}});
  add_once(found, odd_ends(parts, surface, ends));
  add_once(found, held_in_no_plane(parts, layer, half_held, ends));
  add_once(found, held_in_layer(parts, layer));
  return found;
}

/// How far a surface reaches sideways, its images behind planes of symmetry included: radius of the circle of its area;
/// between two planes across one axis, where it has no end, half its width; without an end either way: infinity.
struct Reach {
  double half_width = 0.0;
  bool strip = false;
};

Reach sideways_reach(const Layer& layer, double same_plane) {
  const SurfaceMesh& mesh = layer.articular;
  double area = surface_extent(mesh).area, length = 1.0;
  int endless = 0;
  for (int k = 0; k < 3; ++k) {
    double low = kInfinity, high = -kInfinity;
    for (std::size_t v = 0; v < layer.mirror.size() && v < mesh.vertices.size(); ++v) {
      if ((layer.mirror[v] & (1u << k)) == 0) continue;
      low = std::min(low, mesh.vertices[v][k]);
      high = std::max(high, mesh.vertices[v][k]);
    }
    if (low > high) continue;
    if (high - low <= 2 * same_plane) {
      area *= 2;
    } else {
      length *= high - low;
      ++endless;
    }
  }
  if (endless > 1) return {kInfinity, false};
  return endless == 1 ? Reach{0.5 * area / length, true} : Reach{std::sqrt(area / kPi), false};
}

/// Springs and the layer law suppose a thin layer.
Findings not_thin(const std::string& surface, const Layer& layer, double same_plane) {
  const double thickness = layer.mean_thickness();
  const Reach reach = sideways_reach(layer, same_plane);
  if (!(thickness > reach.half_width)) return {};
  return {{"not-thin",
           {.surface = surface},
           {{"thickness", thickness},
            {"half_width", reach.half_width},
            {"give_thickness", NamedSetting{"thickness"}},
            {"give_bone", NamedSetting{"bone"}}},
           reach.strip ? 0 : 1}};
}

/// Edges of the rim that count as a plane of symmetry where no such plane was found.
int walls_alone(const LayerFace& face) {
  const SurfaceMesh& mesh = face.mesh;
  int count = 0;
  for (const LayerFace::Edge& e : face.edges) {
    if (e.rim != Rim::Wall) continue;
    const auto& tri = mesh.triangles[at(e.triangle)];
    count +=
        mesh.planes.empty() || (mesh.planes[at(tri[at(e.edge)])] & mesh.planes[at(tri[at((e.edge + 1) % 3)])]) == 0;
  }
  return count;
}

/// Does the face end there, in a free edge?
bool free_edge_at(const Layer& layer, const SymmetryPlane& plane, double tolerance) {
  const SurfaceMesh& mesh = layer.face.mesh;
  return std::any_of(layer.face.edges.begin(), layer.face.edges.end(), [&](const LayerFace::Edge& e) {
    return e.rim == Rim::Free && std::abs(mesh.corner(e.triangle, e.edge)[plane.axis] - plane.at) <= tolerance &&
           std::abs(mesh.corner(e.triangle, (e.edge + 1) % 3)[plane.axis] - plane.at) <= tolerance;
  });
}

/// The ends of a layer's part that its user should know of.
std::vector<PartEnd> ends_of(const ModelParts& parts, const Layer& layer) {
  std::set<int> regions;
  for (const int node : layer.region_nodes) regions.insert(parts.region[at(node)]);
  std::vector<PartEnd> ends;
  for (const PartEnd& end : parts.holders.ends)
    if (regions.count(end.region) > 0 && (end.is_plane || free_edge_at(layer, end.plane, parts.holders.same_plane)))
      ends.push_back(end);
  return ends;
}

/// Deformable shells on the facets of a surface: their names, quoted.
std::string deformable_shells(const ModelParts& parts, const Surface& s) {
  std::set<std::string> names;
  for (int f = 0; f < s.size(); ++f) {
    const std::vector<ElementFace>* faces = find_face(parts, s, f);
    if (faces == nullptr) continue;
    for (const ElementFace& face : *faces) {
      const Domain& d = parts.model.domains[at(face.domain)];
      if (is_shell(d.shape) && d.material >= 0 && !parts.rigid[at(d.material)]) names.insert("\"" + d.name + "\"");
    }
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/// What was left out of a surface.
Findings left_out_findings(const std::string& surface, const std::vector<FaceKind>& kinds) {
  const auto turned = std::count(kinds.begin(), kinds.end(), FaceKind::SideWall),
             bonded = std::count(kinds.begin(), kinds.end(), FaceKind::Bonded);
  if (turned + bonded == 0) return {};
  return {{"facets-left-out",
           {.surface = surface},
           {{"walls", turned}, {"bonded", bonded}, {"facets", kinds.size()}, {"keep", NamedSetting{"keep-facets"}}},
           bonded == 0   ? 0
           : turned == 0 ? 1
                         : 2}};
}

/// Rims that are neither one thing nor the other.
Findings rim_findings(const std::string& surface, const LayerFace& face) {
  double rim = 0.0, stepped = 0.0, highest = 0.0;
  for (const LayerFace::Edge& e : face.edges) {
    const double length =
        (face.mesh.corner(e.triangle, e.edge) - face.mesh.corner(e.triangle, (e.edge + 1) % 3)).norm();
    rim += length;
    if (e.step > 0.0) stepped += length;
    highest = std::max(highest, e.step);
  }
  constexpr double kWorthSaying = 0.02;
  Findings findings;
  if (face.bevelled > kWorthSaying * rim)
    findings.push_back({"rim-bevelled", {.surface = surface}, {{"length", face.bevelled}}});
  if (stepped > kWorthSaying * rim)
    findings.push_back({"face-stepped", {.surface = surface}, {{"height", highest}, {"length", stepped}}});
  return findings;
}

}  // namespace

Findings layer_findings(const ModelParts& parts, const Layer& layer) {
  const Surface& surface = parts.model.surfaces[at(layer.surface)];
  Findings findings = layer.findings;
  add_once(findings, rim_findings(surface.name, layer.face));
  add_once(findings, left_out_findings(surface.name, layer.facet_kinds));
  if (!layer.compartments.names.empty())
    findings.push_back({"compartments", {.surface = surface.name}, {{"compartments", layer.compartments.names}}});
  const std::string shells = layer.material >= 0 ? deformable_shells(parts, surface) : "";
  if (!shells.empty()) findings.push_back({"shells-left-out", {.surface = surface.name}, {{"shells", shells}}});
  const int alone = walls_alone(layer.face);
  if (alone > 0)
    findings.push_back({"held-edges-in-no-plane",
                        {.surface = surface.name},
                        {{"edges", alone}, {"same_plane", parts.holders.same_plane}}});
  add_once(findings, not_thin(surface.name, layer, parts.holders.same_plane));
  if (!layer.rigid) add_once(findings, held_findings(parts, layer, ends_of(parts, layer)));
  return findings;
}

}  // namespace dea
