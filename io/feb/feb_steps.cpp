// Control, load controllers, and what can only be known at the end: steps, must points, references to controllers.
#include <fmt/format.h>

#include "io/feb/feb_reading.h"
#include "src/base/error.h"
#include "src/base/names.h"

namespace dea::feb {
namespace {

void read_analysis(Reading& reading, const XMLElement& element) {
  const std::string word = element.Attribute("type") != nullptr ? attribute(element, "type") : text_of(element);
  const bool solid = reading.model.module.empty() || reading.model.module.find("solid") != std::string::npos;
  if (same_word(trim(word), "DYNAMIC") || (solid && trim(word) == "1")) {
    ignore(reading, element, febio::analysis_remark("solid", true));
  } else if (same_word(trim(word), "TRANSIENT") || trim(word) == "1") {
    ignore(reading, element, febio::analysis_remark("biphasic", true));
  }
}

std::vector<double> must_points(JointModel& model, const Control& control, double begin, double end) {
  const int index = febio::need_controller(model, control.dtmax_controller, control.dtmax_origin);
  if (index < 0) return {};
  const LoadController& curve = model.controllers[at(index)];
  if (curve.points.empty() && (!curve.unsupported.empty() || !curve.expression.empty())) {
    model.ignored.push_back({fmt::format("dtmax: load controller {} with {} gives no must points", curve.id,
                                         curve.unsupported.empty() ? "an expression" : curve.unsupported),
                             1, control.dtmax_origin});
  }
  return febio::must_points(curve, begin, end);
}

/// `<loadcurve>`: interpolation and way to extend are attributes, and children of any name the points.
void read_old_curve(const Reading& reading, const XMLElement& element, LoadController& curve) {
  if (!attribute(element, "type").empty()) febio::set_interpolate(curve, attribute(element, "type"));
  if (element.Attribute("extend") != nullptr) febio::set_extend(curve, attribute(element, "extend"));
  for (const XMLElement& child : children(element))
    febio::add_point(reading, origin_of(reading, child), text_of(child), curve);
  febio::check_times(curve);
}

void read_controller(Reading& reading, const XMLElement& element, LoadController& curve) {
  const febio::Component component = checked(reading, febio::Place::Controller, element);
  const std::string& type = component.type;
  const febio::Component* math = febio::find(component, "math");
  if (type.empty() || type == "loadcurve")
    febio::read_curve(reading, component, curve);
  else if (type != "math")
    curve.unsupported = fmt::format("type {}{}", quote(type), did_you_mean(type, {"loadcurve", "math"}));
  else if (math == nullptr)
    fail(reading, element, "load controller of type math without <math>: add it, an expression in t");
  else
    febio::set_expression(curve, math->text, febio::find(component, "var") != nullptr);
}

}  // namespace

void read_control(Reading& reading, const XMLElement& section) {
  Control& control = reading.control();
  control.origin = origin_of(reading, section);
  for (const XMLElement& child : children(section)) {
    const std::string_view tag = child.Name();
    if (tag == "time_steps") {
      control.time_steps = read_double(reading, child);
      if (control.time_steps != -1 && !(control.time_steps >= 0)) {
        fail(reading, child,
             fmt::format("time_steps = {:g}, need time_steps >= 0, or -1 with a final_time", control.time_steps));
      }
    } else if (tag == "step_size") {
      control.step_size = read_double(reading, child);
      if (!(control.step_size > 0))
        fail(reading, child, fmt::format("step_size = {:g}, need step_size > 0", control.step_size));
    } else if (tag == "final_time") {
      control.final_time = read_double(reading, child);
    } else if (tag == "analysis") {
      read_analysis(reading, child);
    } else if (tag == "time_stepper") {
      const XMLElement* dtmax = child.FirstChildElement("dtmax");
      if (dtmax == nullptr) continue;
      control.dtmax_controller = read_lc(reading, *dtmax);
      control.dtmax_origin = origin_of(reading, *dtmax);
    } else {
      febio::check_control_word(reading, origin_of(reading, child), tag);
    }
  }
}

void read_load_data(Reading& reading, const XMLElement& element) {
  const std::string_view tag = element.Name();
  if (tag != "loadcurve" && tag != "load_controller") return pass_over(reading, element);
  LoadController curve;
  need_attribute(reading, element, "id");
  curve.id = read_id(reading, element);
  curve.name = attribute(element, "name");
  curve.origin = origin_of(reading, element);
  check_attributes(reading, element);
  if (tag == "loadcurve")
    read_old_curve(reading, element, curve);
  else
    read_controller(reading, element, curve);
  for (const LoadController& other : reading.model.controllers) {
    if (other.id == curve.id)
      fail(reading, element, fmt::format("load controller {} exists twice: renumber one", curve.id));
  }
  if (curve.unsupported.empty() && curve.expression.empty() && curve.points.empty())
    febio::assume(reading, curve.origin, fmt::format("load controller {}", curve.id), "points", "0 at all times");
  reading.model.controllers.push_back(std::move(curve));
}

void complete_model(Reading& reading) {
  JointModel& model = reading.model;
  if (reading.controls.empty()) reading.controls.push_back(reading.top_control);
  double begin = 0.0;
  for (const Control& control : reading.controls) {
    Step step = {control.name, 0.0, control.step_size, {}, control.origin};
    if (control.time_steps >= 0) {
      step.duration = control.time_steps * control.step_size;
    } else if (control.final_time && *control.final_time > 0) {
      step.duration = *control.final_time;
    } else {
      throw fault_at(model, control.origin, "time_steps = -1 without a final_time > 0: give one of them");
    }
    step.must_points = must_points(model, control, begin, begin + step.duration);
    begin += step.duration;
    model.steps.push_back(std::move(step));
  }
  resolve_surface_maps(reading);
  febio::resolve_controllers(model);
  resolve_functions(reading);
  febio::check_joints(reading);
  febio::hold_from_the_start(reading);
  febio::remark_double_motion(reading);
  febio::refuse_unusable_controllers(model);
  // A named Nodes section is a node set too; FEBio lists it before the others.
  std::vector<NodeSet> named;
  for (const NodeRange& range : reading.node_ranges) {
    if (reading.node_set_index.count(range.name) > 0) continue;
    named.push_back({range.name, {}, {}});
    for (int node = range.begin; node < range.end; ++node) named.back().nodes.push_back(node);
  }
  model.node_sets.insert(model.node_sets.begin(), named.begin(), named.end());
  model.node_ids = reading.nodes.take();
  febio::refuse_moved_rigid_nodes(model, reading.unsupported_index);
}

}  // namespace dea::feb
