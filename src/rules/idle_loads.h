// src/rules/idle_loads.h – loads that move nothing, for the body is not free to go their way; settings that nothing
// uses.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "src/base/finding.h"
#include "src/base/sentence.h"
#include "src/joint/joint.h"

namespace dea {

/// A load of the settings (a force, or a table of loads) on a body that is held or moved against it at the end of the
/// model's last step.
struct IdleLoad {
  NamedSetting given;
  std::string body;
  std::array<bool, kDofs> lost = {};  ///< components of force and moment, global axes, that have no effect
  bool all = true;                    ///< nothing of the load has an effect
};

/// Of each force and table of the settings with an idle component. A force of zero is none. Where a component acts
/// beside the centre of mass of a body that is free to turn, its moment counts as an effect.
std::vector<IdleLoad> idle_loads(const JointModel& model, const Joint& joint, const Settings& settings);

/// What to do about it: "load another body, or let it move (...)" with the setting that frees it, also to turn where
/// a moment is lost.
Sentence instead_of(const IdleLoad& load);

/// Why it has no effect: "the body "tibia" is not free to move along x, y, z; this load has no effect".
std::string idle_in_words(const IdleLoad& load);

/// Loads of the model without effect. Forces along a motion that it prescribes, in all steps in which they act. Where
/// no load of the model or the settings has an effect, also forces on bodies that are held; else these are the other
/// ends of muscles. Moments about an axis that is held or prescribed, but for those whose opposite acts on another
/// body, as a joint has them. Not loads that the settings replace, those of value 0, and those of kind Target or
/// relative ones, which FEBio counts from the reaction.
Findings idle_model_loads(const JointModel& model, const Joint& joint, const Settings& settings);

/// Points of the settings (load-at) that change nothing: no force acts on the body, or none of its
/// rotations is free. Followers and forces at nodes have points of their own.
Findings idle_load_points(const JointModel& model, const Joint& joint, const Settings& settings);

/// Settings of a surface that no sliding contact has; points of turning (rotate-about) of a body that nothing turns.
/// Not frames: a settings file has all of a bone's.
Findings idle_settings(const JointModel& model, const Joint& joint, const Settings& settings);

/// What the user is to be warned of. Of a table's moments nothing is said unless its forces are idle
/// too: measured tables have them, and bones that do not turn are usual.
Findings idle_findings(const std::vector<IdleLoad>& loads);

}  // namespace dea
