#include "src/joint/layer_face.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

#include "src/base/disjoint_sets.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/geometry/ray_caster.h"
#include "src/model/element_faces.h"

namespace dea {

namespace {

constexpr double kCos20 = 0.93969262078590838;
constexpr double kCos40 = 0.76604444311897801;  // an edge that turns by more is the end of the face
constexpr double kCos45 = 0.70710678118654752;
constexpr double kCos60 = 0.5;

struct FacetShape {
  Vector3d center = Vector3d::Zero(), normal = Vector3d::Zero();  // normal: zero for a facet of no area
  double area = 0.0;
};

FacetShape shape_of(const JointModel& model, const std::vector<int>& facet) {
  FacetShape shape;
  Vector3d sum = Vector3d::Zero();
  for (const auto& t : split_facet(facet, model.nodes)) {
    const Vector3d v = area_vector(t, model.nodes);
    const double area = 0.5 * v.norm();
    shape.center += area / 3.0 * (model.nodes[at(t[0])] + model.nodes[at(t[1])] + model.nodes[at(t[2])]);
    shape.area += area;
    sum += v;
  }
  if (shape.area > 0) shape.center /= shape.area;
  if (sum.norm() > 0) shape.normal = sum.normalized();
  return shape;
}

/// The pieces of a facet's edge: one, or two at a mid-side node.
std::vector<std::array<int, 2>> edge_pieces(const std::vector<int>& facet, int edge) {
  const int n = static_cast<int>(facet.size()), corners = facet_corners(n);
  const int a = facet[at(edge)], b = facet[at((edge + 1) % corners)];
  if (n < 2 * corners || n == 10) return {{a, b}};  // cubic: flat through its corners
  const int mid = facet[at(corners + edge)];
  return {{a, mid}, {mid, b}};
}

/// Normal of a facet beside one of its edges: of the triangles there, for a quadratic facet is curved.
Vector3d normal_at_edge(const JointModel& model, const std::vector<int>& facet, int edge) {
  const auto pieces = edge_pieces(facet, edge);
  Vector3d sum = Vector3d::Zero();
  for (const auto& t : split_facet(facet, model.nodes))
    for (const auto& piece : pieces)
      if (std::count(t.begin(), t.end(), piece[0]) + std::count(t.begin(), t.end(), piece[1]) == 2)
        sum += area_vector(t, model.nodes);
  return sum.norm() > 0 ? Vector3d(sum.normalized()) : sum;
}

/// Cosine of the angle by which the surface turns from a facet to the next.
double turn_cosine(const JointModel& model, const std::vector<std::vector<int>>& facets, const FacetEdge& a,
                   const FacetEdge& b) {
  return normal_at_edge(model, facets[at(a.facet)], a.edge).dot(normal_at_edge(model, facets[at(b.facet)], b.edge));
}

/// Where the surface turns away from itself from facet a to b, as at a ridge: how deep b's middle lies below a, > 0.
double downwards(const JointModel& model, const std::vector<std::vector<int>>& facets, const FacetEdge& a,
                 const FacetEdge& b) {
  const std::vector<int>& facet = facets[at(a.facet)];
  return (model.nodes[at(facet[at(a.edge)])] - shape_of(model, facets[at(b.facet)]).center)
      .dot(normal_at_edge(model, facet, a.edge));
}

std::vector<std::vector<int>> all_facets(const FacetList& list) {
  std::vector<std::vector<int>> facets;
  for (int f = 0; f < list.size(); ++f) facets.push_back(list.facet(f));
  return facets;
}

std::unordered_map<FaceKey, int, FaceKeyHash> index_of(const FacetList& list) {
  std::unordered_map<FaceKey, int, FaceKeyHash> index;
  for (int f = 0; f < list.size(); ++f) index.try_emplace(face_key(list.facet(f)), f);
  return index;
}

bool any_held(const LayerBoundary& boundary, const std::vector<int>& facet) {
  return std::any_of(facet.begin(), facet.end(), [&](int node) { return boundary.node_held[at(node)] != 0; });
}

}  // namespace

bool mirrored(int held, const Vector3d& outward) {
  for (int i = 0; i < 3; ++i)
    if ((held >> i & 1) != 0 && std::abs(outward[i]) > kIntoPlane) return true;
  return false;
}

Vector3d outward_at(const SurfaceMesh& mesh, int t, int k) {
  return (mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k)).cross(mesh.normals[at(t)]).normalized();
}

