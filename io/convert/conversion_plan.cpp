#include "io/convert/conversion_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/facts/bodies.h"
#include "src/facts/symmetry_planes.h"
#include "src/run/analysis.h"

namespace dea {

namespace {

const NamedSetting kLinear = {"law", "", "linear"};

void refuse_settings(const Settings& s) {
  const auto refuse = [](bool given, const NamedSetting& setting, const char* found,
                         const char* expected = "leave it out") {
    if (given) throw UsageError(Fault{.given = setting, .found = found, .expected = expected});
  };
  refuse(s.springs_at == SpringsAt::Bone, {"springs-at", "", "bone"},
         "a contact of type dea has its springs on the articular surface;");
  refuse(s.interface_stiffness.has_value(), {"interface-stiffness"}, "a contact of type dea has none;");
  refuse(s.layer_fit != LayerFit::TwoTerms, {"layer-terms", "", "1"}, "a contact of type dea takes two;");
  refuse(!s.leave_out.empty(), {"leave-out"}, "a converted file keeps all elements of the model;");
  constexpr const char* kInModel = "change them in the model";
  const auto refuse_values = [&](const char* setting, const auto& values, const char* found) {
    if (!values.empty()) refuse(true, {setting, values.begin()->first}, found, kInModel);
  };
  constexpr const char* kLoads = "a converted file keeps the model's own motion and loads;";
  refuse_values("force", s.force, kLoads);
  refuse_values("load-at", s.load_at, kLoads);
  refuse_values("free", s.free, kLoads);
  refuse_values("set", s.set_values, "a converted file keeps the model's own springs and forces;");
  constexpr const char* kSteps = "a converted file keeps the model's own motion, loads and steps;";
  refuse(!s.loads.file.empty(), {"loads"}, kSteps, kInModel);
  refuse(!s.motion.file.empty(), {"motion"}, kSteps, kInModel);
  refuse(s.skip_steps, {"skip-steps"}, kSteps, kInModel);
}

InputError nothing_to_convert(const JointModel& model, const Contact& contact) {
  return fault_at(model, contact.origin,
                  fmt::format("contact \"{}\" is of type dea already: nothing to convert", contact.name));
}

/// Contacts of the joint that become contacts of type dea.
void choose_contacts(const JointModel& model, const Settings& settings, ConversionPlan& plan) {
  plan.converted.assign(model.contacts.size(), 0);
  plan.contact_gone.assign(model.contacts.size(), 0);
  bool any = false;
  for (const ContactPair& pair : plan.joint.contacts) {
    const Contact& c = model.contacts[at(pair.contact)];
    if (c.dea) continue;
    plan.converted[at(pair.contact)] = 1;
    any = true;
  }
  if (!plan.joint.parts.empty())
    throw fault_at(model, {0, 0},
                   say("part \"{}\" gives way as its elements do, which a contact of type dea cannot;",
                       plan.joint.parts.front().name),
                   say("solve it with dea run, or take it as rigid with {}",
                       NamedSetting{"rigid", "", plan.joint.parts.front().name}));
  if (!any) throw nothing_to_convert(model, model.contacts[at(plan.joint.contacts.front().contact)]);
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    const Contact& c = model.contacts[i];
    if (plan.converted[i] || c.kind != Contact::Kind::Sliding || c.dea) continue;
    const bool other = !settings.contact.empty() && c.name != settings.contact;
    plan.notes.push_back(
        say("contact \"{}\" ({}) stays as it is: {}", c.name, c.type,
            other ? say("left out by {}", NamedSetting{"contact"}) : Sentence("both its surfaces belong to one body")));
  }
}

/// Per body the rigid material its cartilage takes: the first the model has, else the first taken as rigid (--rigid).
/// The ground gets a new one when it carries cartilage.
std::vector<int> rigid_material_of_bodies(const JointModel& model, const ConversionPlan& plan) {
  std::vector<int> rigid_material;
  for (const Body& body : plan.joint.bodies) {
    int material = -1;
    for (int m : body.materials)
      if (material < 0 && model.materials[at(m)].rigid) material = m;
    if (material < 0 && !body.materials.empty()) material = body.materials.front();
    rigid_material.push_back(material);
  }
  return rigid_material;
}

/// Per node the body whose converted cartilage it belongs to, -1: none.
std::vector<int> cartilage_nodes(const JointModel& model, const ConversionPlan& plan) {
  std::vector<int> body(model.nodes.size(), -1);
  const auto& bodies = plan.joint.bodies;
  for (const ContactPair& pair : plan.joint.contacts) {
    if (!plan.converted[at(pair.contact)]) continue;
    for (const Layer& layer : pair.layers) {
      for (int node : layer.region_nodes) {
        int& known = body[at(node)];
        if (known >= 0 && known != layer.body)
          throw fault_at(
              model, model.surfaces[at(layer.surface)].origin,
              fmt::format("the cartilage under surface \"{}\" belongs to body \"{}\" for one contact and "
                          "to \"{}\" for another; it can be rigid with one of them only",
                          model.surfaces[at(layer.surface)].name, bodies[at(known)].name, bodies[at(layer.body)].name));
        known = layer.body;
      }
    }
  }
  return body;
}

void add_ground(const JointModel& model, ConversionPlan& plan, std::vector<int>& rigid_material,
                const std::vector<int>& cartilage) {
  const int ground = static_cast<int>(plan.joint.bodies.size()) - 1;
  if (std::find(cartilage.begin(), cartilage.end(), ground) == cartilage.end()) return;
  std::set<std::string> names;
  Material material;
  for (const Material& m : model.materials) {
    names.insert(m.name);
    material.id = std::max(material.id, m.id);
  }
  ++material.id;
  material.name = take_free_name("ground", names);
  material.type = "rigid body";
  material.rigid = true;
  material.center_of_mass = Vector3d::Zero();
  plan.ground = static_cast<int>(plan.target.materials.size());
  rigid_material[at(ground)] = plan.ground;
  plan.target.materials.push_back(material);
  RigidFixed fixed;
  fixed.material = plan.ground;
  fixed.dofs.fill(true);
  fixed.name = material.name + " held";
  plan.target.rigid_fixed.push_back(fixed);
  plan.changes.push_back(
      fmt::format("material \"{}\": new, rigid, for cartilage on the ground; held in all six dofs", material.name));
}

/// Bones taken as rigid that fixed nodes hold: the nodes become rigid, so the body is held instead.
void hold_bones(const JointModel& model, ConversionPlan& plan, const std::vector<int>& rigid_material) {
  for (std::size_t b = 0; b < plan.joint.bodies.size(); ++b) {
    const Body& body = plan.joint.bodies[b];
    if (!taken_as_rigid(model, body) || rigid_material[b] < 0) continue;
    const BodyHolds& holds = plan.joint.conditions.steps.front()[b];
    if (!holds.coupled.empty()) {
      const FixedNodes& f = model.fixed_nodes[at(holds.first_coupled)];
      throw fault_at(
          model, f.origin,
          fmt::format("fixed nodes \"{}\" leave bone \"{}\", which becomes a rigid body, a hinge, a pin or a "
                      "guided end, and FEBio ignores fixed nodes of rigid bodies: make it a rigid body of the "
                      "model with a joint there (`dea run` solves the model as it is)",
                      f.name, body.name));
    }
    for (const FixedNodes& f : model.fixed_nodes)
      if (f.step >= 0 && std::any_of(f.nodes.begin(), f.nodes.end(),
                                     [&](int node) { return plan.joint.node_body[at(node)] == static_cast<int>(b); }))
        throw fault_at(model, f.origin,
                       fmt::format("fixed nodes \"{}\" hold bone \"{}\", which becomes a rigid body, in one step only: "
                                   "make it a rigid body of the model and hold that",
                                   f.name, body.name));
    RigidFixed held;
    held.material = rigid_material[b];
    std::string dofs;
    for (std::size_t k = 0; k < kDofs; ++k) {
      held.dofs[k] = holds.dofs[k].state == DofState::Held && holds.dofs[k].by == HeldBy::Nodes;
      if (held.dofs[k]) dofs += fmt::format("{}{}", dofs.empty() ? "" : ", ", kDofNames[k]);
    }
    if (dofs.empty()) continue;
    held.name = body.name + " held";
    plan.target.rigid_fixed.push_back(held);
    plan.changes.push_back(fmt::format("body \"{}\": held in {}, as its fixed nodes did", body.name, dofs));
  }
}

bool is_layer_shape(const Domain& d) { return !is_line(d.shape) && !is_shell(d.shape); }

/// The elements of a domain that go to each body (-1: stay), in parts of their own where they are several.
void convert_domain(const JointModel& model, int index, const std::vector<int>& body_of_element,
                    const std::vector<int>& rigid_material, ConversionPlan& plan, std::set<std::string>& names) {
  const Domain& d = model.domains[at(index)];
  const std::string old = model.materials[at(d.material)].name;
  std::vector<int> bodies = body_of_element;
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  const std::size_t n = at(nodes_per_element(d.shape));
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Domain part = d;
    part.element_ids.clear();
    part.nodes.clear();
    for (std::size_t e = 0; e < body_of_element.size(); ++e) {
      if (body_of_element[e] != bodies[b]) continue;
      part.element_ids.push_back(d.element_ids[e]);
      const auto begin = d.nodes.begin() + static_cast<std::ptrdiff_t>(e * n);
      part.nodes.insert(part.nodes.end(), begin, begin + static_cast<std::ptrdiff_t>(n));
    }
    if (bodies[b] >= 0) part.material = rigid_material[at(bodies[b])];
    if (b > 0) {
      part.name = take_free_name(d.name, names);
      plan.split = true;
    }
    if (bodies[b] >= 0)
      plan.changes.push_back(fmt::format("domain \"{}\": material \"{}\" becomes \"{}\", rigid", part.name, old,
                                         plan.target.materials[at(part.material)].name));
    if (b == 0)
      plan.target.domains[at(index)] = std::move(part);
    else
      plan.target.domains.push_back(std::move(part));
  }
}

