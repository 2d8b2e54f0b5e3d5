#include "src/results/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "src/base/numbers.h"
#include "src/geometry/coincident.h"
#include "src/geometry/ray_caster.h"
#include "src/results/percentile.h"

namespace dea {

namespace {

/// A spring that stands on the source in a pose.
struct Foot {
  Vector3d at;
  double size = 0.0, pressure = 0.0;
};

/// Feet in cubes a little wider than the largest of them.
struct FootGrid {
  double size = 0.0;   // of the largest foot
  double width = 0.0;  // of a cube: more than sqrt(1 + 1/4) of that
  std::map<GridCell, std::vector<Foot>> cells;

  explicit FootGrid(const std::vector<Foot>& feet) {
    for (const Foot& f : feet) size = std::max(size, f.size);
    width = 1.2 * size;
    for (const Foot& f : feet) cells[grid_cell(f.at, width)].push_back(f);
  }
  /// The nearest inwards of an edge, within its own size; nullptr: none. Measured across `normal`; along it no more
  /// than `depth`.
  const Foot* nearest(const Vector3d& x, const Vector3d& normal, const Vector3d& outward, double depth) const {
    const Foot* found = nullptr;
    double best = kInfinity;
    const int steps = static_cast<int>(std::ceil(depth / size));
    for (int step = -steps; step <= steps; ++step) {  // along the normal; across it the cubes beside are far enough
      const GridCell home = grid_cell(x + step * size * normal, width);
      for (long i = -1; i <= 1; ++i)
        for (long j = -1; j <= 1; ++j)
          for (long k = -1; k <= 1; ++k) {
            const auto near_by = cells.find({home[0] + i, home[1] + j, home[2] + k});
            if (near_by == cells.end()) continue;
            for (const Foot& f : near_by->second) {
              const Vector3d d = f.at - x;
              const double along = d.dot(normal), across = (d - along * normal).norm();
              if (std::abs(along) > depth || across > f.size || d.dot(outward) > 0 || !(across < best)) continue;
              best = across;
              found = &f;
            }
          }
    }
    return found;
  }
};

/// The edges of surfaces of the same body that other contacts have against the layer that this side presses, by their
/// nodes, the lesser first: the body goes on pressing there.
std::set<std::array<int, 2>> pressed_by_neighbours(const Joint& joint, std::size_t contact, int side) {
  std::set<std::array<int, 2>> edges;
  const ContactPair& own = joint.contacts[contact];
  const int layer = place_in_shared_layer(joint, own, 1 - side).layer;
  if (layer < 0) return edges;
  for (const LayerUse& use : joint.shared_layers[at(layer)].uses) {
    const Layer& bare = joint.contacts[at(use.contact)].layers[1 - use.side];
    if (at(use.contact) == contact || bare.body != own.layers[side].body) continue;
    for (const auto& corners : bare.articular.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = bare.articular.model_nodes[at(corners[k])],
                  b = bare.articular.model_nodes[at(corners[(k + 1) % 3])];
        edges.insert({std::min(a, b), std::max(a, b)});
      }
  }
  return edges;
}

/// Of side `side` of a contact. Pressed: more than `above`.
PressedRim pressed_rim(const Joint& joint, const Equilibrium& e, std::size_t contact, int side, double above) {
  const ContactPair& pair = joint.contacts[contact];
  const Layer &layer = pair.layers[side], &partner = pair.layers[1 - side];
  const SpringStates& s = e.springs[contact];
  const SurfaceMesh& mesh = layer.articular;
  PressedRim rim;
  std::vector<Foot> feet;
  bool pressed = false;
  for (int i = 0; i < s.size(); ++i) {
    if (!(s.area[at(i)] > 0)) continue;
    feet.push_back({s.foot[at(i)], std::sqrt(2 * s.area[at(i)]), s.pressure[at(i)]});
    pressed = pressed || s.pressure[at(i)] > above;
  }
  if (layer.bare_rim.empty() || !pressed) return rim;
  const FootGrid grid(feet);
  const SurfaceMesh& cartilage = partner.face.mesh.size() > 0 ? partner.face.mesh : partner.articular;
  std::optional<RayCaster> beyond;  // made when it is asked for
  const auto now = [&](const Layer& of, const Vector3d& x) {
    const Pose& pose = e.poses[at(of.body)];
    return Vector3d(pose.center + pose.rotation * (x - joint.bodies[at(of.body)].center_of_mass));
  };
  const Pose& other = e.poses[at(partner.body)];
  const double depth = partner.max_thickness();
  const std::set<std::array<int, 2>> others = pressed_by_neighbours(joint, contact, side);
  for (const BareRimEdge& edge : layer.bare_rim) {
    const auto& corners = mesh.triangles[at(edge.triangle)];
    const int from = mesh.model_nodes[at(corners[at(edge.edge)])],
              to = mesh.model_nodes[at(corners[at((edge.edge + 1) % 3)])];
    if (others.count({std::min(from, to), std::max(from, to)}) > 0) continue;
    const Vector3d a = now(layer, mesh.corner(edge.triangle, edge.edge)),
                   b = now(layer, mesh.corner(edge.triangle, (edge.edge + 1) % 3)),
                   normal = e.poses[at(layer.body)].rotation * mesh.normals[at(edge.triangle)],
                   outward = (b - a).cross(normal).normalized();
    const double length = (b - a).norm();
    rim.whole += length;
    // an edge may be much longer than a spring is wide
    const int parts = std::clamp(static_cast<int>(std::ceil(length / grid.size)), 1, 100);
    for (int k = 0; k < parts; ++k) {
      const Vector3d x = a + (k + 0.5) / parts * (b - a);
      const Foot* foot = grid.nearest(x, normal, outward, depth);
      if (foot == nullptr || !(foot->pressure > above)) continue;
      // does the cartilage go on there?
      const Vector3d outside = x + foot->size * outward;
      const Vector3d seen =
          other.rotation.transpose() * (outside - other.center) + joint.bodies[at(partner.body)].center_of_mass;
      if (!beyond) beyond.emplace(cartilage);
      const Vector3d gap = other.rotation * (position(cartilage, beyond->closest(seen)) - seen);
      const double along = gap.dot(normal);
      if ((gap - along * normal).norm() > 0.2 * foot->size + 0.3 * std::abs(along)) continue;
      (edge.goes_on ? rim.selection : rim.mesh) += length / parts;
    }
  }
  return rim;
}

/// One per name, of contact `contact`. A spring belongs to the compartment it stands on, or, where the target has them,
/// presses; a facet without springs to the nearest. `fields`: of the same contact and equilibrium.
std::vector<CompartmentLoad> compartment_loads(const Joint& joint, const SpringBeds& beds, const FieldMaps& maps,
                                               const Equilibrium& e, const ContactFields& fields, std::size_t contact) {
  const ContactPair& pair = joint.contacts[contact];
  const int side = compartment_side(pair);
  if (side < 0) return {};
  const Layer& layer = pair.layers[side];
  const FieldMaps::ContactMap& map = maps.contacts[contact];
  const auto nearest = [&](const Vector3d& x) {
    const Pose& pose = e.poses[at(layer.body)];
    const Vector3d reference =
        pose.rotation.transpose() * (x - pose.center) + joint.bodies[at(layer.body)].center_of_mass;
    return layer.compartments.of_triangle[at(map.articular[side].closest(reference).triangle)];
  };
  std::vector<CompartmentLoad> loads(at(layer.compartments.size()));
  std::vector<double> sum(loads.size(), 0.0);
  std::vector<Vector3d> moment(loads.size(), Vector3d::Zero());
  const SpringStates& s = e.springs[contact];
  const Springs& springs = beds.beds[contact].springs;
  const bool on_articular = layer.springs_at == SpringsAt::Articular;
  for (int i = 0; i < s.size(); ++i) {
    const double f = s.force(at(i));
    if (!(f > 0)) continue;
    const int triangle = !on_articular ? -1 : side == pair.source ? springs.surface_triangle[at(i)] : s.triangle[at(i)];
    const int c = triangle >= 0 ? layer.compartments.of_triangle[at(triangle)] : nearest(s.foot[at(i)]);
    loads[at(c)].force += f * s.direction[at(i)];
    moment[at(c)] += f * s.foot[at(i)];
    sum[at(c)] += f;
  }
  std::vector<int> of_facet(at(map.plotted.facets()), -1);  // of the source's surface
  const Layer& source = pair.source_layer();
  for (int t = 0; side == pair.source && t < source.articular.size(); ++t)
    of_facet[at(source.articular.facet[at(t)])] = source.compartments.of_triangle[at(t)];
  const Pose& pose = e.poses[at(source.body)];
  for (std::size_t f = 0; f < of_facet.size(); ++f)
    if (of_facet[f] < 0)
      of_facet[f] = nearest(
          pose.center + pose.rotation * (map.plotted.facet_centers[f] - joint.bodies[at(source.body)].center_of_mass));
  const std::vector<double> pressure = plotted_values(fields.sides[pair.source].pressure);
  for (std::size_t c = 0; c < loads.size(); ++c) {
    if (sum[c] > 0) loads[c].center_of_pressure = moment[c] / sum[c];
    FacetMask mask;
    for (int of : of_facet) mask.push_back(of == static_cast<int>(c));
    loads[c].headline = headline(map.plotted, pressure, mask);
  }
  return loads;
}

/// How many of the largest forces p A make up nine tenths of their sum.
int fewest_of_most(const std::vector<double>& pressure, const std::vector<double>& area) {
  std::vector<double> forces;
  for (std::size_t i = 0; i < pressure.size(); ++i) forces.push_back(pressure[i] * area[i]);
  std::sort(forces.begin(), forces.end(), std::greater<>());
  const double most = 0.9 * std::accumulate(forces.begin(), forces.end(), 0.0);
  double sum = 0.0;
  int count = 0;
  for (double f : forces) {
    if (sum >= most) break;
    sum += f;
    ++count;
  }
  return count;
}

}  // namespace

int compartment_side(const ContactPair& pair) {
  for (int side : {pair.source, 1 - pair.source})
    if (pair.layers[side].compartments.size() > 0) return side;
  return -1;
}

const std::vector<std::string>& compartment_names(const ContactPair& pair) {
  static const std::vector<std::string> none;
  const int side = compartment_side(pair);
  return side < 0 ? none : pair.layers[side].compartments.names;
}

std::vector<ContactStatistics> contact_statistics(const Joint& joint, const SpringBeds& beds, const FieldMaps& maps,
                                                  const Equilibrium& e, const std::vector<ContactFields>& fields) {
  std::vector<ContactStatistics> all;
  for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
    const ContactPair& pair = joint.contacts[c];
    const SpringStates& s = e.springs[c];
    const SideFields& source = fields[c].sides[pair.source];
    ContactStatistics stats;
    stats.headline = headline(maps.contacts[c].plotted, plotted_values(source.pressure));
    stats.springs = beds.beds[c].springs.size();
    std::vector<double> pressure, area;
    Vector3d moment = Vector3d::Zero();
    double force = 0.0, pressed = 0.0;
    for (int i = 0; i < s.size(); ++i) {
      const auto k = at(i);
      if (s.area[k] <= 0) continue;
      ++stats.springs_hit;
      if (s.pressure[k] <= 0) continue;
      ++stats.springs_active;
      pressure.push_back(s.pressure[k]);
      area.push_back(s.area[k]);
      const double f = s.force(k);
      moment += f * s.foot[k];
      force += f;
      pressed += s.pressure[k] * s.area[k];
      stats.contact_area += s.area[k];
      stats.largest_strain = std::max(stats.largest_strain, s.strain[k]);
    }
    stats.springs_most = fewest_of_most(pressure, area);
    if (s.rates.rows() > 0) stats.complementarity = s.complementarity;
    const bool any = !pressure.empty();
    stats.peak = any ? *std::max_element(pressure.begin(), pressure.end()) : kNaN;
    stats.mean = any ? pressed / stats.contact_area : kNaN;
    set_percentiles(stats, in_rising_order(pressure, area));
    stats.center_of_pressure = any ? Vector3d(moment / force) : Vector3d::Constant(kNaN);
    std::vector<double> nodal;
    for (double p : source.vertex_pressure)
      if (p > 0) nodal.push_back(p);
    stats.nodal_peak = nodal.empty() ? kNaN : *std::max_element(nodal.begin(), nodal.end());
    stats.nodal_mean =
        nodal.empty() ? kNaN : std::accumulate(nodal.begin(), nodal.end(), 0.0) / static_cast<double>(nodal.size());
    stats.nodal_median = weighted_percentile(nodal, std::vector<double>(nodal.size(), 1.0), 0.5);
    double facet_peak = 0.0;
    for (double p : source.pressure) facet_peak = std::max(facet_peak, p);
    stats.facet_peak = facet_peak > 0 ? facet_peak : kNaN;
    stats.facet_contact_area = source.contact_area;
    stats.force = e.contact_on_target[c].head<3>();
    stats.moment = e.contact_on_target[c].tail<3>();
    for (int side = 0; side < 2 && any; ++side)
      stats.pressed_rim[side] = pressed_rim(joint, e, c, side, kFelt * stats.peak);
    stats.compartments = compartment_loads(joint, beds, maps, e, fields[c], c);
    all.push_back(stats);
  }
  return all;
}

