#include "views/text/info_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/settings/settings_xml.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/time_text.h"
#include "src/facts/parts.h"
#include "src/rules/rules.h"
#include "views/text/run_text.h"

namespace dea {

namespace {

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
                          shown(body.name), vector_text(body.center_of_mass));
      continue;
    }
    const auto part = std::find_if(check.joint.parts.begin(), check.joint.parts.end(),
                                   [&](const SoftPart& p) { return p.free() && p.body == b; });
    if (part != check.joint.parts.end()) {
      text += fmt::format("  {}: a part that gives way and nothing holds, material {}; centre {}\n", shown(body.name),
                          in_quotes(part->material), vector_text(body.center_of_mass));
      continue;
    }
    std::string materials;
    for (int m : body.materials) materials += (materials.empty() ? "" : ", ") + in_quotes(model.materials[at(m)].name);
    text += fmt::format("  {}: material{} {}; centre of mass {} ({}); mass {}\n", shown(body.name),
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
  add("pressed by another contact beyond", rim.shared);
  if (text.empty()) text = " none, the surface is closed";
  const std::string beyond =
      rim.area_beyond > 0 ? fmt::format("; beyond it {} of the layer's face", number_text(rim.area_beyond)) : "";
  return fmt::format("      rim of the selected facets:{}{}\n", text, beyond);
}

/// " (given, times 0.8)"; measured and not scaled: "".
std::string thickness_origin(const Layer& layer) {
  std::string text = !layer.thickness_from.empty() ? "from " + shown(layer.thickness_from)
                     : layer.thickness_given       ? "given"
                                                   : "";
  if (layer.thickness_scale != 1.0)
    text += fmt::format("{}times {}", text.empty() ? "measured, " : ", ", number_text(layer.thickness_scale));
  return text.empty() ? "" : " (" + text + ")";
}

/// Nothing of a sphere where the surface is none: its centre and radius would mean nothing.
std::string sphere_text(const Layer& layer, const SphereFit& sphere, const std::string& length) {
  if (roundness(layer.articular, sphere) != Roundness::Round)
    return "      least-squares sphere: none, the surface is flat or not round\n";
  return fmt::format("      least-squares sphere: centre {}, radius {}, rms distance {}{}\n",
                     vector_text(sphere.center), number_text(sphere.radius), number_text(sphere.rms), length);
}

std::string layer_text(const JointModel& model, const JointCheck& check, const Layer& layer, const SideCheck& side,
                       const char* role) {
  const Surface& surface = model.surfaces[at(layer.surface)];
  const std::string length = unit_behind(model, Dimension::Length), area = unit_behind(model, Dimension::Area),
                    pressure = unit_behind(model, Dimension::Pressure);
  std::string text = fmt::format("    {}: surface {}, {} facets, area {}{}\n", role, in_quotes(surface.name),
                                 surface.size(), number_text(side.area), area);
  text += fmt::format("      body {}: {}\n", shown(check.joint.bodies[at(layer.body)].name),
                      message_line(layer.attached_by));
  if (layer.part >= 0) {
    const SoftPart& part = check.joint.parts[at(layer.part)];
    text += fmt::format("      part {}: {} elements, {} nodes, {} of them held\n", in_quotes(part.name),
                        part.mesh.elements(), part.mesh.size(),
                        part.mesh.size() - std::count(part.holder.begin(), part.holder.end(), -1));
  } else if (layer.rigid) {
    text += "      bare rigid surface, no cartilage\n";
  } else {
    const Elasticity& e = layer.elasticity;
    const std::string material = layer.material < 0
                                     ? std::string("given")
                                     : fmt::format("{} ({})", in_quotes(model.materials[at(layer.material)].name),
                                                   shown(model.materials[at(layer.material)].type));
    text +=
        fmt::format("      cartilage: material {}, E {}{}, nu {}, confined modulus {}{}\n", material, number_text(e.E),
                    pressure, number_text(e.nu), number_text(confined_modulus(e.E, e.nu)), pressure);
    text += fmt::format("      thickness{}: min {}, mean {}, max {}{}", thickness_origin(layer),
                        number_text(layer.min_thickness()), number_text(layer.mean_thickness()),
                        number_text(layer.max_thickness()), length);
    text += layer.thickness_given
                ? "\n"
                : fmt::format("; normals that missed: {} of {}\n", layer.missed_count(), layer.missed.size());
  }
  if (side.whole_face) text += rim_text(side);
  if (side.side_walls + side.bonded > 0)
    text += fmt::format("      left out: {} facets, {} side wall, {} bonded to bone; area of those kept {}{}\n",
                        side.side_walls + side.bonded, side.side_walls, side.bonded, number_text(side.area), area);
  return text + sphere_text(layer, side.sphere, length);
}