LayerBoundary find_layer_boundary(const JointModel& model, const std::vector<LayerElement>& elements,
                                  std::vector<char> node_held) {
  struct Found {
    int count = 0;
    LayerElement element = {-1, -1};
    int face = -1;
  };
  std::unordered_map<FaceKey, Found, FaceKeyHash> faces;
  faces.reserve(4 * elements.size());
  std::vector<int> nodes;
  const auto face_nodes = [&](const LayerElement& element, int face) {
    const Domain& d = model.domains[at(element.domain)];
    const int* first = d.nodes.data() + static_cast<std::ptrdiff_t>(element.element) * nodes_per_element(d.shape);
    nodes.clear();
    for (int k : element_faces(d.shape)[at(face)]) nodes.push_back(first[k]);
  };
  for (const LayerElement& element : elements) {
    const int count = static_cast<int>(element_faces(model.domains[at(element.domain)].shape).size());
    for (int face = 0; face < count; ++face) {
      face_nodes(element, face);
      Found& found = faces[face_key(nodes)];
      if (found.count++ == 0) {
        found.element = element;
        found.face = face;
      }
    }
  }
  std::vector<const Found*> outer;
  for (const auto& entry : faces)  // a collapsed face, an edge or a point, has no outside
    if (entry.second.count == 1 && entry.first[1] >= 0) outer.push_back(&entry.second);
  std::sort(outer.begin(), outer.end(), [](const Found* a, const Found* b) {
    return std::tie(a->element.domain, a->element.element, a->face) <
           std::tie(b->element.domain, b->element.element, b->face);
  });
  LayerBoundary boundary;
  boundary.node_held = std::move(node_held);
  for (const Found* f : outer) {
    face_nodes(f->element, f->face);
    const bool held =
        std::all_of(nodes.begin(), nodes.end(), [&](int node) { return boundary.node_held[at(node)] != 0; });
    boundary.faces.add(nodes);
    boundary.kinds.push_back(held ? FaceKind::Bonded : FaceKind::Open);
  }
  return boundary;
}

void open_feather_facets(const JointModel& model, const FacetList& selected, LayerBoundary& boundary) {
  const auto index = index_of(boundary.faces);
  std::vector<int> both;  // selected and held
  for (int f = 0; f < selected.size(); ++f) {
    const auto found = index.find(face_key(selected.facet(f)));
    if (found != index.end() && boundary.kinds[at(found->second)] == FaceKind::Bonded) both.push_back(found->second);
  }
  if (both.empty()) return;
  std::vector<std::vector<int>> facets;
  for (int f : both) facets.push_back(boundary.faces.facet(f));
  DisjointSets patches(both.size());
  const std::vector<FacetEdge> edges = facet_edges(facets);
  for_each_place(edges, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first + 1; i < last; ++i)
      if (turn_cosine(model, facets, edges[first], edges[i]) > kCos40) patches.join(edges[first].facet, edges[i].facet);
  });
  FacetList inwards;
  for (int f = 0; f < boundary.faces.size(); ++f) inwards.add(turned_round(boundary.faces.facet(f)));
  const SurfaceMesh mesh = make_surface_mesh(inwards.begin, inwards.nodes, model.nodes);
  const RayCaster caster(mesh);
  std::vector<double> sees_open(both.size(), 0.0);  // per patch: area that looks through the layer at an open face,
                                                    // less that which looks at a held one
  for (std::size_t i = 0; i < both.size(); ++i) {
    const FacetShape shape = shape_of(model, facets[i]);
    if (!(shape.area > 0)) continue;
    const LineHit hit =
        caster.nearest_facing(shape.center, -shape.normal, 0.0, 1e-9 * std::sqrt(shape.area), kInfinity);
    const bool held =
        hit.point.triangle >= 0 && boundary.kinds[at(mesh.facet[at(hit.point.triangle)])] == FaceKind::Bonded;
    sees_open[at(patches.root(static_cast<int>(i)))] += held ? -shape.area : shape.area;
  }
  for (std::size_t i = 0; i < both.size(); ++i)
    if (sees_open[at(patches.root(static_cast<int>(i)))] < 0) boundary.kinds[at(both[i])] = FaceKind::Open;
}

