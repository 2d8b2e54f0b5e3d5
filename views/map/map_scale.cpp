#include "views/map/map_scale.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/base/numbers.h"

namespace dea {

bool is_pressure(const std::string& field) {
  return field == "contact pressure" || field.rfind("contact pressure ", 0) == 0 || field == "nodal contact pressure" ||
         field.rfind("peak pressure", 0) == 0;
}

bool is_stress(const std::string& field) { return field.rfind("max shear stress", 0) == 0; }

bool is_difference(const std::string& field) { return field.find("difference") != std::string::npos; }

bool zero_without_contact(const std::string& field) {
  return is_pressure(field) || is_stress(field) || is_difference(field) || field.find("overlap") != std::string::npos ||
         field.find("strain") != std::string::npos;
}

MapValues map_values(const ResultSurface& surface, const std::string& field, std::vector<double> facets) {
  MapValues v;
  const bool zero_counts = zero_without_contact(field);
  bool gaps = false;
  std::vector<double> there, filled;
  for (double& x : facets) {
    if (!std::isfinite(x) || (x == 0 && !zero_counts)) x = kNaN;
    const bool gap = std::isnan(x);
    gaps = gaps || gap;
    there.push_back(gap ? 0.0 : 1.0);
    filled.push_back(gap ? 0.0 : x);
  }
  v.facets = std::move(facets);
  v.vertices = nodal_average(surface, filled);
  if (!gaps && zero_counts) return v;
  const std::vector<double> share = nodal_average(surface, there);
  for (std::size_t i = 0; i < share.size(); ++i) v.vertices[i] = share[i] > 0 ? v.vertices[i] / share[i] : kNaN;
  return v;
}

void ValueRange::add(double x) {
  if (!std::isfinite(x)) return;
  least = std::min(least, x);
  most = std::max(most, x);
}

void ValueRange::add(const std::vector<double>& values) {
  for (double x : values) add(x);
}

void ValueRange::add(const ValueRange& other) {
  least = std::min(least, other.least);
  most = std::max(most, other.most);
}

void add_areas(const ResultSurface& surface, const std::vector<double>& facets,
               std::vector<std::pair<double, double>>& found) {
  for (std::size_t f = 0; f < facets.size(); ++f)
    if (facets[f] != 0 && std::isfinite(facets[f])) found.push_back({facets[f], surface.facet_areas[f]});
}

double most_of_area_below(std::vector<std::pair<double, double>> found) {
  std::sort(found.begin(), found.end());
  double area = 0.0, below = 0.0;
  for (const auto& f : found) area += f.second;
  for (const auto& f : found) {
    below += f.second;
    if (below >= 0.95 * area) return f.first;
  }
  return 0.0;
}

MapScale map_scale(const ScaleKind& kind, const ValueRange& range) {
  const double least = range.least, most = range.most;
  const bool sequential = !is_diverging(kind.map), zero = least == 0 && most == 0;
  MapScale s;
  s.empty = range.empty() || (zero && sequential);
  if (s.empty) {
    s.low = kind.low.value_or(0.0);
    s.high = kind.high.value_or(s.low + 1.0);
  } else if (!sequential) {
    s.high = kind.high.value_or(zero ? 1.0 : std::max(std::abs(least), std::abs(most)));
    s.low = -s.high;
  } else {
    s.high = kind.high.value_or(kind.usual > 0 && kind.usual > kind.low.value_or(0.0) ? kind.usual : most);
    s.low = kind.low.value_or(least < 0 || (!kind.pressure && least > 0.5 * most) ? least : 0.0);
    if (!(s.high > s.low) && !kind.low) s.low = std::min(0.0, 2.0 * s.high);
    if (!(s.high > s.low) && !kind.high) s.high = s.low + 1.0;
  }
  // Two ends that differ in the last digits only are one; and rounding of a constant field is no pattern.
  if (!kind.low && sequential && s.high - s.low < 1e-5 * std::max(std::abs(s.low), std::abs(s.high)))
    s.low = std::min(0.0, 2.0 * s.high);
  if (s.high > s.low) s.step = scale_step(s.low, s.high);
  return s;
}

double scale_step(double low, double high) {
  const double raw = (high - low) / kScaleSteps, power = std::pow(10.0, std::floor(std::log10(raw)));
  for (double m : kScaleMultiples)
    if (m * power >= raw * (1 - 1e-9)) return m * power;
  return kScaleMultiples.back() * power;
}

std::vector<double> scale_ticks(const MapScale& s) {
  std::vector<double> ticks;
  const double first = std::ceil(s.low / s.step - 1e-6);
  for (int k = 0; k <= 2 * kScaleSteps && (first + k) * s.step <= s.high + 1e-6 * s.step; ++k)
    ticks.push_back((first + k) * s.step + 0.0);
  return ticks;
}

std::vector<double> scale_lines(const MapScale& s, ColourMap map) {
  std::vector<double> lines;
  const double margin = 1e-6 * s.step;
  for (double t : scale_ticks(s))
    if (t > s.low + margin && t < s.high - margin && (t != 0 || !is_diverging(map))) lines.push_back(t);
  return lines;
}

bool white_line(const Rgb& under) { return oklab(under).L < 0.62; }

}  // namespace dea
