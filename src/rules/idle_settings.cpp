#include "src/rules/idle_settings.h"

#include <algorithm>
#include <set>
#include <string>

#include "src/base/numbers.h"
#include "src/base/say.h"

namespace dea {

namespace {

/// Warns of those of a setting's surfaces that no sliding contact has.
template <class Values>
void add_surfaces(const std::set<std::string>& sliding, const char* setting, const Values& values, Findings& idle) {
  for (const auto& entry : values)
    if (!entry.first.empty() && sliding.count(entry.first) == 0)
      idle.push_back({"idle-setting",
                      {.surface = entry.first},
                      {{"given", NamedSetting{.setting = setting, .of = entry.first, .bare = true}}}});
}

bool turns(const JointModel& model, const Joint& joint, const Settings& settings, int body) {
  const auto is_it = [&](const std::string& name) { return !name.empty() && joint.find_body(model, name) == body; };
  return (settings.motion.turns && is_it(settings.motion.body)) ||
         std::any_of(settings.placements.begin(), settings.placements.end(),
                     [&](const Placement& p) { return p.kind == Placement::Kind::Rotate && is_it(p.body); });
}

}  // namespace

Findings idle_settings(const JointModel& model, const Joint& joint, const Settings& settings) {
  std::set<std::string> sliding;  // surfaces, also of contacts that the settings leave out
  for (const Contact& c : model.contacts)
    if (c.kind == Contact::Kind::Sliding)
      for (const int surface : {c.primary, c.secondary}) sliding.insert(model.surfaces[at(surface)].name);
  Findings idle;
  add_surfaces(sliding, "attach", settings.attach, idle);
  add_surfaces(sliding, "bone", settings.bone, idle);
  add_surfaces(sliding, "thickness", settings.thickness, idle);
  add_surfaces(sliding, "thickness-from", settings.thickness_from, idle);
  add_surfaces(sliding, "thickness-scale", settings.thickness_scale, idle);
  add_surfaces(sliding, "E", settings.E, idle);
  add_surfaces(sliding, "nu", settings.nu, idle);
  for (const auto& entry : settings.rotate_about)
    if (!turns(model, joint, settings, joint.find_body(model, entry.first)))
      idle.push_back({"idle-setting",
                      {.body = entry.first},
                      {{"given", NamedSetting{.setting = "rotate-about", .of = entry.first, .bare = true}},
                       {"turn", NamedSetting{"rotate", entry.first, "x,y,z,DEGREES"}}},
                      1});
  return idle;
}

}  // namespace dea