void convert_domains(const JointModel& model, const std::vector<char>& rigid, const std::vector<int>& rigid_material,
                     const std::vector<int>& cartilage, const std::vector<int>& body_of_material,
                     ConversionPlan& plan) {
  std::set<std::string> names;
  for (const Domain& d : model.domains) names.insert(d.name);
  for (int i = 0; i < static_cast<int>(model.domains.size()); ++i) {
    const Domain& d = model.domains[at(i)];
    if (d.material < 0 || d.element_ids.empty() || model.materials[at(d.material)].rigid) continue;
    const std::size_t n = at(nodes_per_element(d.shape));
    std::vector<int> bodies(d.element_ids.size(), -1);
    if (rigid[at(d.material)]) {
      if (is_line(d.shape)) continue;
      bodies.assign(bodies.size(), body_of_material[at(d.material)]);
      const int to = rigid_material[at(bodies.front())];
      if (to == d.material) continue;  // that material itself becomes rigid
    } else if (is_layer_shape(d)) {
      for (std::size_t e = 0; e < bodies.size(); ++e) bodies[e] = cartilage[at(d.nodes[e * n])];
      if (std::all_of(bodies.begin(), bodies.end(), [](int b) { return b < 0; })) continue;
    } else {
      continue;
    }
    convert_domain(model, i, bodies, rigid_material, plan, names);
  }
}