SurfaceMesh bonded_surface(const JointModel& model, const LayerBoundary& boundary,
                           const std::vector<unsigned char>& node_planes) {
  FacetList bone;
  for (int f = 0; f < boundary.faces.size(); ++f)
    if (boundary.kinds[at(f)] == FaceKind::Bonded) bone.add(turned_round(boundary.faces.facet(f)));
  return make_surface_mesh(bone.begin, bone.nodes, model.nodes, nullptr, node_planes);
}

FacetList faces_without(const LayerBoundary& boundary, const FacetList& facets) {
  const auto index = index_of(facets);
  FacetList others;
  for (int f = 0; f < boundary.faces.size(); ++f) {
    const std::vector<int> face = boundary.faces.facet(f);
    if (index.count(face_key(face)) == 0) others.add(face);
  }
  return others;
}

void find_side_walls(const JointModel& model, const SurfaceMesh& bone, LayerBoundary& boundary) {
  const std::vector<std::vector<int>> facets = all_facets(boundary.faces);
  const RayCaster caster(bone);
  struct Seen {
    double distance = 0.0;  // of the closest bone
    double cosine = 1.0;    // of the angle to it
  };
  std::vector<Seen> seen(facets.size());
  std::vector<FacetShape> shapes(facets.size());
  parallel_for(facets.size(), [&](std::size_t f) {
    if (boundary.kinds[f] != FaceKind::Open) return;
    shapes[f] = shape_of(model, facets[f]);
    const Vector3d &x = shapes[f].center, &n = shapes[f].normal;
    if (!(n.norm() > 0)) return;
    const SurfacePoint p = caster.closest(x);
    seen[f].distance = (position(bone, p) - x).norm();
    seen[f].cosine = n.dot(bone.normals[at(p.triangle)]);
    if (seen[f].cosine >= kCos60) return;
    for (int t : caster.within(x, 1.05 * seen[f].distance))  // over a ridge the other flank counts as well
      seen[f].cosine = std::max(seen[f].cosine, n.dot(bone.normals[at(t)]));
  });
  double deepest = 0.0;
  for (std::size_t f = 0; f < facets.size(); ++f)
    if (boundary.kinds[f] == FaceKind::Open && seen[f].cosine >= kCos60) deepest = std::max(deepest, seen[f].distance);
  // Where bone rises beside the layer (cartilage in a hollow) it is nearest, but the face looks at the bone below it.
  std::vector<char> turned(facets.size(), 0);
  parallel_for(facets.size(), [&](std::size_t f) {
    if (boundary.kinds[f] != FaceKind::Open || seen[f].cosine >= kCos60) return;
    const LineHit hit = caster.nearest_facing(shapes[f].center, -shapes[f].normal, 0.0, 0.0, 2.0 * deepest, kCos45);
    turned[f] = hit.point.triangle < 0 || hit.distance <= 0.0;
  });
  DisjointSets patches(facets.size());
  const std::vector<FacetEdge> edges = facet_edges(facets);
  for_each_place(edges, [&](std::size_t first, std::size_t last) {
    int before = -1;
    for (std::size_t i = first; i < last; ++i) {
      if (!turned[at(edges[i].facet)]) continue;
      if (before >= 0) patches.join(before, edges[i].facet);
      before = edges[i].facet;
    }
  });
  // An isolated steep facet amid the face is no wall: a wall goes down to the bone, or looks back at it.
  std::vector<char> wall(facets.size(), 0);
  for (int f = 0; f < static_cast<int>(facets.size()); ++f)
    if (turned[at(f)] && (any_held(boundary, facets[at(f)]) || seen[at(f)].cosine < -kCos60))
      wall[at(patches.root(f))] = 1;
  for (int f = 0; f < static_cast<int>(facets.size()); ++f)
    if (turned[at(f)] && wall[at(patches.root(f))]) boundary.kinds[at(f)] = FaceKind::SideWall;
}