/// ", only in step 2"; in all: "".
std::string step_words(int step) { return step >= 0 ? fmt::format(", only in step {}", step + 1) : ""; }

std::string contacts_text(const JointModel& model, const Settings& settings, const JointCheck& check) {
  std::string text;
  for (std::size_t c = 0; c < check.joint.contacts.size(); ++c) {
    const ContactPair& pair = check.joint.contacts[c];
    const ContactCheck& found = check.contacts[c];
    text += fmt::format(
        "  {}: type {}, springs on {} ({}, {}), law {}{}\n", in_quotes(pair.name),
        shown(model.contacts[at(pair.contact)].type), shown(check.joint.bodies[at(pair.source_layer().body)].name),
        pair.source == 0 ? "primary" : "secondary", name(settings.springs_at), name(pair.law), step_words(pair.step));
    text += fmt::format("    law {}: {}\n", name(pair.law), law_origin(model.contacts[at(pair.contact)], settings));
    for (int side = 0; side < 2; ++side)
      text += layer_text(model, check, pair.layers[side], found.sides[side], side == 0 ? "primary" : "secondary");
    text +=
        fmt::format("    springs: {} cast, {} over the other side; initial gap min {}, 5% {}, median {}, max {}{}\n",
                    found.springs, found.springs_hit, number_text(found.gap_min), number_text(found.gap_p5),
                    number_text(found.gap_median), number_text(found.gap_max), unit_behind(model, Dimension::Length));
  }
  return text;
}

/// `by_table`: how many of the dofs, from the first on, a table moves. `loads`: told as they are, before the arm.
std::string conditions_text_with(const BodyConditions& c, int by_table, const std::string& loads, bool paper) {
  constexpr const char* kInPaper[kDofs] = {"translation along x", "translation along y", "translation along z",
                                           "rotation about x",    "rotation about y",    "rotation about z"};
  constexpr const char* kAlike[] = {"translations", "rotations"};
  std::string text;
  for (int k = 0; k < kDofs; ++k) {
    const DofState s = c.dofs[at(k)];
    const bool alike =
        k % 3 == 0 && k >= by_table && s != DofState::Prescribed && c.dofs[at(k + 1)] == s && c.dofs[at(k + 2)] == s;
    text += fmt::format("{}{} {}", k ? ", " : "", !paper ? kDofNames[k] : alike ? kAlike[k / 3] : kInPaper[k], word(s));
    if (paper && alike)
      k += 2;
    else if (k < by_table)
      text += " by the table";
    else if (s == DofState::Prescribed)
      text += fmt::format(" {}{}", number_text(c.value[k]), c.relative[at(k)] ? " (relative)" : "");
  }
  if (!c.held_points.empty())
    text += fmt::format("; fixed nodes couple these, and take {} of them", c.held_points.size());
  const auto add = [&](const char* what, const Vector3d& v) {
    if (v.norm() > 0) text += fmt::format("; {} {}", what, vector_text(v));
  };
  add("force", c.dead.head<3>());
  add("moment", c.dead.tail<3>());
  add("following force", c.follower.head<3>());
  add("following moment", c.follower.tail<3>());
  text += loads;
  add("acting at an arm of", c.arm);
  for (const PointForce& p : c.point_forces)
    text += fmt::format("; {} {} at {} from the centre of mass", p.turns ? "following force" : "force",
                        vector_text(p.force), vector_text(p.arm));
  if (c.on_reaction) text += "; loads that start from the reaction at the step's start, not known here";
  return text;
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
  return fmt::format("  {}: {} {} to {} {}, {}{}\n", in_quotes(l.name), shown(joint.bodies[at(l.body_a)].name),
                     vector_text(l.point_a), shown(joint.bodies[at(l.body_b)].name), vector_text(l.point_b), law,
                     step_words(l.step));
}