void convert_materials(const std::vector<int>& rigid_material, ConversionPlan& plan) {
  for (std::size_t b = 0; b < plan.joint.bodies.size(); ++b) {
    const Body& body = plan.joint.bodies[b];
    if (body.ground || rigid_material[b] < 0) continue;
    Material& material = plan.target.materials[at(rigid_material[b])];
    if (!material.rigid) {
      plan.changes.push_back(
          say("material \"{}\": type {} becomes rigid body ({})", material.name, material.type, NamedSetting{"rigid"}));
      material.rigid = true;
      material.type = "rigid body";
      material.E = material.nu = std::nan("");
      if (std::isnan(material.density)) {
        material.density = 1.0;
        plan.changes.push_back(
            fmt::format("material \"{}\": a density that is not one number becomes 1", material.name));
      }
    }
    const Vector3d& c = body.center_of_mass;
    if (material.center_of_mass && *material.center_of_mass == c) continue;
    material.center_of_mass = c;
    plan.changes.push_back(fmt::format("material \"{}\": center_of_mass {:.6g},{:.6g},{:.6g} written out",
                                       material.name, c.x(), c.y(), c.z()));
  }
}

/// FEBio makes one body of rigid materials whose elements share nodes: after the conversion these must be the bodies
/// there were.
void check_bodies(const JointModel& model, const ConversionPlan& plan, const std::vector<int>& rigid_material) {
  const std::vector<char> rigid = rigid_materials(plan.target, {});
  const Bodies after = find_bodies(plan.target, rigid);
  const auto& bodies = plan.joint.bodies;
  for (std::size_t a = 0; a < bodies.size(); ++a) {
    for (int m : bodies[a].materials) {
      if (!rigid[at(m)] || rigid_material[a] < 0 ||
          after.of_material[at(m)] == after.of_material[at(rigid_material[a])])
        continue;
      throw fault_at(model, model.materials[at(m)].origin,
                     fmt::format("materials \"{}\" and \"{}\" are one body through rigid node sets; as rigid "
                                 "materials they would be two: give their elements one material",
                                 model.materials[at(rigid_material[a])].name, model.materials[at(m)].name));
    }
    for (std::size_t b = a + 1; b < bodies.size(); ++b) {
      if (rigid_material[a] < 0 || rigid_material[b] < 0 ||
          after.of_material[at(rigid_material[a])] != after.of_material[at(rigid_material[b])])
        continue;
      throw fault_at(model, {0, 0},
                     say("the cartilage shares nodes with bodies \"{}\" and \"{}\", which would become one rigid body;",
                         bodies[a].name, bodies[b].name),
                     "give each its own nodes");
    }
  }
}

