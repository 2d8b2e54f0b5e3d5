#include "src/joint/joint.h"

#include <cmath>
#include <utility>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/facts/parts.h"
#include "src/facts/symmetry_planes.h"
#include "src/joint/given_values.h"
#include "src/model/sound_mesh.h"

namespace dea {

namespace {

void check_surface(const JointModel& model, NamedSetting given, const std::string& name) {
  if (name.empty() || surface_index(model, name) >= 0) return;
  throw UsageError(
      Fault{.given = std::move(given), .found = no_such_name("surface", name, every_name(model.surfaces))});
}

void check_body(const JointModel& model, const std::vector<Body>& bodies, NamedSetting given, const std::string& name) {
  if (body_by_name(model, bodies, name) >= 0) return;
  throw UsageError(Fault{.given = std::move(given), .found = no_such_name("rigid body", name, every_name(bodies))});
}

/// Settings name surfaces of the model.
void check_names(const ModelParts& parts) {
  const JointModel& model = parts.model;
  const Settings& settings = parts.settings;
  for (const auto& e : settings.attach) check_surface(model, {"attach", e.first}, e.first);
  for (const auto& e : settings.bone) check_surface(model, {"bone", e.first}, e.first);
  for (const std::string& name : settings.keep_facets) check_surface(model, {"keep-facets", "", name}, name);
  for (const auto& e : settings.thickness) check_surface(model, {"thickness", e.first}, e.first);
  for (const auto& e : settings.thickness_scale) check_surface(model, {"thickness-scale", e.first}, e.first);
  for (const auto& e : settings.thickness_from) {
    check_surface(model, {"thickness-from", e.first}, e.first);
    if (settings.thickness.count(e.first) > 0)
      throw UsageError(
          Fault{.given = NamedSetting{"thickness-from", e.first, e.second.file},
                .found = say("{} says the thickness of the same surface;", NamedSetting{"thickness", e.first}),
                .expected = "leave one out"});
  }
  for (const auto& e : settings.E) check_surface(model, {"E", e.first}, e.first);
  for (const auto& e : settings.nu) check_surface(model, {"nu", e.first}, e.first);
}

/// What was taken otherwise than the model says.
Findings liberties(const JointModel& model, const Settings& settings) {
  Findings findings;
  for (const RigidNodes& set : model.rigid_nodes)
    if (set.step >= 0) findings.push_back({"rigid-nodes-in-one-step", {}, {{"set", set.name}, {"step", set.step + 1}}});
  for (const std::string& name : settings.rigid)
    findings.push_back({"taken-as-rigid", {}, {{"material", name}, {"given", NamedSetting{"rigid"}}}});
  return findings;
}

/// The bodies that FEBio would have.
Bodies bodies_of_model(const JointModel& model) {
  std::vector<char> rigid;
  for (const Material& m : model.materials) rigid.push_back(m.rigid ? 1 : 0);
  return find_bodies(model, rigid);
}

/// Centres of mass that FEBio leaves out: of another material of a body than its first. `own`: its bodies.
Findings unused_centers(const JointModel& model, const Bodies& own) {
  Findings findings;
  for (const Body& body : own.bodies)
    for (const int m : body.materials)
      if (const auto& given = model.materials[at(m)].center_of_mass; given && *given != body.center_of_mass)
        findings.push_back({"center-of-mass-left-out",
                            {.body = body.name},
                            {{"material", model.materials[at(m)].name},
                             {"x", (*given)[0]},
                             {"y", (*given)[1]},
                             {"z", (*given)[2]},
                             {"body_x", body.center_of_mass[0]},
                             {"body_y", body.center_of_mass[1]},
                             {"body_z", body.center_of_mass[2]}}});
  return findings;
}

/// Centres of mass of bones that the user takes as rigid, where they are not what the elements and densities say.
Findings chosen_centers(const JointModel& model, const Bodies& bodies) {
  Findings findings;
  for (const Body& body : bodies.bodies) {
    const int counts = rigid_in_model(model, body);
    for (const int m : body.materials) {
      const Material& material = model.materials[at(m)];
      if (counts >= 0 && !material.rigid)
        findings.push_back({"center-of-mass-of-other",
                            {.body = body.name},
                            {{"material", material.name}, {"other", model.materials[at(counts)].name}}});
      else if (counts < 0 && std::isnan(material.density))
        findings.push_back({"density-varies", {.body = body.name}, {{"material", material.name}}});
    }
  }
  return findings;
}

/// Rigid bodies of the model (`own`) that what the user takes as rigid makes one of: FEBio has several, each with its
/// centre.
Findings joined_bodies(const JointModel& model, const Bodies& bodies, const Bodies& own) {
  Findings findings;
  for (const Body& body : bodies.bodies) {
    const int counts = rigid_in_model(model, body);
    for (const int m : body.materials)
      if (m != counts && own.of_material[at(m)] >= 0 && own.bodies[at(own.of_material[at(m)])].materials.front() == m &&
          own.of_material[at(m)] != own.of_material[at(counts)])
        findings.push_back(
            {"bodies-joined", {.body = model.materials[at(counts)].name}, {{"other", model.materials[at(m)].name}}});
  }
  return findings;
}

/// Per node, the body that carries it: of its rigid elements, of what holds its layer, of its rigid node set.
std::vector<int> find_carriers(const ModelParts& parts, const std::vector<ContactPair>& contacts) {
  const JointModel& model = parts.model;
  std::vector<int> body = parts.bodies.of_node;
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    if (body[i] >= 0 || parts.region[i] < 0) continue;
    const auto held = parts.holders.of_region.find(parts.region[i]);
    if (held != parts.holders.of_region.end() && held->second.size() == 1) body[i] = held->second.begin()->first;
  }
  for (const RigidNodes& set : model.rigid_nodes)
    for (int node : set.nodes)
      if (body[at(node)] < 0) body[at(node)] = parts.bodies.of_material[at(set.material)];
  for (const ContactPair& pair : contacts)
    for (const Layer& layer : pair.layers)
      for (int node : layer.region_nodes)
        if (parts.bodies.of_node[at(node)] < 0) body[at(node)] = layer.body;
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    if (body[i] < 0) body[i] = parts.holders.fixed[i] ? parts.bodies.ground() : parts.moved[i];
  return body;
}

/// Contacts that do not slide, and walls, in one list; the first's place.
struct OtherContacts {
  std::string list;
  Origin first;
  bool tied = false;
};

OtherContacts other_contacts(const JointModel& model) {
  OtherContacts others;
  const auto add = [&](const std::string& what, Origin origin) {
    if (others.list.empty()) others.first = origin;
    others.list += (others.list.empty() ? "" : ", ") + what;
  };
  for (const Contact& c : model.contacts)
    if (c.kind == Contact::Kind::Tied) add(fmt::format("\"{}\" of type {}", c.name, c.type), c.origin);
  others.tied = !others.list.empty();
  for (const Remark& r : model.unsupported)
    if (r.what.rfind("contact ", 0) == 0 || r.what.rfind("constraint \"rigid_wall", 0) == 0) {
      const std::size_t question =
          r.advice.text.rfind("did you mean ", 0) == 0 ? r.advice.text.find('?') : std::string::npos;
      add(r.what + (question == std::string::npos ? "" : " (" + r.advice.text.substr(0, question + 1) + ")"), r.origin);
    }
  if (others.list.empty() && (model.version == "1.2" || model.version == "2.0"))  // there it is a contact
    for (const RigidNodes& set : model.rigid_nodes)
      if (others.list.empty()) add("contact \"rigid\", which fastens nodes to a rigid body", set.origin);
  return others;
}

}  // namespace

