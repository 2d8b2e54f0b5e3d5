// views/text/info_words.h – what was recognised in words, the same in text and JSON.
#pragma once
#include <string>

#include "src/run/check.h"

namespace dea {

const char* word(DofState state);                    ///< free, held, prescribed
const char* word(RigidJoint::Motion motion);         ///< the same of a joint's motions
const char* word(DiscreteSprings::Measure measure);  ///< elongation, strain, stretch
/// Who chose the law of a contact.
std::string law_origin(const Contact& contact, const Settings& settings);

}  // namespace dea
