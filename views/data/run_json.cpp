#include "views/data/run_json.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/settings/settings_xml.h"
#include "src/base/numbers.h"
#include "src/model/settings_table.h"
#include "src/results/contact_numbers.h"
#include "src/rules/rules.h"
#include "src/version.h"
#include "views/text/info_text.h"
#include "views/text/run_text.h"

namespace dea {

namespace {

Json json_value(std::monostate) { return nullptr; }
Json json_value(double number) { return json_number(number); }
Json json_value(const Vector3d& vector) { return json_vector(vector); }
template <class Value>
Json json_value(const Value& value) {
  return value;
}

Json item_json(const SettingItem& item) {
  return std::visit([](const auto& value) { return json_value(value); }, item);
}

Json content_json(const SettingContent& content) {
  if (const auto* item = std::get_if<SettingItem>(&content)) return item_json(*item);
  Json j = Json::object();
  for (const auto& entry : std::get<1>(content)) j[entry.first] = item_json(entry.second);
  return j;
}

Json body_json(const Body& body, const Pose& pose, const Vector6& reaction) {
  const Eigen::AngleAxisd turn(pose.rotation);
  Json j;
  j["translation"] = json_vector(pose.center - body.center_of_mass);
  j["rotation"] = json_vector(turn.angle() * turn.axis());
  j["force"] = json_vector(reaction.head<3>());
  j["moment"] = json_vector(reaction.tail<3>());
  return j;
}

/// Of ligaments or cables.
template <class Springs>
Json tensions_json(const Springs& springs, const std::vector<double>& forces) {
  Json list = Json::array();
  for (std::size_t i = 0; i < forces.size() && i < springs.size(); ++i)
    list.push_back({{"name", springs[i].name}, {"force", json_number(forces[i])}});
  return list;
}

Json inside_json(const std::optional<InsideEnds>& ends) {
  if (!ends) return nullptr;
  Json j;
  for (const InsideEnd& end : kInsideEnds)
    for (const InsideMeasure& measure : kInsideMeasures)
      j[end.name][measure.name] = numbers_json((*ends).*end.value.*measure.value, kInsideNumbers);
  j["peak_near_free_edge"] = ends->peak_near_free_edge > 0;
  return j;
}

Json remarks_json(const JointModel& model, const std::vector<Remark>& remarks) {
  return list_json(remarks, [&](const Remark& r) -> Json {
    const bool known = r.origin.file >= 0 && r.origin.file < static_cast<int>(model.files.size());
    return {{"what", r.what},
            {"count", r.count},
            {"file", known ? model.files[at(r.origin.file)] : ""},
            {"line", r.origin.line}};
  });
}

Json layer_json(const JointModel& model, const JointCheck& check, const Layer& layer, const SideCheck& side) {
  Json j;
  j["surface"] = model.surfaces[at(layer.surface)].name;
  j["facets"] = model.surfaces[at(layer.surface)].size();
  j["area"] = json_number(side.area);
  j["body"] = check.joint.bodies[at(layer.body)].name;
  j["attached_by"] = layer.attached_by;
  j["rigid"] = layer.rigid;
  j["material"] = layer.material < 0 ? Json(nullptr) : Json(model.materials[at(layer.material)].name);
  j["E"] = json_number(layer.rigid ? kNaN : layer.elasticity.E);
  j["nu"] = json_number(layer.rigid ? kNaN : layer.elasticity.nu);
  j["confined_modulus"] = json_number(layer.rigid ? kNaN : confined_modulus(layer.elasticity.E, layer.elasticity.nu));
  j["thickness_min"] = json_number(layer.min_thickness());
  j["thickness_mean"] = json_number(layer.mean_thickness());
  j["thickness_max"] = json_number(layer.max_thickness());
  j["thickness_given"] = layer.thickness_given;
  j["vertices"] = layer.missed.size();
  j["missed_normals"] = layer.missed_count();
  j["rim"] = nullptr;  // null: no layer, or springs at the bone
  if (side.whole_face)
    j["rim"] = Json{{"free", json_number(side.rim.free)},         {"goes_on", json_number(side.rim.goes_on)},
                    {"symmetry", json_number(side.rim.symmetry)}, {"bonded", json_number(side.rim.bonded)},
                    {"shared", json_number(side.rim.shared)},     {"area_beyond", json_number(side.rim.area_beyond)}};
  j["left_out"] = Json{{"side_wall", side.side_walls}, {"bonded", side.bonded}};
  j["sphere"] = Json{{"center", json_vector(side.sphere.center)},
                     {"radius", json_number(side.sphere.radius)},
                     {"rms", json_number(side.sphere.rms)}};
  j["thickness_scale"] = json_number(layer.thickness_scale);  // part of the thicknesses above
  j["thickness_from"] = json_word(layer.thickness_from);
  j["part"] = layer.part < 0 ? Json(nullptr) : Json(check.joint.parts[at(layer.part)].name);
  return j;
}

Json step_json(const JointCheck& check, const StepCheck& step) {
  Json j;
  j["name"] = step.name;
  j["start"] = step.start;
  j["duration"] = step.end - step.start;
  j["step_size"] = step.step_size;
  j["states"] = step.states;
  j["bodies"] = Json::object();
  for (int b : reported_bodies(check.joint)) {
    const BodyConditions& c = step.load_case.bodies[at(b)];
    Json body;
    for (int k = 0; k < kDofs; ++k) {
      body["dofs"][kDofNames[k]] = word(c.dofs[at(k)]);
      body["prescribed"].push_back(c.dofs[at(k)] == DofState::Prescribed ? json_number(c.value[k]) : Json(nullptr));
    }
    body["force"] = json_vector(c.dead.head<3>());
    body["moment"] = json_vector(c.dead.tail<3>());
    body["following_force"] = json_vector(c.follower.head<3>());
    body["following_moment"] = json_vector(c.follower.tail<3>());
    body["arm"] = json_vector(c.arm);
    body["point_forces"] = list_json(c.point_forces, [](const PointForce& p) -> Json {
      return {{"force", json_vector(p.force)}, {"arm", json_vector(p.arm)}, {"following", p.turns}};
    });
    j["bodies"][check.joint.bodies[at(b)].name] = body;
  }
  return j;
}

Json body_json(const JointModel& model, const Body& body) {
  Json j;
  j["name"] = body.name;
  j["materials"] = list_json(body.materials, [&](int m) { return model.materials[at(m)].name; });
  j["center_of_mass"] = json_vector(body.center_of_mass);
  j["center_given"] = body.center_given;
  j["mass"] = json_number(body.mass);
  j["ground"] = body.ground;
  j["moved_nodes"] = !body.moved_by.empty();
  return j;
}

/// Of what acts in one step only, counted from 1.
Json step_number(int step) { return step < 0 ? Json(nullptr) : Json(step + 1); }

Json contact_json(const JointModel& model, const Settings& settings, const JointCheck& check, std::size_t c) {
  const ContactPair& pair = check.joint.contacts[c];
  const ContactCheck& found = check.contacts[c];
  const Contact& contact = model.contacts[at(pair.contact)];
  Json j;
  j["name"] = pair.name;
  j["type"] = contact.type;
  j["step"] = step_number(pair.step);
  j["source"] = check.joint.bodies[at(pair.source_layer().body)].name;
  j["target"] = check.joint.bodies[at(pair.target_layer().body)].name;
  j["law"] = name(pair.law);
  j["law_chosen_by"] = law_origin(contact, settings);
  j["springs_at"] = name(settings.springs_at);
  j["springs"] = found.springs;
  j["springs_hit"] = found.springs_hit;
  j["gap_min"] = json_number(found.gap_min);
  j["gap_p5"] = json_number(found.gap_p5);
  j["gap_median"] = json_number(found.gap_median);
  j["gap_max"] = json_number(found.gap_max);
  j["primary"] = layer_json(model, check, pair.layers[0], found.sides[0]);
  j["secondary"] = layer_json(model, check, pair.layers[1], found.sides[1]);
  return j;
}

/// Points (measure, force), or an expression in t, the measure.
Json curve_json(const LoadController& curve) {
  if (!curve.expression.empty()) return curve.expression;
  return list_json(curve.points, [](const auto& p) { return Json::array({json_number(p[0]), json_number(p[1])}); });
}

Json ligament_json(const JointModel& model, const Joint& joint, const Ligament& l) {
  const bool linear = l.law == Ligament::Law::Linear, curve = l.law == Ligament::Law::Curve,
             constant = l.law == Ligament::Law::Constant;
  Json j;
  j["name"] = l.name;
  j["body_a"] = joint.bodies[at(l.body_a)].name;
  j["body_b"] = joint.bodies[at(l.body_b)].name;
  j["point_a"] = json_vector(l.point_a);
  j["point_b"] = json_vector(l.point_b);
  j["law"] = linear ? "linear" : curve ? "curve" : "constant";
  j["stiffness"] = linear ? json_number(l.stiffness) : Json(nullptr);
  j["free_length"] = constant ? Json(nullptr) : json_number(l.free_length);
  j["tension_only"] = l.tension_only;
  j["measure"] = curve ? Json(word(l.measure)) : Json(nullptr);
  j["curve"] = curve && l.curve ? curve_json(*l.curve) : Json(nullptr);
  j["scale"] = linear ? Json(nullptr) : json_number(l.scale.factor);  // of the curve; or the force itself
  j["load_controller"] = l.scale.controller < 0 ? Json(nullptr) : Json(model.controllers[at(l.scale.controller)].id);
  j["step"] = step_number(l.step);
  return j;
}

Json cable_json(const Joint& joint, const Cable& c) {
  Json j;
  j["name"] = c.name;
  j["points"] = list_json(c.points, [&](const Cable::Point& p) -> Json {
    return {{"body", joint.bodies[at(p.body)].name}, {"point", json_vector(p.position)}};
  });
  j["direction"] = json_vector(c.direction);
  j["force"] = json_number(c.force.factor);
  j["step"] = step_number(c.step);
  return j;
}

Json connector_json(const Joint& joint, const Connector& c) {
  Json j;
  j["name"] = c.name;
  j["type"] = c.type;
  j["body_a"] = joint.bodies[at(c.body_a)].name;
  j["body_b"] = joint.bodies[at(c.body_b)].name;
  j["point"] = json_vector(c.joint_origin);
  for (int k = 0; k < 3; ++k) j["axes"].push_back(json_vector(c.axes.col(k)));
  for (int k = 0; k < kDofs; ++k) j["motion"].push_back(word(c.motion[at(k)]));
  j["step"] = step_number(c.step);
  return j;
}

Json head_json(const char* schema, const JointModel& model, const Settings& settings) {
  Json j;
  j["schema"] = schema;
  j["model"] = model.files.empty() ? "" : model.files.front();
  j["version"] = kVersion;
  j["settings"] = settings_json(settings);
  return j;
}

/// With no states in it.
Json frame_json(const JointModel& model, const Settings& settings, const Analysis& analysis, const Timings& timings) {
  const Joint& joint = analysis.joint;
  Json j = head_json("dea.run/1", model, settings);
  j["timings"] = {{"read", timings.read},
                  {"joint", timings.joint},
                  {"solve", timings.solve},
                  {"write", timings.write},
                  {"total", timings.total}};
  j["bodies"] = list_json(reported_bodies(joint), [&](int b) { return joint.bodies[at(b)].name; });
  j["states"] = Json::array();
  j["units"] = json_word(model.units);
  j["findings"] = lines(analysis.findings, command_line_wording());
  j["unit_names"] = units_json(model.units);
  j["finding_values"] = findings_json(analysis.findings);
  return j;
}

/// A text of json_text as an entry of a list in an object: no line feed at the end, all lines two farther in. Line
/// feeds in values are written as \n, so each is one of the layout.
std::string entry(const std::string& text) {
  std::string out = "  ";
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    out += text[i];
    if (text[i] == '\n') out += "  ";
  }
  return out;
}

}  // namespace

