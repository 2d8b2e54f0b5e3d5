// views/map/colour_map.h – numbers as colours: equal steps of the number are equal steps of what the eye sees.
//
// Sequential and Diverging are curves in OKLab (B. Ottosson 2020, "A perceptual color space for image processing"), in
// which distances are those the eye sees, passed through at constant speed. They stay in order for readers with red or
// green blindness.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dea {

/// Sequential: dark violet, blue, green, yellow; lightness rises all the way. For values from 0 upwards.
/// Diverging: blue, near white, red; equally light at equal distances from the middle. For differences, 0 in the
/// middle.
/// Viridis, Cividis, Gray: sequential too, from dark to light, as matplotlib has them.
enum class ColourMap { Sequential, Diverging, Viridis, Cividis, Gray };

/// Has a middle, from which values go to both sides.
inline bool is_diverging(ColourMap map) { return map == ColourMap::Diverging; }

/// Names for users: dea, viridis, cividis, gray, blue-white-red. "grey" is gray too.
std::vector<std::string> colour_map_names();
std::optional<ColourMap> colour_map_named(const std::string& name);

/// sRGB, 0 .. 1 each.
struct Rgb {
  double r = 0.0, g = 0.0, b = 0.0;
  bool operator==(const Rgb&) const = default;
};

/// Colour of a fraction 0 .. 1 of the scale; beyond it that of the nearer end. The fraction must not be NaN.
Rgb colour(ColourMap map, double fraction);

using ByteColour = std::array<std::uint8_t, 3>;
ByteColour bytes(const Rgb& colour);
/// "#1f9e89"
std::string hex(const Rgb& colour);

/// Lightness L (0 black .. 1 white) and the opponent axes a (green to red), b (blue to yellow) of an sRGB colour.
struct OkLab {
  double L = 0.0, a = 0.0, b = 0.0;
};
OkLab oklab(const Rgb& colour);
/// Channels beyond what sRGB can show are cut to 0 .. 1.
Rgb srgb(const OkLab& colour);

}  // namespace dea
