// io/study/ready_joints.h – joints of model files, each made ready once, and how often a study still wants them.
#pragma once
#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "io/settings/output_options.h"
#include "src/run/ready_joint.h"
#include "src/run/states.h"
#include "src/study/plan.h"

namespace dea {

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

/// A case of a joint that is ready, as solve_states takes it.
struct ReadyCase {
  Settings settings;  ///< with the tables that they name
  States states;
  Findings findings;  ///< how the settings were taken
};
/// `settings`: of the joint's own. `asked`: its `states`. Throws UsageError, InputError.
ReadyCase ready_case(const ReadyJoint& ready, Settings settings, const OutputSettings& asked);

/// Cases that share a joint have the same model, and the same values of all factors that change the joint. Several
/// threads may tell of cases at a time.
class JointUses {
 public:
  /// Of the cases of these indices in plan.cases. The plan outlives it.
  JointUses(const Plan& plan, const std::vector<std::size_t>& cases);

  /// A case has ended: does no other want its joint any more? Mistaken, it costs time or memory and nothing else.
  bool was_last(const PlannedCase& c);

 private:
  std::uint64_t joint_of(const PlannedCase& c) const;

  std::vector<bool> of_joint_;  // per factor: changes it
  std::mutex mutex_;
  std::unordered_map<std::uint64_t, std::uint32_t> left_;
};

}  // namespace dea
