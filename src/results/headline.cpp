#include "src/results/headline.h"

#include <cmath>

#include "src/results/within_facets.h"

namespace dea {

namespace {

double plotted(double x) { return std::isfinite(x) ? static_cast<double>(static_cast<float>(x)) : 0.0; }

/// Sum of A p^2 over sum of A p, where p > 0: every place counts by the force it carries. NaN: no pressure.
double mean_pressure_of_load(const std::vector<double>& pressure, const std::vector<double>& areas) {
  double force = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < pressure.size(); ++i) {
    if (!(pressure[i] > 0)) continue;
    force += areas[i] * pressure[i];
    sum += areas[i] * pressure[i] * pressure[i];
  }
  return force > 0 ? sum / force : kNaN;
}

}  // namespace

Headline headline(const ResultSurface& surface, const std::vector<double>& pressure, const FacetMask& mask) {
  Headline h;
  h.above = kHeadlineShare * mean_pressure_of_load(pressure, surface.facet_areas);
  if (std::isnan(h.above)) return h;
  const std::vector<PressedPart> parts = pressed_parts(surface, pressure, h.above);
  const std::vector<double> areas = facet_areas(surface, mask);
  double force = 0.0;
  for (std::size_t f = 0; f < parts.size(); ++f) {
    h.area += areas[f] * parts[f].share;
    force += areas[f] * parts[f].pressure;
  }
  if (!(h.area > 0)) return h;
  h.mean = force / h.area;
  const Distribution nodes = distribution(nodal_average(surface, pressure), nodal_areas(surface, mask), h.above);
  h.p99 = std::fmax(nodes.p99, h.mean);
  h.peak = std::fmax(nodes.peak, h.mean);
  return h;
}

ResultSurface plotted_surface(const JointModel& model, const Surface& surface) {
  std::vector<Vector3d> positions = model.nodes;
  for (Vector3d& x : positions) x = Vector3d(plotted(x[0]), plotted(x[1]), plotted(x[2]));
  return make_result_surface(surface.name, surface.begin, surface.nodes, positions);
}

std::vector<double> plotted_values(std::vector<double> values) {
  for (double& x : values) x = plotted(x);
  return values;
}

}  // namespace dea
