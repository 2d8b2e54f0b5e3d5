#include "src/results/inside_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/base/say.h"
#include "src/facts/bodies.h"
#include "src/geometry/ray_caster.h"
#include "src/model/element_columns.h"

namespace dea {

std::vector<InsidePlace> inside_places(const Layer& layer, const LayerFace& of, const LayerMesh& mesh,
                                       const std::vector<Vector3d>& points) {
  constexpr double kFar = 1.5;  // of the thickness: bone and face together are further than through the layer
  const RayCaster face(of.mesh), bone(layer.bone);
  const bool no_bone = layer.bone.vertices == layer.articular.vertices;
  std::vector<InsidePlace> places(points.size());
  parallel_for(points.size(), [&](std::size_t i) {
    const Vector3d& x = points[i];
    const SurfacePoint above = face.closest(x);
    const Vector3d foot = position(of.mesh, above);
    const double to_face = (foot - x).norm(), thickness = interpolate(of.mesh, of.thickness, above);
    if (no_bone) {
      if (thickness > 0 && to_face <= kFar * thickness)
        places[i] = inside_place(mesh, above.triangle, above.weights, std::max(0.0, 1 - to_face / thickness));
      return;
    }
    const double to_bone = (position(layer.bone, bone.closest(x)) - x).norm(), between = to_face + to_bone,
                 through = (position(layer.bone, bone.closest(foot)) - foot).norm();
    if (!(between > 0) || between > kFar * std::max(through, thickness)) return;
    places[i] = inside_place(mesh, above.triangle, above.weights, to_bone / between);
  });
  return places;
}

InsideState turned(InsideState state, const Eigen::Matrix3d& rotation) {
  state.normal = rotation * state.normal;
  state.shear = rotation * state.shear;
  state.stress = rotation * state.stress * rotation.transpose();
  return state;
}

InsideStatistics inside_statistics(const InsideLayer& inside, const std::vector<InsideMeasures>& measured,
                                   const std::vector<char>& among) {
  std::vector<double> shear, first, third, area;
  for (std::size_t v = 0; v < measured.size(); ++v) {
    if (!among.empty() && !among[v]) continue;
    if (!(inside.value(static_cast<Eigen::Index>(v), 0) > 0)) continue;
    const InsideMeasures& m = measured[v];
    shear.push_back(m.max_shear);
    first.push_back(m.first_strain);
    third.push_back(m.third_strain);
    area.push_back(inside.layer->mesh.mesh.vertex_areas[v]);
  }
  return {inside_distribution(shear, area, false), inside_distribution(first, area, false),
          inside_distribution(third, area, true)};
}

namespace {

const BedLayer& bed_layer(const SpringBed& bed, int side) {
  return side == bed.pair.source ? bed.layers->source : bed.layers->target;
}

/// Fills `layers` and `layer_of`.
void find_layers(const std::vector<SpringBed>& beds, InsideMaps& maps) {
  for (std::size_t c = 0; c < beds.size(); ++c) {
    maps.layer_of.push_back({-1, -1});
    for (const int side : {0, 1}) {
      if (!beds[c].layers) continue;
      const std::shared_ptr<const LayerOperator>& layer = bed_layer(beds[c], side).layer;
      if (!layer || layer->law.terms < 2) continue;
      const auto known = std::find_if(maps.layers.begin(), maps.layers.end(),
                                      [&](const InsideMap& map) { return map.layer == layer; });
      maps.layer_of[c][at(side)] = static_cast<int>(known - maps.layers.begin());
      if (known == maps.layers.end())
        maps.layers.push_back({layer, inside_shape(*layer), make_depth_laws(layer->elasticity.nu), {}});
      maps.layers[at(maps.layer_of[c][at(side)])].uses.push_back({static_cast<int>(c), side});
    }
  }
}

/// A layer under the pressures of all contacts that press it, and where each of them does.
struct LookedInto {
  InsideLayer inside;
  std::vector<std::vector<char>> pressed;  ///< per use and vertex; empty: one use, whose all pressure is
};

/// `map` must outlive the result. Frame: the layer's reference configuration. Contacts that are not active press
/// nothing.
LookedInto look_inside(const InsideMap& map, const std::vector<SpringBed>& beds, const Equilibrium& e) {
  LayerFeet all;
  std::vector<double> pressure;
  LookedInto result;
  for (const auto& [contact, side] : map.uses) {
    const SpringBed& bed = beds[at(contact)];
    const SpringStates& states = e.springs[at(contact)];
    if (map.uses.size() > 1) result.pressed.emplace_back(at(map.layer->mesh.nodes()), 0);
    if (states.size() == 0) continue;
    LayerFeet feet;
    if (side == bed.pair.source) {
      feet = feet_on_source(*bed.layers, Eigen::Map<const Eigen::VectorXd>(states.area.data(), states.size()));
    } else {
      SpringStates pressed = states;  // of the others nobody asks what they would press
      for (int i = 0; i < pressed.size(); ++i)
        if (!(pressed.pressure[at(i)] > 0)) pressed.triangle[at(i)] = -1;
      feet = feet_on_target(bed, pressed, e.poses[at(bed.source_body)], e.poses[at(bed.target_body)], kInfinity);
    }
    for (int i = 0; i < feet.size() && !result.pressed.empty(); ++i)
      for (int k = feet.begin[at(i)]; k < feet.begin[at(i + 1)]; ++k)
        if (states.pressure[at(i)] > 0) result.pressed.back()[at(feet.node[at(k)])] = 1;
    append(all, feet);
    pressure.insert(pressure.end(), states.pressure.begin(), states.pressure.end());
  }
  result.inside =
      look_inside(*map.layer, map.shape, map.laws, all,
                  Eigen::Map<const Eigen::VectorXd>(pressure.data(), static_cast<Eigen::Index>(pressure.size())));
  return result;
}

/// At each place; NaN throughout where a place has no triangle.
std::vector<InsideState> states_inside(const InsideLayer& inside, const std::vector<InsidePlace>& places) {
  InsideState none;
  none.normal = none.shear = Vector3d::Constant(kNaN);
  none.pressure = kNaN;
  none.stress = none.strain = Eigen::Matrix3d::Constant(kNaN);
  std::vector<InsideState> states(places.size(), none);
  parallel_for(places.size(), [&](std::size_t i) {
    if (places[i].triangle >= 0) states[i] = state_inside(inside, places[i], StrainMeasure::Large);
  });
  return states;
}

/// Elements that fields are given for, with what is asked of them again and again.
struct SolidElements {
  std::vector<int> element_domain;   ///< per element: place in InsideMaps::domains
  std::vector<Vector3d> centroid;    ///< mean of its volume, reference
  std::vector<ElementBlock> blocks;  ///< one per domain
};

SolidElements solid_elements(const JointModel& model, const InsideMaps& maps) {
  SolidElements solid;
  for (std::size_t d = 0; d < maps.domains.size(); ++d) {
    const Domain& domain = model.domains[at(maps.domains[d])];
    solid.blocks.push_back({domain.shape, &domain.nodes});
    for (int e = 0; e < solid.blocks.back().size(); ++e) {
      solid.element_domain.push_back(static_cast<int>(d));
      solid.centroid.push_back(element_volume(model, domain, e).centroid);
    }
  }
  return solid;
}

/// The elements all of whose nodes the layer has.
std::vector<int> elements_of(const JointModel& model, const InsideMaps& maps, const Layer& layer) {
  std::vector<char> of_layer(model.nodes.size(), 0);
  for (int node : layer.region_nodes) of_layer[at(node)] = 1;
  std::vector<int> elements;
  for (std::size_t d = 0; d < maps.domains.size(); ++d) {
    const Domain& domain = model.domains[at(maps.domains[d])];
    const int n = nodes_per_element(domain.shape), count = static_cast<int>(domain.element_ids.size());
    for (int e = 0; e < count; ++e) {
      const auto first = domain.nodes.begin() + static_cast<std::ptrdiff_t>(e) * n;
      if (std::all_of(first, first + n, [&](int node) { return of_layer[at(node)] != 0; }))
        elements.push_back(maps.first[d] + e);
    }
  }
  return elements;
}

/// Rows of elements under the articular surface.
void count_rows(const JointModel& model, const SolidElements& solid, const Layer& layer, InsideElements& of) {
  const Surface& surface = model.surfaces[at(layer.surface)];
  const ElementColumns columns = element_columns(solid.blocks, surface.begin, surface.nodes);
  for (std::size_t f = 0; f < columns.of_facet.size(); ++f) {
    if (!columns.whole[f]) continue;
    const int rows = static_cast<int>(columns.of_facet[f].size());
    of.fewest_rows = of.fewest_rows == 0 ? rows : std::min(of.fewest_rows, rows);
    of.most_rows = std::max(of.most_rows, rows);
  }
}

InsideElements place_elements(const JointModel& model, const InsideMaps& maps, const SolidElements& solid,
                              const Layer& layer, const LayerFace& face, const LayerMesh& mesh) {
  InsideElements of;
  const std::vector<int> elements = elements_of(model, maps, layer);
  std::vector<Vector3d> centroids;
  std::set<std::string> names;
  for (int e : elements) {
    centroids.push_back(solid.centroid[at(e)]);
    const int material = model.domains[at(maps.domains[at(solid.element_domain[at(e)])])].material;
    names.insert(fmt::format("\"{}\"", model.materials[at(material)].name));
  }
  for (const std::string& name : names) of.parts += (of.parts.empty() ? "" : ", ") + name;
  of.all = static_cast<int>(elements.size());
  const std::vector<InsidePlace> places = inside_places(layer, face, mesh, centroids);
  of.lowest = 1;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].triangle < 0) continue;
    of.element.push_back(elements[i]);
    of.places.push_back(places[i]);
    of.lowest = std::min(of.lowest, places[i].height);
    of.highest = std::max(of.highest, places[i].height);
  }
  count_rows(model, solid, layer, of);
  return of;
}