void find_side_walls(const JointModel& model, const FacetList& selected, LayerBoundary& boundary) {
  const std::vector<std::vector<int>> facets = all_facets(boundary.faces);
  DisjointSets patches(facets.size());
  const std::vector<FacetEdge> edges = facet_edges(facets);
  const auto open = [&](int f) { return boundary.kinds[at(f)] == FaceKind::Open; };
  for_each_place(edges, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      for (std::size_t j = i + 1; j < last; ++j)
        if (open(edges[i].facet) && open(edges[j].facet) && turn_cosine(model, facets, edges[i], edges[j]) > kCos40)
          patches.join(edges[i].facet, edges[j].facet);
  });
  std::vector<double> area(facets.size(), 0.0);  // selected, per patch
  std::vector<char> reaches(facets.size(), 0);
  const auto index = index_of(boundary.faces);
  for (int f = 0; f < selected.size(); ++f) {
    const auto found = index.find(face_key(selected.facet(f)));
    if (found != index.end() && open(found->second))
      area[at(patches.root(found->second))] += shape_of(model, facets[at(found->second)]).area;
  }
  for (int f = 0; f < static_cast<int>(facets.size()); ++f)
    if (open(f) && any_held(boundary, facets[at(f)])) reaches[at(patches.root(f))] = 1;
  const int largest = static_cast<int>(std::max_element(area.begin(), area.end()) - area.begin());
  for (int f = 0; f < static_cast<int>(facets.size()); ++f)
    if (open(f) && patches.root(f) != largest && reaches[at(patches.root(f))])
      boundary.kinds[at(f)] = FaceKind::SideWall;
}

std::vector<FaceKind> kinds_of(const LayerBoundary& boundary, const FacetList& facets) {
  const auto index = index_of(boundary.faces);
  std::vector<FaceKind> kinds;
  for (int f = 0; f < facets.size(); ++f) {
    const auto found = index.find(face_key(facets.facet(f)));
    kinds.push_back(found == index.end() ? FaceKind::Open : boundary.kinds[at(found->second)]);
  }
  return kinds;
}

FacetList kept_facets(const FacetList& facets, const std::vector<FaceKind>& kinds) {
  FacetList kept;
  for (int f = 0; f < facets.size(); ++f) {
    const bool keep = kinds.empty() || kinds[at(f)] == FaceKind::Open;
    kept.add(keep ? facets.facet(f) : std::vector<int>());
  }
  return kept;
}

std::string mostly_left_out(const JointModel& model, const FacetList& facets, const std::vector<FaceKind>& kinds) {
  const SurfaceMesh all = make_surface_mesh(facets.begin, facets.nodes, model.nodes);
  std::array<double, 3> area = {0, 0, 0};
  std::array<long, 3> count = {0, 0, 0};
  for (int t = 0; t < all.size(); ++t) area[static_cast<std::size_t>(kinds[at(all.facet[at(t)])])] += all.areas[at(t)];
  for (FaceKind kind : kinds) ++count[static_cast<std::size_t>(kind)];
  const auto open = static_cast<std::size_t>(FaceKind::Open), bonded = static_cast<std::size_t>(FaceKind::Bonded),
             wall = static_cast<std::size_t>(FaceKind::SideWall);
  // a selection closed all round has as much bone side as articular side
  if (count[open] > 0 && area[wall] <= area[open]) return "";
  const std::string rest = count[open] == 0
                               ? "none:"
                               : fmt::format(
                                     "{} facets, of less area ({:.3g}) than the side wall ({:.3g}): too little to tell "
                                     "the articular face by;",
                                     count[open], area[open], area[wall]);
  return fmt::format(
      "{} of its {} facets turn away from the articular face (side wall) and {} are bonded to bone, which leaves {}",
      count[wall], facets.size(), count[bonded], rest);
}