/// Per node of the model: does it belong to an element of one of these materials?
std::vector<char> nodes_of_materials(const JointModel& model, const std::vector<char>& materials) {
  std::vector<char> nodes(model.nodes.size(), 0);
  for (const Domain& d : model.domains)
    if (d.material >= 0 && materials[at(d.material)] && !is_line(d.shape))
      for (int node : d.nodes) nodes[at(node)] = 1;
  return nodes;
}

/// Takes the nodes that became rigid out of a condition. True: none is left.
template <class Condition>
bool remove_rigid_nodes(const std::vector<char>& was_rigid, const std::vector<char>& is_rigid, Condition& condition) {
  const auto became = [&](int node) { return is_rigid[at(node)] && !was_rigid[at(node)]; };
  if (std::none_of(condition.nodes.begin(), condition.nodes.end(), became)) return false;
  auto& nodes = condition.nodes;
  std::erase_if(nodes, [&](int node) { return is_rigid[at(node)] != 0; });
  return nodes.empty();
}

/// FEBio moves no nodes of rigid bodies.
void refuse_moved_nodes(const JointModel& model, const std::vector<int>& cartilage, const std::vector<char>& rigid) {
  const std::vector<char> rigid_now = nodes_of_materials(model, rigid);
  for (const PrescribedNodes& p : model.prescribed_nodes)
    if (std::any_of(p.nodes.begin(), p.nodes.end(),
                    [&](int node) { return cartilage[at(node)] >= 0 || rigid_now[at(node)]; }))
      throw fault_at(model, p.origin,
                     fmt::format("prescribed displacement \"{}\" moves nodes that the conversion makes rigid, "
                                 "and FEBio moves no nodes of rigid bodies: make the bone behind them a rigid "
                                 "body and prescribe its motion (`dea run` solves the model as it is)",
                                 p.name));
}

