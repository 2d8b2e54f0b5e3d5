// views/map/picture_format.h – what a picture's file is.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace dea {

enum class PictureFormat { Png, Svg, Pdf };

/// By the ending of the file's name. Throws UsageError in the name of the option, "-o".
PictureFormat picture_format(const std::string& option, const std::string& path);

/// A picture as pixels: sRGB of 8 bits, row by row from the top, three bytes a pixel.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

}  // namespace dea
