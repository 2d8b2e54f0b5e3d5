// PLY: a head of text that says which elements follow, with which properties, then these as text or bytes.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>

#include "io/surfaces/surface_text.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"

namespace dea {

namespace {

enum class Type { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float, Double };

struct Property {
  std::string name;
  Type type = Type::Float;
  bool list = false;
  Type count_type = Type::UInt8;
};

struct Element {
  std::string name;
  long long count = 0;
  std::vector<Property> properties;
};

struct Head {
  bool binary = false, swap = false;
  std::vector<Element> elements;
};

Type type_of(SurfaceText& text, std::string_view word) {
  constexpr std::string_view kWords[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                            {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                            {"float", "float32"}, {"double", "float64"}};
  for (std::size_t i = 0; i < std::size(kWords); ++i)
    if (word == kWords[i][0] || word == kWords[i][1]) return static_cast<Type>(i);
  text.refuse(fmt::format("found the type \"{}\", expected one of PLY's: float, uchar, int, ...", shown(word)));
}

Property next_property(SurfaceText& text) {
  Property p;
  std::string_view word = text.next_word();
  p.list = word == "list";
  if (p.list) {
    p.count_type = type_of(text, text.next_word());
    word = text.next_word();
  }
  p.type = type_of(text, word);
  p.name = text.next_word();
  return p;
}

Head read_head(SurfaceText& text) {
  Head head;
  text.next_line();  // ply
  for (;;) {
    const std::string_view word = text.next_word();
    if (word.empty()) text.refuse_end("\"end_header\"");
    if (word == "format") {
      const std::string_view format = text.next_word();
      head.binary = format != "ascii";
      head.swap = format == "binary_big_endian";
      if (head.binary && !head.swap && format != "binary_little_endian")
        text.refuse(fmt::format("found the format \"{}\", expected ascii, binary_little_endian or binary_big_endian",
                                shown(format)));
    } else if (word == "element") {
      Element e;
      e.name = text.next_word();
      e.count = text.next_integer("the number of elements");
      head.elements.push_back(e);
    } else if (word == "property") {
      if (head.elements.empty()) text.refuse("found a property, expected an element before it");
      head.elements.back().properties.push_back(next_property(text));
      continue;
    } else if (word == "end_header") {
      text.next_line();
      return head;
    }
    text.next_line();
  }
}

double next_value(SurfaceText& text, const Head& head, Type type) {
  const char* what = "a value of an element";
  if (!head.binary) return text.next_number(what);
  switch (type) {
    case Type::Int8:
      return text.next_bytes<std::int8_t>(head.swap, what);
    case Type::UInt8:
      return text.next_bytes<std::uint8_t>(head.swap, what);
    case Type::Int16:
      return text.next_bytes<std::int16_t>(head.swap, what);
    case Type::UInt16:
      return text.next_bytes<std::uint16_t>(head.swap, what);
    case Type::Int32:
      return text.next_bytes<std::int32_t>(head.swap, what);
    case Type::UInt32:
      return text.next_bytes<std::uint32_t>(head.swap, what);
    case Type::Float:
      return static_cast<double>(text.next_bytes<float>(head.swap, what));
    case Type::Double:
      return text.next_bytes<double>(head.swap, what);
  }
  return 0;
}

long long next_whole(SurfaceText& text, const Head& head, Type type) {
  const double value = next_value(text, head, type);
  if (!(std::abs(value) < 4e18) || value != static_cast<double>(static_cast<long long>(value)))
    text.refuse(fmt::format("found {}, expected a whole number", value));
  return static_cast<long long>(value);
}

void read_element(SurfaceText& text, const Head& head, const Element& element, TriangleSurface& surface) {
  Eigen::Vector3d x(kNaN, kNaN, kNaN);
  std::vector<long long> corners;
  for (const Property& p : element.properties) {
    if (!p.list) {
      const double value = next_value(text, head, p.type);
      if (element.name == "vertex" && p.name.size() == 1 && p.name[0] >= 'x' && p.name[0] <= 'z')
        x[p.name[0] - 'x'] = value;
      continue;
    }
    const std::size_t count = text.checked_count(next_whole(text, head, p.count_type), 1, "values of a list");
    const bool polygon = element.name == "face" && (p.name == "vertex_indices" || p.name == "vertex_index");
    for (std::size_t i = 0; i < count; ++i) {
      if (polygon)
        corners.push_back(next_whole(text, head, p.type));
      else
        next_value(text, head, p.type);
    }
    if (polygon) text.add_polygon(surface, corners);
  }
  if (element.name == "vertex") surface.points.push_back(x);
}

}  // namespace

TriangleSurface read_ply(SurfaceText& text) {
  const Head head = read_head(text);
  TriangleSurface surface;
  for (const Element& element : head.elements) {
    if (element.properties.empty()) continue;
    const std::size_t count = text.checked_count(element.count, 1, "elements");
    for (std::size_t i = 0; i < count; ++i) read_element(text, head, element, surface);
  }
  return surface;
}

}  // namespace dea
