// views/map/svg_text.h – letters of an SVG that are text.
#pragma once
#include <string>

#include "views/map/colour_map.h"

namespace dea {

struct SvgText {
  Rgb colour;
  double alpha = 1.0, size = 10.0;
  bool bold = false;
};
/// The element <text>. `place`: its attributes x and y, or transform. `more`: others, each with a blank before it.
std::string svg_text(const SvgText& look, const std::string& place, const std::string& text,
                     const std::string& more = "");
/// The attributes of a seam around the letters.
std::string svg_seam(const Rgb& paper);

}  // namespace dea
