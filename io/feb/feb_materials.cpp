// Materials of a file; io/febio/febio_material.cpp reduces them to density and small-strain E and nu.
#include <fmt/format.h>

#include <cmath>

#include "io/feb/feb_reading.h"
#include "io/febio/febio_material.h"

namespace dea::feb {
namespace {

/// FEBio's: a centre of mass that is written counts, unless <override_com> behind it says 0; 1 without one is the
/// origin.
void read_center_of_mass(Reading& reading, const XMLElement& element, Material& material) {
  bool counts = false;
  Vector3d center = Vector3d::Zero();
  for (const XMLElement& child : children(element)) {
    const std::string_view tag = child.Name();
    if (tag == "center_of_mass") {
      center = read_vector(reading, child);
      counts = true;
    } else if (tag == "override_com") {
      counts = febio::to_flag(reading, origin_of(reading, child), tag, text_of(child));
    }
  }
  const std::string owner = fmt::format("rigid body {}", quote(material.name));
  if (counts) {
    if (element.FirstChildElement("center_of_mass") == nullptr)
      febio::assume(reading, origin_of(reading, element), owner, "center_of_mass", "0,0,0");
    material.center_of_mass = center;
  } else if (const XMLElement* given = element.FirstChildElement("center_of_mass")) {
    ignore(
        reading, *given,
        fmt::format("<center_of_mass> of {}, for <override_com> is 0: it is that of the elements, as in FEBio", owner));
  }
}

void read_material(Reading& reading, const XMLElement& element) {
  Material material;
  material.origin = origin_of(reading, element);
  const auto id = whole_int(need_attribute(reading, element, "id"));
  if (!id || *id < 1)
    fail(reading, element,
         fmt::format("material with id = {}, expected a positive whole number", quote(attribute(element, "id"))));
  material.id = *id;
  material.name = element.Attribute("name") != nullptr ? attribute(element, "name") : fmt::format("Material{}", *id);
  for (const Material& other : reading.model.materials) {
    if (other.id == material.id) {
      fail(reading, element,
           fmt::format("material id {} exists twice: {} and {}; renumber one", *id, quote(other.name),
                       quote(material.name)));
    }
  }
  const int place = static_cast<int>(reading.model.materials.size());
  if (!reading.material_index.emplace(material.name, place).second) {
    if (reading.rules->unique_materials)
      fail(reading, element, fmt::format("material {} exists twice: rename one", quote(material.name)));
    reading.ambiguous_materials.insert(material.name);  // old files number them; a fault where the name is used
    material.name = fmt::format("{} (material {})", material.name, *id);
    reading.material_index.emplace(material.name, place);
  }
  material.type = need_attribute(reading, element, "type");
  material.rigid = material.type == "rigid body";
  const febio::Component given = component_of(reading, element);
  febio::check_material_words(reading, given);
  if (material.rigid) {
    read_center_of_mass(reading, element, material);
    if (const XMLElement* parent = element.FirstChildElement("parent_id");
        parent != nullptr && read_int(reading, *parent) >= 0)
      unsupported(reading, *parent, fmt::format("<parent_id> of rigid body {}", quote(material.name)),
                  "give its elements the parent's material: both are one body then");
    material.note = "rigid body";
  } else {
    set_elasticity(material, given, reading.rules->up_to_25, reading.model);
  }
  std::string why;
  set_density(material, given, reading.model, why);
  if (std::isnan(material.density) && material.rigid && !material.center_of_mass) {
    unsupported(reading, *element.FirstChildElement("density"),
                fmt::format("rigid body whose density is not one number ({})", why), "give it a center_of_mass");
  }
  reading.model.materials.push_back(std::move(material));
}

}  // namespace

void read_materials(Reading& reading, const XMLElement& section) {
  constexpr TagReader kReaders[] = {{"material", read_material}};
  read_children(reading, section, kReaders, pass_over);
}

}  // namespace dea::feb
