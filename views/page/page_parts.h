// views/page/page_parts.h – what all pages are made of: arrays as text (byte planes, zlib, base64, which page/data.js
// reads), numbers and tables as JSON, the frame around them.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "src/results/comparison.h"
#include "views/data/json.h"
#include "views/map/map_geometry.h"
#include "views/map/map_scale.h"
#include "views/text/table.h"

namespace dea {

/// An array as it stands in the page.
///
/// Bytes of `base64` after inflating: elements of `bytes` bytes, little endian, as planes: first all lowest bytes, ...,
/// last all highest ones (like lies beside like, zlib finds more). `delta`: every element but the first is the
/// difference from the one before it, modulo 2^(8 bytes).
struct PackedArray {
  std::string base64;
  std::size_t count = 0;  ///< elements
  int bytes = 4;
  bool delta = false;
  bool real = false;  ///< 4-byte floats; otherwise integers
};

/// Indices, -1 included, as differences.
PackedArray pack_integers(const std::vector<std::int32_t>& values);
/// Floats, exact. NaN is kept.
PackedArray pack_floats(const std::vector<float>& values);

/// One code of 16 bits per value:
///     value = least + code * (most - least) / 65534,   65535: undefined (NaN)
/// so values come back within half a step, (most - least) / 131068, but for those above `least` by less than half a
/// step: they get code 1, not 0, because what is pressed must not look as if it were not; they come back within a step.
/// All values must be NaN or finite.
struct Codes {
  std::vector<std::uint16_t> codes;
  double least = 0.0, most = 0.0;
};
Codes quantise(const std::vector<double>& values);

PackedArray pack_codes(const std::vector<std::uint16_t>& codes);

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