int Joint::find_body(const JointModel& model, const std::string& name) const {
  return body_by_name(model, bodies, name);
}

int Joint::body_of(int material) const {
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (int m : bodies[b].materials)
      if (m == material) return static_cast<int>(b);
  return -1;
}

Fault no_sliding_contact(const JointModel& model) {
  const OtherContacts others = other_contacts(model);
  std::string expected =
      "DEA needs one between two bodies (Contact section, e.g. type \"sliding-elastic\")" +
      (others.list.empty() ? ", and there is no contact at all: add one, or there is nothing to solve for DEA"
                           : "; found " + others.list);
  if (others.tied) expected += ", which fastens surfaces: change its type if they are to slide";
  return make_fault(model, others.first, "no sliding contact in the model;", expected);
}

void check_body_names(const JointModel& model, const std::vector<Body>& bodies, const Settings& settings) {
  const auto check = [&](const char* setting, const std::string& name) {
    check_body(model, bodies, {setting, name}, name);
  };
  const auto check_value = [&](const char* setting, const std::string& name) {
    if (!name.empty()) check_body(model, bodies, {setting, "", name}, name);
  };
  for (const auto& e : settings.free) {
    check("free", e.first);
    if (bodies[at(body_by_name(model, bodies, e.first))].ground)
      throw UsageError(Fault{
          .given = NamedSetting{"free", e.first}, .found = "the ground never moves;", .expected = "name a rigid body"});
  }
  for (const auto& e : settings.force) check("force", e.first);
  for (const auto& e : settings.load_at) check("load-at", e.first);
  for (const Placement& p : settings.placements) check(p.kind == Placement::Kind::Rotate ? "rotate" : "move", p.body);
  for (const auto& e : settings.rotate_about) check("rotate-about", e.first);
  check_value("load-body", settings.loads.body);
  check_value("load-frame", settings.loads.frame.body);
  check_value("motion-body", settings.motion.body);
  check_value("source", settings.source);
}