/// How far a point lies beside the place that was found for it, over the thickness there.
double distance_beside(const LayerMesh& mesh, const InsidePlace& place, const Vector3d& x) {
  const SurfacePoint point{place.triangle, place.weights};
  const Vector3d from = x - position(mesh.mesh, point), &n = mesh.mesh.normals[at(place.triangle)];
  const double thickness = interpolate(mesh.mesh, mesh.thickness, point);
  return thickness > 0 ? (from - from.dot(n) * n).norm() / thickness : 0.0;
}

/// An element that lies beside one contact's face and under another's is the other's.
void leave_to_the_nearest(const SolidElements& solid, InsideMaps& maps) {
  constexpr double kAlike = 0.05;
  const auto beside = [&](std::size_t c, int side, std::size_t i) {
    const InsideElements& of = maps.placed[c][at(side)];
    return distance_beside(maps.layers[at(maps.layer_of[c][at(side)])].layer->mesh, of.places[i],
                           solid.centroid[at(of.element[i])]);
  };
  std::vector<double> least(at(maps.elements), kInfinity);
  for (std::size_t c = 0; c < maps.placed.size(); ++c)
    for (const int side : {0, 1})
      for (std::size_t i = 0; i < maps.placed[c][at(side)].element.size(); ++i) {
        double& best = least[at(maps.placed[c][at(side)].element[i])];
        best = std::min(best, beside(c, side, i));
      }
  for (std::size_t c = 0; c < maps.placed.size(); ++c)
    for (const int side : {0, 1}) {
      InsideElements& of = maps.placed[c][at(side)];
      std::size_t kept = 0;
      for (std::size_t i = 0; i < of.element.size(); ++i) {
        if (beside(c, side, i) > least[at(of.element[i])] + kAlike) continue;
        of.element[kept] = of.element[i];
        of.places[kept++] = of.places[i];
      }
      of.element.resize(kept);
      of.places.resize(kept);
    }
}

