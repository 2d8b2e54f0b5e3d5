#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "src/base/numbers.h"
#include "src/joint/shared_ends.h"
#include "src/rules/look.h"

namespace dea {

ForceAtEdges force_at_edges(const Layer& layer, const std::vector<double>& pressure) {
  const SurfaceMesh& mesh = layer.articular;
  const double near_by = layer.mean_thickness();
  std::vector<std::pair<Vector3d, double>> pressed;  // centroids of triangles, and their forces
  Eigen::AlignedBox3d box;
  double all = 0.0, beside = 0.0;
  for (int t = 0; t < mesh.size(); ++t) {
    const double p = pressure[at(mesh.facet[at(t)])];
    if (!(p > 0)) continue;
    pressed.emplace_back(mesh.centroid(t), p * mesh.areas[at(t)]);
    box.extend(pressed.back().first);
    all += pressed.back().second;
  }
  ForceAtEdges found;
  if (pressed.empty()) return found;
  struct FreeEdge {
    Vector3d a, b;
    double wall;
  };
  std::vector<FreeEdge> edges;  // that contact may reach
  const SurfaceMesh& face = layer.face.mesh;
  for (const LayerFace::Edge& e : layer.face.edges) {
    if (e.rim != Rim::Free) continue;
    const Vector3d a = face.corner(e.triangle, e.edge), b = face.corner(e.triangle, (e.edge + 1) % 3);
    const double half = 0.5 * (b - a).norm();
    if (box.exteriorDistance(Vector3d(0.5 * (a + b))) <= half + near_by) edges.push_back({a, b, e.wall});
  }
  for (const auto& [centroid, force] : pressed)
    for (const FreeEdge& edge : edges)
      if (distance_to_segment(centroid, edge.a, edge.b) <= near_by) {
        beside += force;
        found.wall += force * edge.wall;
        break;
      }
  found.share = beside / all;
  if (beside > 0) found.wall /= beside;
  return found;
}

namespace {

/// Largest pressure of both surfaces where they end in one plane.
double pressure_at(const SharedEnd& end, const ContactPair& pair, const ContactFields& fields) {
  double most = 0.0;
  for (int side = 0; side < 2; ++side) {
    const SurfaceMesh& mesh = pair.layers[side].articular;
    const std::vector<double>& pressure = fields.sides[side].vertex_pressure;
    if (pressure.size() != mesh.vertices.size()) continue;
    for (std::size_t v = 0; v < pressure.size(); ++v)
      if (std::abs(mesh.vertices[v][end.plane.axis] - end.plane.at) <= end.tolerance)
        most = std::max(most, pressure[v]);
  }
  return most;
}

}  // namespace

/// Contact that runs over a free edge. The deeper, the more is missing: a film that is pressed out over an edge flows
/// the less, the thinner it has become; and twice as much over a wall that is undercut (docs/layer_law.md, section 3).
Findings force_at_edge(const JointModel& model, const Joint& joint, const SolvedStates& result) {
  constexpr double kSome = 0.1, kUndercut = 105 * kPi / 180;
  Findings found;
  for (const JudgedSide& s : judged_sides(model, joint, result)) {
    if (s.layer.rigid || s.fields.pressure.empty()) continue;
    const auto [share, wall] = force_at_edges(s.layer, s.fields.pressure);
    if (!(share > kSome)) continue;
    const double strain = s.statistics.largest_strain;
    const bool undercut = wall > kUndercut;
    const int cost = (strain < 0.15 ? 5 : strain < 0.25 ? 10 : 20) * (undercut ? 2 : 1);
    found.push_back({"force-at-edge",
                     s.subject,
                     {{"percent", 100 * share},
                      {"thickness", s.layer.mean_thickness()},
                      {"strain", 100 * strain},
                      {"cost", cost},
                      {"wall", wall * 180 / kPi}},
                     undercut        ? 2
                     : strain < 0.15 ? 0
                                     : 1});
  }
  return found;
}

/// Selections that end under pressure though the cartilage goes on.
Findings pressed_selection(const JointModel& model, const Joint& joint, const SolvedStates& result) {
  Findings found;
  for (const JudgedContact& c : judged_contacts(joint, result)) {
    const int contact = static_cast<int>(&c.pair - joint.contacts.data());
    for (const int side : {0, 1}) {
      const Layer& layer = c.pair.layers[side];
      const double length = pressed_end_of_selection(layer, c.fields.sides[side].pressure, kFelt * c.statistics.peak,
                                                     pressed_beside(joint, c.state.fields, contact, side));
      if (length > 2 * layer.facet_size() * layer.mean_thickness())
        found.push_back({"selection-ends-under-pressure", c.subject(model, layer), {{"length", length}}});
    }
  }
  return found;
}

/// Bare surfaces that end under pressure though the cartilage goes on.
Findings pressed_bare_rim(const JointModel& model, const Joint& joint, const SolvedStates& result) {
  Findings found;
  for (const JudgedSide& s : judged_sides(model, joint, result)) {
    if (!s.layer.rigid || s.layer.bare_rim.empty()) continue;
    const PressedRim& rim = s.statistics.pressed_rim[s.side];
    const double mesh = s.layer.part < 0 ? rim.mesh : 0.0;  // a meniscus ends where its mesh does
    const double length = rim.selection + mesh, facet = s.partner.facet_size() * s.partner.mean_thickness();
    if (!(length > 0) || !(length > facet)) continue;
    found.push_back(
        {"bare-surface-ends-under-pressure",
         s.subject,
         {{"length", length}, {"percent", 100 * length / rim.whole}, {"mesh", mesh}, {"selection", rim.selection}},
         mesh == 0            ? 0
         : rim.selection == 0 ? 1
                              : 2});
  }
  return found;
}

/// Half a joint whose cut is not held: both surfaces end in one plane under pressure, and not in another one opposite,
/// as two plates of one size do.
Findings cut_face(const JointModel&, const Joint& joint, const SolvedStates& result) {
  Findings found;
  for (const JudgedContact& c : judged_contacts(joint, result)) {
    const ContactPair& pair = c.pair;
    std::vector<std::pair<SharedEnd, double>> pressed;
    for (const SharedEnd& end : shared_ends(pair)) {
      const double most = pressure_at(end, pair, c.fields);
      if (most > kFelt * c.statistics.peak) pressed.push_back({end, most});
    }
    for (const auto& [end, most] : pressed) {
      const int axis = end.plane.axis;
      const auto ends = std::count_if(pressed.begin(), pressed.end(),
                                      [axis](const auto& other) { return other.first.plane.axis == axis; });
      if (end.symmetry || ends > 1) continue;
      found.push_back(
          {"cut-under-pressure",
           c.subject(),
           {{"plane", in_words(std::vector<SymmetryPlane>{end.plane})}, {"pressure", most}, {"axis", "xyz"[axis]}}});
    }
  }
  return found;
}

/// Layers whose greatest shear is where the law of the inside knows least.
Findings shear_at_edge(const JointModel& model, const Joint& joint, const SolvedStates& result) {
  Findings found;
  for (const JudgedContact& c : judged_contacts(joint, result))
    for (const int side : {0, 1}) {
      const std::optional<InsideEnds>& inside = c.statistics.inside[side];
      if (!inside || !(inside->peak_near_free_edge > 0)) continue;
      const Layer& layer = side == 0 ? c.pair.source_layer() : c.pair.target_layer();
      Subject subject = c.subject(model, layer);
      subject.body = joint.bodies[at(layer.body)].name;
      const double near_by = inside->peak_near_free_edge;
      found.push_back({"shear-at-edge", subject, {{"near", near_by}}, near_by > kNearEdge ? 1 : 0});
    }
  return found;
}

}  // namespace dea
