// views/map/picture_format.h – what a picture's file is.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace dea {

enum class PictureFormat { Png, Svg, Pdf };

/// False: this program is linked without Cairo, and draws SVG alone.
bool draws_pixels();
/// Of a file that nobody names: ".png", or ".svg".
inline const char* picture_ending() { return draws_pixels() ? ".png" : ".svg"; }
inline constexpr const char* kSvgAlone =
    "this program draws SVG alone; PNG, PDF, GIF and MP4 need dea as built on Debian";

/// By the ending of the file's name. Throws UsageError in the name of the option, "-o".
PictureFormat picture_format(const std::string& option, const std::string& path);

/// A picture as pixels: sRGB of 8 bits, row by row from the top, three bytes a pixel.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

}  // namespace dea