SymmetricTensor packed(const Eigen::Matrix3d& m) { return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(1, 2), m(0, 2)}; }

std::vector<InsideMeasures> measures_at(const InsideLayer& inside, double height) {
  const std::vector<InsideState> states = states_at_height(inside, height, StrainMeasure::Large);
  std::vector<InsideMeasures> measured(states.size());
  parallel_for(states.size(), [&](std::size_t v) { measured[v] = measures(states[v]); });
  return measured;
}

/// The triangles of the layer's mesh that make up triangle `t` of a contact's surface: so many from this one on.
std::array<int, 2> mesh_triangles(const BedLayer& bed, int t) {
  const int parts = bed.layer->mesh.divide * bed.layer->mesh.divide;
  return {(bed.triangle.empty() ? t : bed.triangle[at(t)]) * parts, parts};
}

/// Means over the facets of what is linear in each triangle of the layer's mesh.
std::vector<double> facet_means(const Layer& layer, const BedLayer& bed, const std::vector<InsideMeasures>& measured,
                                double InsideMeasures::*measure) {
  const LayerMesh& mesh = bed.layer->mesh;
  std::vector<double> sum(at(layer.articular.facets), 0.0), area(sum.size(), 0.0);
  for (int t = 0; t < layer.articular.size(); ++t) {
    const auto facet = at(layer.articular.facet[at(t)]);
    const auto [first, parts] = mesh_triangles(bed, t);
    for (int part = first; part < first + parts; ++part) {
      double mean = 0.0;
      for (int v : mesh.mesh.triangles[at(part)]) mean += measured[at(v)].*measure / 3;
      sum[facet] += mesh.mesh.areas[at(part)] * mean;
      area[facet] += mesh.mesh.areas[at(part)];
    }
  }
  for (std::size_t f = 0; f < sum.size(); ++f) sum[f] = area[f] > 0 ? sum[f] / area[f] : 0.0;
  return sum;
}

