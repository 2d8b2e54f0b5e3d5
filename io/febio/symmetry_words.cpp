#include "io/febio/symmetry_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/base/parse.h"

namespace dea::febio {

std::optional<std::vector<SymmetryPlane>> planes_of_text(std::string_view text) {
  std::vector<SymmetryPlane> planes;
  if (trimmed(std::string(text)).empty()) return planes;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string part = trimmed(std::string(text.substr(begin, end - begin)));
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos) return std::nullopt;
    const std::string axis = trimmed(part.substr(0, equals));
    const std::size_t k = axis.size() == 1 ? std::string_view("xyz").find(axis) : std::string_view::npos;
    if (k == std::string_view::npos) return std::nullopt;
    try {
      const double at = parse_number(trimmed(part.substr(equals + 1)));
      if (!std::isfinite(at)) return std::nullopt;
      planes.push_back({static_cast<int>(k), at});
    } catch (const BadValue&) {
      return std::nullopt;
    }
    begin = end + 1;
  }
  return planes;
}

std::string text_of_planes(const std::vector<SymmetryPlane>& planes) {
  std::string text;
  for (const SymmetryPlane& plane : planes)
    text += fmt::format("{}{}={}", text.empty() ? "" : ", ", "xyz"[plane.axis], plane.at);
  return text;
}

}  // namespace dea::febio
