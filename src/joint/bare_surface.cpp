#include "src/joint/bare_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "src/base/disjoint_sets.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/geometry/coincident.h"
#include "src/geometry/ray_caster.h"
#include "src/joint/compartments.h"
#include "src/model/element_faces.h"

namespace dea {

namespace {

constexpr double kSamePlace = 1e-6;  // of the facets' size: coordinates of a file have less noise

/// Takes nodes at one place for one, in the facets' lists.
void merge_nodes(const ContactSide& in, const std::vector<double>& areas, BareSurface& surface) {
  double area = 0.0;
  for (double a : areas) area += a;
  const double size = std::sqrt(area / static_cast<double>(std::max<std::size_t>(areas.size(), 1)));
  surface.stands_for = coincident_nodes(surface.facets.nodes, in.parts.model.nodes, kSamePlace * size);
  if (surface.stands_for.empty()) return;
  std::unordered_map<int, char> all;
  for (int& node : surface.facets.nodes) {
    all.try_emplace(node, 1);
    const auto other = surface.stands_for.find(node);
    if (other != surface.stands_for.end()) node = other->second;
  }
  surface.findings = {
      {"nodes-merged", {.surface = in.surface.name}, {{"merged", surface.stands_for.size()}, {"nodes", all.size()}}}};
}

/// The facet across an edge, and whether it is wound to the same side.
struct Beside {
  int facet;
  bool alike;
  int low, high;
};

std::string edge_text(const JointModel& model, int a, int b) {
  const Vector3d x = 0.5 * (model.nodes[at(a)] + model.nodes[at(b)]);
  return fmt::format("the edge between nodes {} and {} at ({:.6g}, {:.6g}, {:.6g})", model.node_ids[at(a)],
                     model.node_ids[at(b)], x.x(), x.y(), x.z());
}

InputError several_sheets(const ContactSide& in, const std::vector<FacetEdge>& edges, std::size_t first,
                          std::size_t last) {
  std::string list;
  for (std::size_t i = first; i < last; ++i)
    list += fmt::format("{}{}", list.empty() ? "" : i + 1 == last ? " and " : ", ", edges[i].facet + 1);
  return refusal_of(in,
                    say("facets {} meet at {}: a surface of shells with {} facets at one edge has no two sides;", list,
                        edge_text(in.parts.model, edges[first].low, edges[first].high), last - first),
                    "select one sheet of facets, the one that touches, each facet once");
}

InputError one_sided(const ContactSide& in, int facet, const Beside& beside) {
  return refusal_of(
      in,
      say("its facets cannot be turned to one side (a Moebius strip has but one): facets {} and {} at {} would look to "
          "opposite sides;",
          facet + 1, beside.facet + 1, edge_text(in.parts.model, beside.low, beside.high)),
      "take out the facets through which it comes back to itself turned over");
}

/// Per facet those across its edges. Edges where solids and shells meet by threes, or solids, part them.
std::vector<std::vector<Beside>> facets_beside(const ContactSide& in, const std::vector<char>& on_shell,
                                               const FacetList& list) {
  std::vector<std::vector<int>> facets;
  for (int f = 0; f < list.size(); ++f) facets.push_back(list.facet(f));
  const std::vector<FacetEdge> edges = facet_edges(facets);
  std::vector<std::vector<Beside>> beside(facets.size());
  for_each_place(edges, [&](std::size_t first, std::size_t last) {
    const FacetEdge &a = edges[first], &b = edges[last - 1];
    if (last - first > 2 && std::all_of(&a, &b + 1, [&](const FacetEdge& e) { return on_shell[at(e.facet)] != 0; }))
      throw several_sheets(in, edges, first, last);
    if (last - first != 2 || a.facet == b.facet) return;
    const bool alike = facets[at(a.facet)][at(a.edge)] != facets[at(b.facet)][at(b.edge)];  // one comes, one goes
    beside[at(a.facet)].push_back({b.facet, alike, a.low, a.high});
    beside[at(b.facet)].push_back({a.facet, alike, a.low, a.high});
  });
  return beside;
}

/// Winds facets like those beside them, from those of solids on, then from the first of each piece of shells on.
void wind_alike(const ContactSide& in, const std::vector<char>& on_shell, const std::vector<double>& areas,
                BareSurface& surface) {
  const auto beside = facets_beside(in, on_shell, surface.facets);
  std::vector<char> known(on_shell.size(), 0);
  const auto follow = [&](std::vector<int>& piece, bool on_solids) {  // from facets on whose sense is known
    for (std::size_t i = 0; i < piece.size(); ++i) {
      const int f = piece[i];
      for (const Beside& next : beside[at(f)]) {
        const char sense = next.alike ? surface.turned[at(f)] : !surface.turned[at(f)];
        if (!known[at(next.facet)]) {
          known[at(next.facet)] = 1;
          surface.turned[at(next.facet)] = sense;
          piece.push_back(next.facet);
        } else if (surface.turned[at(next.facet)] != sense && !on_solids) {
          throw one_sided(in, f, next);
        }
      }
    }
  };
  std::vector<int> solids;
  for (int f = 0; f < surface.facets.size(); ++f)
    if (!on_shell[at(f)]) {
      known[at(f)] = 1;
      solids.push_back(f);
    }
  follow(solids, true);
  for (int f = 0; f < surface.facets.size(); ++f) {
    if (known[at(f)]) continue;
    known[at(f)] = 1;
    std::vector<int> piece = {f};
    follow(piece, false);
    double turned = 0.0;  // area, less that of the others
    for (int p : piece) turned += surface.turned[at(p)] ? areas[at(p)] : -areas[at(p)];
    if (turned > 0)
      for (int p : piece) surface.turned[at(p)] = !surface.turned[at(p)];
  }
}

// ---- towards the partner -------------------------------------------------------------------------------------------

/// Number of the connected piece, per triangle.
std::vector<int> connected_pieces(const SurfaceMesh& mesh) {
  DisjointSets sets(mesh.triangles.size());
  for (int t = 0; t < mesh.size(); ++t)
    for (int next : mesh.neighbours[at(t)])
      if (next >= 0) sets.join(t, next);
  return sets.numbers();
}

/// Per piece: does it look away from the partner? Compared at the closest points, area-weighted; the nearer, the more
/// it counts: a closed surface looks away on its far side.
std::vector<double> looking_away(const SurfaceMesh& surface, const std::vector<int>& piece,
                                 const SurfaceMesh& partner) {
  const RayCaster caster(partner);
  std::vector<double> facing(at(*std::max_element(piece.begin(), piece.end()) + 1), 0.0);
  for (int t = 0; t < surface.size(); ++t) {
    const Vector3d x = surface.centroid(t);
    const SurfacePoint p = caster.closest(x);
    const double area = surface.areas[at(t)], near = area + (position(partner, p) - x).squaredNorm();
    facing[at(piece[at(t)])] += area / near * surface.normals[at(t)].dot(partner.normals[at(p.triangle)]);
  }
  return facing;
}

/// The surface and its other side.
SurfaceMesh both_sides(const SurfaceMesh& mesh) {
  SurfaceMesh both = with_turned(mesh, std::vector<char>(at(mesh.size()), 1));
  both.triangles.insert(both.triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
  both.normals.insert(both.normals.end(), mesh.normals.begin(), mesh.normals.end());
  return both;
}

/// Per piece: does more than half of its area see another piece before the partner when it looks back?
std::vector<char> behind_another(const SurfaceMesh& mesh, const std::vector<int>& piece, const SurfaceMesh& partner) {
  const RayCaster own(both_sides(mesh)), other(both_sides(partner));
  std::vector<double> behind(at(*std::max_element(piece.begin(), piece.end()) + 1), 0.0);
  for (int t = 0; t < mesh.size(); ++t) {
    const Vector3d x = mesh.centroid(t), back = -mesh.normals[at(t)];
    const double start = 1e-6 * std::sqrt(mesh.areas[at(t)]);
    const LineHit hit = own.nearest_facing(x + start * back, back, 0.0, 0.0, kInfinity);
    bool hidden = hit.point.triangle >= 0 && piece[at(hit.point.triangle % mesh.size())] != piece[at(t)];
    if (hidden) {
      const LineHit beyond = other.nearest_facing(x + start * back, back, 0.0, 0.0, kInfinity);
      hidden = beyond.point.triangle < 0 || hit.distance < beyond.distance;
    }
    behind[at(piece[at(t)])] += hidden ? mesh.areas[at(t)] : -mesh.areas[at(t)];
  }
  std::vector<char> is_behind;
  for (double area : behind) is_behind.push_back(area > 0);
  return is_behind;
}

// ---- rim -----------------------------------------------------------------------------------------------------------

/// RimFaces of a body's elements, of nodes that stand for all at their place.
using RimFaces =
    std::unordered_map<FaceKey, std::pair<std::vector<int>, int>, FaceKeyHash>;  // its nodes, how many have it

/// Those of elements that have two nodes or more on the rim.
RimFaces faces_at(const ModelParts& parts, int body, const std::unordered_map<int, int>& stands_for,
                  const std::vector<char>& on_rim) {
  const JointModel& model = parts.model;
  const auto own = [&](int node) {
    const auto found = stands_for.find(node);
    return found == stands_for.end() ? node : found->second;
  };
  RimFaces faces;
  std::vector<int> nodes, face;
  const auto add = [&] { ++faces.try_emplace(face_key(face), face, 0).first->second.second; };
  for (const Domain& d : model.domains) {
    if (d.material < 0 || !parts.rigid[at(d.material)] || is_line(d.shape) ||
        parts.bodies.of_material[at(d.material)] != body)
      continue;
    const int n = nodes_per_element(d.shape);
    for (std::size_t first = 0; first + at(n) <= d.nodes.size(); first += at(n)) {
      nodes.clear();
      int count = 0;
      for (int k = 0; k < n; ++k) {
        nodes.push_back(own(d.nodes[first + at(k)]));
        count += on_rim[at(nodes.back())];
      }
      if (count < 2) continue;
      if (is_shell(d.shape)) {
        face = nodes;
        add();
        continue;
      }
      for (const auto& corners : element_faces(d.shape)) {
        face.clear();
        for (int k : corners) face.push_back(nodes[at(k)]);
        add();
      }
    }
  }
  return faces;
}

/// Does a face go on from an edge of a triangle, turned by less than 40 degrees?
bool goes_on_from(const JointModel& model, const SurfaceMesh& mesh, const BareRimEdge& e,
                  const std::vector<int>& face) {
  constexpr double kCos40 = 0.76604444311897801;
  const Vector3d &a = mesh.corner(e.triangle, e.edge), &b = mesh.corner(e.triangle, (e.edge + 1) % 3);
  const Vector3d along = (b - a).normalized(), outward = along.cross(mesh.normals[at(e.triangle)]);
  Vector3d center = Vector3d::Zero();
  const int corners = facet_corners(static_cast<int>(face.size()));
  for (int k = 0; k < corners; ++k) center += model.nodes[at(face[at(k)])] / corners;
  Vector3d there = center - 0.5 * (a + b);
  there -= there.dot(along) * along;
  return there.dot(outward) > kCos40 * there.norm();
}

}  // namespace

std::vector<BareRimEdge> bare_rim(const ModelParts& parts, const Layer& layer) {
  const JointModel& model = parts.model;
  const SurfaceMesh& mesh = layer.articular;
  std::vector<BareRimEdge> rim;
  std::vector<int> nodes;  // first those of the rim: they stand for others at their place
  std::vector<char> on_rim(model.nodes.size(), 0);
  const auto node_at = [&](const BareRimEdge& e, int end) {
    return mesh.model_nodes[at(mesh.triangles[at(e.triangle)][at((e.edge + end) % 3)])];
  };
  for (int t = 0; t < mesh.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      if (mesh.neighbours[at(t)][at(k)] >= 0) continue;
      rim.push_back({t, k, false});
      for (int end : {0, 1}) {
        nodes.push_back(node_at(rim.back(), end));
        on_rim[at(nodes.back())] = 1;
      }
    }
  if (rim.empty()) return rim;
  for (const Domain& d : model.domains)
    if (d.material >= 0 && parts.rigid[at(d.material)] && parts.bodies.of_material[at(d.material)] == layer.body)
      nodes.insert(nodes.end(), d.nodes.begin(), d.nodes.end());
  double area = 0.0;
  for (double a : mesh.areas) area += a / mesh.size();
  const std::unordered_map<int, int> stands_for = coincident_nodes(nodes, model.nodes, kSamePlace * std::sqrt(area));
  RimFaces faces = faces_at(parts, layer.body, stands_for, on_rim);
  const Surface& surface = model.surfaces[at(layer.surface)];
  for (int f = 0; f < surface.size(); ++f) {  // what is selected does not go on
    std::vector<int> facet = surface.facet(f);
    for (int& node : facet)
      if (const auto found = stands_for.find(node); found != stands_for.end()) node = found->second;
    faces.erase(face_key(facet));
  }
  std::unordered_map<int, std::vector<const std::vector<int>*>> at_node;
  for (const auto& entry : faces) {
    const std::vector<int>& face = entry.second.first;
    // one element's alone; shells of two bodies' parts may lie on each other
    if (entry.second.second > 1) continue;
    for (int node : face)
      if (on_rim[at(node)]) at_node[node].push_back(&face);
  }
  for (BareRimEdge& e : rim) {
    const auto found = at_node.find(node_at(e, 0));
    if (found == at_node.end()) continue;
    for (const std::vector<int>* face : found->second)
      e.goes_on = e.goes_on || (std::find(face->begin(), face->end(), node_at(e, 1)) != face->end() &&
                                goes_on_from(model, mesh, e, *face));
  }
  return rim;
}

BareSurface bare_surface(const ContactSide& in, const CarriedSurface& carried, bool merge) {
  const JointModel& model = in.parts.model;
  BareSurface surface;
  surface.facets = carried.facets;
  surface.turned.assign(carried.carriers.size(), 0);
  std::vector<double> areas;
  for (int f = 0; f < carried.facets.size(); ++f)
    areas.push_back(0.5 * area_vector(carried.facets.facet(f), model.nodes).norm());
  if (merge) merge_nodes(in, areas, surface);
  if (!carried.on_shells) return surface;
  std::vector<char> on_shell;
  for (const ElementFace& c : carried.carriers) on_shell.push_back(is_shell(model.domains[at(c.domain)].shape));
  wind_alike(in, on_shell, areas, surface);
  FacetList wound;
  for (int f = 0; f < surface.facets.size(); ++f) {
    const std::vector<int> facet = surface.facets.facet(f);
    wound.add(surface.turned[at(f)] ? turned_round(facet) : facet);
  }
  surface.facets = std::move(wound);
  return surface;
}

Findings face_partner(const ModelParts& parts, Facets facets, const SurfaceMesh& partner, Layer& layer) {
  const CarriedSurface carried = carried_surface(parts, layer.surface);
  const SurfaceMesh& mesh = layer.articular;
  if (layer.material >= 0 || !carried.on_shells || mesh.size() == 0 || partner.size() == 0) return {};
  const std::vector<int> piece = connected_pieces(mesh);
  std::vector<double> away = looking_away(mesh, piece, partner);
  for (int t = 0; t < mesh.size(); ++t)
    if (!is_shell(parts.model.domains[at(carried.carriers[at(mesh.facet[at(t)])].domain)].shape))
      away[at(piece[at(t)])] = -kInfinity;  // solids know their outside
  if (away.size() > 1 && std::any_of(away.begin(), away.end(), [](double a) { return a > 0; })) {
    const std::vector<char> behind = behind_another(mesh, piece, partner);
    for (std::size_t p = 0; p < away.size(); ++p)
      if (behind[p]) away[p] = 0;
  }
  std::vector<char> turn(at(mesh.size()), 0), facet_turns(layer.turned.size(), 0);
  for (int t = 0; t < mesh.size(); ++t) {
    turn[at(t)] = away[at(piece[at(t)])] > 0;
    if (turn[at(t)]) facet_turns[at(mesh.facet[at(t)])] = 1;
  }
  if (std::count(turn.begin(), turn.end(), 1) > 0) {
    layer.articular = with_turned(mesh, turn);
    if (facets == Facets::Flat) flatten(layer.articular);
    layer.bone = layer.articular;
    for (std::size_t f = 0; f < facet_turns.size(); ++f)
      layer.turned[f] = facet_turns[f] ? !layer.turned[f] : layer.turned[f];
  }
  const auto turned = std::count(layer.turned.begin(), layer.turned.end(), 1);
  if (turned == 0) return {};
  return {{"shells-turned",
           {.surface = parts.model.surfaces[at(layer.surface)].name},
           {{"turned", turned}, {"facets", layer.turned.size()}},
           turned == static_cast<std::ptrdiff_t>(layer.turned.size()) ? 0 : 1}};
}

void leave_out_far_side(const ModelParts& parts, Facets facets, const SurfaceMesh& partner, Layer& layer) {
  constexpr double kFacing = -0.3, kAway = 0.5;  // cosines between the normals at the closest points
  const SurfaceMesh& mesh = layer.articular;
  const Surface& surface = parts.model.surfaces[at(layer.surface)];
  const auto& keep = parts.settings.keep_facets;
  if (layer.part < 0 || partner.size() == 0 || std::count(keep.begin(), keep.end(), surface.name) > 0) return;
  const RayCaster caster(partner);
  std::vector<double> facing(at(mesh.facets), 0.0), area(facing);
  for (int t = 0; t < mesh.size(); ++t) {
    const auto f = at(mesh.facet[at(t)]);
    area[f] += mesh.areas[at(t)];
    facing[f] +=
        mesh.areas[at(t)] * mesh.normals[at(t)].dot(partner.normals[at(caster.closest(mesh.centroid(t)).triangle)]);
  }
  double away = 0.0, all = 0.0;
  std::vector<FaceKind> kinds;
  for (std::size_t f = 0; f < area.size(); ++f) {
    all += area[f];
    if (facing[f] > kAway * area[f]) away += area[f];
    kinds.push_back(facing[f] > kFacing * area[f] ? FaceKind::SideWall : FaceKind::Open);
  }
  constexpr double kSome = 0.1;
  if (away < kSome * all || std::count(kinds.begin(), kinds.end(), FaceKind::Open) == 0) return;
  const CarriedSurface carried = carried_surface(parts, layer.surface);
  const FacetList kept = kept_facets(carried.facets, kinds);
  layer.articular = make_surface_mesh(kept.begin, kept.nodes, parts.model.nodes);
  if (facets == Facets::Flat) flatten(layer.articular);
  layer.bone = layer.articular;
  layer.facet_kinds = std::move(kinds);
  layer.compartments = find_compartments(parts.model, carried, layer.articular);
}

}  // namespace dea
