// VTK's surfaces: legacy files of polydata, text or big-endian bytes.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>

#include "io/surfaces/surface_text.h"
#include "src/base/names.h"

namespace dea {

namespace {

struct VtkType {
  std::string_view name;
  NumberReader next;
};
constexpr NumberReader kInt32 = next_as<std::int32_t>;
constexpr VtkType kVtkTypes[] = {{"float", next_as<float>},
                                 {"double", next_as<double>},
                                 {"int", kInt32},
                                 {"vtkIdType", kInt32},
                                 {"vtktypeint64", next_as<std::int64_t>},
                                 {"long", next_as<std::int64_t>}};

NumberReader vtk_type(SurfaceText& text, std::string_view word) {
  for (const VtkType& type : kVtkTypes)
    if (word == type.name) return type.next;
  text.refuse(fmt::format("found the type \"{}\", expected float, double, int or vtktypeint64", shown(word)));
}

long long next_whole(SurfaceText& text, bool binary, NumberReader next) {
  if (!binary) return text.next_integer("a point's number");
  const double value = next(text, true, "a number");
  if (!(std::abs(value) < 4e18)) text.refuse(fmt::format("found {}, expected a whole number", value));
  return static_cast<long long>(value);
}

void end_bytes(SurfaceText& text, bool binary) {
  if (binary && !text.at_end()) text.next_line();
}

void read_points(SurfaceText& text, bool binary, TriangleSurface& surface) {
  const std::size_t count = text.checked_count(text.next_integer("the number of points"), "points");
  const NumberReader next = vtk_type(text, text.next_word());
  text.next_line();
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3d x;
    for (int c = 0; c < 3; ++c) x[c] = binary ? next(text, true, "a number") : text.next_number("a number");
    surface.points.push_back(x);
  }
  end_bytes(text, binary);
}

/// Offsets and corners by themselves, as files of version 5.1 have them; the count is one more than there are cells.
void read_cells_51(SurfaceText& text, bool binary, long long offsets, long long corners, TriangleSurface* surface) {
  std::vector<long long> begin, all;
  const auto read = [&](const char* name, long long count, std::vector<long long>& values) {
    if (text.next_word() != name) text.refuse(fmt::format("found another word, expected \"{}\"", name));
    const NumberReader next = vtk_type(text, text.next_word());
    text.next_line();
    const std::size_t n = text.checked_count(count, "numbers");
    for (std::size_t i = 0; i < n; ++i) values.push_back(next_whole(text, binary, next));
    end_bytes(text, binary);
  };
  read("OFFSETS", offsets, begin);
  read("CONNECTIVITY", corners, all);
  for (std::size_t i = 0; surface != nullptr && i + 1 < begin.size(); ++i) {
    if (begin[i] < 0 || begin[i + 1] < begin[i] || begin[i + 1] > static_cast<long long>(all.size()))
      text.refuse(fmt::format("found the offset {}, expected offsets that grow to {}", begin[i + 1], all.size()));
    text.add_polygon(*surface, {all.begin() + begin[i], all.begin() + begin[i + 1]});
  }
}

/// POLYGONS, or cells that are passed over (surface: nullptr).
void read_cells(SurfaceText& text, bool binary, bool version_5, TriangleSurface* surface) {
  const long long first = text.next_integer("the number of cells"), second = text.next_integer("the size of the cells");
  text.next_line();
  if (version_5) return read_cells_51(text, binary, first, second, surface);
  const std::size_t cells = text.checked_count(first, "cells");
  for (std::size_t i = 0; i < cells; ++i) {
    const std::size_t count = text.checked_count(next_whole(text, binary, kInt32), "corners");
    std::vector<long long> corners;
    for (std::size_t k = 0; k < count; ++k) corners.push_back(next_whole(text, binary, kInt32));
    if (surface != nullptr) text.add_polygon(*surface, corners);
  }
  end_bytes(text, binary);
}

}  // namespace

TriangleSurface read_vtk(SurfaceText& text) {
  const bool version_5 = text.next_line().find("Version 5") != std::string_view::npos;
  text.next_line();  // title
  const std::string_view coding = text.next_word();
  if (coding != "ASCII" && coding != "BINARY")
    text.refuse(fmt::format("found \"{}\", expected ASCII or BINARY", shown(coding)));
  const bool binary = coding == "BINARY";
  if (text.next_word() != "DATASET" || text.next_word() != "POLYDATA")
    text.refuse("found another data set, expected \"DATASET POLYDATA\": a surface, not a volume or grid");
  TriangleSurface surface;
  for (std::string_view word = text.next_word(); !word.empty(); word = text.next_word()) {
    if (word == "POINTS") {
      read_points(text, binary, surface);
    } else if (word == "POLYGONS") {
      read_cells(text, binary, version_5, &surface);
      return surface;
    } else if (word == "VERTICES" || word == "LINES") {
      read_cells(text, binary, version_5, nullptr);
    } else if (word == "METADATA") {
      while (!text.at_end() && !text.next_line().empty()) {
      }
    } else {
      text.refuse(
          fmt::format("found \"{}\", expected POINTS and POLYGONS (triangle strips and fields before the "
                      "polygons are not read: save the surface as STL)",
                      shown(word)));
    }
  }
  return surface;
}

}  // namespace dea