namespace {

/// What is across an edge of a facet.
struct Across {
  int facet = -1, edge = -1;
  bool smooth = false, bevelled = false;
  double turn = 0.0;  ///< by how much the surface turns there [rad]; < 0: upwards
};

/// All facets that may meet at an edge: the boundary, and selected facets that are no part of it.
struct Meeting {
  std::vector<std::vector<int>> facets;
  std::vector<FaceKind> kinds;
  std::vector<char> in_face;                  // per facet: selected, or what the face goes on to
  std::vector<std::array<Across, 4>> across;  // per facet and edge
};

Meeting meeting_facets(const JointModel& model, const LayerBoundary& boundary, const FacetList& selected) {
  Meeting m;
  m.facets = all_facets(boundary.faces);
  m.kinds = boundary.kinds;
  const auto index = index_of(boundary.faces);
  m.in_face.assign(m.facets.size(), 0);
  for (int f = 0; f < selected.size(); ++f) {
    const std::vector<int> facet = selected.facet(f);
    if (facet.empty()) continue;
    const auto found = index.find(face_key(facet));
    if (found != index.end()) {
      m.in_face[at(found->second)] = 1;
      m.facets[at(found->second)] = facet;  // it may have more nodes than its element's face
      continue;
    }
    m.facets.push_back(facet);
    m.kinds.push_back(FaceKind::Open);
    m.in_face.push_back(1);
  }
  const std::vector<FacetEdge> edges = facet_edges(m.facets);
  m.across.resize(m.facets.size());
  for_each_place(edges, [&](std::size_t first, std::size_t last) {
    if (last - first != 2) return;  // the rim of nothing, or faces that merely touch there
    const FacetEdge &a = edges[first], &b = edges[first + 1];
    const double cosine = turn_cosine(model, m.facets, a, b);
    const bool bevelled = cosine < kCos20 && cosine > kCos40;
    const double turn = std::copysign(std::acos(std::clamp(cosine, -1.0, 1.0)), downwards(model, m.facets, a, b));
    m.across[at(a.facet)][at(a.edge)] = {b.facet, b.edge, cosine > kCos40, bevelled, turn};
    m.across[at(b.facet)][at(b.edge)] = {a.facet, a.edge, cosine > kCos40, bevelled, turn};
  });
  return m;
}

/// Length of the selection's edges beyond which a bevel begins.
double bevelled_length(const JointModel& model, const Meeting& m) {
  double length = 0.0;
  for (int f = 0; f < static_cast<int>(m.facets.size()); ++f)
    for (int k = 0; m.in_face[at(f)] && k < 4; ++k) {
      const Across& next = m.across[at(f)][at(k)];
      if (next.facet < 0 || !next.bevelled || m.in_face[at(next.facet)] || m.kinds[at(next.facet)] == FaceKind::Bonded)
        continue;
      for (const auto& piece : edge_pieces(m.facets[at(f)], k))
        length += (model.nodes[at(piece[0])] - model.nodes[at(piece[1])]).norm();
    }
  return length;
}

/// Takes open facets across smooth edges into the face, as far as `reach`; returns them, ascending.
std::vector<int> grow(const JointModel& model, const SurfaceMesh& articular, double reach, Meeting& m) {
  const RayCaster caster(articular);
  std::vector<char> far(m.facets.size(), 0);
  std::vector<int> open_ends, grown;
  for (int f = 0; f < static_cast<int>(m.facets.size()); ++f)
    if (m.in_face[at(f)]) open_ends.push_back(f);
  while (!open_ends.empty()) {
    const int f = open_ends.back();
    open_ends.pop_back();
    for (const Across& next : m.across[at(f)]) {
      if (next.facet < 0 || !next.smooth || m.in_face[at(next.facet)] || far[at(next.facet)] ||
          m.kinds[at(next.facet)] != FaceKind::Open)
        continue;
      const Vector3d center = shape_of(model, m.facets[at(next.facet)]).center;
      if (std::isfinite(reach) && (position(articular, caster.closest(center)) - center).norm() > reach) {
        far[at(next.facet)] = 1;
        continue;
      }
      m.in_face[at(next.facet)] = 1;
      grown.push_back(next.facet);
      open_ends.push_back(next.facet);
    }
  }
  std::sort(grown.begin(), grown.end());
  return grown;
}

/// The ends of a facet's edge.
std::array<Vector3d, 2> edge_ends(const JointModel& model, const std::vector<int>& nodes, int edge) {
  const int corners = facet_corners(static_cast<int>(nodes.size()));
  return {model.nodes[at(nodes[at(edge)])], model.nodes[at(nodes[at((edge + 1) % corners)])]};
}

/// Over the walls of a step or a notch at an edge, the next facet of the face that looks the same way: how far its edge
/// is; 0: there is none nearer than `most`.
double step_size(const JointModel& model, const Meeting& m, int f, int k, double most) {
  const Vector3d normal = normal_at_edge(model, m.facets[at(f)], k);
  const auto middle = [&](int facet, int edge) {
    const auto ends = edge_ends(model, m.facets[at(facet)], edge);
    return Vector3d(0.5 * (ends[0] + ends[1]));
  };
  const auto outward = [&](int facet, int edge) {
    const auto ends = edge_ends(model, m.facets[at(facet)], edge);
    return Vector3d((ends[1] - ends[0]).cross(normal_at_edge(model, m.facets[at(facet)], edge)).normalized());
  };
  constexpr std::size_t kMostWalls = 6;
  std::vector<int> walls = {m.across[at(f)][at(k)].facet};
  for (std::size_t w = 0; w < walls.size() && w < kMostWalls; ++w)
    for (const Across& next : m.across[at(walls[w])]) {
      if (next.facet < 0 || next.facet == f || m.kinds[at(next.facet)] == FaceKind::Bonded) continue;
      const double distance = (middle(next.facet, next.edge) - middle(f, k)).norm();
      if (!(distance < most)) continue;
      if (normal_at_edge(model, m.facets[at(next.facet)], next.edge).dot(normal) <= kCos40) {
        if (std::find(walls.begin(), walls.end(), next.facet) == walls.end()) walls.push_back(next.facet);
      } else if (m.in_face[at(next.facet)] && outward(f, k).dot(outward(next.facet, next.edge)) < -0.5) {
        return distance > 0 ? distance : std::numeric_limits<double>::min();
      }
    }
  return 0.0;
}

/// What is beyond edges of the face (of which triangle is not known yet), by the nodes of their pieces, the lesser
/// first.
using BeyondEdges = std::map<std::array<int, 2>, LayerFace::Edge>;

std::array<int, 2> piece_key(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

BeyondEdges beyond_edges(const JointModel& model, const Meeting& m, double highest_step) {
  BeyondEdges beyond;
  for (int f = 0; f < static_cast<int>(m.facets.size()); ++f) {
    if (!m.in_face[at(f)]) continue;
    for (int k = 0; k < 4; ++k) {
      const Across& next = m.across[at(f)][at(k)];
      if (next.facet < 0) continue;
      const FaceKind kind = m.kinds[at(next.facet)];
      LayerFace::Edge found;
      if (!next.smooth) {
        if (kind != FaceKind::Bonded) {
          found.step = step_size(model, m, f, k, highest_step);
          if (found.step == 0 && next.turn > 0) found.wall = next.turn;
        }
      } else if (m.in_face[at(next.facet)]) {
        continue;
      } else if (kind == FaceKind::Bonded) {
        found.rim = Rim::Wall;
        found.bonded = true;
      } else if (kind == FaceKind::Open) {
        found.rim = Rim::Continues;
      }
      for (const auto& piece : edge_pieces(m.facets[at(f)], k)) beyond[piece_key(piece[0], piece[1])] = found;
    }
  }
  return beyond;
}

/// The rim of the face's mesh.
std::vector<LayerFace::Edge> rim_edges(const SurfaceMesh& mesh, const BeyondEdges& beyond,
                                       const std::vector<unsigned char>& mirror) {
  std::vector<LayerFace::Edge> edges;
  for (int t = 0; t < mesh.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      if (mesh.neighbours[at(t)][at(k)] >= 0) continue;
      const auto& tri = mesh.triangles[at(t)];
      const int a = mesh.model_nodes[at(tri[at(k)])], b = mesh.model_nodes[at(tri[at((k + 1) % 3)])];
      LayerFace::Edge edge;
      if (mirrored(mirror[at(a)] & mirror[at(b)], outward_at(mesh, t, k)))
        edge.rim = Rim::Wall;
      else if (const auto found = beyond.find(piece_key(a, b)); found != beyond.end())
        edge = found->second;
      edge.triangle = t;
      edge.edge = k;
      edges.push_back(edge);
    }
  return edges;
}

}  // namespace

LayerFace grow_face(const JointModel& model, const LayerBoundary& boundary, const FacetList& selected,
                    const SurfaceMesh& articular, double deepest, bool whole, const std::vector<unsigned char>& mirror,
                    const std::vector<unsigned char>& node_planes) {
  Meeting meeting = meeting_facets(model, boundary, selected);
  LayerFace face;
  face.bevelled = bevelled_length(model, meeting);
  const std::vector<int> grown = grow(model, articular, whole ? kInfinity : kFaceReach * deepest, meeting);
  face.pressed = articular.size();
  if (grown.empty()) {
    face.mesh = articular;
  } else {
    FacetList list = selected;
    for (int f : grown) list.add(meeting.facets[at(f)]);
    face.mesh = make_surface_mesh(list.begin, list.nodes, model.nodes, nullptr, node_planes);
  }
  face.edges = rim_edges(face.mesh, beyond_edges(model, meeting, deepest), mirror);
  return face;
}

LayerFace selected_face(const SurfaceMesh& articular, const std::vector<unsigned char>& mirror) {
  LayerFace face;
  face.mesh = articular;
  face.pressed = articular.size();
  face.edges = rim_edges(articular, {}, mirror);
  return face;
}

std::vector<SelectionEdge> selection_rim(const LayerFace& face) {
  const int selected = face.pressed;
  std::vector<SelectionEdge> rim;
  auto edge = face.edges.begin();
  for (int t = 0; t < selected; ++t)
    for (int k = 0; k < 3; ++k) {
      const int next = face.mesh.neighbours[at(t)][at(k)];
      if (next >= 0 && next < selected) continue;
      const auto& tri = face.mesh.triangles[at(t)];
      SelectionEdge found = {{tri[at(k)], tri[at((k + 1) % 3)]}, next >= 0, {}};
      found.edge.triangle = t;
      found.edge.edge = k;
      found.edge.rim = Rim::Continues;
      if (next < 0) {
        while (edge != face.edges.end() && std::tie(edge->triangle, edge->edge) < std::tie(t, k)) ++edge;
        if (edge == face.edges.end() || edge->triangle != t || edge->edge != k) continue;
        found.edge = *edge;
        found.goes_on = edge->rim == Rim::Continues && !edge->shared;
      } else if (!face.pressed_by_others.empty() && face.pressed_by_others[at(next)]) {
        found.goes_on = false;
        found.edge.shared = true;
      }
      rim.push_back(found);
    }
  return rim;
}

RimLengths rim_lengths(const LayerFace& face) {
  RimLengths lengths;
  for (const SelectionEdge& e : selection_rim(face)) {
    const double length = (face.mesh.vertices[at(e.vertices[0])] - face.mesh.vertices[at(e.vertices[1])]).norm();
    if (e.goes_on)
      lengths.goes_on += length;
    else if (e.edge.shared)
      lengths.shared += length;
    else if (e.edge.rim == Rim::Free)
      lengths.free += length;
    else if (e.edge.bonded)
      lengths.bonded += length;
    else
      lengths.symmetry += length;
  }
  for (int t = face.pressed; t < face.mesh.size(); ++t) lengths.area_beyond += face.mesh.areas[at(t)];
  return lengths;
}

}  // namespace dea
