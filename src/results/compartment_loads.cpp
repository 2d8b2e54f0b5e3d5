#include "src/results/compartment_loads.h"

#include "src/base/numbers.h"
#include "src/geometry/ray_caster.h"

namespace dea {

namespace {

/// Which compartment of one side is nearest to a point of space, in a state.
struct NearestCompartment {
  const RayCaster& surface;  // articular, reference frame
  const Compartments& compartments;
  const Pose& pose;
  const Vector3d& center;  // of mass, reference frame
  int operator()(const Vector3d& x) const {
    const Vector3d reference = pose.rotation.transpose() * (x - pose.center) + center;
    return compartments.of_triangle[at(surface.closest(reference).triangle)];
  }
};

/// Per facet of the source's surface: its compartment.
std::vector<int> compartments_of_facets(const Joint& joint, const ContactPair& pair, const Equilibrium& e,
                                        const ResultSurface& surface, const NearestCompartment& nearest) {
  const Layer& source = pair.source_layer();
  std::vector<int> of_facet(at(surface.facets()), -1);
  if (&nearest.compartments == &source.compartments)
    for (int t = 0; t < source.articular.size(); ++t)
      of_facet[at(source.articular.facet[at(t)])] = source.compartments.of_triangle[at(t)];
  const Pose& pose = e.poses[at(source.body)];
  for (int f = 0; f < surface.facets(); ++f)
    if (of_facet[at(f)] < 0)
      of_facet[at(f)] = nearest(
          pose.center + pose.rotation * (surface.facet_centers[at(f)] - joint.bodies[at(source.body)].center_of_mass));
  return of_facet;
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

std::vector<CompartmentLoad> compartment_loads(const Joint& joint, const SpringBeds& beds, const FieldMaps& maps,
                                               const Equilibrium& e, const ContactFields& fields, std::size_t contact) {
  const ContactPair& pair = joint.contacts[contact];
  const int side = compartment_side(pair);
  if (side < 0) return {};
  const Layer& layer = pair.layers[side];
  const FieldMaps::ContactMap& map = maps.contacts[contact];
  const NearestCompartment nearest{map.articular[side], layer.compartments, e.poses[at(layer.body)],
                                   joint.bodies[at(layer.body)].center_of_mass};
  std::vector<CompartmentLoad> loads(at(layer.compartments.size()));
  std::vector<double> sum(loads.size(), 0.0);
  std::vector<Vector3d> moment(loads.size(), Vector3d::Zero());
  const SpringStates& s = e.springs[contact];
  const Springs& springs = beds.beds[contact].springs;
  const bool on_articular = layer.springs_at == SpringsAt::Articular;
  for (int i = 0; i < s.size(); ++i) {
    const double f = s.pressure[at(i)] * s.area[at(i)];
    if (!(f > 0)) continue;
    const int triangle = !on_articular ? -1 : side == pair.source ? springs.surface_triangle[at(i)] : s.triangle[at(i)];
    const int c = triangle >= 0 ? layer.compartments.of_triangle[at(triangle)] : nearest(s.foot[at(i)]);
    loads[at(c)].force += f * s.direction[at(i)];
    moment[at(c)] += f * s.foot[at(i)];
    sum[at(c)] += f;
  }
  const std::vector<int> of_facet = compartments_of_facets(joint, pair, e, map.plotted, nearest);
  const std::vector<double> pressure = plotted_values(fields.sides[pair.source].pressure);
  for (std::size_t c = 0; c < loads.size(); ++c) {
    if (sum[c] > 0) loads[c].center_of_pressure = moment[c] / sum[c];
    FacetMask mask;
    for (int of : of_facet) mask.push_back(of == static_cast<int>(c));
    loads[c].headline = headline(map.plotted, pressure, mask);
  }
  return loads;
}

}  // namespace dea
