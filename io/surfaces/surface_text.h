// io/surfaces/surface_text.h – words, numbers and bytes of a surface's file, with the line where they stand.
#pragma once
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "src/geometry/triangle_surface.h"

namespace dea {

/// The bytes at the begin as a number, of the other byte order if `swap`.
template <class Number>
Number number_in(std::string_view bytes, bool swap) {
  char turned[sizeof(Number)];
  for (std::size_t i = 0; i < sizeof(Number); ++i) turned[swap ? sizeof(Number) - 1 - i : i] = bytes[i];
  Number value;
  std::memcpy(&value, turned, sizeof(Number));
  return value;
}

/// Walks over a file's content. Faults are InputErrors with file and line.
class SurfaceText {
 public:
  SurfaceText(const std::string& path, std::string_view content) : path_(path), content_(content) {}

  bool at_end() const { return place_ >= content_.size(); }
  std::size_t bytes_left() const { return content_.size() - place_; }

  /// Up to the next end of line (of Unix, Windows, or old Macs), which is passed; without white space at both ends.
  std::string_view next_line();
  /// The next word, over ends of lines; empty at the end of the file.
  std::string_view next_word();
  /// Each is refused unless the next word is one; `what` is told.
  double next_number(const char* what);
  long long next_integer(const char* what);

  /// The next bytes as a number, of the other byte order if `swap`.
  template <class Number>
  Number next_bytes(bool swap, const char* what) {
    if (bytes_left() < sizeof(Number)) refuse_end(what);
    const Number value = number_in<Number>(content_.substr(place_), swap);
    place_ += sizeof(Number);
    return value;
  }
  void skip_bytes(std::size_t count, const char* what);

  [[noreturn]] void refuse(const std::string& text) const;
  /// Of the line that next_line gave.
  [[noreturn]] void refuse_above(const std::string& expected) const;
  [[noreturn]] void refuse_end(const char* what) const;
  /// A count that the rest of the file cannot hold, at a byte each, is refused before memory is asked for it.
  std::size_t checked_count(long long count, const char* what) const;

  /// Adds a polygon as triangles from its first corner. Refused: fewer than three corners, a corner that is no point.
  void add_polygon(TriangleSurface& surface, const std::vector<long long>& corners) const;

 private:
  std::string path_;
  std::string_view content_;
  std::size_t place_ = 0;
  int line_ = 1;
};

/// The next number of a file's type, from bytes.
using NumberReader = double (*)(SurfaceText& text, bool swap, const char* what);
template <class Number>
double next_as(SurfaceText& text, bool swap, const char* what) {
  return static_cast<double>(text.next_bytes<Number>(swap, what));
}

/// Of each kind; the text stands at the file's begin.
TriangleSurface read_stl_text(SurfaceText& text);
TriangleSurface read_stl_binary(SurfaceText& text);
TriangleSurface read_obj(SurfaceText& text);
TriangleSurface read_ply(SurfaceText& text);
TriangleSurface read_vtk(SurfaceText& text);
TriangleSurface read_vtp(const std::string& path, std::string_view content);

}  // namespace dea
