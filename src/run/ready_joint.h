// src/run/ready_joint.h – a joint recognised and factorised once, for all cases that differ only in how it is placed,
// loaded and moved.
#pragma once
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "src/base/finding.h"
#include "src/run/analysis.h"

namespace dea {

/// A joint that is ready to be solved under any loads. Never changes.
struct ReadyJoint {
  JointModel model;
  Prepared prepared;
  FieldMaps maps;
  Settings settings;  ///< of the joint
  Findings warnings;  ///< of the model and the joint

  /// The end of the model's last step, as the file has it, solved from the reference when it is first asked for;
  /// nullptr: it is no solution. Stopped: `stop` was set.
  const KnownBalance* end_of_model(const StopFlag* stop) const;
  /// The inside of its layers, made ready when it is first asked for.
  const InsideMaps& inside() const;

 private:
  mutable std::once_flag end_solved_;
  mutable std::optional<KnownBalance> end_of_model_;
  mutable std::once_flag looked_inside_;
  mutable InsideMaps inside_;
};

/// `recognition` has no faults; its loads do not matter (recognise_joint). Stopped: `stop` was set.
std::shared_ptr<const ReadyJoint> make_ready_joint(Recognition recognition, const StopFlag* stop);

/// A text for each joint of a model: different where joint_settings(settings) differ in any setting.
std::string joint_key(const Settings& settings);
/// Whether they say nothing of how the joint is placed, loaded and moved: then it is the model's.
bool is_its_joint(const Settings& settings);

}  // namespace dea
