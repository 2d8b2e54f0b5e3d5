#include "src/joint/contacts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/facts/given_layer.h"
#include "src/joint/bare_surface.h"
#include "src/joint/layer_findings.h"

namespace dea {

namespace {

/// About 10 GB of springs: more is a slip of the keyboard.
constexpr double kMostSprings = 2e7;

/// The same surfaces at the same time as a contact before.
void refuse_doubled(const JointModel& model, const std::vector<ContactPair>& others, const Contact& c) {
  for (const ContactPair& other : others) {
    const Contact& o = model.contacts[at(other.contact)];
    if (double_contact(o, c))
      throw fault_at(model, c.origin,
                     say("contacts \"{}\" and \"{}\" join the same surfaces at the same time and would share the "
                         "load between them;",
                         o.name, c.name),
                     say("keep one: {}", NamedSetting{"contact", "", o.name}));
  }
}

// ---- one contact ---------------------------------------------------------------------------------------------------

/// What its contact and the settings say of a pair; its layers are left empty. Throws UsageError where they contradict.
ContactPair stated_pair(const ModelParts& parts, int contact) {
  const Contact& c = parts.model.contacts[at(contact)];
  const Settings& settings = parts.settings;
  ContactPair pair{c, contact};
  pair.source = c.dea ? c.dea->source : 0;
  pair.law = law_of(settings, c);
  pair.layer_fit = settings.layer_fit;
  if (settings.interface_stiffness) pair.interface_compliance = 1.0 / *settings.interface_stiffness;
  if (pair.law == Law::Layer && settings.springs_at == SpringsAt::Bone)
    throw UsageError(Fault{.given = NamedSetting{"springs-at", "", "bone"},
                           .found = "the layer law needs springs at the articular surface;",
                           .expected = say("use {}, logarithmic or neo-Hookean", NamedSetting{"law", "", "linear"})});
  if (pair.law != Law::Layer && settings.layer_fit == LayerFit::OneTerm)
    throw UsageError(Fault{.given = NamedSetting{"layer-terms", "", "1"},
                           .found = say("contact \"{}\" has law {};", c.name, name(pair.law)),
                           .expected = "only law layer has terms"});
  pair.facets = facets_of(settings, c);
  pair.refine = settings.refine.value_or(c.dea ? c.dea->refine.value_or(1) : 1);
  return pair;
}

void refuse_many_springs(const ContactPair& pair) {
  const double springs = static_cast<double>(pair.refine) * pair.refine * pair.source_layer().spring_surface().size();
  const int largest =
      static_cast<int>(std::sqrt(kMostSprings / std::max(1, pair.source_layer().spring_surface().size())));
  if (springs > kMostSprings)
    throw UsageError(Fault{.given = NamedSetting{"refine", "", std::to_string(pair.refine)},
                           .found = say("{:.0f} springs for contact \"{}\",", springs, pair.name),
                           .expected = say("need at most {:.0f}: {} at most", kMostSprings,
                                           NamedSetting{"refine", "", std::to_string(largest)})});
}

InputError no_cartilage(const JointModel& model, const Contact& c) {
  return fault_at(
      model, c.origin,
      say("contact \"{}\": both surfaces are bare rigid surfaces, there is no cartilage to compress;", c.name),
      say("give one a layer {}with {} {} {}",
          c.dea ? "in the contact as <primary_thickness>, <primary_E>, <primary_nu>, or " : "",
          NamedSetting{"thickness", "SURFACE", "VALUE"}, NamedSetting{"E", "SURFACE", "VALUE"},
          NamedSetting{"nu", "SURFACE", "VALUE"}));
}

/// Layers that are next to nothing beside their facets: thickness in another unit.
void refuse_too_thin(const JointModel& model, const Contact& c, const ContactPair& pair) {
  if (pair.law != Law::Layer) return;
  for (const Layer& layer : pair.layers) {
    const int thin = layer.without_thickness(kLayerLawThickness), all = static_cast<int>(layer.thickness.size());
    if (2 * thin <= all) continue;
    const std::string& name = model.surfaces[at(layer.surface)].name;
    throw fault_at(
        model, c.origin,
        say("surface \"{}\": at {} of {} vertices its {}thickness, {:.3g} in the mean, is less than {:g}% of "
            "the facets' size, which law layer has no answer for;",
            name, thin, all, layer.thickness_given ? "given " : "", layer.mean_thickness(), 100 * kLayerLawThickness),
        layer.thickness_given ? say("give it in the model's unit of length, which its nodes are in, or take {}",
                                    NamedSetting{"law", "", "linear"})
                              : say("check its bone surface and the units, give {}, or take {}",
                                    NamedSetting{"thickness", name, "VALUE"}, NamedSetting{"law", "", "linear"}));
  }
}

/// Layers so auxetic that the search for law layer's pressures was not seen to end: on the hip and with a sphere on a
/// flat layer it does at nu = -0.3 and does not at -0.35.
void refuse_too_auxetic(const JointModel& model, const Contact& c, const ContactPair& pair) {
  constexpr double kLeastNu = -0.3;
  if (pair.law != Law::Layer) return;
  for (const Layer& layer : pair.layers)
    if (!layer.rigid && layer.elasticity.nu < kLeastNu)
      throw fault_at(model, c.origin,
                     say("surface \"{}\": nu = {:g}, and law layer has no answer for less than {:g};",
                         model.surfaces[at(layer.surface)].name, layer.elasticity.nu, kLeastNu),
                     say("check its sign, or take {}", NamedSetting{"law", "", "neo-Hookean"}));
}

/// The side whose layer carries the springs.
int source_of(const ModelParts& parts, const ContactPair& pair) {
  const int body =
      parts.settings.source.empty() ? -1 : body_by_name(parts.model, parts.bodies.bodies, parts.settings.source);
  for (int side = 1; side >= 0; --side)
    if (body >= 0 && pair.layers[side].body == body) return side;
  return pair.source;
}

/// Both layers of a pair; what keeps them from being recognised, each once, is added to `faults`.
bool make_layers(const ModelParts& parts, const Contact& c, ContactPair& pair, std::vector<Fault>& faults) {
  bool good = true;
  for (int side = 0; side < 2; ++side) {
    try {
      pair.layers[side] = make_layer(parts, c, side);
    } catch (const InputError& error) {
      good = false;
      add_once(faults, error);
    }
  }
  return good;
}

/// The faces of layers without elements end where the selection does.
void find_selected_faces(const ModelParts& parts, ContactPair& pair) {
  for (Layer& layer : pair.layers) {
    if (layer.rigid || layer.springs_at == SpringsAt::Bone || layer.face.mesh.size() > 0) continue;
    layer.face = selected_face(layer.articular, parts.holders.held_components);
    layer.face.thickness = layer.thickness;
  }
}

/// Springs that know nothing of each other cannot press a part, all of which moves with any force on it.
InputError needs_layer_law(const JointModel& model, const ContactPair& pair) {
  return fault_at(
      model, pair.origin,
      say("contact \"{}\" presses a deformable part, and law {} has no answer for it;", pair.name, name(pair.law)),
      say("take {}", NamedSetting{"law", "", "layer"}));
}

/// A contact whose layers are known joins the others, unless it joins a body with itself.
void add_contact(const ModelParts& parts, ContactPair pair, FoundContacts& found) {
  const JointModel& model = parts.model;
  const Contact& c = model.contacts[at(pair.contact)];
  refuse_many_springs(pair);
  refuse_doubled(model, found.contacts, c);
  if (pair.layers[0].body == pair.layers[1].body && pair.layers[0].part == pair.layers[1].part) {
    found.findings.push_back(
        {"one-body", {.contact = c.name, .body = parts.bodies.bodies[at(pair.layers[0].body)].name}});
    return;
  }
  const bool parts_press = pair.layers[0].part >= 0 || pair.layers[1].part >= 0;
  if (pair.layers[0].rigid && pair.layers[1].rigid && !parts_press) throw no_cartilage(model, c);
  if (parts_press && pair.law != Law::Layer) throw needs_layer_law(model, pair);
  for (int side = 0; side < 2; ++side)  // a shell surface has two sides
    add_once(found.findings, face_partner(parts, pair.facets, pair.layers[1 - side].articular, pair.layers[side]));
  if (parts_press) {
    const SurfaceMesh whole[2] = {pair.layers[0].articular, pair.layers[1].articular};
    for (int side = 0; side < 2; ++side) leave_out_far_side(parts, pair.facets, whole[1 - side], pair.layers[side]);
  }
  for (Layer& layer : pair.layers)
    if (layer.rigid) layer.bare_rim = bare_rim(parts, layer);
  refuse_too_thin(model, c, pair);
  refuse_too_auxetic(model, c, pair);
  find_selected_faces(parts, pair);
  for (const Layer& layer : pair.layers) add_once(found.findings, layer_findings(parts, layer));
  pair.source = source_of(parts, pair);
  found.contacts.push_back(std::move(pair));
}

}  // namespace

FoundContacts find_contacts(const ModelParts& parts, std::vector<Fault> faults) {
  const JointModel& model = parts.model;
  const std::string& wanted = parts.settings.contact;
  FoundContacts found;
  found.faults = std::move(faults);
  std::vector<std::string> names;
  for (int i = 0; i < static_cast<int>(model.contacts.size()); ++i) {
    const Contact& c = model.contacts[at(i)];
    if (c.kind != Contact::Kind::Sliding) continue;
    names.push_back(c.name);
    if (!wanted.empty() && c.name != wanted) continue;
    try {
      if (c.primary < 0 || c.secondary < 0)
        throw fault_at(model, c.origin, say("contact \"{}\" lacks a surface:", c.name), "give it two");
      ContactPair pair = stated_pair(parts, i);
      if (make_layers(parts, c, pair, found.faults)) add_contact(parts, std::move(pair), found);
    } catch (const InputError& alone) {
      found.faults = {alone.fault};
      return found;
    }
  }
  found.sliding = static_cast<int>(names.size());
  if (!wanted.empty() && std::find(names.begin(), names.end(), wanted) == names.end())
    throw UsageError(
        Fault{.given = NamedSetting{"contact", "", wanted}, .found = no_such_name("sliding contact", wanted, names)});
  return found;
}

}  // namespace dea
