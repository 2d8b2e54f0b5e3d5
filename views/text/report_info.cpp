#include <febiodea/views/text/report_info.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <febiodea/base/error.h>
#include <febiodea/base/numbers.h>
#include <febiodea/run/analysis.h>
#include <febiodea/run/recognise.h>
#include <febiodea/version.h>
#include <febiodea/views/data/report_json.h>
#include <febiodea/views/text/report_text.h>

namespace dea {

namespace {

const char* word(DofState s) {
  switch (s) {
    case DofState::Free:
      return "free";
    case DofState::Held:
      return "held";
    case DofState::Prescribed:
      return "prescribed";
  }
  return "";
}

std::string quoted(const std::string& name) { return fmt::format("\"{}\"", name); }

std::string bodies_text(const JointModel& model, const JointCheck& check) {
  std::string text;
  for (int b : reported_bodies(check.joint)) {
    const Body& body = check.joint.bodies[at(b)];
    if (body.ground) {
      text += "  ground: never moves\n";
      continue;
    }
    if (!body.moved_by.empty()) {
      text += fmt::format("  {}: nodes that are moved together, a bone that the model leaves out; middle {}\n",
                          body.name, vector_text(body.center_of_mass));
      continue;
    }
    std::string materials;
    for (int m : body.materials) materials += (materials.empty() ? "" : ", ") + quoted(model.materials[at(m)].name);
    text += fmt::format("  {}: material{} {}; centre of mass {} ({}); mass {}\n", body.name,
                        body.materials.size() > 1 ? "s" : "", materials, vector_text(body.center_of_mass),
                        body.center_given ? "given"
                        : body.mass > 0   ? "integrated from its elements"
                                          : "no mass: the origin, as in FEBio",
                        number_text(body.mass));
  }
  return text;
}

/// What is beyond the rim of the selected facets.
std::string rim_text(const SideCheck& side) {
  const RimLengths& rim = side.rim;
  std::string text;
  const auto add = [&](const char* what, double length) {
    if (length > 0) text += fmt::format("{} {} {}", text.empty() ? "" : ",", what, number_text(length));
  };
  add("free", rim.free);
  add("the layer goes on", rim.goes_on);
  add("plane of symmetry", rim.symmetry);
  add("bonded to bone", rim.bonded);
  if (text.empty()) text = " none, the surface is closed";
  const std::string beyond =
      rim.area_beyond > 0 ? fmt::format("; beyond it {} of the layer's face", number_text(rim.area_beyond)) : "";
  return fmt::format("      rim of the selected facets:{}{}\n", text, beyond);
}

std::string layer_text(const JointModel& model, const JointCheck& check, const Layer& layer, const SideCheck& side,
                       const char* role) {
  const Surface& surface = model.surfaces[at(layer.surface)];
  std::string text = fmt::format("    {}: surface {}, {} facets, area {}\n", role, quoted(surface.name), surface.size(),
                                 number_text(side.area));
  text += fmt::format("      body {}: {}\n", check.joint.bodies[at(layer.body)].name, layer.attached_by);
  if (layer.rigid) {
    text += "      bare rigid surface, no cartilage\n";
  } else {
    const Elasticity& e = layer.elasticity;
    const std::string material = layer.material < 0
                                     ? std::string("given")
                                     : fmt::format("{} ({})", quoted(model.materials[at(layer.material)].name),
                                                   model.materials[at(layer.material)].type);
    text += fmt::format("      cartilage: material {}, E {}, nu {}, confined modulus {}\n", material, number_text(e.E),
                        number_text(e.nu), number_text(confined_modulus(e.E, e.nu)));
    text += fmt::format("      thickness{}: min {}, mean {}, max {}", layer.thickness_given ? " (given)" : "",
                        number_text(layer.min_thickness()), number_text(layer.mean_thickness()),
                        number_text(layer.max_thickness()));
    text += layer.thickness_given
                ? "\n"
                : fmt::format("; normals that missed: {} of {}\n", layer.missed_count(), layer.missed.size());
  }
  if (side.whole_face) text += rim_text(side);
  if (side.side_walls + side.bonded > 0)
    text += fmt::format("      left out: {} facets, {} side wall, {} bonded to bone; area of those kept {}\n",
                        side.side_walls + side.bonded, side.side_walls, side.bonded, number_text(side.area));
  text += fmt::format("      least-squares sphere: centre {}, radius {}, rms distance {}\n",
                      vector_text(side.sphere.center), number_text(side.sphere.radius), number_text(side.sphere.rms));
  return text;
}

/// Who chose the law.
std::string law_origin(const Contact& contact, const Settings& settings) {
  if (settings.law) return "chosen with --law";
  if (contact.dea && contact.dea->law) return "as the contact of type dea says";
  if (settings.springs_at == SpringsAt::Bone)
    return "the default with --springs-at bone (springs at the articular surface: layer)";
  return "the default (with --springs-at bone: linear); another one with --law";
}

std::string contacts_text(const JointModel& model, const Settings& settings, const JointCheck& check) {
  std::string text;
  for (std::size_t c = 0; c < check.joint.contacts.size(); ++c) {
    const ContactPair& pair = check.joint.contacts[c];
    const ContactCheck& found = check.contacts[c];
    text += fmt::format("  {}: type {}, springs on {} ({}, {}), law {}{}\n", quoted(pair.name),
                        model.contacts[at(pair.contact)].type, check.joint.bodies[at(pair.source_layer().body)].name,
                        pair.source == 0 ? "primary" : "secondary", name(settings.springs_at), name(pair.law),
                        pair.step >= 0 ? fmt::format(", only in step {}", pair.step + 1) : "");
    text += fmt::format("    law {}: {}\n", name(pair.law), law_origin(model.contacts[at(pair.contact)], settings));
    for (int side = 0; side < 2; ++side)
      text += layer_text(model, check, pair.layers[side], found.sides[side], side == 0 ? "primary" : "secondary");
    text += fmt::format("    springs: {} cast, {} over the other side; initial gap min {}, 5% {}, median {}, max {}\n",
                        found.springs, found.springs_hit, number_text(found.gap_min), number_text(found.gap_p5),
                        number_text(found.gap_median), number_text(found.gap_max));
  }
  return text;
}

std::string conditions_text(const BodyConditions& c) {
  std::string text, loads;
  for (int k = 0; k < kDofs; ++k) {
    const DofState s = c.dofs[at(k)];
    text += fmt::format("{}{} {}", k ? ", " : "", kDofNames[k], word(s));
    if (s == DofState::Prescribed)
      text += fmt::format(" {}{}", number_text(c.value[k]), c.relative[at(k)] ? " (relative)" : "");
  }
  const auto add = [&](const char* what, const Vector3d& v) {
    if (v.norm() > 0) text += fmt::format("; {} {}", what, vector_text(v));
  };
  add("force", c.dead.head<3>());
  add("moment", c.dead.tail<3>());
  add("following force", c.follower.head<3>());
  add("following moment", c.follower.tail<3>());
  add("acting at an arm of", c.arm);
  for (const PointForce& p : c.point_forces)
    text += fmt::format("; {} {} at {} from the centre of mass", p.turns ? "following force" : "force",
                        vector_text(p.force), vector_text(p.arm));
  if (c.on_reaction) text += "; loads that start from the reaction at the step's start, not known here";
  return text;
}

const char* word(DiscreteSprings::Measure measure) {
  return measure == DiscreteSprings::Measure::Elongation ? "elongation"
         : measure == DiscreteSprings::Measure::Strain   ? "strain"
                                                         : "stretch";
}

std::string ligament_text(const Joint& joint, const Ligament& l) {
  std::string law;
  switch (l.law) {
    case Ligament::Law::Linear:
      law = fmt::format("stiffness {}, free length {} of {}{}", number_text(l.stiffness), number_text(l.free_length),
                        number_text((l.point_b - l.point_a).norm()), l.tension_only ? ", tension only" : "");
      break;
    case Ligament::Law::Curve:
      law = fmt::format("force by a curve of {}, length {}", word(l.measure), number_text(l.free_length));
      break;
    case Ligament::Law::Constant:
      law =
          fmt::format("force {}{}", number_text(l.scale.factor), l.scale.controller >= 0 ? " times a load curve" : "");
      break;
  }
  return fmt::format("  {}: {} {} to {} {}, {}\n", quoted(l.name), joint.bodies[at(l.body_a)].name,
                     vector_text(l.point_a), joint.bodies[at(l.body_b)].name, vector_text(l.point_b), law);
}

std::string cable_text(const Joint& joint, const Cable& c) {
  std::string points;
  for (const Cable::Point& p : c.points)
    points +=
        fmt::format("{}{} {}", points.empty() ? "" : ", ", joint.bodies[at(p.body)].name, vector_text(p.position));
  return fmt::format("  cable {}: {}; then along {}; tension {}{}\n", quoted(c.name), points, vector_text(c.direction),
                     number_text(c.force.factor), c.force.controller >= 0 ? " times a load curve" : "");
}

const char* word(RigidJoint::Motion motion) {
  return motion == RigidJoint::Motion::Held ? "held" : motion == RigidJoint::Motion::Free ? "free" : "prescribed";
}

std::string connector_text(const Joint& joint, const Connector& c) {
  std::string text = fmt::format("  {}: {}, {} and {}, at {}; axes {} {} {};", quoted(c.name), c.type,
                                 joint.bodies[at(c.body_a)].name, joint.bodies[at(c.body_b)].name, vector_text(c.point),
                                 vector_text(c.axes.col(0)), vector_text(c.axes.col(1)), vector_text(c.axes.col(2)));
  for (int k = 0; k < kDofs; ++k)
    text += fmt::format("{} {} {} {}", k ? "," : "", k < 3 ? "along" : "about", k % 3 + 1, word(c.motion[at(k)]));
  return text + "\n";
}

std::string steps_text(const JointCheck& check) {
  std::string text;
  for (std::size_t s = 0; s < check.steps.size(); ++s) {
    const StepCheck& step = check.steps[s];
    text += fmt::format("  step {}{}: time {} to {}, step size {}, {} states; at its end:\n", s + 1,
                        step.name.empty() ? "" : fmt::format(" \"{}\"", step.name), number_text(step.start),
                        number_text(step.end), number_text(step.step_size), step.states);
    for (int b : reported_bodies(check.joint)) {
      if (check.joint.bodies[at(b)].ground) continue;
      text +=
          fmt::format("    {}: {}\n", check.joint.bodies[at(b)].name, conditions_text(step.conditions.bodies[at(b)]));
    }
  }
  return text;
}

Json remarks_json(const JointModel& model, const std::vector<Remark>& remarks) {
  Json list = Json::array();
  for (const Remark& r : remarks) {
    Json j;
    j["what"] = r.what;
    j["count"] = r.count;
    j["file"] = r.origin.file >= 0 && r.origin.file < static_cast<int>(model.files.size())
                    ? model.files[at(r.origin.file)]
                    : "";
    j["line"] = r.origin.line;
    list.push_back(j);
  }
  return list;
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
  const double undefined = std::numeric_limits<double>::quiet_NaN();
  j["E"] = json_number(layer.rigid ? undefined : layer.elasticity.E);
  j["nu"] = json_number(layer.rigid ? undefined : layer.elasticity.nu);
  j["confined_modulus"] =
      json_number(layer.rigid ? undefined : confined_modulus(layer.elasticity.E, layer.elasticity.nu));
  j["thickness_min"] = json_number(layer.min_thickness());
  j["thickness_mean"] = json_number(layer.mean_thickness());
  j["thickness_max"] = json_number(layer.max_thickness());
  j["thickness_given"] = layer.thickness_given;
  j["vertices"] = layer.missed.size();
  j["missed_normals"] = layer.missed_count();
  j["rim"] = nullptr;  // null: no layer, or springs at the bone
  if (side.whole_face)
    j["rim"] = Json{{"free", json_number(side.rim.free)},
                    {"goes_on", json_number(side.rim.goes_on)},
                    {"symmetry", json_number(side.rim.symmetry)},
                    {"bonded", json_number(side.rim.bonded)},
                    {"area_beyond", json_number(side.rim.area_beyond)}};
  j["left_out"] = Json{{"side_wall", side.side_walls}, {"bonded", side.bonded}};
  Json sphere;
  sphere["center"] = json_vector(side.sphere.center);
  sphere["radius"] = json_number(side.sphere.radius);
  sphere["rms"] = json_number(side.sphere.rms);
  j["sphere"] = sphere;
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
    const BodyConditions& c = step.conditions.bodies[at(b)];
    Json body;
    body["dofs"] = Json::object();
    for (int k = 0; k < kDofs; ++k) body["dofs"][kDofNames[k]] = word(c.dofs[at(k)]);
    Json value = Json::array();
    for (int k = 0; k < kDofs; ++k)
      value.push_back(c.dofs[at(k)] == DofState::Prescribed ? json_number(c.value[k]) : Json(nullptr));
    body["prescribed"] = value;
    body["force"] = json_vector(c.dead.head<3>());
    body["moment"] = json_vector(c.dead.tail<3>());
    body["following_force"] = json_vector(c.follower.head<3>());
    body["following_moment"] = json_vector(c.follower.tail<3>());
    body["arm"] = json_vector(c.arm);
    body["point_forces"] = Json::array();
    for (const PointForce& p : c.point_forces)
      body["point_forces"].push_back(
          Json{{"force", json_vector(p.force)}, {"arm", json_vector(p.arm)}, {"following", p.turns}});
    j["bodies"][check.joint.bodies[at(b)].name] = body;
  }
  return j;
}

}  // namespace

