#include <febiodea/run/idle_settings.h>

#include <algorithm>
#include <set>
#include <string>

#include <febiodea/base/numbers.h>
#include <febiodea/base/say.h>

namespace dea {

namespace {

/// Warns of those of a setting's surfaces that no solved contact has.
template <class Values>
void add_surfaces(const std::set<std::string>& solved, const char* setting, const Values& values,
                  std::vector<Sentence>& idle) {
  for (const auto& entry : values)
    if (!entry.first.empty() && solved.count(entry.first) == 0)
      idle.push_back(say("{}: it has no effect, for no contact that is solved has this surface",
                         NamedSetting{.setting = setting, .of = entry.first, .bare = true}));
}

bool turns(const JointModel& model, const Joint& joint, const Settings& settings, int body) {
  const auto is_it = [&](const std::string& name) { return !name.empty() && joint.find_body(model, name) == body; };
  return (settings.motion.turns && is_it(settings.motion.body)) ||
         std::any_of(settings.placements.begin(), settings.placements.end(),
                     [&](const Placement& p) { return p.kind == Placement::Kind::Rotate && is_it(p.body); });
}

bool names_frame(const Settings& settings, const std::string& frame) {
  return settings.loads.frame.frame == frame ||
         std::any_of(settings.placements.begin(), settings.placements.end(),
                     [&](const Placement& p) { return p.frame == frame; }) ||
         std::any_of(settings.force_frame.begin(), settings.force_frame.end(),
                     [&](const auto& given) { return given.second == frame; });
}

}  // namespace

std::vector<Sentence> idle_settings(const JointModel& model, const Joint& joint, const Settings& settings) {
  std::set<std::string> solved;  // surfaces
  for (const ContactPair& pair : joint.contacts)
    for (const Layer& layer : pair.layers) solved.insert(model.surfaces[at(layer.surface)].name);
  std::vector<Sentence> idle;
  add_surfaces(solved, "attach", settings.attach, idle);
  add_surfaces(solved, "bone", settings.bone, idle);
  add_surfaces(solved, "thickness", settings.thickness, idle);
  add_surfaces(solved, "thickness-from", settings.thickness_from, idle);
  add_surfaces(solved, "thickness-scale", settings.thickness_scale, idle);
  add_surfaces(solved, "E", settings.E, idle);
  add_surfaces(solved, "nu", settings.nu, idle);
  for (const auto& entry : settings.rotate_about)
    if (!turns(model, joint, settings, joint.find_body(model, entry.first)))
      idle.push_back(say("{}: it has no effect, for no setting turns body \"{}\"; turn it with {}, or leave it out",
                         NamedSetting{.setting = "rotate-about", .of = entry.first, .bare = true}, entry.first,
                         NamedSetting{"rotate", entry.first, "x,y,z,DEGREES"}));
  for (const auto& entry : settings.frames)
    if (!names_frame(settings, entry.first))
      idle.push_back(say("{}: it has no effect, for no setting names it (frame:{})",
                         NamedSetting{.setting = "frame", .of = entry.first, .bare = true}, entry.first));
  return idle;
}

}  // namespace dea
