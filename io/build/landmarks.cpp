#include "io/build/landmarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>

#include "io/febio/febio_text.h"
#include "io/files/free_memory.h"
#include "io/files/output.h"
#include "io/tables/table.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"

namespace dea {

namespace {

/// Column of one of these names; -1: there is none.
int column_of(const TextTable& table, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    for (std::size_t i = 0; i < table.names.size(); ++i)
      if (lower_case(table.names[i]) == name) return static_cast<int>(i);
  return -1;
}

struct Columns {
  int name = -1, defined = -1;
  std::array<int, 3> point = {-1, -1, -1};
  std::string axes;
};

Columns columns_of(const TextTable& table) {
  Columns c;
  c.name = column_of(table, {"name", "label", "landmark"});
  c.defined = column_of(table, {"defined"});
  c.axes = table.axes;
  for (const char* letters : {"xyz", "lps", "ras"}) {
    for (std::size_t k = 0; k < 3; ++k) c.point[k] = column_of(table, {std::string(1, letters[k])});
    if (c.point[0] < 0 || c.point[1] < 0 || c.point[2] < 0) continue;
    if (letters[0] != 'x') c.axes = letters[0] == 'l' ? "LPS" : "RAS";
    if (c.name >= 0) return c;
  }
  throw table_fault(table.path, table.names_line,
                    fmt::format("found columns {}, expected name (or label) and x, y, z (or l, p, s or r, a, s)",
                                fmt::join(table.names, ", ")));
}

using Json = nlohmann::json;

/// A member's text; "": there is none.
std::string text_of(const Json& object, const char* member) {
  const auto found = object.find(member);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

/// Slicer's own file of markups, .mrk.json: lists of control points.
LandmarkFile read_markups(const std::string& path) {
  const std::optional<std::string> content = whole_file(path, 20);
  if (!content) throw table_fault(path, 0, "found no file that can be read, expected landmarks");
  Json all;
  try {
    all = Json::parse(*content);
  } catch (const Json::parse_error& e) {
    const auto end = content->begin() + static_cast<std::ptrdiff_t>(std::min(e.byte, content->size()));
    throw table_fault(path, 1 + static_cast<int>(std::count(content->begin(), end, '\n')),
                      "found no JSON, expected the list of markups as Slicer saves it: the file is damaged or cut off");
  } catch (const Json::exception&) {  // a number beyond all bounds
    throw table_fault(path, 0, "found a number beyond 1e308, expected coordinates");
  }
  const auto lists = all.find("markups");
  if (lists == all.end() || !lists->is_array())
    throw table_fault(path, 0,
                      "found no \"markups\", expected a list of markups as Slicer saves it (.mrk.json), or CSV");
  LandmarkFile file;
  for (const Json& list : *lists) {
    const std::string axes = text_of(list, "coordinateSystem");
    if (axes != "LPS" && axes != "RAS")
      throw table_fault(path, 0,
                        fmt::format("coordinateSystem: found {}, expected \"LPS\" or \"RAS\"", febio::quote(axes)));
    const std::string units = text_of(list, "coordinateUnits");
    if (!units.empty() && units != "mm")
      throw table_fault(
          path, 0, fmt::format("coordinateUnits: found {}, expected \"mm\": save the list in mm", febio::quote(units)));
    const auto points = list.find("controlPoints");
    if (points == list.end()) continue;
    if (!file.landmarks.empty() && axes != file.axes)
      throw table_fault(path, 0, "coordinateSystem: found both LPS and RAS, expected one; save the lists as two files");
    file.axes = axes;
    for (const Json& point : *points) {
      const std::string status = text_of(point, "positionStatus");
      if (!status.empty() && status != "defined") continue;
      Landmark landmark;
      landmark.name = text_of(point, "label");
      const auto position = point.find("position");
      if (position == point.end() || !position->is_array() || position->size() != 3 ||
          std::any_of(position->begin(), position->end(), [](const Json& x) { return !x.is_number(); }))
        throw table_fault(
            path, 0,
            fmt::format("position of {}: found {}, expected three numbers in brackets", febio::quote(landmark.name),
                        position == point.end()
                            ? "nothing"
                            : position->dump(-1, ' ', true, Json::error_handler_t::replace).substr(0, 40)));
      for (std::size_t k = 0; k < 3; ++k) landmark.point[static_cast<Eigen::Index>(k)] = (*position)[k].get<double>();
      file.landmarks.push_back(landmark);
    }
  }
  if (file.landmarks.empty()) throw table_fault(path, 0, "found no control point with a position, expected landmarks");
  return file;
}

}  // namespace

LandmarkFile read_landmarks(const std::string& path) {
  if (extension_of(path) == ".json") return read_markups(path);
  const TextTable table = read_text_table(path);
  const Columns columns = columns_of(table);
  LandmarkFile file;
  file.axes = columns.axes;
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const std::vector<std::string>& row = table.rows[r];
    if (columns.defined >= 0 && row[at(columns.defined)] == "0") continue;
    Landmark landmark;
    landmark.name = row[at(columns.name)];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string& text = row[at(columns.point[k])];
      try {
        landmark.point[static_cast<Eigen::Index>(k)] = parse_number(text);
      } catch (const BadValue&) {
        throw table_fault(
            path, table.lines[r],
            fmt::format("{} of {}: found {}, expected a number with a decimal point", table.names[at(columns.point[k])],
                        febio::quote(landmark.name), febio::quote(text)));
      }
    }
    file.landmarks.push_back(landmark);
  }
  return file;
}

std::string frames_as_settings(const std::vector<AnatomicalFrame>& frames) {
  std::string text = "<?xml version=\"1.0\"?>\n<febiodea_settings version=\"1\">\n";
  for (const AnatomicalFrame& f : frames) {
    std::string axes;
    for (int k = 0; k < 3; ++k)
      axes += fmt::format("{}{},{},{}", k > 0 ? "/" : "", f.axes(0, k) + 0.0, f.axes(1, k) + 0.0,
                          f.axes(2, k) + 0.0);  // no -0
    text += fmt::format("  <!-- {}: x forwards, y up, z to the right -->\n  <frame name=\"{}\">{}</frame>\n", f.name,
                        f.name, axes);
  }
  return text + "</febiodea_settings>\n";
}

}  // namespace dea
