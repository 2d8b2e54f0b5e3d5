#include "views/data/info_json.h"

#include "io/settings/settings_xml.h"
#include "src/base/numbers.h"
#include "src/rules/rules.h"
#include "src/version.h"
#include "views/data/run_json.h"
#include "views/text/info_text.h"
#include "views/text/run_text.h"

namespace dea {

namespace {

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
  j["point"] = json_vector(c.point);
  for (int k = 0; k < 3; ++k) j["axes"].push_back(json_vector(c.axes.col(k)));
  for (int k = 0; k < kDofs; ++k) j["motion"].push_back(word(c.motion[at(k)]));
  j["step"] = step_number(c.step);
  return j;
}

}  // namespace

Json info_json(const JointModel& model, const Settings& settings, const JointCheck& check) {
  const Joint& joint = check.joint;
  Json j;
  j["schema"] = "dea.info/1";
  j["model"] = model.files.empty() ? "" : model.files.front();
  j["version"] = kVersion;
  j["settings"] = settings_json(settings);
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
