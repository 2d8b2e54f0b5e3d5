// src/joint/contact_side.h – one side of a contact, as the stages of its recognition see it, and its surface with the
// elements that carry it.
#pragma once
#include <string>
#include <vector>

#include "src/base/error.h"
#include "src/facts/given_layer.h"
#include "src/facts/parts.h"

namespace dea {

/// References: must not outlive what it was made of.
struct ContactSide {
  const ModelParts& parts;
  const Contact& contact;
  int side;   ///< 0: primary, 1: secondary
  int index;  ///< of the surface
  const Surface& surface;
  GivenLayer given;
  std::vector<SymmetryPlane> planes;    ///< of the contact (find_planes)
  std::vector<unsigned char> in_plane;  ///< per node: as make_surface_mesh has it (find_planes)
};
/// Without its planes: only the stages that make surfaces need them.
ContactSide contact_side(const ModelParts& parts, const Contact& contact, int side);
void find_planes(ContactSide& in);

/// `contact "c", surface "s": found; expected`, at the surface's place; to be thrown.
InputError refusal_of(const ContactSide& in, const Sentence& found, const Sentence& expected);

/// Of a contact of type dea whose layer is to be measured, and cannot be.
InputError unmeasured(const ContactSide& in, const char* why);

/// A setting of this surface, with the parameter of a contact of type dea that says the same.
NamedSetting setting_of(const ContactSide& in, const char* setting, const char* value = "VALUE");
/// E and nu.
Sentence modulus_settings(const ContactSide& in);
/// "primary_thickness": a parameter of a contact of type dea.
std::string parameter_of(const ContactSide& in, const char* setting);

/// Facets of a surface with their carrying elements, oriented out of them.
struct CarriedSurface {
  FacetList facets;
  std::vector<ElementFace> carriers;  ///< one per facet
  bool on_shells = false;             ///< a shell has two sides: the surface's own orientation tells which
  int turned = 0;                     ///< facets that the model winds into their solid element
};
/// InputError: a fault of the surface or an element.
CarriedSurface carried_surface(const ModelParts& parts, int surface);

/// InputError: a solid element is inside out or has no volume.
void check_volume(const JointModel& model, const Domain& domain, int element);

}  // namespace dea
