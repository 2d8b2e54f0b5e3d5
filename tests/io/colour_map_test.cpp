// The colour maps: what they promise to the eye, and to eyes without red or green cones.
#include "views/map/colour_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace dea::colour_map_test {

double difference(const Rgb& x, const Rgb& y) {
  const OkLab a = oklab(x), b = oklab(y);
  return std::hypot(a.L - b.L, a.a - b.a, a.b - b.b);
}

double linear(double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); }
double gamma(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
}

enum class Eye { Normal, Protanope, Deuteranope };

/// What a dichromat sees: F. Vienot, H. Brettel, J. D. Mollon (1999), Digital video colourmaps for checking the
/// legibility of displays by dichromats, Color Res. Appl. 24: 243-252.
Rgb seen(const Rgb& c, Eye eye) {
  if (eye == Eye::Normal) return c;
  const bool protan = eye == Eye::Protanope;
  const double scale = protan ? 0.992052 : 0.957237, offset = protan ? 0.003974 : 0.0213814;
  const double r = scale * linear(c.r) + offset, g = scale * linear(c.g) + offset, b = scale * linear(c.b) + offset;
  double l = 17.8824 * r + 43.5161 * g + 4.11935 * b;
  double m = 3.45565 * r + 27.1554 * g + 3.86714 * b;
  const double s = 0.0299566 * r + 0.184309 * g + 1.46709 * b;
  if (protan)
    l = 2.02344 * m - 2.52581 * s;
  else
    m = 0.494207 * l + 1.24827 * s;
  return {gamma(0.080944 * l - 0.130504 * m + 0.116721 * s), gamma(-0.0102485 * l + 0.0540194 * m - 0.113615 * s),
          gamma(-0.000365294 * l - 0.00412163 * m + 0.693513 * s)};
}

std::vector<Rgb> samples(ColourMap map, int n, Eye eye = Eye::Normal) {
  std::vector<Rgb> out;
  for (int i = 0; i <= n; ++i) out.push_back(seen(colour(map, static_cast<double>(i) / n), eye));
  return out;
}

TEST(ColourMap, OkLabOfKnownColours) {
  // Ottosson 2020: white is L = 1 without chroma; red as in the CSS Color 4 specification.
  EXPECT_NEAR(oklab({1, 1, 1}).L, 1.0, 1e-6);
  EXPECT_NEAR(oklab({1, 1, 1}).a, 0.0, 1e-6);
  EXPECT_NEAR(oklab({1, 1, 1}).b, 0.0, 1e-6);
  EXPECT_NEAR(oklab({1, 0, 0}).L, 0.6280, 1e-4);
  EXPECT_NEAR(oklab({1, 0, 0}).a, 0.2249, 1e-4);
  EXPECT_NEAR(oklab({1, 0, 0}).b, 0.1258, 1e-4);
  for (const Rgb& c : {Rgb{0.1, 0.5, 0.9}, Rgb{0.7, 0.02, 0.3}, Rgb{0, 0, 0}})
    EXPECT_NEAR(difference(srgb(oklab(c)), c), 0.0, 1e-6);
}

TEST(ColourMap, SequentialGetsLighterForEveryEye) {
  for (Eye eye : {Eye::Normal, Eye::Protanope, Eye::Deuteranope}) {
    const std::vector<Rgb> c = samples(ColourMap::Sequential, 64, eye);
    for (std::size_t i = 1; i < c.size(); ++i)
      EXPECT_GT(oklab(c[i]).L - oklab(c[i - 1]).L, 0.5 / 64 * (oklab(c[64]).L - oklab(c[0]).L)) << i;
    EXPECT_GT(oklab(c.back()).L - oklab(c.front()).L, 0.6);
  }
}

TEST(ColourMap, EverySequentialMapGetsLighterAllTheWay) {
  for (ColourMap map : {ColourMap::Sequential, ColourMap::Viridis, ColourMap::Cividis, ColourMap::Gray}) {
    // as they are drawn, in 128 steps; cividis is made for eyes without red or green cones
    const std::vector<Rgb> c = samples(map, 128);
    for (std::size_t i = 1; i < c.size(); ++i)
      EXPECT_GT(oklab(c[i]).L, oklab(c[i - 1]).L) << static_cast<int>(map) << " " << i;
    EXPECT_GT(oklab(c.back()).L - oklab(c.front()).L, 0.5);
    EXPECT_FALSE(is_diverging(map));
  }
  for (Eye eye : {Eye::Protanope, Eye::Deuteranope}) {
    const std::vector<Rgb> c = samples(ColourMap::Cividis, 64, eye);
    for (std::size_t i = 1; i < c.size(); ++i) EXPECT_GT(oklab(c[i]).L, oklab(c[i - 1]).L) << i;
  }
}

