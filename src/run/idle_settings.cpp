#include "src/run/idle_settings.h"

#include <algorithm>
#include <set>
#include <string>

#include "src/base/numbers.h"
#include "src/base/say.h"

namespace dea {

namespace {

/// Warns of those of a setting's surfaces that no sliding contact has.
template <class Values>
void add_surfaces(const std::set<std::string>& sliding, const char* setting, const Values& values,
                  std::vector<Sentence>& idle) {
  for (const auto& entry : values)
    if (!entry.first.empty() && sliding.count(entry.first) == 0)
      idle.push_back(say("{}: it has no effect, for no sliding contact has this surface",
                         NamedSetting{.setting = setting, .of = entry.first, .bare = true}));
}

bool turns(const JointModel& model, const Joint& joint, const Settings& settings, int body) {
  const auto is_it = [&](const std::string& name) { return !name.empty() && joint.find_body(model, name) == body; };
  return (settings.motion.turns && is_it(settings.motion.body)) ||
         std::any_of(settings.placements.begin(), settings.placements.end(),
                     [&](const Placement& p) { return p.kind == Placement::Kind::Rotate && is_it(p.body); });
}

}  // namespace

std::vector<Sentence> idle_settings(const JointModel& model, const Joint& joint, const Settings& settings) {
  std::set<std::string> sliding;  // surfaces, also of contacts that the settings leave out
  for (const Contact& c : model.contacts)
    if (c.kind == Contact::Kind::Sliding)
      for (const int surface : {c.primary, c.secondary}) sliding.insert(model.surfaces[at(surface)].name);
  std::vector<Sentence> idle;
  add_surfaces(sliding, "attach", settings.attach, idle);
  add_surfaces(sliding, "bone", settings.bone, idle);
  add_surfaces(sliding, "thickness", settings.thickness, idle);
  add_surfaces(sliding, "thickness-from", settings.thickness_from, idle);
  add_surfaces(sliding, "thickness-scale", settings.thickness_scale, idle);
  add_surfaces(sliding, "E", settings.E, idle);
  add_surfaces(sliding, "nu", settings.nu, idle);
  for (const auto& entry : settings.rotate_about)
    if (!turns(model, joint, settings, joint.find_body(model, entry.first)))
      idle.push_back(say("{}: it has no effect, for no setting turns body \"{}\"; turn it with {}, or leave it out",
                         NamedSetting{.setting = "rotate-about", .of = entry.first, .bare = true}, entry.first,
                         NamedSetting{"rotate", entry.first, "x,y,z,DEGREES"}));
  return idle;
}

}  // namespace dea
