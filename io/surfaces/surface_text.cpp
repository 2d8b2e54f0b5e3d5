#include "io/surfaces/surface_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/parse.h"

namespace dea {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }

}  // namespace

std::string_view SurfaceText::next_line() {
  const std::size_t begin = place_;
  const std::size_t end = std::min(content_.find_first_of("\r\n", begin), content_.size());
  const bool both = content_.substr(end, 2) == "\r\n";
  place_ = std::min(end + (both ? 2 : 1), content_.size());
  ++line_;
  std::string_view found = content_.substr(begin, end - begin);
  while (!found.empty() && is_blank(found.front())) found.remove_prefix(1);
  while (!found.empty() && is_blank(found.back())) found.remove_suffix(1);
  return found;
}

std::string_view SurfaceText::next_word() {
  for (; place_ < content_.size() && is_blank(content_[place_]); ++place_)
    line_ += content_[place_] == '\n' ||
             (content_[place_] == '\r' && !(place_ + 1 < content_.size() && content_[place_ + 1] == '\n'));
  const std::size_t begin = place_;
  while (place_ < content_.size() && !is_blank(content_[place_])) ++place_;
  return content_.substr(begin, place_ - begin);
}

double SurfaceText::next_number(const char* what) {
  std::string_view word = next_word();
  if (word.empty()) refuse_end(what);
  if (word.front() == '+') word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = read_number(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range && word.find("e-") != std::string_view::npos) return 0.0;  // tiny
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
    refuse(fmt::format("found \"{}\", expected a number ({})", shown(word), what));
  return value;
}

long long SurfaceText::next_integer(const char* what) {
  const std::string_view word = next_word();
  if (word.empty()) refuse_end(what);
  long long value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size())
    refuse(fmt::format("found \"{}\", expected a whole number ({})", shown(word), what));
  return value;
}

void SurfaceText::skip_bytes(std::size_t count, const char* what) {
  if (bytes_left() < count) refuse_end(what);
  place_ += count;
}

void SurfaceText::refuse(const std::string& text) const { throw InputError(path_, line_, text); }

void SurfaceText::refuse_above(const std::string& expected) const {
  throw InputError(path_, line_ - 1, "found another line, " + expected);
}

void SurfaceText::refuse_end(const char* what) const {
  refuse(fmt::format("found the end of the file, expected {}: the file is cut off", what));
}

std::size_t SurfaceText::checked_count(long long count, const char* what) const {
  if (count < 0 || static_cast<std::size_t>(count) > bytes_left())
    refuse(fmt::format("found a count of {} {}, expected no more than the rest of the file holds", count, what));
  return static_cast<std::size_t>(count);
}

void SurfaceText::add_polygon(TriangleSurface& surface, const std::vector<long long>& corners) const {
  if (corners.size() < 3) refuse(fmt::format("found a polygon of {} corners, expected three or more", corners.size()));
  for (const long long corner : corners)
    if (corner < 0 || corner >= static_cast<long long>(surface.points.size()))
      refuse(fmt::format("found a corner at point {} (counted from 0), expected one of the {} points", corner,
                         surface.points.size()));
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    surface.triangles.push_back(
        {static_cast<int>(corners[0]), static_cast<int>(corners[i]), static_cast<int>(corners[i + 1])});
}

}  // namespace dea