void convert_conditions(const JointModel& model, ConversionPlan& plan) {
  const std::vector<char> was_rigid = nodes_of_materials(model, rigid_materials(model, {}));
  const auto take_out = [&](auto& conditions, const std::string& what, std::vector<char>& gone) {
    for (auto& condition : conditions) {
      const std::size_t before = condition.nodes.size();
      gone.push_back(remove_rigid_nodes(was_rigid, plan.node_rigid, condition));
      if (gone.back())
        plan.changes.push_back(fmt::format("{} \"{}\": taken out, its nodes are rigid now", what, condition.name));
      else if (condition.nodes.size() < before)
        plan.changes.push_back(fmt::format("{} \"{}\": {} of its {} nodes are rigid now and taken out", what,
                                           condition.name, before - condition.nodes.size(), before));
    }
  };
  take_out(plan.target.rigid_nodes, "rigid node set", plan.rigid_nodes_gone);
  take_out(plan.target.fixed_nodes, "fixed nodes", plan.fixed_nodes_gone);

  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    const Contact& c = model.contacts[i];
    if (c.kind != Contact::Kind::Tied) continue;
    bool all = true;
    for (int s : {c.primary, c.secondary})
      for (int node : model.surfaces[at(s)].nodes) all = all && plan.node_rigid[at(node)];
    if (!all) continue;
    plan.contact_gone[i] = 1;
    plan.changes.push_back(
        fmt::format("tied contact \"{}\" ({}): taken out, both its surfaces are rigid now", c.name, c.type));
  }
}

/// Thickness per node of the surface, from the vertices of the articular surface. A node in the middle of a facet,
/// which is no vertex, gets the mean of the others.
std::vector<double> thickness_map(const Surface& surface, const Layer& layer) {
  const std::unordered_map<int, int> vertex = articular_vertices(layer);
  std::vector<double> map;
  for (std::size_t f = 0; f + 1 < surface.begin.size(); ++f) {
    double sum = 0.0;
    int count = 0;
    for (int k = surface.begin[f]; k < surface.begin[f + 1]; ++k) {
      const auto found = vertex.find(surface.nodes[at(k)]);
      if (found == vertex.end()) continue;
      sum += layer.thickness[at(found->second)];
      ++count;
    }
    for (int k = surface.begin[f]; k < surface.begin[f + 1]; ++k) {
      const auto found = vertex.find(surface.nodes[at(k)]);
      map.push_back(found != vertex.end() ? layer.thickness[at(found->second)] : count > 0 ? sum / count : 0.0);
    }
  }
  return map;
}

DeaLayer dea_layer(const JointModel& model, const Layer& layer) {
  DeaLayer out;
  if (layer.rigid) {
    out.thickness = 0.0;
    return out;
  }
  out.E = layer.elasticity.E;
  out.nu = layer.elasticity.nu;
  if (layer.thickness_given && layer.min_thickness() == layer.max_thickness())
    out.thickness = layer.thickness.empty() ? 0.0 : layer.thickness.front();
  else
    out.thickness_map = thickness_map(model.surfaces[at(layer.surface)], layer);
  return out;
}

