#include "io/surfaces/read_surface.h"

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <sstream>

#include "io/files/free_memory.h"
#include "io/files/output.h"
#include "io/surfaces/surface_text.h"
#include "src/base/error.h"
#include "src/base/parse.h"

namespace dea {

namespace {

constexpr std::size_t kStlHead = 84, kStlTriangle = 50;

std::string content_of(const std::string& path) {
  constexpr double kMemoryPerByte = 4;  // of a file: its bytes, points and triangles
  std::optional<std::string> content = whole_file(path, kMemoryPerByte);
  if (!content) throw InputError(path, 0, "found no file that can be read, expected a triangle surface");
  return std::move(*content);
}

/// Without a byte order mark and blanks at its beginning.
std::string_view begun(const std::string& content) {
  std::string_view text = content;
  if (text.substr(0, 3) == "\xef\xbb\xbf") text.remove_prefix(3);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first == std::string_view::npos ? std::string_view() : text.substr(first);
}

std::uint32_t stl_count(const std::string& content) {
  std::uint32_t count = 0;
  std::memcpy(&count, content.data() + 80, 4);
  return count;
}

/// A binary STL may begin with "solid" too: its size tells.
bool is_binary_stl(const std::string& content) {
  return content.size() >= kStlHead && content.size() == kStlHead + kStlTriangle * std::size_t{stl_count(content)};
}

TriangleSurface read_content(const std::string& path, const std::string& content) {
  SurfaceText text(path, content);
  const std::string extension = extension_of(path);
  if (content.empty()) throw InputError(path, 0, "found an empty file, expected a triangle surface");
  if (is_binary_stl(content)) return read_stl_binary(text);
  if (content.starts_with("ply\n") || content.starts_with("ply\r")) return read_ply(text);
  if (content.starts_with("# vtk DataFile")) return read_vtk(text);
  if (content.starts_with("<?xml") || content.starts_with("<VTKFile")) return read_vtp(path, content);
  if (extension == ".obj") return read_obj(text);
  const std::string_view word = begun(content).substr(0, 5);
  if (word == "solid" && content.find("facet") < 2000) return read_stl_text(text);
  if (word == "SOLID") {  // some programs shout
    return read_content(path, lower_case(content));
  }
  if (extension == ".stl" && content.size() >= kStlHead && content.find('\0') < kStlHead)
    throw InputError(
        path, 0,
        fmt::format("found {} bytes, expected {} for the {} triangles that this STL file names: it is cut "
                    "off or damaged",
                    content.size(), kStlHead + kStlTriangle * std::size_t{stl_count(content)}, stl_count(content)));
  throw InputError(path, 0, "found no surface that is known, expected STL, OBJ, PLY, VTK (polydata) or VTP");
}

/// A triangle of the last three points.
void add_last_three(TriangleSurface& surface) {
  const int first = static_cast<int>(surface.points.size()) - 3;
  surface.triangles.push_back({first, first + 1, first + 2});
}

}  // namespace

TriangleSurface read_surface(const std::string& path) {
  TriangleSurface surface = read_content(path, content_of(path));
  if (surface.triangles.empty()) throw InputError(path, 0, "found no triangle, expected a surface");
  for (std::size_t i = 0; i < surface.points.size(); ++i)
    if (!surface.points[i].allFinite() || surface.points[i].cwiseAbs().maxCoeff() > 1e15)
      throw InputError(path, 0,
                       fmt::format("found a coordinate of point {} that is no number of use, expected finite "
                                   "ones: the file is damaged",
                                   i + 1));
  return surface;
}

TriangleSurface read_stl_binary(SurfaceText& text) {
  text.skip_bytes(80, "the head of the STL file");
  const auto count = text.next_bytes<std::uint32_t>(false, "the number of triangles");
  TriangleSurface surface;
  surface.points.reserve(3 * std::size_t{count});
  for (std::uint32_t i = 0; i < count; ++i) {
    text.skip_bytes(12, "a triangle");
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d x;
      for (int c = 0; c < 3; ++c) x[c] = static_cast<double>(text.next_bytes<float>(false, "a triangle"));
      surface.points.push_back(x);
    }
    text.skip_bytes(2, "a triangle");
    add_last_three(surface);
  }
  return surface;
}

TriangleSurface read_stl_text(SurfaceText& text) {
  TriangleSurface surface;
  text.next_line();  // solid and its name
  bool ended = false;
  for (std::string_view word = text.next_word(); !word.empty(); word = text.next_word()) {
    if (word == "facet") ended = false;
    if (word == "endsolid" || word == "solid") {
      ended = true;
      text.next_line();
      continue;
    }
    if (word != "vertex") continue;
    Eigen::Vector3d x;
    for (int c = 0; c < 3; ++c) x[c] = text.next_number("a coordinate");
    surface.points.push_back(x);
    if (surface.points.size() % 3 == 0) add_last_three(surface);
  }
  if (!ended || surface.points.size() % 3 != 0) text.refuse_end("\"endsolid\"");
  return surface;
}

TriangleSurface read_obj(SurfaceText& text) {
  TriangleSurface surface;
  std::vector<long long> corners;
  while (!text.at_end()) {
    std::istringstream words{std::string(text.next_line())};
    words.imbue(std::locale::classic());
    std::string word;
    words >> word;
    if (word == "v") {
      Eigen::Vector3d x;
      if (!(words >> x.x() >> x.y() >> x.z())) text.refuse_above("expected \"v x y z\" with three numbers");
      surface.points.push_back(x);
    } else if (word == "f") {
      corners.clear();
      while (words >> word) {
        char* end = nullptr;
        const long long corner = std::strtoll(word.c_str(), &end, 10);  // "3/1/2": point, texture, normal
        if (end == word.c_str() || corner == 0) text.refuse_above("expected \"f 1 2 3\" with numbers of points");
        corners.push_back(corner > 0 ? corner - 1 : static_cast<long long>(surface.points.size()) + corner);
      }
      text.add_polygon(surface, corners);
    }
  }
  return surface;
}

}  // namespace dea