std::string cable_text(const Joint& joint, const Cable& c) {
  std::string points;
  for (const Cable::Point& p : c.points)
    points += fmt::format("{}{} {}", points.empty() ? "" : ", ", shown(joint.bodies[at(p.body)].name),
                          vector_text(p.position));
  return fmt::format("  cable {}: {}; then along {}; tension {}{}{}\n", in_quotes(c.name), points,
                     vector_text(c.direction), number_text(c.force.factor),
                     c.force.controller >= 0 ? " times a load curve" : "", step_words(c.step));
}

std::string connector_text(const Joint& joint, const Connector& c) {
  std::string text = fmt::format("  {}: {}, {} and {}, at {}; axes {} {} {};", in_quotes(c.name), shown(c.type),
                                 shown(joint.bodies[at(c.body_a)].name), shown(joint.bodies[at(c.body_b)].name),
                                 vector_text(c.joint_origin), vector_text(c.axes.col(0)), vector_text(c.axes.col(1)),
                                 vector_text(c.axes.col(2)));
  for (int k = 0; k < kDofs; ++k)
    text += fmt::format("{} {} {} {}", k ? "," : "", k < 3 ? "along" : "about", k % 3 + 1, word(c.motion[at(k)]));
  return text + step_words(c.step) + "\n";
}

/// How many states of a step are solved: with tables, or without walking through the steps, at most its end.
std::string states_words(const StepCheck& step, const Settings& settings) {
  if (step.states == 0) return "not walked through; at its end";
  if (row_count(settings) > 0) return "solved at its end alone, on the way to the table's rows; there";
  return fmt::format("{} state{}; at its end", step.states, step.states == 1 ? "" : "s");
}

/// A line per body: `conditions(body)`.
template <class Conditions>
std::string loaded_text(const Joint& joint, Conditions conditions) {
  std::string text;
  for (int b : reported_bodies(joint))
    if (!joint.bodies[at(b)].ground)
      text += fmt::format("    {}: {}\n", shown(joint.bodies[at(b)].name), conditions(b));
  return text;
}

/// What holds, moves and loads the bodies once the rows begin.
std::string rows_text(const JointModel& model, const Settings& settings, const JointCheck& check) {
  if (!check.row) return "";
  return "  in every row of the table:\n" +
         loaded_text(check.joint, [&](int b) { return row_conditions_text(model, settings, check, b); });
}

std::string steps_text(const JointCheck& check, const Settings& settings) {
  constexpr std::size_t kBegin = 20, kEnd = 5, kMany = 40;  // of very many steps the first and last
  std::string text;
  for (std::size_t s = 0; s < check.steps.size(); ++s) {
    const StepCheck& step = check.steps[s];
    if (check.steps.size() > kMany && s == kBegin) {
      s = check.steps.size() - kEnd - 1;
      text += fmt::format("  ... {} more steps\n", check.steps.size() - kBegin - kEnd);
      continue;
    }
    text += fmt::format("  step {}{}: time {} to {}, step size {}, {}:\n", s + 1,
                        step.name.empty() ? "" : " " + in_quotes(step.name), time_text(step.start), time_text(step.end),
                        number_text(step.step_size), states_words(step, settings));
    text += loaded_text(check.joint, [&](int b) { return conditions_text(step.load_case.bodies[at(b)]); });
  }
  return text;
}

std::string connections_text(const Joint& joint) {
  std::string text;
  if (!joint.ligaments.empty() || !joint.cables.empty()) text += "\nsprings between bodies\n";
  for (const Ligament& l : joint.ligaments) text += ligament_text(joint, l);
  for (const Cable& c : joint.cables) text += cable_text(joint, c);
  if (!joint.connectors.empty()) text += "\njoints between bodies\n";
  for (const Connector& c : joint.connectors) text += connector_text(joint, c);
  return text;
}

/// Where forces act that act at the centre of a sphere.
std::string load_points_text(const JointModel& model, const Settings& settings, const Joint& joint) {
  std::string text;
  for (const auto& entry : settings.load_at) {
    if (!entry.second.sphere_center) continue;
    const LoadPointFound found = find_load_point(joint, joint.find_body(model, entry.first), entry.second);
    text += fmt::format("  force on {} acts at the centre of its sphere {}, radius {}, rms distance {}\n",
                        shown(entry.first), vector_text(found.point), number_text(found.fit.radius),
                        number_text(found.fit.rms));
  }
  return text;
}

