// Springs between nodes: discrete materials and sets of node pairs (2.5 and later).
#include <fmt/format.h>

#include <cmath>

#include <febiodea/base/error.h>
#include <febiodea/io/feb/feb_reading.h>
#include <febiodea/model/load_curve.h>

namespace dea::feb {
namespace {

/// A number; one with a controller or map gives a reason in `why`.
double plain_number(const Reading& reading, const XMLElement& parent, const char* name, double fallback,
                    std::string& why) {
  const XMLElement* child = parent.FirstChildElement(name);
  if (child == nullptr) return fallback;
  const std::string type = attribute(*child, "type");
  const bool plain = child->Attribute("lc") == nullptr && (type.empty() || type == "const");
  if (!plain && why.empty()) why = fmt::format("spring whose {} is not one number", name);
  return plain ? read_double(reading, *child) : fallback;
}

/// Fills `force` from <force type="point|math|const|linear ramp|step">, or notes the load curve that is the function.
void read_force(Reading& reading, const XMLElement& element, DiscreteMaterial& material) {
  LoadController& curve = material.springs.force.emplace();
  curve.origin = origin_of(reading, element);
  const std::string type = attribute(element, "type");
  if (type.empty() && element.Attribute("lc") != nullptr) {  // a load curve, with the measure in place of time
    material.function = read_lc(reading, element);
    if (!trim(text_of(element)).empty()) material.function_scale = read_double(reading, element);
    return;
  }
  if (type == "point") {
    const XMLElement* log = element.FirstChildElement("log");
    read_curve(reading, element, false, curve);
    if (element.FirstChildElement("points") == nullptr) curve.unsupported = "a point function without <points>";
    if (log != nullptr && read_bool(reading, *log)) curve.unsupported = "log = 1";
  } else if (type == "math") {
    std::string text = is_leaf(element) ? text_of(element) : child_text(element, "math");
    text = trim(text);
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
    const double value =
        is_leaf(element) ? read_double(reading, element) : child_double(reading, element, "value", 0.0);
    curve.points = {{0.0, value}};
  } else if (type == "linear ramp") {
    const double slope = child_double(reading, element, "slope", 0.0);
    const double intercept = child_double(reading, element, "intercept", 0.0);
    curve.points = {{0.0, intercept}, {1.0, intercept + slope}};
    curve.extend = LoadController::Extend::Extrapolate;
  } else {
    curve.unsupported = fmt::format("force of type {}", quote(type));
  }
}

/// Rises (or falls) with E at zero and approaches sM in tension, -sm in compression.
void read_experimental(const Reading& reading, const XMLElement& element, DiscreteMaterial& material) {
  const double E = plain_number(reading, element, "E", 0.0, material.unsupported);
  const double most = plain_number(reading, element, "sM", 0.0, material.unsupported);
  const double least = plain_number(reading, element, "sm", 0.0, material.unsupported);
  if (!(E >= 0 && most > 0 && least > 0)) {
    fail(reading, element,
         fmt::format("experimental spring with E = {:g}, sM = {:g}, sm = {:g}, need E >= 0, sM > 0 and sm > 0", E, most,
                     least));
  }
  LoadController& curve = material.springs.force.emplace();
  curve.origin = origin_of(reading, element);
  curve.expression = fmt::format(
      "{0:.17g}*(1-exp(-{2:.17g}*max(t,0)/{0:.17g}))-{1:.17g}*(1-exp({2:.17g}*min(t,0)/{1:.17g}))", most, least, E);
}

void read_discrete_material(Reading& reading, const XMLElement& element) {
  DiscreteMaterial material;
  const std::string type = need_attribute(reading, element, "type");
  if (type == "linear spring" || type == "tension-only linear spring") {
    material.springs.stiffness = plain_number(reading, element, "E", 1.0, material.unsupported);
    material.springs.tension_only = type != "linear spring";
  } else if (type == "nonlinear spring") {
    read_nonlinear(reading, element, material);
  } else if (type == "experimental spring") {
    read_experimental(reading, element, material);
  } else {
    material.unsupported = fmt::format("discrete material {}", quote(type));
    material.advice = febio::word_advice(febio::WordOf::DiscreteMaterial, type);
  }
  if (material.unsupported.empty() && material.springs.force && !material.springs.force->unsupported.empty()) {
    material.unsupported = fmt::format("{} with {}", type, material.springs.force->unsupported);
  }
  reading.discrete_materials.push_back(std::move(material));
}

void read_discrete_springs(Reading& reading, const XMLElement& element) {
  const std::string set_name = need_attribute(reading, element, "discrete_set");
  const auto set = reading.discrete_set_index.find(set_name);
  if (set == reading.discrete_set_index.end()) {
    fail(reading, element,
         fmt::format("discrete_set = {}, expected the name of a DiscreteSet{}", quote(set_name),
                     those_there(set_name, reading.discrete_set_index)));
  }
  const std::string dmat = need_attribute(reading, element, "dmat");
  const auto number = whole_int(dmat);
  if (!number || *number < 1 || *number > static_cast<int>(reading.discrete_materials.size())) {
    fail(reading, element,
         fmt::format("dmat = {}, expected the number of one of the {} discrete materials above it", quote(dmat),
                     reading.discrete_materials.size()));
  }
  const std::string type = attribute(element, "type");
  const DiscreteMaterial& material = reading.discrete_materials[static_cast<std::size_t>(*number) - 1];
  if (!type.empty() && type != "spring") {
    unsupported(reading, element, fmt::format("discrete elements of type {}", quote(type)),
                "make it type spring, or take it out");
    return;
  }
  add_springs(reading, element, material, set->second);
}

}  // namespace

void add_springs(Reading& reading, const XMLElement& element, const DiscreteMaterial& material, int set) {
  if (!material.unsupported.empty()) {
    unsupported(reading, element, material.unsupported, material.advice);
    return;
  }
  DiscreteSprings springs = material.springs;
  springs.set = set;
  springs.step = reading.step;
  springs.name = attribute(element, "name");
  if (springs.name.empty()) springs.name = reading.model.discrete_sets[static_cast<std::size_t>(set)].name;
  springs.origin = origin_of(reading, element);
  if (material.function > 0) {
    reading.function_uses.push_back(
        {static_cast<int>(reading.model.discrete_springs.size()), material.function, material.function_scale});
  }
  reading.model.discrete_springs.push_back(std::move(springs));
}

void read_nonlinear(Reading& reading, const XMLElement& element, DiscreteMaterial& material) {
  const XMLElement* scale = element.FirstChildElement("scale");
  const XMLElement* measure = element.FirstChildElement("measure");
  const XMLElement* force = element.FirstChildElement("force");
  material.springs.scale = scale == nullptr ? Scaled{1.0, 0} : read_scaled(reading, *scale);
  if (measure != nullptr) {
    const int word = read_word(*measure, {"elongation", "strain", "stretch"});
    if (word < 0) {
      fail(reading, *measure,
           fmt::format("measure = {}, expected elongation, strain or stretch", quote(trim(text_of(*measure)))));
    }
    material.springs.measure = static_cast<DiscreteSprings::Measure>(word);
  }
  if (force == nullptr) fail(reading, element, "nonlinear spring without <force>: add it, of type point or math");
  read_force(reading, *force, material);
}

void resolve_functions(Reading& reading) {
  JointModel& model = reading.model;
  for (const FunctionUse& use : reading.function_uses) {
    DiscreteSprings& springs = model.discrete_springs[static_cast<std::size_t>(use.springs)];
    const int index = need_controller(model, use.id, springs.origin);
    const LoadController& curve = model.controllers[static_cast<std::size_t>(index)];
    if (!curve.unsupported.empty() || !curve.expression.empty()) {
      unsupported(reading, springs.origin,
                  fmt::format("springs whose force is load controller {} with {}", curve.id,
                              curve.unsupported.empty() ? "an expression" : curve.unsupported),
                  "give the force as points: <force type=\"point\">");
    }
    springs.force = curve;
    for (auto& point : springs.force->points) point[1] *= use.scale;
  }
}

void read_discrete(Reading& reading, const XMLElement& section) {
  static constexpr TagReader readers[] = {{"discrete_material", read_discrete_material},
                                          {"discrete", read_discrete_springs},
                                          {"rigid_axial_force", read_axial_force},
                                          {"rigid_cable", read_cable}};
  read_children(reading, section, readers);
}

}  // namespace dea::feb
