#include "src/model/settings.h"

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/say.h"

namespace dea {

Settings joint_settings(Settings s) {
  s.free.clear();
  s.force.clear();
  s.force_frame.clear();
  s.frames.clear();
  s.load_at.clear();
  s.placements.clear();
  s.rotate_about.clear();
  s.loads = {};
  s.motion = {};
  s.skip_steps = false;
  s.inside = false;
  return s;
}

Eigen::Matrix3d frame_axes(const Settings& settings, const std::string& frame, const NamedSetting& asks) {
  if (frame.empty()) return Eigen::Matrix3d::Identity();
  const auto found = settings.frames.find(frame);
  if (found != settings.frames.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& entry : settings.frames) names.push_back(entry.first);
  throw UsageError(Fault{.given = asks,
                         .found = say("there is no frame \"{}\"{};", frame, did_you_mean(frame, names)),
                         .expected = say("name one of {}, or give it with {}", name_list(names, frame),
                                         NamedSetting{"frame", frame, "x,y,z/x,y,z/x,y,z"})});
}

Eigen::Vector3d global_vector(const Settings& settings, const Placement& p) {
  const char* setting = p.kind == Placement::Kind::Rotate ? "rotate" : "move";
  return frame_axes(settings, p.frame, {setting, p.body}) * p.vector;
}

Eigen::Vector3d global_force(const Settings& settings, const std::string& body) {
  const auto frame = settings.force_frame.find(body);
  const Eigen::Vector3d& force = settings.force.at(body);
  return frame == settings.force_frame.end() ? force : frame_axes(settings, frame->second, {"force", body}) * force;
}

const char* name(SpringsAt springs_at) { return word_of(springs_at, {"articular", "bone"}); }

const char* name(Facets facets) { return word_of(facets, {"curved", "flat"}); }

const char* name(Law law) { return word_of(law, {"linear", "logarithmic", "neo-Hookean", "layer"}); }

const char* name(LayerFit fit) { return word_of(fit, {"one term", "two terms"}); }

}  // namespace dea