/// Per vertex of the layer's mesh: whether it belongs to compartment `c`, and, unless it is empty, to `pressed`.
std::vector<char> vertices_of_compartment(const Layer& layer, const BedLayer& bed, int c,
                                          const std::vector<char>& pressed) {
  const LayerMesh& mesh = bed.layer->mesh;
  std::vector<char> among(at(mesh.nodes()), 0);
  for (int t = 0; t < layer.articular.size(); ++t) {
    if (layer.compartments.of_triangle[at(t)] != c) continue;
    const auto [first, parts] = mesh_triangles(bed, t);
    for (int part = first; part < first + parts; ++part)
      for (int v : mesh.mesh.triangles[at(part)]) among[at(v)] = pressed.empty() || pressed[at(v)];
  }
  return among;
}

/// As in InsideEnds. `among`: per vertex; empty: all.
double peak_near_free_edge(const InsideLayer& inside, const std::vector<InsideMeasures>& bone,
                           const std::vector<char>& among) {
  const LayerMesh& mesh = inside.layer->mesh;
  std::size_t peak = bone.size();
  for (std::size_t v = 0; v < bone.size(); ++v) {
    if (!(inside.value(static_cast<Eigen::Index>(v), 0) > 0) || (!among.empty() && !among[v])) continue;
    if (peak == bone.size() || bone[v].max_shear > bone[peak].max_shear) peak = v;
  }
  if (peak == bone.size()) return 0.0;
  constexpr double kSlope100 = -0.17632698070846498;  // of a wall of 100 degrees
  const double near_by = mesh.wall_slope[peak] < kSlope100 ? kNearOverhang : kNearEdge;
  return mesh.edge_distance[peak] < near_by * mesh.thickness[peak] ? near_by : 0.0;
}

/// `pressed`: where the contact presses, as in LookedInto.
InsideSide side_results(const Layer& layer, const BedLayer& bed, const InsideLayer& inside,
                        const std::vector<char>& pressed) {
  const std::vector<InsideMeasures> bone = measures_at(inside, 0), surface = measures_at(inside, 1);
  const auto ends = [&](const std::vector<char>& among) -> InsideEnds {
    return {inside_statistics(inside, bone, among), inside_statistics(inside, surface, among),
            peak_near_free_edge(inside, bone, among)};
  };
  InsideSide side{ends(pressed), {}, {}};
  for (int c = 0; c < layer.compartments.size(); ++c)
    side.compartments.push_back(ends(vertices_of_compartment(layer, bed, c, pressed)));
  for (const auto* measured : {&bone, &surface})
    for (const auto measure :
         {&InsideMeasures::max_shear, &InsideMeasures::first_strain, &InsideMeasures::third_strain})
      side.facets.push_back(facet_means(layer, bed, *measured, measure));
  return side;
}

