// src/run/recognise.h – what joint a model describes, and every reason for which it cannot be solved.
#pragma once
#include <string>
#include <vector>

#include "src/base/fault.h"
#include "src/base/finding.h"
#include "src/joint/joint.h"

namespace dea {

/// A model with what it was taken for. A value: it keeps the model and the settings it was made from, so that nothing
/// can be asked of one model with another's joint.
struct Recognition {
  JointModel model;
  Settings settings;
  bool recognised = false;    ///< `joint` is filled: bodies, layers and contacts were found
  Joint joint;                ///< frame: the model's, reference configuration
  std::vector<Fault> faults;  ///< empty: the joint can be solved, as far as is known before solving
  double seconds = 0.0;       ///< spent on it
};

/// Finds bodies, layers, contacts and what joins them (docs/theory.md, section 2). Faults, the most basic first: no
/// sliding contact, no rigid body; then what is not supported, in the order of the file; then layers that cannot be
/// recognised, in the order of the contacts; then motions, loads and times. What could only be found once something
/// else is mended is not among them. `all_states`: every state of the model is wanted, so there must not be too many.
/// Throws UsageError for settings that name nothing in the model.
Recognition recognise(JointModel model, Settings settings = {}, bool all_states = false);

/// The same but for motions, loads and times: whether they can be followed is not asked, and how they are taken not
/// told.
Recognition recognise_joint(JointModel model, Settings settings = {});

/// What settings that place, load and move the bodies make of a joint that is there.
struct Loading {
  std::vector<Fault> faults;  ///< as Recognition::faults
  Findings findings;          ///< how they were taken
};
/// `joint`: recognised from `model` and joint_settings(settings), whose bodies they name (check_body_names). Throws
/// UsageError for settings that contradict each other.
Loading check_loading(const JointModel& model, const Joint& joint, const Settings& settings);

/// Refuses a model that holds something which changes the mechanics and is not supported (InputError at its place).
void refuse_unsupported(const JointModel& model);

}  // namespace dea