Json contact_json(const JointModel& model, const Joint& joint, const ContactPair& pair, const ContactStatistics& s,
                  const ContactFields& fields) {
  Json j;
  j["name"] = pair.name;
  j["source"] = joint.bodies[at(pair.source_layer().body)].name;
  j["target"] = joint.bodies[at(pair.target_layer().body)].name;
  for (const SpringNumber& row : spring_table())
    std::visit([&](auto value) { j[row.name] = json_value(s.*value); }, row.value);
  j["source_resultant_factor"] = json_number(fields.sides[pair.source].resultant_factor);
  j["target_resultant_factor"] = json_number(fields.sides[1 - pair.source].resultant_factor);
  j["complementarity"] = json_number(s.complementarity);
  j["law"] = name(pair.law);
  j["facets"] = name(pair.facets);
  j["refine"] = pair.refine;
  Json& h = j["headline"] = {{"surface", model.surfaces[at(pair.source_layer().surface)].name}};
  h.update(headline_json(s.headline));
  j["compartments"] = Json::array();
  for (std::size_t i = 0; i < s.compartments.size(); ++i) {
    const CompartmentLoad& load = s.compartments[i];
    j["compartments"].push_back({{"name", compartment_names(pair)[i]},
                                 {"headline", headline_json(load.headline)},
                                 {"force", json_vector(load.force)},
                                 {"center_of_pressure", json_vector(load.center_of_pressure)},
                                 {"inside", inside_json(load.inside)}});
  }
  j["inside"] = nullptr;
  if (s.inside[0] || s.inside[1])
    j["inside"] = {{"source", inside_json(s.inside[0])}, {"target", inside_json(s.inside[1])}};
  return j;
}

