#include "src/joint/given_values.h"

#include <algorithm>
#include <cmath>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/model/load_curve.h"

namespace dea {

namespace {

/// A number that a user may replace.
struct Replaceable {
  const char* parameter;
  Scaled in_model;
};

/// A thing of the model that has such numbers.
struct NamedThing {
  std::vector<std::string> names;
  std::string kind;  ///< in messages: "spring"
  std::vector<Replaceable> numbers;
  bool pulls = false;  ///< its force has one sense: a muscle does not push
  int body = -1;       ///< of a rigid force
  int axis = -1;       ///< of a rigid force: 0 x, 1 y, 2 z
};

void add_springs_between_nodes(const JointModel& model, std::vector<NamedThing>& things) {
  for (const DiscreteSprings& springs : model.discrete_springs) {
    const DiscreteSet& set = model.discrete_sets[at(springs.set)];
    NamedThing thing{{springs.name, set.name}, "spring", {}};
    if (const auto force = constant_force(springs)) {
      thing.kind = "spring of constant force";
      thing.numbers = {{kForce, {*force, springs.scale.controller}}};
      thing.pulls = true;
      things.insert(things.end(), set.pairs.size(), thing);
      continue;
    }
    if (springs.force) thing.kind = "spring by a curve";
    if (!springs.force) thing.numbers.push_back({kStiffness, Scaled{springs.stiffness}});
    for (const auto& pair : set.pairs) {
      things.push_back(thing);
      things.back().numbers.push_back(
          {kSlackLength, Scaled{(model.nodes[at(pair[1])] - model.nodes[at(pair[0])]).norm()}});
    }
  }
}

std::vector<NamedThing> named_things(const ModelParts& parts) {
  const JointModel& model = parts.model;
  std::vector<NamedThing> things;
  for (const RigidSpring& s : model.rigid_springs) {
    const double length = s.free_length > 0 ? s.free_length : (s.insertion_b - s.insertion_a).norm();
    things.push_back({{s.name}, "spring", {{kStiffness, Scaled{s.k}}, {kSlackLength, Scaled{length}}}});
  }
  add_springs_between_nodes(model, things);
  for (const RigidAxialForce& f : model.rigid_axial_forces)
    things.push_back({{f.name}, "axial force", {{kForce, f.force}}, true});
  for (const RigidCable& c : model.rigid_cables) things.push_back({{c.name}, "cable", {{kForce, c.force}}, true});
  for (const RigidLoad& l : model.rigid_loads)
    if (l.dof < 3)
      things.push_back(
          {{l.name}, "rigid force", {{kForce, l.value}}, false, body_of_material(parts, l.material), l.dof});
  return things;
}

std::vector<NamedThing> called(const std::vector<NamedThing>& things, const std::string& name) {
  std::vector<NamedThing> found;
  for (const NamedThing& thing : things)
    if (std::count(thing.names.begin(), thing.names.end(), name) > 0) found.push_back(thing);
  return found;
}

const Replaceable* number_of(const NamedThing& thing, const std::string& parameter) {
  for (const Replaceable& number : thing.numbers)
    if (parameter == number.parameter) return &number;
  return nullptr;
}

/// One entry of the settings.
struct GivenValue {
  std::string name, parameter;
  double value;
};

std::vector<GivenValue> given_values(const Settings& settings) {
  std::vector<GivenValue> values;
  for (const auto& [key, value] : settings.set_values) {
    const std::size_t dot = key.rfind('.');
    values.push_back({key.substr(0, dot), dot == key.npos ? "" : key.substr(dot + 1), value});
  }
  return values;
}

[[noreturn]] void refuse(const GivenValue& given, Sentence found, Sentence expected) {
  throw UsageError(
      Fault{.given = NamedSetting{"set", given.name + "." + given.parameter, fmt::format("{:g}", given.value)},
            .found = std::move(found),
            .expected = std::move(expected)});
}

[[noreturn]] void refuse_name(const std::vector<NamedThing>& things, const GivenValue& given) {
  std::vector<std::string> names;
  for (const NamedThing& thing : things)
    for (const std::string& name : thing.names)
      if (!name.empty() && std::count(names.begin(), names.end(), name) == 0) names.push_back(name);
  refuse(given,
         say("the model has no spring, axial force, cable or rigid force of this name{}; it has {}",
             did_you_mean(given.name, names), name_list(names, given.name)),
         {});
}

[[noreturn]] void refuse_parameter(const NamedThing& thing, const GivenValue& given) {
  std::string has;
  for (const Replaceable& number : thing.numbers) has += (has.empty() ? "" : ", ") + std::string(number.parameter);
  refuse(given, say("{} \"{}\" has no {};", thing.kind, given.name, given.parameter), say("it has {}", has));
}

/// Only what pushes or is no length would be another thing.
void check_sign(const NamedThing& thing, const Replaceable& number, const GivenValue& given) {
  const double v = given.value;
  if (given.parameter == kStiffness && !(v >= 0)) refuse(given, "a stiffness is not negative;", "give a number >= 0");
  if (given.parameter == kSlackLength && !(v > 0)) refuse(given, "a length is positive;", "give a number > 0");
  const double sense = number.in_model.factor < 0 ? -1.0 : 1.0;
  if (given.parameter == kForce && thing.pulls && !(sense * v >= 0))
    refuse(
        given,
        say("{} \"{}\" would push where it pulls in the model ({:g});", thing.kind, given.name, number.in_model.factor),
        say("give a number {} 0", sense > 0 ? ">=" : "<="));
}

/// A force that other settings have taken the place of would change nothing.
void check_in_use(const ModelParts& parts, const NamedThing& thing, const GivenValue& given) {
  if (thing.body < 0) return;
  const Settings& s = parts.settings;
  const auto is_ours = [&](const std::string& name) {
    return names_body(parts.model, parts.bodies.bodies, name, thing.body);
  };
  const std::string& body = parts.bodies.bodies[at(thing.body)].name;
  for (const auto& entry : s.force)
    if (is_ours(entry.first))
      refuse(given, say("{} takes the place of all forces on body \"{}\";", NamedSetting{"force", entry.first}, body),
             "leave one out");
  if (is_ours(s.loads.body))
    refuse(given, say("{} takes the place of all loads on body \"{}\";", NamedSetting{"loads", "", s.loads.file}, body),
           "leave one out");
}

/// Components of a force that share a name: one number cannot say them all.
void check_one_axis(const ModelParts& parts, const std::vector<NamedThing>& named, const GivenValue& given) {
  const NamedThing* first = nullptr;
  for (const NamedThing& thing : named) {
    if (thing.axis < 0 || given.parameter != kForce) continue;
    if (first == nullptr) first = &thing;
    if (thing.axis == first->axis) continue;
    const std::string& body = parts.bodies.bodies[at(thing.body)].name;
    refuse(given,
           say("rigid force \"{}\" acts along {} and {}, and one number cannot say both;", given.name,
               kDofNames[first->axis], kDofNames[thing.axis]),
           say("give the whole force with {}", NamedSetting{"force", body, "x,y,z"}));
  }
}

/// "60", or "29 to 33" of several.
std::string model_values(const std::vector<const Replaceable*>& numbers) {
  const auto [least, most] = std::minmax_element(
      numbers.begin(), numbers.end(),
      [](const Replaceable* a, const Replaceable* b) { return a->in_model.factor < b->in_model.factor; });
  const std::string low = fmt::format("{:.6g}", (*least)->in_model.factor),
                    high = fmt::format("{:.6g}", (*most)->in_model.factor);
  return low == high ? low : low + " to " + high;
}

/// What still scales the user's number; its value at the end, where a load curve has one for sure.
std::string controller_words(const JointModel& model, const std::vector<const Replaceable*>& numbers) {
  const int controller = numbers.front()->in_model.controller;
  const bool alike = std::all_of(numbers.begin(), numbers.end(),
                                 [&](const Replaceable* n) { return n->in_model.controller == controller; });
  if (!alike) return ", times their load controllers";
  if (controller < 0) return "";
  const LoadController& curve = model.controllers[at(controller)];
  std::string text = fmt::format(", times load controller {}", curve.id);
  if (!curve.expression.empty() || !curve.unsupported.empty()) return text;
  double end = 0.0;
  for (const Step& step : model.steps) end += step.duration;
  return text + fmt::format(", which is {:.6g} at time {:.6g}", value(curve, end), end);
}

}  // namespace

std::optional<double> given_value(const Settings& settings, const std::string& name, const char* parameter) {
  const auto found = settings.set_values.find(name + "." + parameter);
  return name.empty() || found == settings.set_values.end() ? std::nullopt : std::optional<double>(found->second);
}

std::optional<double> given_value(const JointModel& model, const Settings& settings, const DiscreteSprings& springs,
                                  const char* parameter) {
  const std::optional<double> own = given_value(settings, springs.name, parameter);
  return own ? own : given_value(settings, model.discrete_sets[at(springs.set)].name, parameter);
}

std::optional<double> constant_force(const DiscreteSprings& springs) {
  if (!springs.force || !springs.force->unsupported.empty()) return std::nullopt;
  const LoadController& curve = *springs.force;
  if (!curve.expression.empty()) {
    const bool fixed = expression_fault(curve.expression, {}).empty() && expression_variables(curve.expression).empty();
    return fixed ? std::optional<double>(springs.scale.factor * constant_value(curve.expression)) : std::nullopt;
  }
  if (curve.points.empty()) return std::nullopt;
  const double first = curve.points.front()[1];
  for (const auto& point : curve.points)
    if (point[1] != first) return std::nullopt;
  return springs.scale.factor * first;
}

void check_given_values(const ModelParts& parts) {
  if (parts.settings.set_values.empty()) return;
  const std::vector<NamedThing> things = named_things(parts);
  for (const GivenValue& given : given_values(parts.settings)) {
    const std::vector<NamedThing> named = called(things, given.name);
    if (named.empty() || given.name.empty()) refuse_name(things, given);
    if (!std::isfinite(given.value)) refuse(given, "this is no finite number;", "give one");
    bool any = false;
    for (const NamedThing& thing : named) {
      const Replaceable* number = number_of(thing, given.parameter);
      if (number == nullptr) continue;
      any = true;
      check_sign(thing, *number, given);
      check_in_use(parts, thing, given);
    }
    if (!any) refuse_parameter(named.front(), given);
    check_one_axis(parts, named, given);
  }
}

Findings given_value_findings(const ModelParts& parts) {
  Findings findings;
  if (parts.settings.set_values.empty()) return findings;
  const std::vector<NamedThing> things = named_things(parts);
  for (const GivenValue& given : given_values(parts.settings)) {
    const std::vector<NamedThing> named = called(things, given.name);
    std::vector<const Replaceable*> numbers;
    for (const NamedThing& thing : named)
      if (const Replaceable* number = number_of(thing, given.parameter)) numbers.push_back(number);
    std::string all;
    if (numbers.size() < named.size())
      all = fmt::format(" for {} of the {} things of this name", numbers.size(), named.size());
    else if (named.size() > 1)
      all = fmt::format(" for all {} of this name", named.size());
    findings.push_back({"value-set",
                        {},
                        {{"name", given.name},
                         {"parameter", given.parameter},
                         {"value", given.value},
                         {"for", all},
                         {"in_model", model_values(numbers)},
                         {"controller", controller_words(parts.model, numbers)}}});
  }
  return findings;
}

}  // namespace dea
