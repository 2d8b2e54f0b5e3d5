// FEBio's objects as components: parameters and parts as a file of version 4.0 would have them.
#include <FEBioMech/FERigidBody.h>
#include <FEBioMech/FERigidConnector.h>
#include <FECore/FEModelLoad.h>
#include <FECore/FEModelParam.h>
#include <FECore/FEProperty.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string_view>

#include "plugin/fe_reading.h"

namespace dea::fe {

namespace {

using febio::Component;

/// Numbers that read back as they are.
std::string text(double x) { return fmt::format("{:.17g}", x); }
std::string text(const vec3d& v) { return fmt::format("{:.17g},{:.17g},{:.17g}", v.x, v.y, v.z); }

/// FEBio's name of a degree of freedom.
std::string dof_name(Reading& reading, int dof) {
  const char* name = dof < 0 ? nullptr : reading.fem.GetDOFS().GetDOFName(dof);
  return name == nullptr ? std::to_string(dof) : name;
}

/// True for numbers that stand for degrees of freedom of the model; others count within a list of their own.
bool is_dof(FEParam& parameter) {
  const char* enums = parameter.enums();
  return enums != nullptr && std::string_view(enums).rfind("$(dof_list", 0) == 0;
}

/// Numbers of a list, or the names of the degrees of freedom they stand for.
std::string list_text(Reading& reading, FEParam& parameter) {
  std::vector<std::string> words;
  for (const int number : parameter.value<std::vector<int>>())
    words.push_back(is_dof(parameter) ? dof_name(reading, number) : std::to_string(number));
  return fmt::format("{}", fmt::join(words, ","));
}

/// A value that may be a map or an expression: its kind then, and the text of an expression.
template <class Mapped>
void set_mapped(FEParam& parameter, Component& component) {
  Mapped& mapped = parameter.value<Mapped>();
  if (mapped.isConst()) {
    component.text = text(mapped.constValue());
    return;
  }
  component.type = kind_of(parameter);
  component.text = component.type == "math" ? text_of(*mapped.valuator(), "math") : component.type;
}

/// False: a parameter of a kind that no condition, load or joint of ours has.
bool set_value(Reading& reading, FEParam& parameter, Component& component) {
  if (parameter.dim() > 1) {
    if (parameter.type() != FE_PARAM_INT || std::string_view(parameter.name()) != "local") return false;
    const int* numbers = parameter.pvalue<int>();
    component.text = fmt::format("{}", fmt::join(numbers, numbers + parameter.dim(), ","));
    return true;
  }
  switch (parameter.type()) {
    case FE_PARAM_INT: {
      const int number = parameter.value<int>();
      component.text = is_dof(parameter) ? dof_name(reading, number) : std::to_string(number);
      return true;
    }
    case FE_PARAM_BOOL:
      component.text = parameter.value<bool>() ? "1" : "0";
      return true;
    case FE_PARAM_DOUBLE:
      component.text = text(parameter.value<double>());
      return true;
    case FE_PARAM_VEC3D:
      component.text = text(parameter.value<vec3d>());
      return true;
    case FE_PARAM_STD_STRING:
      component.text = parameter.value<std::string>();
      return true;
    case FE_PARAM_STD_VECTOR_INT:
      component.text = list_text(reading, parameter);
      return true;
    case FE_PARAM_STD_VECTOR_VEC2D:
      for (const vec2d& point : parameter.value<std::vector<vec2d>>()) {
        component.parts.emplace_back();
        component.parts.back().text = text(point.x()) + "," + text(point.y());
      }
      return true;
    case FE_PARAM_DOUBLE_MAPPED:
      set_mapped<FEParamDouble>(parameter, component);
      return true;
    case FE_PARAM_VEC3D_MAPPED:
      set_mapped<FEParamVec3>(parameter, component);
      return true;
    default:
      return false;
  }
}

/// Whether the file gives this parameter, of those FEBio keeps that of; the others have a value in any case.
bool is_given(FEParam& parameter) {
  const bool* given = parameter.GetWatchVariable();
  return given == nullptr || *given;
}

void set_part(Component& component, const char* tag, const std::string& value) {
  for (Component& part : component.parts)
    if (part.tag == tag) part.text = value;
}

/// FEBio's Init turns the numbers of a connector's materials into bodies; the pointers, protected, tell that it has
/// been called.
struct Connected : FERigidConnector {
  static FERigidBody* a(FERigidConnector& c) { return c.*&Connected::m_rbA; }
  static FERigidBody* b(FERigidConnector& c) { return c.*&Connected::m_rbB; }
};

/// Once FEModel::Init has begun some loads count bodies instead of materials: back to the number of the material.
void name_material(const Reading& reading, Component& component, const char* tag) {
  const febio::Component* part = febio::find(component, tag);
  if (!reading.in_init || part == nullptr) return;
  const auto body = febio::whole_int(part->text);
  if (!body || *body < 0 || *body >= reading.fem.RigidBodies())
    febio::fail(reading, kNowhere, fmt::format("{} without {}", quote(component.type), tag));
  set_part(component, tag, std::to_string(reading.fem.GetRigidBody(*body)->m_mat + 1));
}

}  // namespace

Component component_of(Reading& reading, FECoreBase& fe, const std::string& tag) {
  Component component;
  component.tag = tag;
  component.type = type_of(fe);
  component.name = fe.GetName();
  FEParameterList& list = fe.GetParameterList();
  FEParamIterator it = list.first();
  for (int i = 0; i < list.Parameters(); ++i, ++it) {
    FEParam& parameter = *it;
    Component part;
    part.tag = parameter.name();
    part.origin = kNowhere;
    const int controller = controller_of(reading, parameter);
    if (controller >= 0) part.lc = std::to_string(controller + 1);
    if (!is_given(parameter) || !set_value(reading, parameter, part)) continue;
    if (part.tag == "local") component.text = part.text;  // places of nodes: in a file the direction's own text
    component.parts.push_back(std::move(part));
  }
  for (int i = 0; i < fe.PropertyClasses(); ++i) {
    FEProperty& property = *fe.PropertyClass(i);
    if (property.IsReference()) continue;
    for (int k = 0; k < property.size(); ++k)
      if (property.get(k) != nullptr)
        component.parts.push_back(component_of(reading, *property.get(k), property.GetName()));
  }
  return component;
}

Component connector_of(Reading& reading, FERigidConnector& fe) {
  Component component = component_of(reading, fe, "constraint");
  if (const FERigidBody* a = Connected::a(fe)) set_part(component, "body_a", std::to_string(a->m_mat + 1));
  if (const FERigidBody* b = Connected::b(fe)) set_part(component, "body_b", std::to_string(b->m_mat + 1));
  return component;
}

Component load_of(Reading& reading, FEModelLoad& fe, const std::string& tag) {
  Component component = component_of(reading, fe, tag);
  const std::string& type = component.type;
  if (type == "rigid_follower_force" || type == "rigid_follower_moment") name_material(reading, component, "rb");
  if (type == "rigid_axial_force") {
    name_material(reading, component, "rbA");
    name_material(reading, component, "rbB");
  }
  for (Component& part : component.parts)
    if (part.tag == "rigid_cable_point") name_material(reading, part, "rigid_body_id");
  return component;
}

}  // namespace dea::fe
