#include "src/joint/joint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "src/base/disjoint_sets.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/facts/find_parts.h"
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

/// What a region was taken for.
Finding part_finding(const ModelParts& parts, std::size_t region, const SoftPart& part) {
  const SoftRegion& soft = parts.soft[region];
  return {"part-recognised",
          {.body = soft.free ? "" : parts.bodies.bodies[at(soft.body)].name},
          {{"part", part.name},
           {"elements", part.mesh.elements()},
           {"nodes", part.mesh.size()},
           {"give", NamedSetting{"part", "", part.material}},
           {"rigid", NamedSetting{"rigid", "", part.material}}},
          soft.form};
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

/// Per node: the bodies it moves with. Empty: it moves freely.
std::vector<std::set<int>> bodies_of_nodes(const ModelParts& parts, const std::vector<ContactPair>& contacts) {
  const JointModel& model = parts.model;
  std::vector<std::set<int>> bodies(model.nodes.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].insert(parts.holders.of_node[i].begin(), parts.holders.of_node[i].end());
    if (parts.bodies.of_node[i] >= 0) bodies[i].insert(parts.bodies.of_node[i]);
    if (parts.moved[i] >= 0) bodies[i].insert(parts.moved[i]);
    if (parts.holders.fixed[i]) bodies[i].insert(parts.bodies.ground());
  }
  for (const RigidNodes& set : model.rigid_nodes)
    for (int node : set.nodes) bodies[at(node)].insert(parts.bodies.of_material[at(set.material)]);
  for (const ContactPair& pair : contacts)
    for (const Layer& layer : pair.layers)
      for (int node : layer.region_nodes) bodies[at(node)].insert(layer.body);
  return bodies;
}

/// Per node: of an element of a layer.
std::vector<char> nodes_of_layers(const ModelParts& parts, const std::vector<ContactPair>& contacts) {
  std::vector<char> in_layer(parts.model.nodes.size(), 0);
  for (const ContactPair& pair : contacts)
    for (const Layer& layer : pair.layers)
      for (int node : layer.region_nodes) in_layer[at(node)] = 1;
  return in_layer;
}

/// The dofs of a body that no step leaves free. `moved_too`: those that a step moves among them.
std::array<bool, kDofs> dofs_never_free(const ModelParts& parts, const Conditions& conditions, int body,
                                        bool moved_too) {
  std::array<bool, kDofs> never;
  never.fill(true);
  for (const std::vector<BodyHolds>& step : conditions.steps) {
    const BodyHolds holds = with_settings(step[at(body)], parts.model, parts.bodies.bodies, body, parts.settings);
    for (std::size_t k = 0; k < kDofs; ++k) {
      const BodyDof& dof = holds.dofs[k];
      const bool back = dof.by == HeldBy::Nodes && dof.motions.empty() && holds.nodes.motions.empty();
      never[k] =
          never[k] && (dof.state == DofState::Held || (dof.state == DofState::Prescribed && (moved_too || back)));
    }
  }
  return never;
}

/// Is the body where it is in every step? Then what fastens it carries nothing that the joint would feel.
bool stays(const ModelParts& parts, const Conditions& conditions, int body) {
  const std::array<bool, kDofs> held = dofs_never_free(parts, conditions, body, false);
  return std::all_of(held.begin(), held.end(), [](bool h) { return h; });
}

/// Of the components in which nodes are held: those in which the body moves, as no half of a symmetric joint does.
unsigned held_against(const ModelParts& parts, const Conditions& conditions, int body, unsigned held) {
  const std::array<bool, kDofs> given = dofs_never_free(parts, conditions, body, true);
  unsigned against = 0;
  for (unsigned k = 0; k < 3; ++k)
    if ((held >> k & 1u) != 0 && !(given[k] && given[3 + (k + 1) % 3] && given[3 + (k + 2) % 3])) against |= 1u << k;
  return against;
}

