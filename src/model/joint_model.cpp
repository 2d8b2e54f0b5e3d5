#include <febiodea/model/joint_model.h>

#include <fmt/format.h>

#include <cassert>

namespace dea {

std::string where(const JointModel& model, Origin origin) {
  if (origin.file < 0 || origin.file >= static_cast<int>(model.files.size())) return {};
  const std::string& file = model.files[static_cast<std::size_t>(origin.file)];
  return origin.line > 0 ? fmt::format("{}:{}: ", file, origin.line) : fmt::format("{}: ", file);
}

Fault make_fault(const JointModel& model, Origin origin, Sentence found, Sentence expected) {
  std::string place = where(model, origin);
  if (!place.empty()) place.resize(place.size() - 2);
  return {.place = std::move(place), .found = std::move(found), .expected = std::move(expected)};
}

InputError fault_at(const JointModel& model, Origin origin, Sentence found, Sentence expected) {
  return InputError(make_fault(model, origin, std::move(found), std::move(expected)));
}

bool double_contact(const Contact& a, const Contact& b) {
  const bool same_time = a.step == b.step || a.step < 0 || b.step < 0;
  return same_time && ((a.primary == b.primary && a.secondary == b.secondary) ||
                       (a.primary == b.secondary && a.secondary == b.primary));
}

int nodes_per_element(ElementShape shape) {
  switch (shape) {
    case ElementShape::Hex8:
      return 8;
    case ElementShape::Hex20:
      return 20;
    case ElementShape::Hex27:
      return 27;
    case ElementShape::Penta6:
      return 6;
    case ElementShape::Penta15:
      return 15;
    case ElementShape::Tet4:
      return 4;
    case ElementShape::Tet5:
      return 5;
    case ElementShape::Tet10:
      return 10;
    case ElementShape::Tet15:
      return 15;
    case ElementShape::Tet20:
      return 20;
    case ElementShape::Pyra5:
      return 5;
    case ElementShape::Pyra13:
      return 13;
    case ElementShape::Tri3:
      return 3;
    case ElementShape::Tri6:
      return 6;
    case ElementShape::Quad4:
      return 4;
    case ElementShape::Quad8:
      return 8;
    case ElementShape::Quad9:
      return 9;
    case ElementShape::Line2:
      return 2;
    case ElementShape::Line3:
      return 3;
  }
  assert(false);
  return 0;
}

bool is_shell(ElementShape shape) {
  return shape == ElementShape::Tri3 || shape == ElementShape::Tri6 || shape == ElementShape::Quad4 ||
         shape == ElementShape::Quad8 || shape == ElementShape::Quad9;
}

bool is_line(ElementShape shape) { return shape == ElementShape::Line2 || shape == ElementShape::Line3; }

}  // namespace dea