std::string info_text(const JointModel& model, const Settings& settings, const JointCheck& check) {
  std::size_t elements = 0;
  for (const Domain& d : model.domains) elements += d.element_ids.size();
  std::string text = fmt::format(
      "{}: FEBio {}{}; {} nodes, {} elements\n{}\n", model.files.empty() ? "" : model.files.front(), model.version,
      model.module.empty() ? "" : ", module " + model.module, model.nodes.size(), elements, units_text(model));
  if (check.recognised) {
    text += "\nbodies\n" + bodies_text(model, check);
    text += "\ncontacts\n" + contacts_text(model, settings, check);
    if (!check.joint.ligaments.empty() || !check.joint.cables.empty()) text += "\nsprings between bodies\n";
    for (const Ligament& l : check.joint.ligaments) text += ligament_text(check.joint, l);
    for (const Cable& c : check.joint.cables) text += cable_text(check.joint, c);
    if (!check.joint.connectors.empty()) text += "\njoints between bodies\n";
    for (const Connector& c : check.joint.connectors) text += connector_text(check.joint, c);
  }
  if (!check.steps.empty()) {
    text += "\nsteps\n" + steps_text(check);
    for (const auto& entry : settings.load_at) {
      if (!entry.second.sphere_center) continue;
      const LoadPointFound found =
          find_load_point(check.joint, check.joint.find_body(model, entry.first), entry.second);
      text +=
          fmt::format("  force on {} acts at the centre of its sphere {}, radius {}, rms distance {}\n", entry.first,
                      vector_text(found.point), number_text(found.fit.radius), number_text(found.fit.rms));
    }
  }
  if (!check.times.empty()) {
    text += fmt::format("\ntimes of the {} states\n ", check.times.size());
    constexpr std::size_t kShown = 60;
    for (std::size_t i = 0; i < std::min(check.times.size(), kShown); ++i)
      text += fmt::format(" {}", number_text(check.times[i].time));
    text += check.times.size() > kShown ? fmt::format(" ... {}\n", number_text(check.times.back().time)) : "\n";
  }
  const std::vector<std::string> remarks = model_remarks(model, check.joint);
  if (!remarks.empty() || !model.unsupported.empty()) text += "\nremarks\n";
  for (const std::string& line : remarks) text += "  " + line + "\n";
  for (const Remark& r : model.unsupported) {
    text += fmt::format("  not supported: {}{}{}\n", where(model, r.origin), r.what,
                        r.count > 1 ? fmt::format(" ({} times)", r.count) : "");
  }
  if (!check.errors.empty()) text += "\nwhy dea run refuses this model\n";
  for (const Fault& fault : check.errors) text += "  " + line(fault, command_line_wording()) + "\n";
  return text;
}