/// A layer that several contacts press.
Json layer_json(const JointModel& model, const Joint& joint, const SharedLayer& layer, const LayerStatistics& s) {
  Json j = {{"surfaces", Json::array()}, {"contacts", Json::array()}};
  for (const LayerUse& use : layer.uses) {
    const ContactPair& pair = joint.contacts[at(use.contact)];
    const std::string& surface = model.surfaces[at(pair.layers[use.side].surface)].name;
    if (std::find(j["surfaces"].begin(), j["surfaces"].end(), surface) == j["surfaces"].end())
      j["surfaces"].push_back(surface);
    j["contacts"].push_back(pair.name);
  }
  j["body"] =
      joint.bodies[at(joint.contacts[at(layer.uses.front().contact)].layers[layer.uses.front().side].body)].name;
  j["headline"] = headline_json(s.headline);
  j["force"] = json_number(s.force);
  return j;
}

/// Stress in a part that gives way.
Json part_json(const SoftPart& part, const PartStress& s) {
  Json j = {{"name", part.name}};
  for (const NamedNumber<PartStress>& number : part_numbers()) j[number.name] = json_number(number.value(s));
  return j;
}

Json state_json(const JointModel& model, const Joint& joint, const StateResult& state) {
  const Equilibrium& e = state.equilibrium;
  Json j;
  j["time"] = json_number(state.when.time);
  j["outcome"] = name(e.outcome);
  j["iterations"] = e.iterations;
  j["residual_force"] = json_number(e.residual_force);
  j["residual_moment"] = json_number(e.residual_moment);
  j["bodies"] = Json::object();
  for (int b : reported_bodies(joint))
    j["bodies"][joint.bodies[at(b)].name] = body_json(joint.bodies[at(b)], e.poses[at(b)], e.reaction[at(b)]);
  j["contacts"] = Json::array();
  for (std::size_t c = 0; c < joint.contacts.size(); ++c)
    j["contacts"].push_back(contact_json(model, joint, joint.contacts[c], state.statistics[c], state.fields[c]));
  j["message"] = outcome_text(e, command_line_wording());
  j["step"] = state.when.step + 1;
  j["load"] = json_number(e.load);
  j["residual_history"] = list_json(e.history, json_number);
  j["held_directions"] = e.held;
  j["least_stiffness"] = json_number(e.least_stiffness);
  j["unstable"] = e.unstable;
  j["ligaments"] = tensions_json(joint.ligaments, e.ligament_force);
  j["cables"] = tensions_json(joint.cables, e.cable_force);
  j["joints"] = Json::array();
  for (std::size_t c = 0; c < e.connector_force.size() && c < joint.connectors.size(); ++c) {
    const Connector& connector = joint.connectors[c];
    j["joints"].push_back({{"name", connector.name},
                           {"type", connector.type},
                           {"body_a", joint.bodies[at(connector.body_a)].name},
                           {"body_b", joint.bodies[at(connector.body_b)].name},
                           {"force", json_vector(e.connector_force[c].head<3>())},
                           {"moment", json_vector(e.connector_force[c].tail<3>())},
                           {"translation", json_vector(e.connector_motion[c].head<3>())},
                           {"rotation", json_vector(e.connector_motion[c].tail<3>())}});
  }
  j["layers"] = Json::array();
  for (std::size_t k = 0; k < state.layers.size(); ++k)
    j["layers"].push_back(layer_json(model, joint, joint.shared_layers[k], state.layers[k]));
  if (!state.parts.empty()) j["parts"] = Json::array();
  for (std::size_t k = 0; k < state.parts.size(); ++k) j["parts"].push_back(part_json(joint.parts[k], state.parts[k]));
  return j;
}

