// views/map/draw_map.h – panels on paper: PNG, SVG or PDF, by Cairo. SVG and PDF are lines and areas, no
// bitmaps.
#pragma once
#include <string>

#include "views/map/map_figure.h"
#include "views/map/picture_format.h"

namespace dea {

constexpr double kUsualFontSize = 11.25;  // [pt]

struct PictureOptions {
  PictureFormat format = PictureFormat::Png;
  double width = 0.0;  ///< [mm]; 0: by the number of panels
  double dpi = 200.0;  ///< of PNG
  bool dark = false;
  int columns = 0;  ///< of panels; 0: by the figure, fewer where the width is too small for them
  double font_size = kUsualFontSize;
  bool text = false;  ///< SVG: letters as text, not as shapes
};

/// The file's bytes; the same for the same figure and fonts. Throws UsageError: too narrow, too many pixels.
std::string picture(const MapFigure& figure, const PictureOptions& options);
/// The same as pixels, those of a PNG. Figures of one animation have one size.
Image map_image(const MapFigure& figure, const PictureOptions& options);

// Which triangles of a panel have which colour, also for whoever draws the same with pens of his own.

/// Steps of colour: below what the eye tells apart.
inline constexpr int kBands = 128;
Rgb band_colour(ColourMap map, int band);

/// Colours of everything but the values.
struct Paper {
  Rgb background, text, faint, line, nothing, turned_away;
};
Paper paper(bool dark, ColourMap map);

/// Triangles of one layer of a panel.
struct PanelMasks {
  TriangleMask all;
  TriangleMask away;          ///< turned away from the viewer
  TriangleMask valued;        ///< filled by their value; a smooth figure: down to panel.edge only
  TriangleMask interpolated;  ///< all three corners have a value
};
PanelMasks panel_masks(const MapFigure& figure, const MapPanel& panel, int layer);

}  // namespace dea