std::vector<LayerStatistics> layer_statistics(const Joint& joint, const FieldMaps& maps,
                                              const std::vector<ContactFields>& fields) {
  std::vector<LayerStatistics> all;
  for (std::size_t k = 0; k < joint.shared_layers.size(); ++k) {
    const FieldMaps::SharedMap& map = maps.shared[k];
    LayerStatistics of;
    of.pressure.assign(at(map.plotted.facets()), 0.0);
    for (std::size_t u = 0; u < map.facet.size(); ++u) {
      const LayerUse& use = joint.shared_layers[k].uses[u];
      const std::vector<double>& pressure = fields[at(use.contact)].sides[use.side].pressure;
      for (std::size_t f = 0; f < pressure.size(); ++f) of.pressure[at(map.facet[u][f])] += pressure[f];
    }
    of.headline = headline(map.plotted, plotted_values(of.pressure));
    for (std::size_t f = 0; f < of.pressure.size(); ++f) of.force += of.pressure[f] * map.plotted.facet_areas[f];
    all.push_back(std::move(of));
  }
  return all;
}

void add_inside(const ContactPair& pair, std::array<std::optional<InsideSide>, 2> inside, ContactFields& fields,
                ContactStatistics& statistics) {
  for (const int side : {0, 1}) {
    std::optional<InsideSide>& of = inside[at(side)];
    if (!of) continue;
    for (std::size_t i = 0; i < of->facets.size(); ++i)
      fields.sides[side].*inside_facet_fields()[i].values = std::move(of->facets[i]);
    statistics.inside[side == pair.source ? 0 : 1] = of->numbers;
    if (side != compartment_side(pair)) continue;
    for (std::size_t i = 0; i < statistics.compartments.size(); ++i)
      statistics.compartments[i].inside = of->compartments[i];
  }
}

