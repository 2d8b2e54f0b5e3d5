#include "views/page/page_parts.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "io/files/encoded_text.h"
#include "src/base/time_text.h"
#include "src/version.h"
#include "views/map/colour_map.h"
#include "views/page/page.h"

namespace dea {

namespace {

constexpr std::uint16_t kUndefined = 65535;
constexpr double kSteps = 65534.0;

template <typename Word>
PackedArray pack(const std::vector<Word>& words, bool delta) {
  PackedArray packed;
  packed.count = words.size();
  packed.bytes = static_cast<int>(sizeof(Word));
  packed.delta = delta;
  std::string planes(words.size() * sizeof(Word), '\0');
  Word before = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const Word word = delta ? static_cast<Word>(words[i] - before) : words[i];
    before = words[i];
    for (std::size_t k = 0; k < sizeof(Word); ++k)
      planes[k * words.size() + i] = static_cast<char>(word >> (8 * k) & 0xffu);
  }
  packed.base64 = base64(packed_bytes(planes));
  return packed;
}

/// 256 colours, six digits each.
std::string table_hex(ColourMap map) {
  std::string out;
  for (int i = 0; i < 256; ++i) out += hex(colour(map, i / 255.0)).substr(1);
  return out;
}

/// A letter per colour of the table: w, b: lines on it are white, black.
std::string table_lines(ColourMap map) {
  std::string out;
  for (int i = 0; i < 256; ++i) out += white_line(colour(map, i / 255.0)) ? 'w' : 'b';
  return out;
}

/// JSON inside a script element: without '<' nothing can end it or open a comment.
std::string script_json(const Json& j) {
  const std::string text = j.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (char c : text) {
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  }
  return out;
}

/// One pass: what has been put in is not looked through again.
std::string filled(std::string_view frame, const std::map<std::string_view, std::string_view>& parts) {
  std::string out;
  for (std::size_t i = 0; i < frame.size();) {
    const std::size_t mark = frame.find('@', i);
    const std::size_t end = mark == std::string_view::npos ? mark : frame.find('@', mark + 1);
    if (end == std::string_view::npos) {
      out += frame.substr(i);
      break;
    }
    const auto part = parts.find(frame.substr(mark + 1, end - mark - 1));
    if (part == parts.end()) {
      out += frame.substr(i, mark + 1 - i);
      i = mark + 1;
      continue;
    }
    out += frame.substr(i, mark - i);
    out += part->second;
    i = end + 1;
  }
  return out;
}

}  // namespace

PackedArray pack_integers(const std::vector<std::int32_t>& values) {
  return pack(std::vector<std::uint32_t>(values.begin(), values.end()), true);
}

PackedArray pack_floats(const std::vector<float>& values) {
  std::vector<std::uint32_t> words(values.size());
  if (!values.empty()) std::memcpy(words.data(), values.data(), values.size() * sizeof(float));
  PackedArray packed = pack(words, false);
  packed.real = true;
  return packed;
}

Codes quantise(const std::vector<double>& values) {
  Codes out;
  ValueRange range;
  range.add(values);
  if (range.empty()) range.add(0.0);
  out.least = range.least;
  out.most = range.most;
  out.codes.reserve(values.size());
  for (double x : values) {
    // halves: the difference of two large numbers must not overflow
    const double fraction = (0.5 * x - 0.5 * out.least) / (0.5 * out.most - 0.5 * out.least);
    if (std::isnan(x))
      out.codes.push_back(kUndefined);
    else
      out.codes.push_back(
          x > out.least ? static_cast<std::uint16_t>(std::clamp(std::round(kSteps * fraction), 1.0, kSteps)) : 0);
  }
  return out;
}

PackedArray pack_codes(const std::vector<std::uint16_t>& codes) { return pack(codes, true); }

