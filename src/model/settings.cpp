#include <febiodea/model/settings.h>

namespace dea {

const char* name(SpringsAt springs_at) { return springs_at == SpringsAt::Bone ? "bone" : "articular"; }

const char* name(Facets facets) { return facets == Facets::Flat ? "flat" : "curved"; }

const char* name(Law law) {
  switch (law) {
    case Law::Linear:
      return "linear";
    case Law::Logarithmic:
      return "logarithmic";
    case Law::NeoHookean:
      return "neo-Hookean";
    case Law::Layer:
      return "layer";
  }
  return "";
}

const char* name(LayerFit fit) { return fit == LayerFit::OneTerm ? "one term" : "two terms"; }

}  // namespace dea
