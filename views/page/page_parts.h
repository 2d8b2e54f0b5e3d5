// views/page/page_parts.h – what all pages are made of: arrays, numbers and tables as JSON, the frame around
// them.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "src/results/comparison.h"
#include "views/data/json.h"
#include "views/map/map_geometry.h"
#include "views/map/map_scale.h"
#include "views/page/pack.h"
#include "views/text/table.h"

namespace dea {

/// Arrays of a page; the JSON refers to them by number.
struct PageArrays {
  std::string html;
  int count = 0;
  Json add(const PackedArray& array);
};

/// Three floats per point.
std::vector<float> coordinates(const std::vector<Vector3d>& points);
/// A mesh for page/data.js. `node_ids`: per vertex.
Json mesh_json(const ResultSurface& surface, const std::vector<std::int32_t>& node_ids, PageArrays& arrays);

/// With nine digits, twelve would be the machine's noise; null: not finite.
Json short_number(double x);
Json time_json(double time);

Json table_json(const TitledTable& table);

/// Ends and lines of maps (views/map/map_scale.h), and the values they are for.
struct PageScale {
  MapScale scale;
  ValueRange range;
};
/// [low, high, step, least, most]; null: there are no values.
Json scale_json(const PageScale& scale);
/// From where to look first at what has these points: "axis", "up", "center" and "radius" of a ball about them.
Json view_json(const MapView& view, const std::vector<Vector3d>& points);

/// "program", "units", and of the colours "steps", "colours", "lines": what all scripts take for there.
void add_page_head(const UnitNames& units, Json& page);

/// The whole page; `style`, `main`: what it has beside the styles and scripts of all pages. No text of `data` or of the
/// title is taken for markup; bytes that are not UTF-8 become U+FFFD.
std::string page_text(const std::string& title, const Json& data, const PageArrays& arrays, std::string_view style,
                      std::string_view main);

}  // namespace dea