Json settings_json(const Settings& settings) {
  Json j;
  for (const SettingOption& option : setting_options())
    j[setting_keyword(option.name)] = content_json(option.content(settings));
  j["placements"] = list_json(settings.placements, [](const Placement& p) {  // as they act one after the other
    return fmt::format("{} {}", p.kind == Placement::Kind::Rotate ? "rotate" : "move", placement_text(p));
  });
  return j;
}

Json run_json(const JointModel& model, const Settings& settings, const Analysis& analysis, const Timings& timings) {
  Json j = frame_json(model, settings, analysis, timings);
  for (const StateResult& state : analysis.states) j["states"].push_back(state_json(model, analysis.joint, state));
  return j;
}

void put_run_json(const JointModel& model, const Settings& settings, const Analysis& analysis, const Timings& timings,
                  const std::function<void(const std::string& piece)>& put) {
  const std::string frame = json_text(frame_json(model, settings, analysis, timings));
  const std::string empty_list = "\n \"states\": [";  // one space: of the object itself, not of one in it
  const std::size_t states = frame.find(empty_list) + empty_list.size();
  put(frame.substr(0, states));
  for (std::size_t i = 0; i < analysis.states.size(); ++i)
    put((i > 0 ? ",\n" : "\n") + entry(json_text(state_json(model, analysis.joint, analysis.states[i]))));
  if (!analysis.states.empty()) put("\n ");
  put(frame.substr(states));
}

