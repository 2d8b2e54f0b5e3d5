// Springs between nodes: FEBio keeps each set of them as a domain with a discrete material.
#include <FECore/FEDiscreteDomain.h>
#include <FECore/FEFunction1D.h>
#include <FECore/FEMesh.h>
#include <FECore/FEProperty.h>
#include <fmt/format.h>

#include <febiodea/model/load_curve.h>
#include <febiodea/plugin/fe_reading.h>

namespace dea::fe {

namespace {

/// Index of the discrete set a domain of springs was made from; a new one if there is none.
int discrete_set_of(Reading& reading, FEDomain& fe) {
  auto& sets = reading.model.discrete_sets;
  for (std::size_t i = 0; i < sets.size(); ++i)
    if (sets[i].name == fe.GetName()) return static_cast<int>(i);
  DiscreteSet set;
  set.name = fe.GetName();
  for (int i = 0; i < fe.Elements(); ++i) set.pairs.push_back({fe.ElementRef(i).m_node[0], fe.ElementRef(i).m_node[1]});
  sets.push_back(std::move(set));
  return static_cast<int>(sets.size()) - 1;
}

/// A number; one with a controller or map gives a reason in `why`.
double plain_number(Reading& reading, FECoreBase& material, const char* name, std::string& why) {
  FEParam& parameter = need_parameter(reading, material, name);
  const auto number = number_of(parameter);
  const bool plain = number && controller_of(reading, parameter) < 0;
  if (!plain && why.empty()) why = fmt::format("spring whose {} is not one number", name);
  return number.value_or(0.0);
}

/// A force as a function of elongation, strain or stretch; what cannot be evaluated is said in its `unsupported`.
LoadController function_of(Reading& reading, FECoreBase& fe) {
  LoadController curve;
  const std::string type = type_of(fe);
  if (type == "point") {
    const auto& points = need_parameter(reading, fe, "points").value<std::vector<vec2d>>();
    set_curve(curve, need_int(reading, fe, "interpolate"), need_int(reading, fe, "extend"), points);
    if (points.empty()) curve.unsupported = "a point function without <points>";
    if (flag(fe, "log")) curve.unsupported = "log = 1";
  } else if (type == "math") {
    const std::string text = text_of(fe, "math");
    const std::vector<std::string> variables = expression_variables(text);
    if (variables.size() > 1) {
      curve.unsupported = fmt::format("expression {}: several variables", quote(text));
    } else {
      curve.expression = text;
      if (!variables.empty()) curve.variable = variables[0];
      const std::string fault = expression_fault(text, {curve.variable});
      if (!fault.empty()) curve.unsupported = fmt::format("expression {}: {}", quote(text), fault);
    }
  } else if (type == "const") {
    curve.points = {{0.0, need_number(reading, fe, "value")}};
  } else if (type == "linear ramp") {
    const double slope = need_number(reading, fe, "slope"), intercept = need_number(reading, fe, "intercept");
    curve.points = {{0.0, intercept}, {1.0, intercept + slope}};
    curve.extend = LoadController::Extend::Extrapolate;
  } else {
    curve.unsupported = fmt::format("force of type {}", quote(type));
  }
  FEParameterList& list = fe.GetParameterList();
  FEParamIterator parameter = list.first();
  for (int i = 0; i < list.Parameters(); ++i, ++parameter)
    if (controller_of(reading, *parameter) >= 0)
      curve.unsupported = fmt::format("{} of its force following a load controller", parameter->name());
  return curve;
}

void read_nonlinear(Reading& reading, FECoreBase& material, DiscreteSprings& springs, std::string& why) {
  springs.scale = need_scaled(reading, material, "scale");
  const int measure = need_int(reading, material, "measure");
  FEProperty* force = material.FindProperty("force");
  if (measure < 0 || measure > 2) {
    why = fmt::format("nonlinear spring with measure = {}", measure);
  } else if (force == nullptr || force->size() == 0 || force->get(0) == nullptr) {
    why = "nonlinear spring without <force>";
  } else {
    springs.measure = static_cast<DiscreteSprings::Measure>(measure);
    springs.force = function_of(reading, *force->get(0));
    if (!springs.force->unsupported.empty()) why = fmt::format("nonlinear spring with {}", springs.force->unsupported);
  }
}

/// Rises (or falls) with E at zero and approaches sM in tension, -sm in compression.
void read_experimental(Reading& reading, FECoreBase& material, DiscreteSprings& springs, std::string& why) {
  const double E = plain_number(reading, material, "E", why);
  const double most = plain_number(reading, material, "sM", why);
  const double least = plain_number(reading, material, "sm", why);
  if (!(E >= 0 && most > 0 && least > 0)) {
    if (why.empty())
      why = fmt::format("experimental spring with E = {:g}, sM = {:g}, sm = {:g}, where E >= 0, sM > 0 and sm > 0", E,
                        most, least);
    return;
  }
  springs.force.emplace().expression = fmt::format(
      "{0:.17g}*(1-exp(-{2:.17g}*max(t,0)/{0:.17g}))-{1:.17g}*(1-exp({2:.17g}*min(t,0)/{1:.17g}))", most, least, E);
}

void read_springs(Reading& reading, FEDomain& fe) {
  FEMaterial* material = fe.GetMaterial();
  const std::string type = material == nullptr ? "" : type_of(*material);
  DiscreteSprings springs;
  std::string why, advice;
  if (type_of(fe).rfind("deformable-spring", 0) == 0) {  // made of pieces that bend
    why = "discrete elements of type \"wire\"";
    advice = "make it type spring, or take it out";
  } else if (type == "linear spring" || type == "tension-only linear spring") {
    springs.stiffness = plain_number(reading, *material, "E", why);
    springs.tension_only = type != "linear spring";
  } else if (type == "nonlinear spring") {
    read_nonlinear(reading, *material, springs, why);
  } else if (type == "experimental spring") {
    read_experimental(reading, *material, springs, why);
  } else {
    why = fmt::format("discrete material {}", quote(type));
    advice = febio::word_advice(febio::WordOf::DiscreteMaterial, type);
  }
  if (!why.empty()) {
    unsupported(reading, why, advice);
    return;
  }
  springs.set = discrete_set_of(reading, fe);
  springs.name = fe.GetName();
  springs.origin = kNowhere;
  reading.model.discrete_springs.push_back(std::move(springs));
}

}  // namespace

void read_discrete(Reading& reading) {
  FEMesh& mesh = reading.fem.GetMesh();
  for (int i = 0; i < mesh.Domains(); ++i)
    if (mesh.Domain(i).Class() == FE_DOMAIN_DISCRETE) read_springs(reading, mesh.Domain(i));
}

}  // namespace dea::fe