TEST(ColourMap, NamesAreMatplotlibs) {
  // matplotlib 3: ends and the entry 128 of 256 of viridis, cividis and gray.
  struct Known {
    const char *name, *first, *middle, *last;
  };
  for (const Known& k :
       {Known{"viridis", "#440154", "#21918c", "#fde725"}, Known{"cividis", "#00224e", "#7d7c78", "#fee838"},
        Known{"gray", "#000000", "#808080", "#ffffff"}, Known{"grey", "#000000", "#808080", "#ffffff"}}) {
    const std::optional<ColourMap> map = colour_map_named(k.name);
    ASSERT_TRUE(map) << k.name;
    EXPECT_EQ(hex(colour(*map, 0)), k.first);
    EXPECT_EQ(hex(colour(*map, 128.0 / 255)), k.middle);
    EXPECT_EQ(hex(colour(*map, 1)), k.last);
  }
  EXPECT_EQ(colour_map_named("dea"), ColourMap::Sequential);
  EXPECT_EQ(colour_map_named("blue-white-red"), ColourMap::Diverging);
  EXPECT_FALSE(colour_map_named("jet"));
  EXPECT_EQ(colour_map_names().size(), 5u);
}

TEST(ColourMap, DivergingIsSymmetricInLightness) {
  for (int i = 0; i <= 50; ++i) {
    const OkLab low = oklab(colour(ColourMap::Diverging, 0.5 - 0.01 * i));
    const OkLab high = oklab(colour(ColourMap::Diverging, 0.5 + 0.01 * i));
    EXPECT_NEAR(low.L, high.L, 1e-6) << i;
    EXPECT_NEAR(std::hypot(low.a, low.b), std::hypot(high.a, high.b), 1e-6) << i;
    if (i > 0) {
      EXPECT_LT(high.L, oklab(colour(ColourMap::Diverging, 0.5 + 0.01 * (i - 1))).L) << i;
    }
  }
  const OkLab middle = oklab(colour(ColourMap::Diverging, 0.5));
  EXPECT_NEAR(std::hypot(middle.a, middle.b), 0.0, 1e-6);
}

TEST(ColourMap, EqualStepsLookEqual) {
  // A chord of 1/128 of the map is shorter than its arc by less than 1 %, and nothing may be cut at the edge of sRGB.
  for (ColourMap map : {ColourMap::Sequential, ColourMap::Diverging}) {
    const std::vector<Rgb> c = samples(map, 128);
    std::vector<double> steps;
    for (std::size_t i = 1; i < c.size(); ++i) steps.push_back(difference(c[i - 1], c[i]));
    const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
    EXPECT_LT(*most / *least, 1.01);
    EXPECT_GT(*least, 0.004);
  }
}

TEST(ColourMap, DivergingHalvesDifferForEveryEye) {
  // 0.02 is about the least difference one sees in OKLab; the halves must differ far more, and each stay in order.
  for (Eye eye : {Eye::Normal, Eye::Protanope, Eye::Deuteranope}) {
    const std::vector<Rgb> c = samples(ColourMap::Diverging, 64, eye);
    for (std::size_t i = 8; i <= 32; ++i) EXPECT_GT(difference(c[32 - i], c[32 + i]), 0.06) << i;
    for (std::size_t i = 1; i <= 32; ++i) {
      EXPECT_LT(oklab(c[32 + i]).L, oklab(c[32 + i - 1]).L) << i;
      EXPECT_LT(oklab(c[32 - i]).L, oklab(c[32 - i + 1]).L) << i;
    }
  }
}

TEST(ColourMap, BytesAreTheMapRounded) {
  for (ColourMap map :
       {ColourMap::Sequential, ColourMap::Diverging, ColourMap::Viridis, ColourMap::Cividis, ColourMap::Gray}) {
    for (int i = 0; i < 256; ++i) {
      const Rgb c = colour(map, i / 255.0);
      EXPECT_NEAR(bytes(c)[0], 255 * c.r, 0.5 + 1e-9);
      EXPECT_NEAR(bytes(c)[1], 255 * c.g, 0.5 + 1e-9);
      EXPECT_NEAR(bytes(c)[2], 255 * c.b, 0.5 + 1e-9);
    }
    EXPECT_EQ(colour(map, -3), colour(map, 0));
    EXPECT_EQ(colour(map, 7), colour(map, 1));
  }
  EXPECT_EQ(hex({0, 1, 0.5}), "#00ff80");
}

}  // namespace dea::colour_map_test