/// What the elements show so far, and the pressure for which they show it.
struct ShownElements {
  std::vector<double> pressure;
  std::vector<SymmetricTensor> stress, strain;
  explicit ShownElements(int elements)
      : pressure(at(elements), -1.0), stress(at(elements), SymmetricTensor{}), strain(stress) {}
  void show(const InsideElements& of, const std::vector<InsideState>& states, const Eigen::Matrix3d& rotation) {
    for (std::size_t i = 0; i < of.element.size(); ++i) {
      const std::size_t e = at(of.element[i]);
      const InsideState state = turned(states[i], rotation);
      const double pressed = std::abs(state.pressure);
      if (!(pressed > pressure[e]) || !state.stress.allFinite() || !state.strain.allFinite()) continue;
      pressure[e] = pressed;
      stress[e] = packed(state.stress);
      strain[e] = packed(state.strain);
    }
  }
};

bool presses_part(const ContactPair& pair) { return pair.layers[0].part >= 0 || pair.layers[1].part >= 0; }

bool has_inside(const ContactPair& pair) {
  return pair.law == Law::Layer && pair.layer_fit == LayerFit::TwoTerms &&
         !(pair.layers[0].rigid && pair.layers[1].rigid);
}

}  // namespace

void check_inside(const Joint& joint, const Settings& settings) {
  if (!settings.inside || std::any_of(joint.contacts.begin(), joint.contacts.end(), has_inside)) return;
  const ContactPair& pair = joint.contacts.front();
  throw UsageError(
      Fault{.given = NamedSetting{.setting = "inside", .bare = true},
            .found = pair.law == Law::Layer
                         ? say("contact \"{}\": found law layer {},", pair.name,
                               pair.layer_fit == LayerFit::OneTerm ? "of one term"
                               : presses_part(pair) ? "without cartilage, on a part whose stress is told anyway"
                                                    : "between two bare rigid surfaces")
                         : say("contact \"{}\": found law {},", pair.name, name(pair.law)),
            .expected = say("expected {} of two terms and a layer of cartilage: other laws say nothing of the inside",
                            NamedSetting{"law", "", "layer"})});
}

InsideMaps make_inside_maps(const JointModel& model, const Settings& settings, const Joint& joint,
                            const SpringBeds& beds) {
  InsideMaps maps;
  const std::vector<char> rigid = rigid_materials(model, settings);
  for (std::size_t d = 0; d < model.domains.size(); ++d) {
    const Domain& domain = model.domains[d];
    if (domain.material < 0 || rigid[at(domain.material)] || element_type(domain.shape).kind != ElementKind::Solid ||
        domain.element_ids.empty())
      continue;
    maps.domains.push_back(static_cast<int>(d));
    maps.first.push_back(maps.elements);
    maps.elements += static_cast<int>(domain.element_ids.size());
  }
  const SolidElements solid = solid_elements(model, maps);
  find_layers(beds.beds, maps);
  for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
    maps.placed.emplace_back();
    for (const int side : {0, 1}) {
      const Layer& layer = joint.contacts[c].layers[side];
      if (maps.layer_of[c][at(side)] < 0 || layer.region_nodes.empty()) continue;
      const int shared = place_in_shared_layer(joint, joint.contacts[c], side).layer;
      maps.placed[c][at(side)] =
          place_elements(model, maps, solid, layer, shared < 0 ? layer.face : joint.shared_layers[at(shared)].face,
                         maps.layers[at(maps.layer_of[c][at(side)])].layer->mesh);
    }
  }
  leave_to_the_nearest(solid, maps);
  return maps;
}

