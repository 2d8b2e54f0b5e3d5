// views/map/map_paint.h – which triangles of a panel have which colour. For pictures (`draw_map.h`) and for
// whoever draws the same with pens of his own.
#pragma once
#include <vector>

#include "views/map/map_figure.h"

namespace dea {

/// Steps of colour: below what the eye tells apart.
inline constexpr int kBands = 128;
/// The step that a value lies in; beyond the scale the nearer end. The value must not be NaN.
int band(const MapFigure& figure, double value);
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
