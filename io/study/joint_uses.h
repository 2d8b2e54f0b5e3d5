// io/study/joint_uses.h – how often the joints of a study's cases are still wanted.
#pragma once
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "src/study/plan.h"

namespace dea {

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
