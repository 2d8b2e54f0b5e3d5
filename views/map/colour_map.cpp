#include "views/map/colour_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "src/base/numbers.h"

namespace dea {

namespace {

// Maps that users know by name, in 256 colours of 8 bits as matplotlib has them.
// viridis: N. Smith, S. van der Walt, E. Firing (2015), CC0. cividis: J. R. Nunez, C. R. Anderton, R. S. Renslow
// (2018), Optimizing colormaps with consideration for color vision deficiency to enable accurate interpretation of
// scientific data, PLoS ONE 13: e0199239; the table is matplotlib's.
constexpr char kViridisTable[] =
    "44015444025645045745055946075a46085c460a5d460b5e470d60470e6147106347116447136548146748166848176948186a481a6c"
    "481b6d481c6e481d6f481f70482071482173482374482475482576482677482878482979472a7a472c7a472d7b472e7c472f7d46307e"
    "46327e46337f463480453581453781453882443983443a83443b84433d84433e85423f85424086424186414287414487404588404688"
    "3f47883f48893e49893e4a893e4c8a3d4d8a3d4e8a3c4f8a3c508b3b518b3b528b3a538b3a548c39558c39568c38588c38598c375a8c"
    "375b8d365c8d365d8d355e8d355f8d34608d34618d33628d33638d32648e32658e31668e31678e31688e30698e306a8e2f6b8e2f6c8e"
    "2e6d8e2e6e8e2e6f8e2d708e2d718e2c718e2c728e2c738e2b748e2b758e2a768e2a778e2a788e29798e297a8e297b8e287c8e287d8e"
    "277e8e277f8e27808e26818e26828e26828e25838e25848e25858e24868e24878e23888e23898e238a8d228b8d228c8d228d8d218e8d"
    "218f8d21908d21918c20928c20928c20938c1f948c1f958b1f968b1f978b1f988b1f998a1f9a8a1e9b8a1e9c891e9d891f9e891f9f88"
    "1fa0881fa1881fa1871fa28720a38620a48621a58521a68522a78522a88423a98324aa8325ab8225ac8226ad8127ad8128ae8029af7f"
    "2ab07f2cb17e2db27d2eb37c2fb47c31b57b32b67a34b67935b77937b87838b9773aba763bbb753dbc743fbc7340bd7242be7144bf70"
    "46c06f48c16e4ac16d4cc26c4ec36b50c46a52c56954c56856c66758c7655ac8645cc8635ec96260ca6063cb5f65cb5e67cc5c69cd5b"
    "6ccd5a6ece5870cf5773d05675d05477d1537ad1517cd2507fd34e81d34d84d44b86d54989d5488bd6468ed64590d74393d74195d840"
    "98d83e9bd93c9dd93ba0da39a2da37a5db36a8db34aadc32addc30b0dd2fb2dd2db5de2bb8de29bade28bddf26c0df25c2df23c5e021"
    "c8e020cae11fcde11dd0e11cd2e21bd5e21ad8e219dae319dde318dfe318e2e418e5e419e7e419eae51aece51befe51cf1e51df4e61e"
    "f6e620f8e621fbe723fde725";

constexpr char kCividisTable[] =
    "00224e00234f00245100255300255400265600275800285900285b00295d002a5f002a61002b62002c64002c66002d68002e6a002e6c"
    "002f6d00306f0030700031700031710132710533710833700c34700f357012357014367016377018376f1a386f1c396f1e3a6f203a6f"
    "213b6e233c6e243c6e263d6e273e6e293f6e2a3f6d2b406d2d416d2e416d2f426d31436d32436d33446d34456c35456c36466c38476c"
    "39486c3a486c3b496c3c4a6c3d4a6c3e4b6c3f4c6c404c6c414d6c424e6c434e6c444f6c45506c46516c47516c48526c49536c4a536c"
    "4b546c4c556c4d556c4e566c4f576c50576c51586d52596d535a6d545a6d555b6d555c6d565c6d575d6d585e6d595e6e5a5f6e5b606e"
    "5c616e5d616e5e626e5e636f5f636f60646f61656f62656f636670646770656870656870666970676a71686a71696b716a6c716b6d72"
    "6c6d726c6e726d6f726e6f736f70737071737172747272747273747374757474757575757676767777767777777878777979777a7a78"
    "7b7a787c7b787d7c787e7c787e7d787f7e78807f78817f788280798381798482798582798683798784788885788985788a86788b8778"
    "8c88788d88788e89788f8a78908b78918b78928c78928d78938e78948e77958f779690779791779892779992779a93769b94769c9576"
    "9d95769e96769f9775a09875a19975a29975a39a74a49b74a59c74a69c74a79d73a89e73a99f73aaa073aba072aca172ada272aea371"
    "afa471b0a571b1a570b3a670b4a76fb5a86fb6a96fb7a96eb8aa6eb9ab6dbaac6dbbad6dbcae6cbdae6cbeaf6bbfb06bc0b16ac1b26a"
    "c2b369c3b369c4b468c5b568c6b667c7b767c8b866c9b965cbb965ccba64cdbb63cebc63cfbd62d0be62d1bf61d2c060d3c05fd4c15f"
    "d5c25ed6c35dd7c45cd9c55cdac65bdbc75adcc859ddc858dec958dfca57e0cb56e1cc55e2cd54e4ce53e5cf52e6d051e7d150e8d24f"
    "e9d34eead34cebd44bedd54aeed649efd748f0d846f1d945f2da44f3db42f5dc41f6dd3ff7de3ef8df3cf9e03afbe138fce236fde334"
    "fee434fee535fee636fee838";

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
