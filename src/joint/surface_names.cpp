#include "src/joint/surface_names.h"

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/facts/find_parts.h"

namespace dea {

namespace {

/// What lies under an articular surface, by name.
struct Underneath {
  int surface = -1;
  std::set<std::string> materials, element_sets, bodies;
};

Underneath what_is_under(const ModelParts& parts, int surface) {
  const JointModel& model = parts.model;
  Underneath under{surface, {}, {}, {}};
  std::set<int> bodies;
  for (int f = 0; f < model.surfaces[at(surface)].size(); ++f) {
    const ElementFace* face = carrier(parts, find_face(parts, model.surfaces[at(surface)], f));
    if (face == nullptr) continue;
    const Domain& d = model.domains[at(face->domain)];
    under.element_sets.insert(d.name);
    if (d.material < 0) continue;
    under.materials.insert(model.materials[at(d.material)].name);
    if (!deformable(parts, d)) {
      bodies.insert(body_of_material(parts, d.material));
      continue;
    }
    const auto held = parts.holders.of_region.find(region_of(parts, d, face->element));
    if (held != parts.holders.of_region.end())
      for (const auto& holder : held->second) bodies.insert(holder.first);
  }
  for (const int b : bodies)
    if (b >= 0) under.bodies.insert(parts.bodies.bodies[at(b)].name);
  return under;
}

/// Whose name it is, and its articular surfaces.
struct Meant {
  const char* what = "";
  std::vector<int> surfaces;
};

Meant meant_by(const std::string& name, const std::vector<Underneath>& all) {
  struct Kind {
    const char* what;
    std::set<std::string> Underneath::*names;
  };
  for (const Kind& kind : {Kind{"material", &Underneath::materials}, Kind{"element set", &Underneath::element_sets},
                           Kind{"body", &Underneath::bodies}}) {
    Meant meant{kind.what, {}};
    for (const Underneath& u : all)
      if ((u.*kind.names).count(name) > 0) meant.surfaces.push_back(u.surface);
    if (!meant.surfaces.empty()) return meant;
  }
  return {};
}

/// Renames the surfaces of settings, one after the other.
struct SurfaceNaming {
  const JointModel& model;
  const Settings& given;  ///< as the user typed them
  Findings& findings;
  std::optional<std::vector<Underneath>> under = {};  ///< found when it is first asked for

  /// `setting`: as it was given, with this name; empty: the name stays.
  std::string surface_of(const NamedSetting& setting, const std::string& name) {
    if (name.empty() || surface_index(model, name) >= 0) return "";
    if (!under) {
      const ModelParts parts = find_parts(model, given);
      std::set<int> articular;
      for (const Contact& c : model.contacts)
        if (c.kind == Contact::Kind::Sliding) articular.insert({c.primary, c.secondary});
      articular.erase(-1);
      under.emplace();
      for (const int s : articular) under->push_back(what_is_under(parts, s));
    }
    const Meant meant = meant_by(name, *under);
    if (meant.surfaces.empty()) return "";
    std::vector<std::string> names;
    for (const int s : meant.surfaces) names.push_back(model.surfaces[at(s)].name);
    if (names.size() > 1)
      throw UsageError(Fault{.given = setting,
                             .found = say("the model has no surface of this name, and {} \"{}\" has {} articular "
                                          "surfaces: {};",
                                          meant.what, name, names.size(), name_list(names)),
                             .expected = "name one of them"});
    findings.push_back(
        {"surface-meant", {.surface = names.front()}, {{"given", setting}, {"what", meant.what}, {"name", name}}});
    return names.front();
  }

  template <class Value>
  void rename(const char* setting, std::map<std::string, Value>& values) {
    const std::map<std::string, Value> before = values;
    for (const auto& entry : before) {
      const std::string surface = surface_of({.setting = setting, .of = entry.first}, entry.first);
      if (surface.empty()) continue;
      if (values.count(surface) > 0)
        throw UsageError(Fault{.given = NamedSetting{setting, entry.first},
                               .found = say("it is taken for surface \"{}\", which is given too;", surface),
                               .expected = "give one of them"});
      values[surface] = entry.second;
      values.erase(entry.first);
    }
  }
};

}  // namespace

Settings name_surfaces(const JointModel& model, const Settings& settings, Findings& findings) {
  Settings named = settings;
  SurfaceNaming naming{model, settings, findings};
  naming.rename("attach", named.attach);
  naming.rename("bone", named.bone);
  naming.rename("thickness", named.thickness);
  naming.rename("thickness-from", named.thickness_from);
  naming.rename("thickness-scale", named.thickness_scale);
  naming.rename("E", named.E);
  naming.rename("nu", named.nu);
  for (std::string& name : named.keep_facets) {
    const std::string surface = naming.surface_of({.setting = "keep-facets", .value = name}, name);
    if (!surface.empty()) name = surface;
  }
  return named;
}

}  // namespace dea
