// Parts of a mesh and their instances (2.5): nodes, elements, sets and surfaces under a prefix, moved.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "io/feb/feb_reading.h"

namespace dea::feb {
namespace {

/// `count` numbers, separated by commas.
std::vector<double> read_numbers(const Reading& reading, const XMLElement& element, std::size_t count) {
  const std::string text = text_of(element);
  std::string_view rest = text;
  std::vector<double> numbers;
  double value = 0.0;
  while (numbers.size() < count && (numbers.empty() || take_comma(rest)) && take_double(rest, value) == Number::Ok) {
    numbers.push_back(value);
  }
  if (numbers.size() != count || !trim(rest).empty()) {
    fail(reading, element, fmt::format("{} = {}, expected {} numbers", element.Name(), quote(trim(text)), count));
  }
  return numbers;
}

/// A rotation as FEBio writes it: quaternion x,y,z,w; a vector along the axis with the angle in degrees as its length;
/// or angles about x, y, z in degrees, in this order about the fixed axes.
Eigen::Matrix3d read_rotation(const Reading& reading, const XMLElement& element) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  const std::string type = attribute(element, "type");
  if (type.empty() || type == "quaternion") {
    const std::vector<double> q = read_numbers(reading, element, 4);
    const Eigen::Quaterniond turn(q[3], q[0], q[1], q[2]);
    if (turn.vec().isZero(0)) return Eigen::Matrix3d::Identity();  // as in quatd::RotateVector
    if (turn.w() == 0)
      fail(reading, element,
           fmt::format(
               "rotate = {}: FEBio turns by no quaternion whose last number is 0; give a half turn with type vector, "
               "in degrees",
               quote(trim(text_of(element)))));
    if (!(std::abs(turn.norm() - 1.0) <= 1e-3))
      fail(reading, element,
           fmt::format(
               "rotate: the quaternion has length {:g}, expected x,y,z,w of length 1 (FEBio would scale the part "
               "by the square of it)",
               turn.norm()));
    return turn.normalized().toRotationMatrix();
  }
  if (type != "vector" && type != "Euler") {
    fail(reading, element, fmt::format("rotate with type {}, expected quaternion, vector or Euler", quote(type)));
  }
  const std::vector<double> v = read_numbers(reading, element, 3);
  const Vector3d r = kDegree * Vector3d(v[0], v[1], v[2]);
  if (type == "vector") {
    if (r.norm() == 0) return Eigen::Matrix3d::Identity();
    return Eigen::AngleAxisd(r.norm(), r.normalized()).toRotationMatrix();
  }
  return (Eigen::AngleAxisd(r[2], Vector3d::UnitZ()) * Eigen::AngleAxisd(r[1], Vector3d::UnitY()) *
          Eigen::AngleAxisd(r[0], Vector3d::UnitX()))
      .toRotationMatrix();
}

/// Reads the part once more, as this instance of it.
void add_instance(Reading& reading, const Part& part, Instance& instance) {
  if (reading.instance != nullptr)
    fail(reading, *part.element, "a part inside a part, expected parts beside each other: move it out");
  const int outer_file = reading.file;
  instance.first_node = reading.nodes.size();
  const int first_element = reading.elements.size();
  reading.file = part.file;
  reading.instance = &instance;
  constexpr TagReader kReaders[] = {
      {"Nodes", read_nodes}, {"Elements", read_elements}, {"NodeSet", read_node_set}, {"Surface", read_named_surface}};
  read_children(reading, *part.element, kReaders, pass_over);
  reading.instance = nullptr;
  reading.file = outer_file;
  constexpr int kMostCopied = 5'000'000;  // one line makes another copy of a part, however large
  reading.copied += reading.nodes.size() - instance.first_node + reading.elements.size() - first_element;
  if (reading.copied > kMostCopied)
    fail(reading, *part.element,
         fmt::format("the instances of parts have more than {} nodes and elements: is one copied again and again?",
                     kMostCopied));
}

}  // namespace

void read_part(Reading& reading, const XMLElement& element) {
  const std::string name = need_attribute(reading, element, "name");
  const std::string type = attribute(element, "type");
  if (!type.empty() && type != "template" && type != "instance") {
    fail(reading, element, fmt::format("Part with type {}, expected template or instance", quote(type)));
  }
  const Part& part = element.Attribute("from") != nullptr
                         ? find_part_in_file(reading, element, name)
                         : add_named(reading, element, reading.parts, name, Part{&element, reading.file}, "part");
  if (type != "instance") return;
  Instance instance;
  instance.prefix = name + ".";
  add_instance(reading, part, instance);
}

void read_instance(Reading& reading, const XMLElement& element) {
  const std::string name = need_attribute(reading, element, "part");
  const auto part = reading.parts.find(name);
  if (part == reading.parts.end()) {
    fail(reading, element, fmt::format("part = {}, expected the name of a Part above it", quote(name)));
  }
  Instance instance;
  instance.prefix = (element.Attribute("name") != nullptr ? attribute(element, "name") : name) + ".";
  for (const XMLElement& child : children(element)) {
    const std::string_view tag = child.Name();
    if (tag == "translate") {
      instance.translation = read_vector(reading, child);
    } else if (tag == "rotate") {
      instance.turn = read_rotation(reading, child);
    } else if (tag == "scale") {
      instance.scale = read_vector(reading, child);
      if (!(instance.scale.array() > 0).all()) {
        fail(reading, child, fmt::format("scale = {}, need three factors > 0", quote(trim(text_of(child)))));
      }
    } else if (tag == "Elements") {
      instance.materials[need_attribute(reading, child, "name")] = need_attribute(reading, child, "mat");
    } else {
      fail(reading, child, fmt::format("<{}> in Instance, expected translate, rotate, scale or Elements", tag));
    }
  }
  add_instance(reading, part->second, instance);
}

}  // namespace dea::feb
