#include "views/map/map_paint.h"

#include <algorithm>
#include <cmath>

#include "src/base/numbers.h"

namespace dea {

int band(const MapFigure& figure, double value) {
  const double f = (value - figure.low) / (figure.high - figure.low);
  return std::clamp(static_cast<int>(std::floor(f * kBands)), 0, kBands - 1);
}

Rgb band_colour(ColourMap map, int band) { return colour(map, (band + 0.5) / kBands); }

Paper paper(bool dark, ColourMap map) {
  const auto grey = [](double x) { return Rgb{x, x, x + 0.012}; };
  const bool middle = is_diverging(map);
  const double nothing = dark ? (middle ? 0.24 : 0.36) : (middle ? 0.72 : 0.89);
  Paper p = dark ? Paper{{0.051, 0.067, 0.09}, grey(0.92), grey(0.66), grey(0.75), grey(nothing), grey(nothing - 0.1)}
                 : Paper{{1, 1, 1}, grey(0.08), grey(0.35), grey(0.3), grey(nothing), grey(nothing - 0.12)};
  if (map == ColourMap::Gray) {  // grey is a value
    p.nothing = dark ? Rgb{0.15, 0.21, 0.32} : Rgb{0.80, 0.87, 0.96};
    p.turned_away = dark ? Rgb{0.10, 0.15, 0.24} : Rgb{0.69, 0.77, 0.89};
  }
  return p;
}

PanelMasks panel_masks(const MapFigure& figure, const MapPanel& panel, int layer) {
  const MapSurface& s = figure.surfaces[at(panel.surface)];
  PanelMasks masks;
  masks.all = layer_triangles(s.mesh, s.projection, layer);
  masks.away = masks.valued = masks.interpolated = TriangleMask(masks.all.size());
  for (std::size_t t = 0; t < masks.all.size(); ++t) {
    masks.away[t] = masks.all[t] && s.projection.back[t];
    const auto& v = s.mesh.triangles[t];
    const bool seen = masks.all[t] && !masks.away[t];
    masks.interpolated[t] =
        seen && std::all_of(v.begin(), v.end(), [&](int i) { return std::isfinite(panel.points[at(i)]); });
    masks.valued[t] = figure.smooth ? masks.interpolated[t] : seen && std::isfinite(panel.facets[at(s.mesh.facet[t])]);
  }
  return masks;
}

}  // namespace dea
