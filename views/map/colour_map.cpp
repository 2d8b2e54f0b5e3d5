#include "views/map/colour_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "src/base/numbers.h"
#include "views/map/known_maps.h"

namespace dea {

namespace {

double to_linear(double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); }
double from_linear(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055; }

/// Lightness, chroma, hue [degrees]: how one thinks of a colour when choosing it.
struct LightnessChromaHue {
  double L, C, h;
};

OkLab lab(const LightnessChromaHue& x) {
  return {x.L, x.C * std::cos(x.h * kPi / 180.0), x.C * std::sin(x.h * kPi / 180.0)};
}

double distance(const OkLab& x, const OkLab& y) { return std::hypot(x.L - y.L, x.a - y.a, x.b - y.b); }

OkLab along(const OkLab& x, const OkLab& y, double t) {
  return {x.L + t * (y.L - x.L), x.a + t * (y.a - x.a), x.b + t * (y.b - x.b)};
}

/// Catmull and Rom's spline from p[1] to p[2].
OkLab spline(const std::array<OkLab, 4>& p, double t) {
  const auto one = [t](double a, double b, double c, double d) {
    return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
  };
  return {one(p[0].L, p[1].L, p[2].L, p[3].L), one(p[0].a, p[1].a, p[2].a, p[3].a),
          one(p[0].b, p[1].b, p[2].b, p[3].b)};
}

/// A smooth curve through points, with the length passed so far.
struct Curve {
  std::vector<OkLab> points;
  std::vector<double> length;
};

Curve curve_through(const std::vector<LightnessChromaHue>& knots) {
  constexpr int kPieces = 200;  // per knot; chords of a thousandth of the map's length
  std::vector<OkLab> p;
  for (const LightnessChromaHue& knot : knots) p.push_back(lab(knot));
  p.insert(p.begin(), along(p[0], p[1], -1.0));
  p.push_back(along(p[p.size() - 1], p[p.size() - 2], -1.0));
  Curve curve;
  for (std::size_t k = 1; k + 2 < p.size(); ++k)
    for (int i = k == 1 ? 0 : 1; i <= kPieces; ++i)
      curve.points.push_back(spline({p[k - 1], p[k], p[k + 1], p[k + 2]}, static_cast<double>(i) / kPieces));
  curve.length = {0.0};
  for (std::size_t i = 1; i < curve.points.size(); ++i)
    curve.length.push_back(curve.length.back() + distance(curve.points[i - 1], curve.points[i]));
  return curve;
}

OkLab at_fraction(const Curve& curve, double fraction) {
  const double s = fraction * curve.length.back();
  const auto after = std::lower_bound(curve.length.begin() + 1, curve.length.end() - 1, s);
  const std::size_t i = static_cast<std::size_t>(after - curve.length.begin());
  const double t = (s - curve.length[i - 1]) / (curve.length[i] - curve.length[i - 1]);
  return along(curve.points[i - 1], curve.points[i], t);
}

const Curve& sequential() {
  static const Curve curve = curve_through({{0.26, 0.105, 303},
                                            {0.38, 0.140, 283},
                                            {0.49, 0.115, 252},
                                            {0.59, 0.095, 215},
                                            {0.69, 0.120, 172},
                                            {0.79, 0.165, 142},
                                            {0.87, 0.170, 121},
                                            {0.945, 0.145, 105}});
  return curve;
}

/// From the middle of the diverging map to one end. Both arms have the same lightness and chroma, so steps are equal.
Curve arm(double hue) {
  return curve_through(
      {{0.955, 0.0, hue}, {0.83, 0.062, hue}, {0.68, 0.115, hue}, {0.53, 0.140, hue}, {0.40, 0.115, hue}});
}

/// Between the entries of a table of 256 colours of six digits.
Rgb of_table(const char* table, double fraction) {
  const auto channel = [&](std::size_t entry, std::size_t k) {
    const char digits[] = {table[6 * entry + 2 * k], table[6 * entry + 2 * k + 1], '\0'};
    return static_cast<double>(std::strtol(digits, nullptr, 16)) / 255.0;
  };
  const std::size_t i = std::min<std::size_t>(254, static_cast<std::size_t>(255 * fraction));
  const double t = 255 * fraction - static_cast<double>(i);
  const auto mixed = [&](std::size_t k) { return (1 - t) * channel(i, k) + t * channel(i + 1, k); };
  return {mixed(0), mixed(1), mixed(2)};
}

struct NamedMap {
  const char* name;
  ColourMap map;
};
constexpr NamedMap kNamedMaps[] = {{"dea", ColourMap::Sequential},
                                   {"viridis", ColourMap::Viridis},
                                   {"cividis", ColourMap::Cividis},
                                   {"gray", ColourMap::Gray},
                                   {"blue-white-red", ColourMap::Diverging}};

}  // namespace

std::vector<std::string> colour_map_names() {
  std::vector<std::string> names;
  for (const NamedMap& m : kNamedMaps) names.emplace_back(m.name);
  return names;
}

std::optional<ColourMap> colour_map_named(const std::string& name) {
  for (const NamedMap& m : kNamedMaps)
    if (name == m.name || (m.map == ColourMap::Gray && name == "grey")) return m.map;
  return std::nullopt;
}

OkLab oklab(const Rgb& colour) {
  const double r = to_linear(colour.r), g = to_linear(colour.g), b = to_linear(colour.b);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

Rgb srgb(const OkLab& x) {
  const auto cube = [](double v) { return v * v * v; };
  const double l = cube(x.L + 0.3963377774 * x.a + 0.2158037573 * x.b);
  const double m = cube(x.L - 0.1055613458 * x.a - 0.0638541728 * x.b);
  const double s = cube(x.L - 0.0894841775 * x.a - 1.2914855480 * x.b);
  const auto channel = [](double v) { return from_linear(std::clamp(v, 0.0, 1.0)); };
  return {channel(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          channel(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          channel(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

Rgb colour(ColourMap map, double fraction) {
  assert(!std::isnan(fraction));
  const double f = std::clamp(fraction, 0.0, 1.0);
  if (map == ColourMap::Sequential) return srgb(at_fraction(sequential(), f));
  if (map == ColourMap::Viridis) return of_table(kViridisTable, f);
  if (map == ColourMap::Cividis) return of_table(kCividisTable, f);
  if (map == ColourMap::Gray) return {f, f, f};
  static const Curve below = arm(256), above = arm(34);
  return srgb(at_fraction(f < 0.5 ? below : above, std::abs(2.0 * f - 1.0)));
}

ByteColour bytes(const Rgb& c) {
  const auto byte = [](double x) { return static_cast<std::uint8_t>(std::lround(255 * x)); };
  return {byte(c.r), byte(c.g), byte(c.b)};
}

std::string hex(const Rgb& c) { return fmt::format("#{:02x}", fmt::join(bytes(c), "")); }

}  // namespace dea
