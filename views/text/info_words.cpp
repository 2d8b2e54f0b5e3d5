#include <febiodea/views/text/info_words.h>

namespace dea {

const char* word(DofState s) {
  switch (s) {
    case DofState::Free:
      return "free";
    case DofState::Held:
      return "held";
    case DofState::Prescribed:
      return "prescribed";
  }
  return "";
}

const char* word(RigidJoint::Motion motion) {
  return motion == RigidJoint::Motion::Held ? "held" : motion == RigidJoint::Motion::Free ? "free" : "prescribed";
}

const char* word(DiscreteSprings::Measure measure) {
  return measure == DiscreteSprings::Measure::Elongation ? "elongation"
         : measure == DiscreteSprings::Measure::Strain   ? "strain"
                                                         : "stretch";
}

std::string law_origin(const Contact& contact, const Settings& settings) {
  if (settings.law) return "chosen with --law";
  if (contact.dea && contact.dea->law) return "as the contact of type dea says";
  if (settings.springs_at == SpringsAt::Bone)
    return "the default with --springs-at bone (springs at the articular surface: layer)";
  return "the default (with --springs-at bone: linear); another one with --law";
}

}  // namespace dea
