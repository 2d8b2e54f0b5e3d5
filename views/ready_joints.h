// febiodea/views/ready_joints.h – joints read, recognised and factorised once, for all cases that differ only in how
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

#include <febiodea/run/analysis.h>

namespace dea {

/// A joint that is ready to be solved under any loads. Never changes.
struct ReadyJoint {
  JointModel model;
  Prepared prepared;
  FieldMaps maps;
  Settings settings;                  ///< of the joint
  std::vector<std::string> warnings;  ///< of the model and the joint, without "warning: "
  double bytes = 0.0;                 ///< of memory: an estimate

  /// The end of the model's last step, as the file has it, solved from the reference when it is first asked for;
  /// nullptr: it is no solution. Stopped: `stop` was set.
  const Begin* begin(const StopFlag* stop) const;

 private:
  mutable std::once_flag begun_;
  mutable std::optional<Begin> begin_;
};

/// The joints that were used last, as many as fit. Several threads may ask at a time; a joint that two want is made
/// once.
class ReadyJoints {
 public:
  /// `bytes`: of all joints together; one is always kept.
  explicit ReadyJoints(double bytes) : most_(bytes) {}

  /// The joint of a model file under joint_settings(settings). Throws as read_feb and recognise do, each time that it
  /// is asked for, and Stopped.
  std::shared_ptr<const ReadyJoint> get(const std::string& path, const Settings& settings, const StopFlag* stop);

 private:
  using Made = std::shared_future<std::shared_ptr<const ReadyJoint>>;
  struct Entry {
    Made made;
    std::uint64_t used = 0;
    double bytes = 0.0;  // 0: still in the making
  };
  void drop_old(const std::string& but);

  double most_;
  std::mutex mutex_;
  std::uint64_t clock_ = 0;
  std::map<std::string, Entry> entries_;  // by path and settings
};

}  // namespace dea
