#include "src/joint/layer_material.h"

#include <cmath>

#include "src/base/numbers.h"
#include "src/base/say.h"

namespace dea {

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
                   say("DEA keeps bones rigid: type {}", NamedSetting{"rigid", "", other.name}));
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
      throw refusal_of(in, say("its part consists of {}, but a layer has one modulus here;", both),
                       say("give one for all of it with {}, or make parts that are no cartilage rigid with {}",
                           modulus_settings(in), NamedSetting{"rigid", "", other.name}));
    findings.push_back({"first-material-for-all",
                        {.surface = in.surface.name},
                        {{"materials", both}, {"give_E", NamedSetting{"E"}}, {"give_nu", NamedSetting{"nu"}}}});
  }
  return findings;
}

}  // namespace dea