InsideResults inside_results(const InsideMaps& maps, const Joint& joint, const SpringBeds& beds, const Equilibrium& e) {
  InsideResults results;
  ShownElements shown(maps.elements);
  results.contacts.resize(joint.contacts.size());
  std::vector<LookedInto> looked(maps.layers.size());
  parallel_for(looked.size(), [&](std::size_t k) { looked[k] = look_inside(maps.layers[k], beds.beds, e); });
  for (std::size_t c = 0; c < joint.contacts.size(); ++c)
    for (const int side : {0, 1}) {
      if (maps.layer_of[c][at(side)] < 0) continue;
      const auto k = at(maps.layer_of[c][at(side)]);
      const std::array<int, 2> own = {static_cast<int>(c), side};
      const auto use =
          std::find(maps.layers[k].uses.begin(), maps.layers[k].uses.end(), own) - maps.layers[k].uses.begin();
      const Layer& layer = joint.contacts[c].layers[side];
      const InsideElements& of = maps.placed[c][at(side)];
      results.contacts[c][at(side)] =
          side_results(layer, bed_layer(beds.beds[c], side), looked[k].inside,
                       looked[k].pressed.empty() ? std::vector<char>{} : looked[k].pressed[at(use)]);
      shown.show(of, states_inside(looked[k].inside, of.places), e.poses[at(layer.body)].rotation);
    }
  for (std::size_t d = 0; d < maps.domains.size(); ++d) {
    const std::ptrdiff_t from = maps.first[d], to = d + 1 < maps.first.size() ? maps.first[d + 1] : maps.elements;
    const auto part = [&](const std::vector<SymmetricTensor>& of) {
      return std::vector<SymmetricTensor>(of.begin() + from, of.begin() + to);
    };
    results.domains.push_back({maps.domains[d], part(shown.stress), part(shown.strain)});
  }
  return results;
}

namespace {

Finding side_finding(const JointModel& model, const ContactPair& pair, const Layer& layer, const InsideElements& of) {
  const Subject subject = {.contact = pair.name, .surface = model.surfaces[at(layer.surface)].name};
  if (of.all == 0) return {"inside-without-elements", subject};
  const std::string rows = of.most_rows == 0 ? ""
                           : of.fewest_rows == of.most_rows
                               ? fmt::format(" in {} row{}", of.most_rows, of.most_rows == 1 ? "" : "s")
                               : fmt::format(" in {} to {} rows", of.fewest_rows, of.most_rows);
  const int beside = of.all - static_cast<int>(of.element.size());
  return {"inside-elements",
          subject,
          {{"elements", of.element.size()},
           {"parts", of.parts},
           {"rows", rows},
           {"lowest", of.lowest},
           {"highest", of.highest},
           {"beside", beside}},
          beside == 0 ? 0 : 1};
}

}  // namespace

Findings inside_findings(const JointModel& model, const Joint& joint, const InsideMaps& maps) {
  Findings found;
  std::vector<char> used(at(maps.elements), 0);
  for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
    const ContactPair& pair = joint.contacts[c];
    if (!has_inside(pair) && presses_part(pair)) continue;
    if (!has_inside(pair)) {
      found.push_back({"inside-unknown", {.contact = pair.name}, {{"need", NamedSetting{"law", "", "layer"}}}});
      continue;
    }
    for (const int side : {0, 1}) {
      if (pair.layers[side].rigid) continue;
      found.push_back(side_finding(model, pair, pair.layers[side], maps.placed[c][at(side)]));
      for (int e : maps.placed[c][at(side)].element) used[at(e)] = 1;
    }
  }
  for (const SoftPart& part : joint.parts)
    for (const PartElement& of : part.elements) {
      const auto d = std::find(maps.domains.begin(), maps.domains.end(), of.domain) - maps.domains.begin();
      used[at(maps.first[at(d)] + of.place)] = 1;
    }
  const auto unused = std::count(used.begin(), used.end(), 0);
  if (unused > 0 && unused < maps.elements)
    found.push_back({"inside-unused", {}, {{"unused", unused}, {"elements", maps.elements}}});
  return found;
}

}  // namespace dea