void convert_contacts(const JointModel& model, ConversionPlan& plan) {
  plan.map_of_surface.assign(model.surfaces.size(), "");
  std::set<std::string> names;  // of maps of this conversion
  for (const ContactPair& pair : plan.joint.contacts) {
    if (!plan.converted[at(pair.contact)]) continue;
    Contact& c = plan.target.contacts[at(pair.contact)];
    const std::vector<SymmetryPlane>& planes = pair.layers[0].planes;
    plan.changes.push_back(fmt::format("contact \"{}\": type {} becomes dea, law {}, facets {}, source {}, refine {}{}",
                                       c.name, c.type, name(pair.law), name(pair.facets),
                                       pair.source == 0 ? "primary" : "secondary", pair.refine,
                                       planes.empty() ? "" : ", planes of symmetry " + in_words(planes)));
    c.type = "dea";
    c.ignored.clear();
    DeaContact dea;
    dea.law = pair.law;
    dea.facets = pair.facets;
    dea.refine = pair.refine;
    dea.source = pair.source;
    dea.symmetry_planes = planes;
    for (std::size_t side = 0; side < 2; ++side) {
      const Layer& layer = pair.layers[side];
      const char* which = side == 0 ? "primary" : "secondary";
      dea.layers[side] = dea_layer(model, layer);
      const std::string& surface = model.surfaces[at(layer.surface)].name;
      if (layer.rigid) {
        plan.changes.push_back(fmt::format("  {} \"{}\": bare rigid surface, thickness 0", which, surface));
        continue;
      }
      std::string thickness;
      if (dea.layers[side].thickness_map.empty()) {
        thickness = fmt::format("thickness {:g}", *dea.layers[side].thickness);
      } else {
        std::string& map = plan.map_of_surface[at(layer.surface)];
        if (map.empty()) map = take_free_name(surface + "_thickness", names);
        thickness = fmt::format("thickness {:.4g} to {:.4g} (mean {:.4g}) as map \"{}\"", layer.min_thickness(),
                                layer.max_thickness(), layer.mean_thickness(), map);
        if (layer.missed_count() > 0)
          plan.notes.push_back(
              fmt::format("surface \"{}\": the normals of {} of {} vertices met no bone; the distance "
                          "of the closest point is their thickness",
                          surface, layer.missed_count(), layer.missed.size()));
      }
      plan.changes.push_back(fmt::format("  {} \"{}\" on body \"{}\": E {:g}, nu {:g}, {}", which, surface,
                                         plan.joint.bodies[at(layer.body)].name, *dea.layers[side].E,
                                         *dea.layers[side].nu, thickness));
    }
    c.dea = dea;
  }
}

/// The same cartilage? With law layer also beyond the selected facets, and the same rims.
bool same_face(const Layer& a, const Layer& b, Law law) {
  if (a.articular.model_nodes != b.articular.model_nodes || a.articular.triangles != b.articular.triangles)
    return false;
  if (law != Law::Layer) return true;
  const auto same_edge = [](const LayerFace::Edge& x, const LayerFace::Edge& y) {
    return x.triangle == y.triangle && x.edge == y.edge && x.rim == y.rim;
  };
  return a.face.mesh.model_nodes == b.face.mesh.model_nodes && a.face.mesh.triangles == b.face.mesh.triangles &&
         std::equal(a.face.edges.begin(), a.face.edges.end(), b.face.edges.begin(), b.face.edges.end(), same_edge);
}

std::vector<std::array<int, 2>> walls_of(const Layer& layer) {
  std::vector<std::array<int, 2>> found;
  for (const LayerFace::Edge& e : layer.face.edges)
    if (e.rim == Rim::Wall) found.push_back({e.triangle, e.edge});
  return found;
}

/// Is the rim between the mirror images' planes and the rest the same? With law layer only.
bool same_walls(const Layer& a, const Layer& b, Law law) {
  return law != Law::Layer || a.face.mesh.triangles != b.face.mesh.triangles || walls_of(a) == walls_of(b);
}