EdgePressures pressed_beside(const Joint& joint, const std::vector<ContactFields>& fields, int contact, int side) {
  EdgePressures beside;
  const int layer = place_in_shared_layer(joint, joint.contacts[at(contact)], side).layer;
  if (layer < 0) return beside;
  for (const LayerUse& use : joint.shared_layers[at(layer)].uses) {
    const SurfaceMesh& mesh = joint.contacts[at(use.contact)].layers[use.side].articular;
    const std::vector<double>& pressure = fields[at(use.contact)].sides[use.side].pressure;
    for (int t = 0; t < mesh.size() && use.contact != contact && !pressure.empty(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& corners = mesh.triangles[at(t)];
        const int a = mesh.model_nodes[at(corners[k])], b = mesh.model_nodes[at(corners[(k + 1) % 3])];
        double& most = beside[{std::min(a, b), std::max(a, b)}];
        most = std::max(most, pressure[at(mesh.facet[at(t)])]);
      }
  }
  return beside;
}

double pressed_end_of_selection(const Layer& layer, const std::vector<double>& pressure, double above,
                                const EdgePressures& beside) {
  constexpr double kAlike = 0.5;
  if (layer.face.mesh.size() == 0 || pressure.empty()) return 0.0;
  double length = 0.0;
  for (const SelectionEdge& e : selection_rim(layer.face)) {
    const double own = pressure[at(layer.articular.facet[at(e.edge.triangle)])];
    if (!(e.goes_on || e.edge.shared) || !(own > above)) continue;
    const auto& nodes = layer.face.mesh.model_nodes;
    const int a = nodes[at(e.vertices[0])], b = nodes[at(e.vertices[1])];
    const auto beyond = beside.find({std::min(a, b), std::max(a, b)});
    if (beyond != beside.end() && beyond->second >= kAlike * own) continue;
    const auto& x = layer.face.mesh.vertices;
    length += (x[at(e.vertices[0])] - x[at(e.vertices[1])]).norm();
  }
  return length;
}

bool passed_through(const Joint& joint, const ContactPair& pair, const std::vector<Pose>& poses) {
  const Layer &source = pair.source_layer(), &target = pair.layers[1 - pair.source];
  const SurfaceMesh& feet = source.articular;
  const RayCaster caster(target.articular);
  const double deep = 4.0 * (source.max_thickness() + target.max_thickness());
  const RelativePose relative = relative_pose(poses[at(source.body)], joint.bodies[at(source.body)].center_of_mass,
                                              poses[at(target.body)], joint.bodies[at(target.body)].center_of_mass);
  double sampled = 0.0, ahead = 0.0, behind = 0.0;  // areas
  const int step = std::max(1, feet.size() / 400);  // a sample is enough
  for (int t = 0; t < feet.size(); t += step) {
    const Vector3d x = relative.rotation * feet.centroid(t) + relative.shift;
    const Vector3d n = relative.rotation * feet.normals[at(t)];
    const LineHit hit = caster.nearest_facing(x, n, -kInfinity, -deep, kInfinity);
    sampled += feet.areas[at(t)];
    if (hit.point.triangle >= 0) (hit.distance > -deep ? ahead : behind) += feet.areas[at(t)];
  }
  constexpr double kSome = 0.05;  // of the surface: not the line of one facet at a rim
  return behind > 3 * ahead && behind > kSome * sampled;
}

double facets_across(const Layer& layer, const std::vector<double>& pressure, double above, double enough) {
  const SurfaceMesh& mesh = layer.articular;
  const auto in_symmetry_plane = [&](int a, int b) {
    return layer.mirror.size() == mesh.vertices.size() && (layer.mirror[at(a)] & layer.mirror[at(b)]) != 0;
  };
  const auto pressed = [&](int t) { return t >= 0 && pressure[at(mesh.facet[at(t)])] > above; };
  std::vector<std::array<Vector3d, 2>> end;  // edges where contact ends
  std::vector<Vector3d> inside;              // ends and middles of all pressed edges
  double size = 0.0, area = 0.0;
  for (int t = 0; t < mesh.size(); ++t) {
    if (!pressed(t)) continue;
    size += mesh.areas[at(t)] * std::sqrt(2 * mesh.areas[at(t)]);
    area += mesh.areas[at(t)];
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = mesh.triangles[at(t)][k], b = mesh.triangles[at(t)][(k + 1) % 3];
      const Vector3d &x = mesh.vertices[at(a)], &y = mesh.vertices[at(b)];
      inside.insert(inside.end(), {x, 0.5 * (x + y)});
      if (!pressed(mesh.neighbours[at(t)][k]) && !in_symmetry_plane(a, b)) end.push_back({x, y});
    }
  }
  if (area == 0) return 0.0;
  const double per_length = 2 * area / size;
  double farthest = 0.0;
  std::size_t first = 0;
  for (const Vector3d& x : inside) {
    if (farthest * per_length > enough) break;
    double nearest = kInfinity;
    // most places are nearer than the farthest so far to some edge, and to that of the place before: then the others do
    // not matter
    for (std::size_t i = 0, e = first; i < end.size() && nearest > farthest; ++i, e = (e + 1) % end.size()) {
      const double distance = distance_to_segment(x, end[e][0], end[e][1]);
      if (distance < nearest) first = e;
      nearest = std::min(nearest, distance);
    }
    farthest = std::max(farthest, nearest);
  }
  return farthest * per_length;
}

}  // namespace dea