nlohmann::ordered_json info_json(const JointModel& model, const Settings& settings, const JointCheck& check) {
  Json j;
  j["schema"] = "dea.info/1";
  j["model"] = model.files.empty() ? "" : model.files.front();
  j["version"] = kVersion;
  j["settings"] = settings_json(settings);
  j["febio_version"] = model.version;
  j["units"] = model.units.empty() ? Json(nullptr) : Json(model.units);
  j["nodes"] = model.nodes.size();
  j["bodies"] = Json::array();
  j["contacts"] = Json::array();
  j["ligaments"] = Json::array();
  j["cables"] = Json::array();
  j["joints"] = Json::array();
  j["steps"] = Json::array();
  if (check.recognised) {
    for (int b : reported_bodies(check.joint)) {
      const Body& body = check.joint.bodies[at(b)];
      Json item;
      item["name"] = body.name;
      item["materials"] = Json::array();
      for (int m : body.materials) item["materials"].push_back(model.materials[at(m)].name);
      item["center_of_mass"] = json_vector(body.center_of_mass);
      item["center_given"] = body.center_given;
      item["mass"] = json_number(body.mass);
      item["ground"] = body.ground;
      item["moved_nodes"] = !body.moved_by.empty();
      j["bodies"].push_back(item);
    }
    for (std::size_t c = 0; c < check.joint.contacts.size(); ++c) {
      const ContactPair& pair = check.joint.contacts[c];
      const ContactCheck& found = check.contacts[c];
      Json item;
      item["name"] = pair.name;
      item["type"] = model.contacts[at(pair.contact)].type;
      item["step"] = pair.step < 0 ? Json(nullptr) : Json(pair.step + 1);
      item["source"] = check.joint.bodies[at(pair.source_layer().body)].name;
      item["target"] = check.joint.bodies[at(pair.target_layer().body)].name;
      item["law"] = name(pair.law);
      item["law_chosen_by"] = law_origin(model.contacts[at(pair.contact)], settings);
      item["springs_at"] = name(settings.springs_at);
      item["springs"] = found.springs;
      item["springs_hit"] = found.springs_hit;
      item["gap_min"] = json_number(found.gap_min);
      item["gap_p5"] = json_number(found.gap_p5);
      item["gap_median"] = json_number(found.gap_median);
      item["gap_max"] = json_number(found.gap_max);
      item["primary"] = layer_json(model, check, pair.layers[0], found.sides[0]);
      item["secondary"] = layer_json(model, check, pair.layers[1], found.sides[1]);
      j["contacts"].push_back(item);
    }
    for (const Ligament& l : check.joint.ligaments) {
      Json item;
      item["name"] = l.name;
      item["body_a"] = check.joint.bodies[at(l.body_a)].name;
      item["body_b"] = check.joint.bodies[at(l.body_b)].name;
      item["point_a"] = json_vector(l.point_a);
      item["point_b"] = json_vector(l.point_b);
      item["law"] = l.law == Ligament::Law::Linear ? "linear" : l.law == Ligament::Law::Curve ? "curve" : "constant";
      const bool linear = l.law == Ligament::Law::Linear, constant = l.law == Ligament::Law::Constant;
      item["stiffness"] = linear ? json_number(l.stiffness) : Json(nullptr);
      item["free_length"] = constant ? Json(nullptr) : json_number(l.free_length);
      item["tension_only"] = l.tension_only;
      item["measure"] = l.law == Ligament::Law::Curve ? Json(word(l.measure)) : Json(nullptr);
      item["curve"] = Json(nullptr);  // points (measure, force), or an expression in t, the measure
      if (l.law == Ligament::Law::Curve && l.curve && !l.curve->expression.empty()) {
        item["curve"] = l.curve->expression;
      } else if (l.law == Ligament::Law::Curve && l.curve) {
        item["curve"] = Json::array();
        for (const auto& point : l.curve->points)
          item["curve"].push_back(Json::array({json_number(point[0]), json_number(point[1])}));
      }
      item["scale"] = linear ? Json(nullptr) : json_number(l.scale.factor);  // of the curve; or the force itself
      item["load_controller"] =
          l.scale.controller < 0 ? Json(nullptr) : Json(model.controllers[at(l.scale.controller)].id);
      j["ligaments"].push_back(item);
    }
    for (const Cable& c : check.joint.cables) {
      Json item;
      item["name"] = c.name;
      item["points"] = Json::array();
      for (const Cable::Point& point : c.points)
        item["points"].push_back(
            Json{{"body", check.joint.bodies[at(point.body)].name}, {"point", json_vector(point.position)}});
      item["direction"] = json_vector(c.direction);
      item["force"] = json_number(c.force.factor);
      j["cables"].push_back(item);
    }
    for (const Connector& c : check.joint.connectors) {
      Json item;
      item["name"] = c.name;
      item["type"] = c.type;
      item["body_a"] = check.joint.bodies[at(c.body_a)].name;
      item["body_b"] = check.joint.bodies[at(c.body_b)].name;
      item["point"] = json_vector(c.point);
      item["axes"] = Json::array();
      for (int k = 0; k < 3; ++k) item["axes"].push_back(json_vector(c.axes.col(k)));
      item["motion"] = Json::array();
      for (int k = 0; k < kDofs; ++k) item["motion"].push_back(word(c.motion[at(k)]));
      j["joints"].push_back(item);
    }
    for (const StepCheck& step : check.steps) j["steps"].push_back(step_json(check, step));
  }
  j["times"] = Json::array();
  for (const TimePoint& t : check.times) j["times"].push_back(t.time);
  const Wording wording = command_line_wording();
  j["findings"] = Json::array();
  for (const Sentence& finding : check.joint.findings) j["findings"].push_back(worded(finding, wording));
  j["ignored"] = remarks_json(model, model.ignored);
  j["unsupported"] = remarks_json(model, model.unsupported);
  j["error"] = check.errors.empty() ? Json(nullptr) : Json(line(check.errors.front(), wording));
  j["errors"] = Json::array();  // all that are known, the most basic first
  for (const Fault& fault : check.errors) j["errors"].push_back(line(fault, wording));
  return j;
}

}  // namespace dea