/// Ligaments, discs, capsules of solids, shells or trusses, no layer of a contact: fastened to two bodies or more, or
/// to one that can move and to the ground in some components (part-not-modelled, one finding for all that join the
/// same).
Findings unmodelled_parts(const ModelParts& parts, const Conditions& conditions,
                          const std::vector<ContactPair>& contacts) {
  const JointModel& model = parts.model;
  const std::vector<std::set<int>> bodies = bodies_of_nodes(parts, contacts);
  const std::vector<char> in_layer = nodes_of_layers(parts, contacts);
  const auto each_element = [&](const auto& use) {
    for (const Domain& d : model.domains) {
      if (d.material < 0 || parts.rigid[at(d.material)]) continue;
      const int n = nodes_per_element(d.shape);
      for (std::size_t e = 0; e < d.element_ids.size(); ++e) {
        const int* nodes = d.nodes.data() + e * at(n);
        // of a layer, or its skin; a truss goes from one layer to another
        if (is_line(d.shape) || !std::all_of(nodes, nodes + n, [&](int node) { return in_layer[at(node)] != 0; }))
          use(d, nodes, n);
      }
    }
  };
  // Parts that meet at a bone alone are two: nodes that move with a body join nothing.
  DisjointSets sets(model.nodes.size());
  each_element([&](const Domain&, const int* nodes, int n) {
    int first = -1;
    for (int k = 0; k < n; ++k) {
      if (!bodies[at(nodes[k])].empty()) continue;
      if (first >= 0) sets.join(first, nodes[k]);
      first = nodes[k];
    }
  });
  struct Piece {
    std::set<int> bodies;
    unsigned held = 0;
    std::vector<std::string> names;
    int elements = 0;
  };
  std::vector<Piece> alone;  // elements of which every node moves with a body
  std::map<int, Piece> pieces;
  each_element([&](const Domain& d, const int* nodes, int n) {
    const int* free = std::find_if(nodes, nodes + n, [&](int node) { return bodies[at(node)].empty(); });
    if (free == nodes + n) alone.emplace_back();
    Piece& piece = free == nodes + n ? alone.back() : pieces[sets.root(*free)];
    for (int k = 0; k < n; ++k) {
      const std::set<int>& with = bodies[at(nodes[k])];
      piece.bodies.insert(with.begin(), with.end());
      if (with.empty()) piece.held |= parts.holders.held_components[at(nodes[k])];
    }
    if (piece.names.empty() || piece.names.back() != d.name) piece.names.push_back(d.name);
    ++piece.elements;
  });
  for (auto& entry : pieces) alone.push_back(std::move(entry.second));
  std::map<std::pair<std::set<int>, unsigned>, Piece> found;  // by what they are fastened to
  for (const Piece& piece : alone) {
    const unsigned held =
        piece.bodies.size() == 1 ? held_against(parts, conditions, *piece.bodies.begin(), piece.held) : 0;
    if (piece.bodies.size() < 2 && held == 0) continue;
    if (std::all_of(piece.bodies.begin(), piece.bodies.end(), [&](int b) { return stays(parts, conditions, b); }))
      continue;
    Piece& part = found[{piece.bodies, held}];
    for (const std::string& name : piece.names)
      if (std::find(part.names.begin(), part.names.end(), name) == part.names.end()) part.names.push_back(name);
    part.elements += piece.elements;
  }
  Findings all;
  for (const auto& [fastened, part] : found) {
    std::vector<std::string> bodies, components;
    for (const int b : fastened.first) bodies.push_back(parts.bodies.bodies[at(b)].name);
    for (unsigned k = 0; k < 3; ++k)
      if ((fastened.second >> k & 1u) != 0) components.emplace_back(1, "xyz"[k]);
    all.push_back({"part-not-modelled",
                   {.body = bodies.front()},
                   {{"parts", part.names}, {"elements", part.elements}, {"bodies", bodies}, {"components", components}},
                   components.empty() ? 1 : 0});
  }
  return all;
}

/// What the nodes of a surface belong to.
struct SurfaceEnd {
  std::set<int> bodies;   ///< of nodes of rigid elements
  std::set<int> regions;  ///< deformable parts of the others
};
SurfaceEnd end_of(const ModelParts& parts, const Surface& s) {
  SurfaceEnd end;
  for (int node : s.nodes) {
    if (parts.bodies.of_node[at(node)] >= 0)
      end.bodies.insert(parts.bodies.of_node[at(node)]);
    else if (parts.region[at(node)] >= 0)
      end.regions.insert(parts.region[at(node)]);
  }
  return end;
}

/// The one body that holds all these parts; -1: there is none.
int holder_of(const ModelParts& parts, const std::set<int>& regions) {
  int body = -1;
  for (int region : regions) {
    const auto held = parts.holders.of_region.find(region);
    if (held == parts.holders.of_region.end() || held->second.size() != 1) return -1;
    if (body >= 0 && held->second.begin()->first != body) return -1;
    body = held->second.begin()->first;
  }
  return body;
}

