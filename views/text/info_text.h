// views/text/info_text.h – what was recognised in a model, for people: what `dea info` prints.
#pragma once
#include <string>

#include "src/run/check.h"

namespace dea {

std::string info_text(const JointModel& model, const Settings& settings, const JointCheck& check);

/// What moves and loads a body: "x free, y held, ..., Ru held; force (0, 0, -100)"; for a paper "translation along x
/// free, ..., rotations held; ...".
std::string conditions_text(const BodyConditions& conditions, bool paper = false);

/// The same in every row of the tables (JointCheck::row, which is there), where what a table gives is told as such:
/// "x free, y held, ...; the load of the table gait.csv".
std::string row_conditions_text(const JointModel& model, const Settings& settings, const JointCheck& check, int body,
                                bool paper = false);

// Words of text and JSON alike.

const char* word(DofState state);                    ///< free, held, prescribed
const char* word(RigidJoint::Motion motion);         ///< the same of a joint's motions
const char* word(DiscreteSprings::Measure measure);  ///< elongation, strain, stretch
/// Who chose the law of a contact.
std::string law_origin(const Contact& contact, const Settings& settings);

}  // namespace dea
