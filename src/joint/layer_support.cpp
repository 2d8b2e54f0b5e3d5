#include "src/joint/layer_support.h"

#include <algorithm>
#include <cmath>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"

namespace dea {

namespace {

/// Deformable shells that may be a bone: those that cover no articular surface.
bool bone_shell(const ContactSide& in, const Domain& d) {
  const ModelParts& parts = in.parts;
  if (!is_shell(d.shape) || d.material < 0 || parts.rigid[at(d.material)]) return false;
  for (int f = 0; f < in.surface.size(); ++f) {
    const std::vector<ElementFace>* faces = find_face(parts, in.surface, f);
    if (faces != nullptr && std::any_of(faces->begin(), faces->end(), [&](const ElementFace& face) {
          return &parts.model.domains[at(face.domain)] == &d;
        }))
      return false;
  }
  return true;
}

/// A layer nothing holds: usually its bone is deformable, of another material of the same part.
InputError not_held(const ContactSide& in, int region, bool of_several, int cartilage) {
  const ModelParts& parts = in.parts;
  const JointModel& model = parts.model;
  const auto touches = [&](const Domain& d) {  // solids lie in one part with all their nodes, shells on it with some
    return std::any_of(d.nodes.begin(), d.nodes.end(), [&](int node) { return parts.region[at(node)] == region; });
  };
  std::set<int> others;
  for (const Domain& d : model.domains)
    if ((deformable(parts, d) || bone_shell(in, d)) && d.material != cartilage && touches(d)) others.insert(d.material);
  Sentence bones;
  for (int m : others) {
    const NamedSetting rigid = {"rigid", "", model.materials[at(m)].name};
    bones = bones.empty() ? say("{}", rigid) : say("{} or {}", bones, rigid);
  }
  std::string bodies;
  const std::vector<int>& body_of_node = parts.bodies.of_node;
  for (std::size_t b = 0; b + 1 < parts.bodies.bodies.size(); ++b) {
    const bool meshed = std::find(body_of_node.begin(), body_of_node.end(), static_cast<int>(b)) != body_of_node.end();
    bodies += fmt::format("{}\"{}\"{}", b ? ", " : "", parts.bodies.bodies[b].name, meshed ? "" : " without elements");
  }
  const Sentence attach =
      say("name the body with {} (bodies: {}), and the layer's bone surface with {} or its thickness with {}",
          setting_of(in, "attach", "BODY"), bodies.empty() ? "none" : bodies, setting_of(in, "bone", "SURFACE"),
          setting_of(in, "thickness"));
  std::string far;
  const auto of_region = [&](int s) {
    const std::vector<int>& nodes = model.surfaces[at(s)].nodes;
    return std::any_of(nodes.begin(), nodes.end(), [&](int node) { return parts.region[at(node)] == region; });
  };
  for (const auto& [contact, tie] : parts.holders.far_ties)
    if (of_region(model.contacts[at(contact)].primary) || of_region(model.contacts[at(contact)].secondary))
      far += fmt::format(
          "contact \"{}\" of type {} reaches {:g}, and {} of {} nodes lie {:.4g} or more from the surface they would "
          "be "
          "tied to: they are not tied, in FEBio neither; if they are to be, write a larger {} into it; ",
          model.contacts[at(contact)].name, model.contacts[at(contact)].type, model.contacts[at(contact)].max_distance,
          tie.nodes, tie.of, tie.nearest,
          ties_by_search_radius(model.contacts[at(contact)].type) ? "<search_radius> (1 if it is not given)"
                                                                  : "<max_distance>");
  return refusal_of(
      in,
      say("{}{} is held by no rigid body (no shared nodes, rigid node set, tied contact or nodes fixed in "
          "x, y and z);",
          far, of_several ? "one of its layer's parts" : "its layer"),
      bones.empty() ? attach : say("take its bone as rigid with {}, or {}", bones, attach));
}

InputError held_by_several(const ContactSide& in, const Support& support, const std::map<int, std::string>& holders) {
  std::string list;
  for (const auto& h : holders) list += (list.empty() ? "" : "; ") + h.second;
  const auto moved = std::count_if(holders.begin(), holders.end(), [&](const auto& h) {
    return !in.parts.bodies.bodies[at(h.first)].moved_by.empty();
  });
  if (support.regions.size() > 1 && moved == 0)
    return refusal_of(
        in, say("the {} parts of its layer are held by {} bodies ({});", support.regions.size(), holders.size(), list),
        say("divide it into one surface per body, or choose one with {}", setting_of(in, "attach", "BODY")));
  return refusal_of(in,
                    say("its layer is held by {} bodies ({}){};", holders.size(), list,
                        moved > 0 ? ", and moved nodes move otherwise than the rest, so it is not bonded to one "
                                    "bone: move all alike, or divide the layer"
                                  : ""),
                    say("choose with {}", setting_of(in, "attach", "BODY")));
}

Attachment attached_by_user(const ContactSide& in, const std::string& name) {
  const Bodies& bodies = in.parts.bodies;
  const int body = name == "ground" ? bodies.ground() : body_by_name(in.parts.model, bodies.bodies, name);
  if (body < 0)
    throw UsageError(Fault{.given = NamedSetting{"attach", in.surface.name, name},
                           .found = no_such_name("rigid body", name, every_name(bodies.bodies))});
  return {body, "attached by the user"};
}

}  // namespace

int Support::main_material() const {
  return std::max_element(materials.begin(), materials.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

Support find_support(const ContactSide& in, const CarriedSurface& carried) {
  const ModelParts& parts = in.parts;
  Support support;
  for (const ElementFace& c : carried.carriers) {
    const Domain& d = parts.model.domains[at(c.domain)];
    if (d.material < 0)
      throw refusal_of(in, say("its elements \"{}\" have no material (no domain in MeshDomains);", d.name),
                       "give them one");
    if (parts.rigid[at(d.material)] && !deformable(parts, d)) {
      support.bodies.insert(parts.bodies.of_material[at(d.material)]);
    } else if (is_shell(d.shape)) {
      throw refusal_of(
          in, say("lies on deformable shells (\"{}\");", d.name),
          say("DEA needs a solid cartilage layer or a rigid surface: mesh the layer with solid elements, or take the "
              "shells as rigid with {} (and, if the other side is rigid too, give cartilage with {} {})",
              NamedSetting{"rigid", "", parts.model.materials[at(d.material)].name}, setting_of(in, "thickness"),
              modulus_settings(in)));
    } else {
      support.regions.insert(region_of(parts, d, c.element));
      ++support.materials[d.material];
    }
  }
  if (!support.regions.empty() && !support.bodies.empty())
    throw refusal_of(in, "lies partly on rigid, partly on deformable elements;", "split it into two surfaces");
  return support;
}

Attachment find_attachment(const ContactSide& in, const Support& support) {
  const std::string name = said_of(in.parts.settings.attach, in.surface.name);
  const bool rigid = support.regions.empty();
  Attachment found;
  if (!name.empty()) found = attached_by_user(in, name);
  if (rigid && support.bodies.size() > 1)
    throw refusal_of(in, "lies on several rigid bodies;", "split it into one surface per body");
  if (found.body >= 0) return found;
  if (rigid) return {*support.bodies.begin(), "is a surface of the rigid body itself"};
  for (const int region : support.regions) {
    const int soft = soft_region(in.parts, region);
    if (soft < 0) continue;
    const SoftRegion& part = in.parts.soft[at(soft)];
    if (support.regions.size() > 1)
      throw refusal_of(in, say("lies on part \"{}\" and on others;", part.name), "split it into one surface per part");
    return {part.body, fmt::format("is a surface of the part \"{}\"", part.name)};
  }
  std::map<int, std::string> holders;
  for (int region : support.regions) {
    const auto held = in.parts.holders.of_region.find(region);
    if (held == in.parts.holders.of_region.end() || held->second.empty()) {
      if (in.contact.dea && in.parts.rigid[at(support.main_material())])
        throw unmeasured(in, "its elements share no nodes with the bone under them");
      throw not_held(in, region, support.regions.size() > 1, support.main_material());
    }
    holders.insert(held->second.begin(), held->second.end());
  }
  if (holders.size() > 1) throw held_by_several(in, support, holders);
  return {holders.begin()->first, holders.begin()->second};
}

namespace {

/// Beyond, forces could overflow.
constexpr double kMostModulus = 1e100;

/// Facets on materials of different modulus, where no modulus was given for them all.
void refuse_several_materials(const ContactSide& in, int material, const std::map<int, int>& under_facets) {
  const JointModel& model = in.parts.model;
  const auto modulus = [](const Material& x) {
    return std::isnan(x.E) ? std::string("no modulus known") : fmt::format("E {:g}, nu {:g}", x.E, x.nu);
  };
  for (const auto& entry : under_facets) {
    const Material &one = model.materials[at(entry.first)], &main = model.materials[at(material)];
    if (entry.first == material || (one.E == main.E && one.nu == main.nu) || (in.given.E && in.given.nu)) continue;
    throw refusal_of(
        in,
        say("its facets lie on several materials (\"{}\": {}; \"{}\": {}), but a layer has one modulus here;",
            main.name, modulus(main), one.name, modulus(one)),
        say("split the surface, or give the modulus with {}", modulus_settings(in)));
  }
}

/// Another, much stiffer material in the same deformable part is a deformable bone: the "layer" would be bone and all.
void refuse_deformable_bone(const ContactSide& in, int material, double E, const Material& other) {
  if (other.E <= 5.0 * E) return;
  const std::string moduli = std::isnan(other.E) ? "no modulus known"
                                                 : fmt::format("E = {:g} against {:g} of \"{}\"", other.E, E,
                                                               in.parts.model.materials[at(material)].name);
  throw refusal_of(in, say("its part also holds material \"{}\" ({}), a deformable bone?", other.name, moduli),
                   say("DEA keeps bones rigid: type {}, or {} to let all of it give way as its elements do",
                       NamedSetting{"rigid", "", other.name}, NamedSetting{"part", "", other.name}));
}

/// What is missing, at the line of who should have it: the material, the contact that gives the other one, or the
/// surface.
Fault missing_constants(const ContactSide& in, int material, const Elasticity& elasticity) {
  const JointModel& model = in.parts.model;
  const Material* m = material >= 0 ? &model.materials[at(material)] : nullptr;
  const bool no_E = std::isnan(elasticity.E), no_nu = std::isnan(elasticity.nu), both = no_E && no_nu;
  const bool by_contact =
      in.contact.dea && !both &&
      in.contact.dea->layers[in.side].E.has_value() != in.contact.dea->layers[in.side].nu.has_value();
  const std::string who = by_contact       ? fmt::format("the contact gives {}, and", no_E ? "nu" : "E")
                          : m              ? fmt::format("material \"{}\" (type {})", m->name, m->type)
                          : in.contact.dea ? "the contact"
                                           : "the rigid surface";
  const std::string note = by_contact || (m == nullptr && in.contact.dea) ? "" : m ? m->note : "no cartilage material";
  const Sentence found = say("contact \"{}\", surface \"{}\": {} {} {}{};", in.contact.name, in.surface.name, who,
                             by_contact ? "no" : "gives no",
                             both   ? "E and nu"
                             : no_E ? "E"
                                    : "nu",
                             note.empty() ? "" : " (" + note + ")");
  const Origin origin = m != nullptr && !by_contact ? m->origin
                        : in.contact.dea            ? in.contact.origin
                                                    : in.surface.origin;
  const bool for_all = m == nullptr && in.parts.settings.thickness.count(in.surface.name) == 0 && !in.contact.dea;
  if (for_all)
    return make_fault(model, origin, found,
                      say("name the surface that has cartilage, {}, or give this one its own with {}",
                          NamedSetting{"thickness", "SURFACE", "VALUE"}, modulus_settings(in)));
  std::string parameters;
  Sentence settings;
  for (const char* name : {"E", "nu"}) {
    if (!(name == std::string("E") ? no_E : no_nu)) continue;
    parameters += fmt::format("{}<{}>", parameters.empty() ? "" : " and ", parameter_of(in, name));
    settings = say("{}{}{}", settings, settings.empty() ? "" : " ", NamedSetting{name, in.surface.name, "VALUE"});
  }
  const char* pronoun = both ? "them" : "it";
  return make_fault(model, origin, found,
                    in.contact.dea ? say("give {} in the contact as {}, or with {}", pronoun, parameters, settings)
                                   : say("give {} with {}", pronoun, settings));
}

}  // namespace

Elasticity layer_elasticity(const ContactSide& in, int material) {
  const Material* m = material >= 0 ? &in.parts.model.materials[at(material)] : nullptr;
  Elasticity elasticity;
  elasticity.E = in.given.E.value_or(m ? m->E : kNaN);
  elasticity.nu = in.given.nu.value_or(m ? m->nu : kNaN);
  return elasticity;
}

std::optional<Fault> elasticity_fault(const ContactSide& in, int material, const Elasticity& elasticity) {
  const double E = elasticity.E, nu = elasticity.nu;
  if (std::isnan(E) || std::isnan(nu)) return missing_constants(in, material, elasticity);
  if (E > 0 && E <= kMostModulus && nu > -1 && nu < 0.5) return std::nullopt;
  return refusal_of(in, say("E = {:g}, nu = {:g};", E, nu),
                    say("need 0 < E <= 1e100 and -1 < nu < 0.5 (an incompressible layer is rigid for a spring bed): "
                        "mend its material, or give others with {}",
                        modulus_settings(in)))
      .fault;
}

Findings other_materials(const ContactSide& in, int material, const std::map<int, int>& under_facets,
                         const std::set<int>& in_part) {
  const JointModel& model = in.parts.model;
  const Material& own = model.materials[at(material)];
  const double E = in.given.E.value_or(own.E);
  Findings findings;
  refuse_several_materials(in, material, under_facets);
  for (int m : in_part) {
    if (m == material) continue;
    const Material& other = model.materials[at(m)];
    if (in.given.has_thickness()) {
      findings.push_back(
          {"other-material-rigid", {.surface = in.surface.name}, {{"material", own.name}, {"other", other.name}}});
      continue;
    }
    refuse_deformable_bone(in, material, E, other);
    const double nu = in.given.nu.value_or(own.nu);  // what the user gives is of the whole part
    const double other_E = in.given.E.value_or(other.E), other_nu = in.given.nu.value_or(other.nu), ratio = other_E / E;
    const double confined = confined_modulus(other_E, other_nu) / confined_modulus(E, nu);
    if ((in.given.E && in.given.nu) || (std::abs(ratio - 1) < 0.01 && std::abs(confined - 1) < 0.01)) continue;
    // Force goes with E, and less than in proportion with the confined modulus: about a fifth off at either limit.
    constexpr double kMostRatio = 1.25, kMostConfined = 1.6;
    const std::string both = fmt::format("\"{}\" (E {:g}, nu {:g}) and \"{}\" (E {:g}, nu {:g})", own.name, E, nu,
                                         other.name, other_E, other_nu);
    if (ratio > kMostRatio || ratio < 1 / kMostRatio || confined > kMostConfined || confined < 1 / kMostConfined)
      throw refusal_of(
          in, say("its part consists of {}, but a layer has one modulus here;", both),
          say("give one for all of it with {}, make parts that are no cartilage rigid with {}, or let "
              "all of it give way as its elements do with {}",
              modulus_settings(in), NamedSetting{"rigid", "", other.name}, NamedSetting{"part", "", other.name}));
    findings.push_back({"first-material-for-all",
                        {.surface = in.surface.name},
                        {{"materials", both}, {"give_E", NamedSetting{"E"}}, {"give_nu", NamedSetting{"nu"}}}});
  }
  return findings;
}

}  // namespace dea