Json converge_json(const JointModel& model, const Settings& settings, const std::vector<Convergence>& studies,
                   double target, int max_springs) {
  Json j = head_json("dea.converge/1", model, settings);
  j["settings"].erase("refine");  // it is what the study varies
  j["target"] = target;
  j["max_springs"] = max_springs;
  j["contacts"] = Json::array();
  for (const Convergence& study : studies) {
    Json c = {{"name", study.contact}};
    c["springs_5_percent"] = study.springs_5_percent < 0 ? Json(nullptr) : Json(study.springs_5_percent);
    c["springs_1_percent"] = study.springs_1_percent < 0 ? Json(nullptr) : Json(study.springs_1_percent);
    c["rows"] = list_json(study.rows, [](const ConvergenceRow& row) {
      Json r;
      r["refine"] = row.refine;
      r["springs"] = row.springs;
      r["springs_hit"] = row.springs_hit;
      r["springs_active"] = row.springs_active;
      r["outcome"] = name(row.outcome);
      r["peak_pressure"] = json_number(row.peak);
      r["mean_pressure"] = json_number(row.mean);
      r["contact_area"] = json_number(row.area);
      r["change_peak"] = json_number(row.change_peak);
      r["change_mean"] = json_number(row.change_mean);
      r["change_area"] = json_number(row.change_area);
      r["headline"] = headline_json(row.headline);
      r["change_headline"] = numbers_json(row.change_headline, kHeadlineNumbers);
      return r;
    });
    j["contacts"].push_back(c);
  }
  j["units"] = json_word(model.units);
  j["unit_names"] = units_json(model.units);
  return j;
}

Json info_json(const JointModel& model, const Settings& settings, const JointCheck& check) {
  const Joint& joint = check.joint;
  Json j = head_json("dea.info/1", model, settings);
  j["febio_version"] = model.version;
  j["units"] = json_word(model.units);
  j["nodes"] = model.nodes.size();
  for (const char* list : {"bodies", "contacts", "ligaments", "cables", "joints", "steps"}) j[list] = Json::array();
  if (check.recognised) {
    for (int b : reported_bodies(joint)) j["bodies"].push_back(body_json(model, joint.bodies[at(b)]));
    for (std::size_t c = 0; c < joint.contacts.size(); ++c)
      j["contacts"].push_back(contact_json(model, settings, check, c));
    for (const Ligament& l : joint.ligaments) j["ligaments"].push_back(ligament_json(model, joint, l));
    for (const Cable& c : joint.cables) j["cables"].push_back(cable_json(joint, c));
    for (const Connector& c : joint.connectors) j["joints"].push_back(connector_json(joint, c));
    for (const StepCheck& step : check.steps) j["steps"].push_back(step_json(check, step));
  }
  j["times"] = list_json(check.times, [](const TimePoint& t) { return t.time; });
  const Wording wording = command_line_wording();
  j["findings"] = Json::array();
  const Findings findings = check.recognised ? model_findings(model, joint) : Findings{};
  for (const Finding& finding : joint.findings)
    if (severity(finding) == Severity::Note) j["findings"].push_back(worded(finding, wording));
  j["ignored"] = remarks_json(model, model.ignored);
  j["unsupported"] = remarks_json(model, model.unsupported);
  j["error"] = check.errors.empty() ? Json(nullptr) : Json(line(check.errors.front(), wording));
  j["errors"] = list_json(check.errors, [&](const Fault& f) { return line(f, wording); });  // the most basic first
  j["unit_names"] = units_json(model.units);
  j["assumed"] = remarks_json(model, model.assumed);
  j["finding_values"] = findings_json(findings);
  return j;
}

}  // namespace dea
