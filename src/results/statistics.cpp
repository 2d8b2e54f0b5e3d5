#include <febiodea/results/statistics.h>

#include <algorithm>
#include <numeric>

#include <febiodea/base/numbers.h>
#include <febiodea/results/percentile.h>

namespace dea {

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
    double force = 0.0;
    for (int i = 0; i < s.size(); ++i) {
      const auto k = at(i);
      if (s.area[k] <= 0) continue;
      ++stats.springs_hit;
      if (s.pressure[k] <= 0) continue;
      ++stats.springs_active;
      pressure.push_back(s.pressure[k]);
      area.push_back(s.area[k]);
      const double f = s.pressure[k] * s.area[k];
      moment += f * s.foot[k];
      force += f;
      stats.contact_area += s.area[k];
      stats.largest_strain = std::max(stats.largest_strain, s.strain[k]);
    }
    if (s.rates.rows() > 0) stats.complementarity = s.complementarity;
    const bool any = !pressure.empty();
    stats.peak = any ? *std::max_element(pressure.begin(), pressure.end()) : kNaN;
    stats.mean = any ? force / stats.contact_area : kNaN;
    set_percentiles(stats, pressure, area);
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
    all.push_back(stats);
  }
  return all;
}

double pressed_end_of_selection(const Layer& layer, const std::vector<double>& pressure, double above) {
  if (layer.face.mesh.size() == 0 || pressure.empty()) return 0.0;
  double length = 0.0;
  for (const SelectionEdge& e : selection_rim(layer.face)) {
    if (!e.goes_on || !(pressure[at(layer.articular.facet[at(e.edge.triangle)])] > above)) continue;
    const auto& x = layer.face.mesh.vertices;
    length += (x[at(e.vertices[0])] - x[at(e.vertices[1])]).norm();
  }
  return length;
}

}  // namespace dea