JointFound find_joint(const JointModel& model, const Settings& settings) {
  if (std::vector<Fault> faults = mesh_faults(model); !faults.empty()) return {{}, std::move(faults)};
  const ModelParts parts = find_parts(model, settings);
  check_names(parts);
  check_body_names(model, parts.bodies.bodies, settings);
  check_given_values(parts);
  JointFound found;
  Joint& joint = found.joint;
  joint.bodies = parts.bodies.bodies;
  joint.findings = parts.findings;
  add_once(joint.findings, liberties(model, settings));
  const Bodies own = settings.rigid.empty() ? parts.bodies : bodies_of_model(model);
  add_once(joint.findings, unused_centers(model, own));
  add_once(joint.findings, chosen_centers(model, parts.bodies));
  add_once(joint.findings, joined_bodies(model, parts.bodies, own));
  add_once(joint.findings, given_value_findings(parts));

  FoundContacts contacts = find_contacts(parts, parts.faults);
  for (const ContactPair& pair : contacts.contacts)
    for (const Layer& layer : pair.layers) add_planes(layer.planes, parts.holders.same_plane, joint.symmetry_planes);
  if (!joint.symmetry_planes.empty())
    joint.findings.push_back({"symmetry-planes", {}, {{"planes", in_words(joint.symmetry_planes)}}});
  add_once(joint.findings, contacts.findings);
  found.faults = std::move(contacts.faults);
  if (found.faults.empty()) found.faults = separate_pieces(parts);
  if (!found.faults.empty()) return found;
  if (contacts.contacts.empty()) {
    found.faults = {
        contacts.sliding == 0
            ? no_sliding_contact(model)
            : make_fault(model, {0, 0},
                         say("no sliding contact joins two different bodies: contact \"{}\": both surfaces belong to "
                             "body \"{}\": left out;",
                             joint.findings.back().subject.contact, joint.findings.back().subject.body),
                         say("name the body of one side with {}", NamedSetting{"attach", "SURFACE", "BODY"}))};
    return found;
  }
  joint.contacts = std::move(contacts.contacts);

  joint.node_body = find_carriers(parts, joint.contacts);
  joint.conditions = find_conditions(model, parts.bodies, joint.node_body);
  add_once(joint.findings, unmodelled_parts(parts, joint.conditions, joint.contacts));
  add_once(joint.findings, dropped_ties(parts, joint.conditions));
  add_once(joint.findings, closing_ties(model, parts.holders));
  try {
    static_cast<Connections&>(joint) = find_connections(parts, joint.node_body, joint.findings);
  } catch (const InputError& error) {
    found.faults = {error.fault};
  }
  return found;
}

Joint make_joint(const JointModel& model, const Settings& settings) {
  JointFound found = find_joint(model, settings);
  throw_if_any(found.faults);
  return std::move(found.joint);
}

}  // namespace dea