/// What is left out of a surface and what is beyond its rim is read from the elements and their bone. Where these can
/// no longer be told apart the converted model would have other pressures.
void check_faces(const JointModel& model, const Settings& settings, ConversionPlan& plan) {
  Settings none;
  none.contact = settings.contact;
  none.keep_facets = settings.keep_facets;
  const JointFound after = find_joint(plan.target, none);
  if (!after.faults.empty()) {
    const Fault& fault = after.faults.front();
    plan.notes.push_back(say("dea run does not take the converted model: {}{}{}{}",
                             fault.place + (fault.place.empty() ? "" : ": "), fault.found,
                             fault.expected.empty() ? "" : " ", fault.expected));
    return;
  }
  for (const ContactPair& pair : plan.joint.contacts) {
    if (!plan.converted[at(pair.contact)]) continue;
    const auto same = std::find_if(after.joint.contacts.begin(), after.joint.contacts.end(),
                                   [&](const ContactPair& other) { return other.contact == pair.contact; });
    if (same == after.joint.contacts.end()) continue;
    for (int side = 0; side < 2; ++side) {
      const Layer& layer = pair.layers[side];
      if (layer.rigid || same_face(layer, same->layers[side], pair.law)) continue;
      const Surface& surface = model.surfaces[at(layer.surface)];
      if (!same_walls(layer, same->layers[side], pair.law))
        throw fault_at(
            model, surface.origin,
            say("surface \"{}\": {} edges of its rim are held across an axis; converted it would be {}, for a contact "
                "of type dea knows whole planes of symmetry alone:",
                surface.name, walls_of(layer).size(), walls_of(same->layers[side]).size()),
            say("hold all nodes where the layer ends, or none, and put them into one plane, or convert with {}",
                kLinear));
      const auto left_out = static_cast<std::ptrdiff_t>(layer.facet_kinds.size()) -
                            std::count(layer.facet_kinds.begin(), layer.facet_kinds.end(), FaceKind::Open);
      if (left_out > 0)
        throw fault_at(
            model, surface.origin,
            fmt::format(
                "surface \"{}\": {} of its facets are side wall or bonded to bone and left out here, but in the "
                "converted model nothing tells them from the articular face: take them out of the surface",
                surface.name, left_out));
      throw fault_at(
          model, surface.origin,
          say("surface \"{}\": its cartilage goes on beyond the selected facets, which the converted model cannot tell "
              "(it knows those under contact surfaces that share nodes with their bone):",
              surface.name),
          say("select the whole face, or convert with {}", kLinear));
    }
  }
}

}  // namespace

ConversionPlan plan_conversion(const JointModel& model, const Settings& settings) {
  refuse_settings(settings);
  ConversionPlan plan;
  JointModel others;  // what neither DEA nor FEBio with rigid cartilage makes sense of
  others.files = model.files;
  for (const Remark& remark : model.unsupported) {
    if (remark.what.rfind("rigid connector", 0) == 0)
      plan.left_to_febio.push_back(remark);
    else
      others.unsupported.push_back(remark);
  }
  refuse_unsupported(others);
  for (const Remark& remark : plan.left_to_febio)
    plan.notes.push_back(
        fmt::format("{}{} stays as it is: FEBio solves it with the contact; `dea run` does not know it",
                    where(model, remark.origin), remark.what));
  // A model of which nothing is left to convert need not be recognised to say so.
  const bool all_dea = std::all_of(model.contacts.begin(), model.contacts.end(),
                                   [](const Contact& c) { return c.kind != Contact::Kind::Sliding || c.dea; });
  for (const Contact& c : model.contacts)
    if (all_dea && c.dea) throw nothing_to_convert(model, c);
  plan.joint = make_joint(model, settings);
  if (!plan.joint.symmetry_planes.empty() && !settings.placements.empty())
    throw UsageError(Fault{
        .found = say("bodies are placed by --rotate or --move, and the model has planes of symmetry ({}), at which "
                     "its surfaces would no longer end;",
                     in_words(plan.joint.symmetry_planes)),
        .expected = "convert the model as it is"});
  plan.target = model;
  choose_contacts(model, settings, plan);

  const std::vector<char> rigid = rigid_materials(model, settings);
  const Bodies bodies = find_bodies(model, rigid);
  const std::vector<int> cartilage = cartilage_nodes(model, plan);
  refuse_moved_nodes(model, cartilage, rigid);
  std::vector<int> rigid_material = rigid_material_of_bodies(model, plan);
  convert_contacts(model, plan);
  add_ground(model, plan, rigid_material, cartilage);
  hold_bones(model, plan, rigid_material);
  convert_materials(rigid_material, plan);
  convert_domains(model, rigid, rigid_material, cartilage, bodies.of_material, plan);
  check_bodies(model, plan, rigid_material);
  plan.node_rigid = nodes_of_materials(plan.target, rigid_materials(plan.target, {}));
  convert_conditions(model, plan);
  check_faces(model, settings, plan);
  return plan;
}

}  // namespace dea
