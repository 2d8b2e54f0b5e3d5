// views/ready_joints.h – joints read, recognised and factorised once, for all cases that differ only in how
// they are placed, loaded and moved.
#pragma once
#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "src/base/finding.h"
#include "src/run/analysis.h"

namespace dea {

/// A joint that is ready to be solved under any loads. Never changes.
struct ReadyJoint {
  JointModel model;
  Prepared prepared;
  FieldMaps maps;
  Settings settings;   ///< of the joint
  Findings warnings;   ///< of the model and the joint
  double bytes = 0.0;  ///< of memory: kept_bytes

  /// The end of the model's last step, as the file has it, solved from the reference when it is first asked for;
  /// nullptr: it is no solution. Stopped: `stop` was set.
  const Begin* begin(const StopFlag* stop) const;
  /// The inside of its layers, made ready when it is first asked for.
  const InsideMaps& inside() const;

 private:
  mutable std::once_flag begun_;
  mutable std::optional<Begin> begin_;
  mutable std::once_flag looked_inside_;
  mutable InsideMaps inside_;
};

/// A text for each joint: different where its model or a setting of it differs.
std::string joint_key(const std::string& path, const Settings& settings);

/// The joints that were used last, as many as fit. Several threads may ask at a time; a joint that two want is made
/// once.
class ReadyJoints {
 public:
  /// `bytes`: of all joints together; one is always kept. They take no more than half of what is free, either.
  explicit ReadyJoints(double bytes) : most_(bytes) {}

  /// The joint of a model file under joint_settings(settings). Throws as read_feb and recognise do, each time that it
  /// is asked for, and Stopped.
  std::shared_ptr<const ReadyJoint> get(const std::string& path, const Settings& settings, const StopFlag* stop);
  /// Nobody will ask for this joint again; whoever has it keeps it.
  void forget(const std::string& path, const Settings& settings);

 private:
  using Made = std::shared_future<std::shared_ptr<const ReadyJoint>>;
  struct Entry {
    Made made;
    std::uint64_t used = 0;
    double bytes = 0.0;  // that it takes, or will take; 0: not known yet, or a fault
    bool ready = false;
  };
  void make_room(const std::string& key, double bytes);

  double most_;
  std::mutex mutex_;
  std::uint64_t clock_ = 0;
  std::map<std::string, Entry> entries_;  // by path and settings
};

}  // namespace dea