std::string times_text(const std::vector<TimePoint>& times) {
  if (times.empty()) return "";
  constexpr std::size_t kShown = 60;
  std::string text =
      times.size() == 1 ? "\ntime of the state\n " : fmt::format("\ntimes of the {} states\n ", times.size());
  for (std::size_t i = 0; i < std::min(times.size(), kShown); ++i) text += fmt::format(" {}", time_text(times[i].time));
  return text + (times.size() > kShown ? fmt::format(" ... {}\n", time_text(times.back().time)) : "\n");
}

std::string remarks_text(const JointModel& model, const Joint& joint) {
  const std::vector<std::string> remarks = coded_lines(model_findings(model, joint), command_line_wording());
  std::string text = remarks.empty() && model.unsupported.empty() ? "" : "\nremarks\n";
  for (const std::string& line : remarks) text += "  " + message_line(line) + "\n";
  for (const Remark& r : model.unsupported)
    text += fmt::format("  not supported: {}{}{}\n", where(model, r.origin), message_line(r.what),
                        r.count > 1 ? fmt::format(" ({} times)", r.count) : "");
  return text;
}

}  // namespace

const char* word(DofState s) { return word_of(s, {"free", "held", "prescribed"}); }

const char* word(RigidJoint::Motion motion) { return word_of(motion, {"held", "free", "prescribed"}); }

const char* word(DiscreteSprings::Measure measure) { return word_of(measure, {"elongation", "strain", "stretch"}); }

std::string law_origin(const Contact& contact, const Settings& settings) {
  if (settings.law) return "chosen with --law";
  if (contact.dea && contact.dea->law) return "as the contact of type dea says";
  if (settings.springs_at == SpringsAt::Bone)
    return "the default with --springs-at bone (springs at the articular surface: layer)";
  return "the default (with --springs-at bone: linear); another one with --law";
}

std::string conditions_text(const BodyConditions& c, bool paper) { return conditions_text_with(c, 0, "", paper); }

std::string row_conditions_text(const JointModel& model, const Settings& settings, const JointCheck& check, int body,
                                bool paper) {
  const auto table = [](const std::string& file) {
    if (file.starts_with("table of ")) return "the " + file;  // of a caller that has no file, as Python
    return file.empty() ? "a table" : "the table " + file;
  };
  const auto is_of = [&](const std::string& name) { return names_body(model, check.joint.bodies, name, body); };
  const LoadTable& loads = settings.loads;
  const MotionTable& motion = settings.motion;
  const bool loaded = !loads.time.empty() && is_of(loads.body), moved = !motion.time.empty() && is_of(motion.body);
  std::string words;
  if (moved) words += fmt::format("; the motion of {}", table(motion.file));
  if (loaded)
    words += fmt::format("; the load of {}{}", table(loads.file),
                         is_of(loads.frame.body) ? ", which turns with the body" : "");
  return conditions_text_with(check.row->bodies[at(body)], !moved ? 0 : motion.turns ? kDofs : 3, words, paper);
}

std::string info_text(const JointModel& model, const Settings& settings, const JointCheck& check) {
  std::size_t elements = 0;
  for (const Domain& d : model.domains) elements += d.element_ids.size();
  std::string text = fmt::format(
      "{}: FEBio {}{}; {} nodes, {} elements\n{}\n", model.files.empty() ? "" : model.files.front(), model.version,
      model.module.empty() ? "" : ", module " + model.module, model.nodes.size(), elements, units_text(model));
  if (check.recognised) {
    text += "\nbodies\n" + bodies_text(model, check);
    text += "\ncontacts\n" + contacts_text(model, settings, check);
    text += connections_text(check.joint);
  }
  if (!check.steps.empty())
    text += "\nsteps\n" + steps_text(check, settings) + rows_text(model, settings, check) +
            load_points_text(model, settings, check.joint);
  text += times_text(check.times) + remarks_text(model, check.joint);
  if (!check.errors.empty()) text += "\nwhy dea run refuses this model\n";
  for (const Fault& fault : check.errors) text += "  " + message_line(line(fault, command_line_wording())) + "\n";
  return text;
}

}  // namespace dea
