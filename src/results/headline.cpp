#include "src/results/headline.h"

#include <cmath>

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
  const std::vector<double> nodal = nodal_average(surface, pressure);
  const double above = kHeadlineShare * mean_pressure_of_load(nodal, nodal_areas(surface));
  if (std::isnan(above)) return {};
  const Distribution d = distribution(nodal, nodal_areas(surface, mask), above);
  return {above, d.p99, d.mean, d.area, d.peak};
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
