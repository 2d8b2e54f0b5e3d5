#include "io/febio/component.h"

#include <fmt/format.h>

#include <algorithm>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"
#include "src/model/load_curve.h"

namespace dea::febio {

void fail(const Draft& draft, Origin origin, const std::string& fault) { throw fault_at(draft.model, origin, fault); }

void ignore(Draft& draft, Origin origin, const std::string& what) {
  list_once(draft.model.ignored, draft.ignored_index, what, origin);
}

void note(Draft& draft, Origin origin, const std::string& what) {
  list_once(draft.model.assumed, draft.assumed_index, what, origin);
}

void assume(Draft& draft, Origin origin, std::string_view owner, std::string_view tag, std::string_view value) {
  note(draft, origin, fmt::format("{} without <{}>: {}, as in FEBio", owner, tag, value));
}

void assume_unless_given(Draft& draft, const Component& component, std::string_view tag, std::string_view value) {
  if (find(component, tag) == nullptr)
    assume(draft, component.origin, component.type.empty() ? component.tag : component.type, tag, value);
}

void unsupported(Draft& draft, Origin origin, const std::string& what, const Sentence& advice) {
  list_once(draft.model.unsupported, draft.unsupported_index, what, origin, advice);
}

// -- values from text --------------------------------------------------------------------------------

namespace {

[[noreturn]] void fail_value(const Draft& draft, Origin origin, std::string_view name, std::string_view text,
                             const char* expected) {
  fail(draft, origin, fmt::format("{} = {}, expected {}", name, quote(trim(text)), expected));
}

}  // namespace

double to_number(const Draft& draft, Origin origin, std::string_view name, std::string_view text) {
  const auto value = whole_double(text);
  if (!value)
    fail_value(draft, origin, name, text,
               has_decimal_comma(std::string(text)) ? "a number with a decimal point" : "a number of at most 1e30");
  return *value;
}

int to_whole_number(const Draft& draft, Origin origin, std::string_view name, std::string_view text) {
  const auto value = whole_int(text);
  if (!value) fail_value(draft, origin, name, text, "a whole number");
  return *value;
}

bool to_flag(const Draft& draft, Origin origin, std::string_view name, std::string_view text) {
  if (trim(text) == "false" || trim(text) == "False") return false;
  const auto value = whole_int(text);
  if (!value) fail_value(draft, origin, name, text, "0 or 1 (a word is 0 for FEBio, whatever it says)");
  return *value != 0;
}

Vector3d to_vector(const Draft& draft, Origin origin, std::string_view name, std::string_view text) {
  std::string_view rest = text;
  Vector3d vector;
  bool good = true;
  for (int i = 0; i < 3 && good; ++i) good = (i == 0 || take_comma(rest)) && take_double(rest, vector[i]) == Number::Ok;
  if (!good || !trim(rest).empty()) fail_value(draft, origin, name, text, "three numbers x,y,z of at most 1e30");
  return vector;
}

int to_controller(const Draft& draft, Origin origin, std::string_view name, std::string_view lc) {
  const auto id = whole_int(lc);
  if (!id || *id < 1)
    fail(draft, origin, fmt::format("{} has lc = {}, expected the id of a load controller", name, quote(lc)));
  return *id;
}

int place_of_word(std::string_view text, std::initializer_list<const char*> words) {
  const std::string_view word = trim(text);
  const auto same = std::find_if(words.begin(), words.end(), [&](const char* one) { return same_word(word, one); });
  if (same != words.end()) return static_cast<int>(same - words.begin());
  const auto position = whole_int(word);
  return position && *position >= 0 && *position < static_cast<int>(words.size()) ? *position : -1;
}

int need_place_of_word(const Draft& draft, Origin origin, std::string_view tag, std::string_view word,
                       std::initializer_list<const char*> words) {
  const int place = place_of_word(word, words);
  if (place >= 0) return place;
  const std::vector<std::string> names(words.begin(), words.end());
  fail(draft, origin,
       fmt::format("<{}> with dof {}{}, expected one of {}", tag, quote(word), did_you_mean(word, names, kDofAliases),
                   fmt::join(names, ", ")));
}

int material_of_id(const Draft& draft, std::string_view text) {
  const auto id = whole_int(text);
  const std::vector<Material>& materials = draft.model.materials;
  const auto place =
      std::find_if(materials.begin(), materials.end(), [&](const Material& m) { return id && m.id == *id; });
  return place == materials.end() ? -1 : static_cast<int>(place - materials.begin());
}

int find_material(const Draft& draft, Origin origin, std::string_view name) {
  if (draft.ambiguous_materials.count(name) > 0)
    fail(draft, origin, fmt::format("several materials are called {}: name it by its id", quote(name)));
  const std::vector<Material>& materials = draft.model.materials;
  const auto place =
      std::find_if(materials.begin(), materials.end(), [&](const Material& m) { return m.name == name; });
  return place == materials.end() ? -1 : static_cast<int>(place - materials.begin());
}

int need_rigid(const Draft& draft, Origin origin, std::string_view id_or_name) {
  const std::vector<Material>& materials = draft.model.materials;
  int index = material_of_id(draft, id_or_name);
  if (index < 0) index = find_material(draft, origin, id_or_name);
  if (index < 0) index = find_material(draft, origin, trim(id_or_name));
  const auto bodies = [&] {
    std::vector<std::string> names;
    for (const Material& material : materials)
      if (material.rigid) names.push_back(material.name);
    return did_you_mean(trim(id_or_name), names) + "; rigid bodies: " + name_list(names, trim(id_or_name));
  };
  if (index < 0)
    fail(draft, origin,
         fmt::format("{} names no material, expected the id or name of a rigid body{}", quote(id_or_name), bodies()));
  const Material& material = materials[at(index)];
  if (!material.rigid)
    fail(draft, origin,
         fmt::format("material {} is {}, expected a rigid body{}", quote(material.name), quote(material.type),
                     bodies()));
  return index;
}

// -- parts of a component ----------------------------------------------------------------------------

const Component* find(const Component& component, std::string_view tag) {
  const auto part = std::find_if(component.parts.begin(), component.parts.end(),
                                 [&](const Component& candidate) { return candidate.tag == tag; });
  return part == component.parts.end() ? nullptr : &*part;
}

double number_of(const Draft& draft, const Component& component, std::string_view tag, double fallback) {
  const Component* part = find(component, tag);
  return part == nullptr ? fallback : to_number(draft, part->origin, tag, part->text);
}

bool flag_of(const Draft& draft, const Component& component, std::string_view tag, bool fallback) {
  const Component* part = find(component, tag);
  return part == nullptr ? fallback : to_flag(draft, part->origin, tag, part->text);
}

Vector3d vector_of(Draft& draft, const Component& component, std::string_view tag, const Vector3d& fallback) {
  const Component* part = find(component, tag);
  if (part == nullptr) return fallback;
  if (part->lc) unsupported(draft, part->origin, fmt::format("{} that follows a load controller", tag));
  return to_vector(draft, part->origin, tag, part->text);
}

std::string text_of(const Component& component, std::string_view tag) {
  const Component* part = find(component, tag);
  return part == nullptr ? std::string() : part->text;
}

int controller_of(const Draft& draft, const Component& parameter) {
  return parameter.lc ? to_controller(draft, parameter.origin, parameter.tag, *parameter.lc) : 0;
}

Scaled scaled(const Draft& draft, const Component& parameter) {
  return {to_number(draft, parameter.origin, parameter.tag, parameter.text), controller_of(draft, parameter)};
}

Scaled scaled_of(const Draft& draft, const Component& component, std::string_view tag) {
  const Component* part = find(component, tag);
  return part == nullptr ? Scaled{0.0, 0} : scaled(draft, *part);
}

int body_of(const Draft& draft, const Component& component, std::string_view tag) {
  const Component* part = find(component, tag);
  if (part == nullptr)
    fail(draft, component.origin,
         fmt::format("<{}> without <{}>: add it, with the name of a rigid material", component.tag, tag));
  return need_rigid(draft, part->origin, part->text);
}

// -- load controllers --------------------------------------------------------------------------------

std::string no_such_word(const char* what, std::string_view word, std::initializer_list<const char*> words) {
  return fmt::format("{} {}{}", what, quote(trim(word)), did_you_mean(trim(word), {words.begin(), words.end()}));
}

void set_interpolate(LoadController& curve, std::string_view word) {
  using Interpolate = LoadController::Interpolate;
  const int place = same_word(trim(word), "smooth-step") ? static_cast<int>(Interpolate::SmoothStep)
                                                         : place_of_word(word, kInterpolateWords);
  if (place >= 0)
    curve.interpolate = static_cast<Interpolate>(place);
  else
    curve.unsupported = no_such_word("interpolation", word, kInterpolateWords);
}

void set_extend(LoadController& curve, std::string_view word) {
  const int place = place_of_word(word, kExtendWords);
  if (place >= 0)
    curve.extend = static_cast<LoadController::Extend>(place);
  else
    curve.unsupported = no_such_word("extend", word, kExtendWords);
}

void set_expression(LoadController& curve, std::string_view math, bool own_variables) {
  curve.expression = trim(math);
  const std::string fault =
      own_variables ? "a <var>, a number of FEBio's model" : expression_fault(curve.expression, {"t"});
  if (!fault.empty()) curve.unsupported = fmt::format("expression {}: {}", quote(curve.expression), fault);
}

void add_point(const Draft& draft, Origin origin, std::string_view text, LoadController& curve) {
  std::string_view rest = text;
  std::array<double, 2> point = {0, 0};
  if (take_double(rest, point[0]) != Number::Ok || !take_comma(rest) || take_double(rest, point[1]) != Number::Ok ||
      !trim(rest).empty())
    fail(draft, origin,
         fmt::format("point {} of load controller {}, expected two numbers time,value of at most 1e30",
                     quote(trim(text)), curve.id));
  curve.points.push_back(point);
}

void read_curve(const Draft& draft, const Component& component, LoadController& curve) {
  if (const Component* word = find(component, "interpolate")) set_interpolate(curve, word->text);
  if (const Component* word = find(component, "extend")) set_extend(curve, word->text);
  if (const Component* points = find(component, "points"))
    for (const Component& point : points->parts) add_point(draft, point.origin, point.text, curve);
  check_times(curve);
}

int need_controller(const JointModel& model, int id, Origin origin) {
  if (id <= 0) return -1;
  for (std::size_t i = 0; i < model.controllers.size(); ++i)
    if (model.controllers[i].id == id) return static_cast<int>(i);
  std::vector<std::string> ids;
  for (const LoadController& curve : model.controllers) ids.push_back(std::to_string(curve.id));
  throw fault_at(model, origin,
                 fmt::format("lc = {}, but there is no load controller {}: add it to LoadData, or use one of those "
                             "there (ids {})",
                             id, id, name_list(ids)));
}

void resolve_controllers(JointModel& model) {
  for_each_controller(model,
                      [&](int& controller, Origin origin) { controller = need_controller(model, controller, origin); });
}

}  // namespace dea::febio
