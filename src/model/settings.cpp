#include <febiodea/model/settings.h>

#include <febiodea/base/names.h>

namespace dea {

Settings joint_settings(Settings s) {
  s.free.clear();
  s.force.clear();
  s.load_at.clear();
  s.placements.clear();
  s.rotate_about.clear();
  s.loads = {};
  s.motion = {};
  s.skip_steps = false;
  s.inside = false;
  return s;
}

const char* name(SpringsAt springs_at) { return word_of(springs_at, {"articular", "bone"}); }

const char* name(Facets facets) { return word_of(facets, {"curved", "flat"}); }

const char* name(Law law) { return word_of(law, {"linear", "logarithmic", "neo-Hookean", "layer"}); }

const char* name(LayerFit fit) { return word_of(fit, {"one term", "two terms"}); }

}  // namespace dea