/// Tied contacts, and rigid node sets, that fasten what stands apart for DEA: two rigid bodies of which one can move
/// (tie-left-out), or two pieces of cartilage on one body, side by side (pieces-side-by-side).
Findings dropped_ties(const ModelParts& parts, const Conditions& conditions) {
  const JointModel& model = parts.model;
  Findings dropped;
  const auto body_name = [&](int body) { return parts.bodies.bodies[at(body)].name; };
  const auto add_pair = [&](const std::string& name, int a, int b) {
    if (!stays(parts, conditions, a) || !stays(parts, conditions, b))
      dropped.push_back({"tie-left-out", {.body = body_name(a)}, {{"tie", name}, {"other", body_name(b)}}});
  };
  for (const Contact& c : model.contacts) {
    if (c.kind != Contact::Kind::Tied || c.primary < 0 || c.secondary < 0) continue;
    const SurfaceEnd a = end_of(parts, model.surfaces[at(c.primary)]),
                     b = end_of(parts, model.surfaces[at(c.secondary)]);
    const std::string name = fmt::format("contact \"{}\"", c.name);
    if (a.regions.empty() && b.regions.empty() && a.bodies.size() == 1 && b.bodies.size() == 1 &&
        a.bodies != b.bodies) {
      add_pair(name, *a.bodies.begin(), *b.bodies.begin());
    } else if (!a.regions.empty() && !b.regions.empty() && a.regions != b.regions) {
      const auto soft = [&](const std::set<int>& regions) {
        return std::any_of(regions.begin(), regions.end(), [&](int r) { return parts.holders.soft_ties.count(r) > 0; });
      };
      const int body = holder_of(parts, a.regions);
      if (body >= 0 && body == holder_of(parts, b.regions) && !soft(a.regions) && !soft(b.regions))
        dropped.push_back({"pieces-side-by-side", {.body = body_name(body)}, {{"tie", name}}});
    }
  }
  for (const RigidNodes& set : model.rigid_nodes) {
    const int body = parts.bodies.of_material[at(set.material)];
    std::set<int> others;
    for (int node : set.nodes)
      if (const int other = parts.bodies.of_node[at(node)]; other >= 0 && other != body) others.insert(other);
    for (int other : others) add_pair(fmt::format("rigid node set \"{}\"", set.name), body, other);
  }
  return dropped;
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

LayerPlace place_in_shared_layer(const Joint& joint, const ContactPair& pair, int side) {
  for (std::size_t k = 0; k < joint.shared_layers.size(); ++k)
    for (const LayerUse& use : joint.shared_layers[k].uses)
      if (use.side == side && joint.contacts[at(use.contact)].contact == pair.contact)
        return {static_cast<int>(k), &use};
  return {};
}

Fault no_sliding_contact(const JointModel& model) {
  std::string list;  // contacts that do not slide, and walls
  Origin first;
  const auto add = [&](const std::string& what, Origin origin) {
    if (list.empty()) first = origin;
    list += (list.empty() ? "" : ", ") + what;
  };
  for (const Contact& c : model.contacts)
    if (c.kind == Contact::Kind::Tied) add(fmt::format("\"{}\" of type {}", c.name, c.type), c.origin);
  const bool tied = !list.empty();
  for (const Remark& r : model.unsupported)
    if (r.what.rfind("contact ", 0) == 0 || r.what.rfind("constraint \"rigid_wall", 0) == 0) {
      const std::size_t question =
          r.advice.text.rfind("did you mean ", 0) == 0 ? r.advice.text.find('?') : std::string::npos;
      add(r.what + (question == std::string::npos ? "" : " (" + r.advice.text.substr(0, question + 1) + ")"), r.origin);
    }
  if (list.empty() && (model.version == "1.2" || model.version == "2.0"))  // there it is a contact
    for (const RigidNodes& set : model.rigid_nodes)
      if (list.empty()) add("contact \"rigid\", which fastens nodes to a rigid body", set.origin);
  std::string expected =
      "DEA needs one between two bodies (Contact section, e.g. type \"sliding-elastic\")" +
      (list.empty() ? ", and there is no contact at all: add one, or there is nothing to solve for DEA"
                    : "; found " + list);
  if (tied) expected += ", which fastens surfaces: change its type if they are to slide";
  return make_fault(model, first, "no sliding contact in the model;", expected);
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
  try {
    joint.parts = make_parts(parts);
    for (std::size_t k = 0; k < joint.parts.size(); ++k) {
      add_once(joint.findings, {part_finding(parts, k, joint.parts[k])});
      add_once(joint.findings, fibre_findings(parts, k));
      add_once(joint.findings, fluid_findings(parts, k));
    }
    joint.shared_layers = find_shared_layers(parts, joint.contacts, joint.findings);
  } catch (const InputError& error) {
    found.faults = {error.fault};
    return found;
  }

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
