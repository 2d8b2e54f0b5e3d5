// PLY: a head of text that says which elements follow, with which properties, then these as text or bytes.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>

#include "io/surfaces/surface_text.h"
#include "src/base/names.h"
#include "src/base/numbers.h"

namespace dea {

namespace {

struct Type {
  std::string_view name, other_name;
  NumberReader next;
};
constexpr Type kTypes[] = {{"char", "int8", next_as<std::int8_t>},    {"uchar", "uint8", next_as<std::uint8_t>},
                           {"short", "int16", next_as<std::int16_t>}, {"ushort", "uint16", next_as<std::uint16_t>},
                           {"int", "int32", next_as<std::int32_t>},   {"uint", "uint32", next_as<std::uint32_t>},
                           {"float", "float32", next_as<float>},      {"double", "float64", next_as<double>}};

struct Property {
  std::string name;
  NumberReader next = nullptr;
  bool list = false;
  NumberReader next_count = nullptr;
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

NumberReader type_of(SurfaceText& text, std::string_view word) {
  for (const Type& type : kTypes)
    if (word == type.name || word == type.other_name) return type.next;
  text.refuse(fmt::format("found the type \"{}\", expected one of PLY's: float, uchar, int, ...", shown(word)));
}

Property next_property(SurfaceText& text) {
  Property p;
  std::string_view word = text.next_word();
  p.list = word == "list";
  if (p.list) {
    p.next_count = type_of(text, text.next_word());
    word = text.next_word();
  }
  p.next = type_of(text, word);
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

double next_value(SurfaceText& text, const Head& head, NumberReader next) {
  const char* what = "a value of an element";
  return head.binary ? next(text, head.swap, what) : text.next_number(what);
}

long long next_whole(SurfaceText& text, const Head& head, NumberReader next) {
  const double value = next_value(text, head, next);
  if (!(std::abs(value) < 4e18) || value != static_cast<double>(static_cast<long long>(value)))
    text.refuse(fmt::format("found {}, expected a whole number", value));
  return static_cast<long long>(value);
}

void read_element(SurfaceText& text, const Head& head, const Element& element, TriangleSurface& surface) {
  Eigen::Vector3d x(kNaN, kNaN, kNaN);
  std::vector<long long> corners;
  for (const Property& p : element.properties) {
    if (!p.list) {
      const double value = next_value(text, head, p.next);
      if (element.name == "vertex" && p.name.size() == 1 && p.name[0] >= 'x' && p.name[0] <= 'z')
        x[p.name[0] - 'x'] = value;
      continue;
    }
    const std::size_t count = text.checked_count(next_whole(text, head, p.next_count), "values of a list");
    const bool polygon = element.name == "face" && (p.name == "vertex_indices" || p.name == "vertex_index");
    for (std::size_t i = 0; i < count; ++i) {
      if (polygon)
        corners.push_back(next_whole(text, head, p.next));
      else
        next_value(text, head, p.next);
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
    const std::size_t count = text.checked_count(element.count, "elements");
    for (std::size_t i = 0; i < count; ++i) read_element(text, head, element, surface);
  }
  return surface;
}

}  // namespace dea
