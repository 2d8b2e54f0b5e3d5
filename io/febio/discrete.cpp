// Springs between nodes: what a discrete material says of them.
#include <fmt/format.h>

#include "io/febio/interpret.h"
#include "src/base/error.h"
#include "src/model/load_curve.h"

namespace dea::febio {
namespace {

/// A number; one with a controller or map gives a reason in `why`.
double plain_number(const Draft& draft, const Component& component, const char* tag, double fallback,
                    std::string& why) {
  const Component* part = find(component, tag);
  if (part == nullptr) return fallback;
  const bool plain = !part->lc && one_of(part->type, {"", "const"});
  if (!plain && why.empty()) why = fmt::format("spring whose {} is not one number", tag);
  return plain ? to_number(draft, part->origin, tag, part->text) : fallback;
}

/// An expression of one variable, whatever it is called.
void set_expression(LoadController& curve, std::string_view text) {
  const std::string expression(trim(text));
  const std::vector<std::string> variables = expression_variables(expression);
  if (variables.size() > 1) {
    curve.unsupported = fmt::format("expression {}: several variables", quote(expression));
    return;
  }
  curve.expression = expression;
  if (!variables.empty()) curve.variable = variables[0];
  const std::string fault = expression_fault(expression, {curve.variable});
  if (!fault.empty()) curve.unsupported = fmt::format("expression {}: {}", quote(expression), fault);
}

/// Fills `force` from a function of type point, math, const or linear ramp, or notes the load curve that is the
/// function.
void set_force(const Draft& draft, const Component& function, DiscreteMaterial& material) {
  LoadController& curve = material.springs.force.emplace();
  curve.origin = function.origin;
  const std::string& type = function.type;
  const bool leaf = function.parts.empty();
  if (type.empty() && function.lc) {  // a load curve, with the measure in place of time
    material.function = controller_of(draft, function);
    if (!trim(function.text).empty())
      material.function_scale = to_number(draft, function.origin, function.tag, function.text);
    return;
  }
  if (type == "point") {
    read_curve(draft, function, curve);
    if (find(function, "points") == nullptr) curve.unsupported = "a point function without <points>";
    if (flag_of(draft, function, "log")) curve.unsupported = "log = 1";
  } else if (type == "math") {
    set_expression(curve, leaf ? function.text : text_of(function, "math"));
  } else if (type == "const") {
    curve.points = {{0.0, leaf ? to_number(draft, function.origin, function.tag, function.text)
                               : number_of(draft, function, "value", 0.0)}};
  } else if (type == "linear ramp") {
    const double slope = number_of(draft, function, "slope", 0.0);
    const double intercept = number_of(draft, function, "intercept", 0.0);
    curve.points = {{0.0, intercept}, {1.0, intercept + slope}};
    curve.extend = LoadController::Extend::Extrapolate;
  } else {
    curve.unsupported = fmt::format("force of type {}", quote(type));
  }
  for (const Component& part : function.parts)
    if (part.lc) curve.unsupported = fmt::format("{} of its force following a load controller", part.tag);
}

void set_nonlinear(const Draft& draft, const Component& component, DiscreteMaterial& material) {
  const Component* scale = find(component, "scale");
  const Component* measure = find(component, "measure");
  const Component* force = find(component, "force");
  material.springs.scale = scale == nullptr ? Scaled{1.0, 0} : scaled(draft, *scale);
  if (measure != nullptr) {
    const int word = place_of_word(measure->text, {"elongation", "strain", "stretch"});
    if (word < 0)
      fail(draft, measure->origin,
           fmt::format("measure = {}, expected elongation, strain or stretch", quote(trim(measure->text))));
    material.springs.measure = static_cast<DiscreteSprings::Measure>(word);
  }
  if (force == nullptr)
    fail(draft, component.origin, "nonlinear spring without <force>: add it, of type point or math");
  set_force(draft, *force, material);
}

/// Rises (or falls) with E at zero and approaches sM in tension, -sm in compression.
void set_experimental(const Draft& draft, const Component& component, DiscreteMaterial& material) {
  const double E = plain_number(draft, component, "E", 0.0, material.unsupported);
  const double most = plain_number(draft, component, "sM", 0.0, material.unsupported);
  const double least = plain_number(draft, component, "sm", 0.0, material.unsupported);
  if (!material.unsupported.empty()) return;
  if (!(E >= 0 && most > 0 && least > 0))
    fail(draft, component.origin,
         fmt::format("experimental spring with E = {:g}, sM = {:g}, sm = {:g}, need E >= 0, sM > 0 and sm > 0", E, most,
                     least));
  LoadController& curve = material.springs.force.emplace();
  curve.origin = component.origin;
  curve.expression = fmt::format(
      "{0:.17g}*(1-exp(-{2:.17g}*max(t,0)/{0:.17g}))-{1:.17g}*(1-exp({2:.17g}*min(t,0)/{1:.17g}))", most, least, E);
}

}  // namespace

DiscreteMaterial discrete_material(Draft& draft, const Component& component) {
  DiscreteMaterial material;
  const std::string& type = component.type;
  if (type == "linear spring" || type == "tension-only linear spring") {
    if (type != "linear spring" && find(component, "E") == nullptr)
      fail(draft, component.origin, fmt::format("{} without <E>, which has no default: add it", type));
    assume_unless_given(draft, component, "E", "1");
    material.springs.stiffness = plain_number(draft, component, "E", 1.0, material.unsupported);
    material.springs.tension_only = type != "linear spring";
  } else if (type == "nonlinear spring") {
    set_nonlinear(draft, component, material);
  } else if (type == "experimental spring") {
    set_experimental(draft, component, material);
  } else {
    material.unsupported = fmt::format("discrete material {}", quote(type));
    material.advice = word_advice(WordOf::DiscreteMaterial, type);
  }
  const auto& force = material.springs.force;
  if (material.unsupported.empty() && force && !force->unsupported.empty())
    material.unsupported = fmt::format("{} with {}", type, force->unsupported);
  return material;
}

}  // namespace dea::febio