Json PageArrays::add(const PackedArray& a) {
  const int id = count++;
  html += fmt::format("<script type=\"text/plain\" id=\"array{}\">{}</script>\n", id, a.base64);
  return {{"id", id}, {"count", a.count}, {"bytes", a.bytes}, {"delta", a.delta}, {"real", a.real}};
}

std::vector<float> coordinates(const std::vector<Vector3d>& points) {
  std::vector<float> out;
  for (const Vector3d& x : points)
    for (int k = 0; k < 3; ++k) out.push_back(static_cast<float>(x[k]));
  return out;
}

Json mesh_json(const ResultSurface& s, const std::vector<std::int32_t>& node_ids, PageArrays& arrays) {
  std::vector<std::int32_t> triangles, facet(s.mesh.facet.begin(), s.mesh.facet.end()),
      begin(s.begin.begin(), s.begin.end()), corner(s.slot_vertex.begin(), s.slot_vertex.end());
  for (const auto& t : s.mesh.triangles) triangles.insert(triangles.end(), t.begin(), t.end());
  return {{"vertices", arrays.add(pack_floats(coordinates(s.mesh.vertices)))},
          {"nodes", arrays.add(pack_integers(node_ids))},
          {"triangles", arrays.add(pack_integers(triangles))},
          {"facet", arrays.add(pack_integers(facet))},
          {"begin", arrays.add(pack_integers(begin))},
          {"corner", arrays.add(pack_integers(corner))},
          {"areas", arrays.add(pack_floats({s.facet_areas.begin(), s.facet_areas.end()}))}};
}

Json short_number(double x) {
  if (!std::isfinite(x)) return nullptr;
  return Json(std::stod(fmt::format("{:.9g}", x)));
}

Json time_json(double time) { return json_number(time_meant(time)); }

Json table_json(const TitledTable& t) {
  return {{"title", t.title}, {"headings", t.table.headings}, {"left", t.table.left}, {"rows", t.table.rows}};
}

Json scale_json(const PageScale& s) {
  if (s.range.empty()) return nullptr;
  return {short_number(s.scale.low), short_number(s.scale.high), short_number(s.scale.step),
          short_number(s.range.least), short_number(s.range.most)};
}

Json view_json(const MapView& view, const std::vector<Vector3d>& points) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& x : points) box.extend(x);
  const Vector3d center = box.center();
  double radius = 0.0;
  for (const Vector3d& x : points) radius = std::max(radius, (x - center).norm());
  return {{"axis", json_vector(view.toward)},
          {"up", json_vector(view.up)},
          {"center", json_vector(center)},
          {"radius", json_number(radius)}};
}

void add_page_head(const UnitNames& units, Json& j) {
  j["program"] = fmt::format("FEBioDEA {} ({})", kVersion, kCommit);
  j["units"] = {{"name", units.system},
                {"length", units.length},
                {"force", units.force},
                {"pressure", units.pressure},
                {"area", units.area}};
  j["steps"] = {{"count", kScaleSteps}, {"multiples", kScaleMultiples}};
  j["colours"] = {{"sequential", table_hex(ColourMap::Sequential)}, {"diverging", table_hex(ColourMap::Diverging)}};
  j["lines"] = {{"sequential", table_lines(ColourMap::Sequential)}, {"diverging", table_lines(ColourMap::Diverging)}};
}

std::string page_text(const std::string& title, const Json& data, const PageArrays& arrays, std::string_view style,
                      std::string_view main) {
  const std::string json = script_json(data);
  const std::string shown_title = escaped(utf8(title));
  const std::string styles = std::string(page::style()).append(style);
  return filled(page::html(), {{"title", shown_title},
                               {"style", styles},
                               {"three", page::three()},
                               {"plot", page::plot()},
                               {"elements", page::elements()},
                               {"data_js", page::data()},
                               {"scene", page::scene()},
                               {"figures", page::figures()},
                               {"main", main},
                               {"licences", page::licences()},
                               {"report", json},
                               {"arrays", arrays.html}});
}

}  // namespace dea
