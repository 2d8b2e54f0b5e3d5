#include "views/text/info_words.h"

#include "src/base/names.h"

namespace dea {

const char* word(DofState s) { return word_of(s, {"free", "held", "prescribed"}); }

const char* word(RigidJoint::Motion motion) { return word_of(motion, {"held", "free", "prescribed"}); }

const char* word(DiscreteSprings::Measure measure) { return word_of(measure, {"elongation", "strain", "stretch"}); }

std::string law_origin(const Contact& contact, const Settings& settings) {
  if (settings.law) return "chosen with --law";
  if (contact.dea && contact.dea->law) return "as the contact of type dea says";
  if (settings.springs_at == SpringsAt::Bone)
    return "the default with --springs-at bone (springs at the articular surface: layer)";
  return "the default (with --springs-at bone: linear); another one with --law";
}

}  // namespace dea
