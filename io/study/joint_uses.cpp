#include "io/study/joint_uses.h"

#include <functional>

#include "io/settings/settings_xml.h"
#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/run/ready_joint.h"

namespace dea {

namespace {

/// Does the option, with the value of this case, make another joint than no option?
bool changes_joint(const Factor& f, const std::string& value) {
  const SettingOption* known = find_setting_option(f.option);
  if (known == nullptr) return true;
  try {
    Settings settings;
    set_value(settings, split_key(*known, f.before + value + f.after));
    return joint_key(settings) != joint_key({});
  } catch (const BadValue&) {  // refused when its case is solved
    return true;
  }
}

}  // namespace

JointUses::JointUses(const Plan& plan, const std::vector<std::size_t>& cases) {
  if (cases.empty()) return;
  for (std::size_t i = 0; i < plan.factors.size(); ++i) {
    bool changes = false;  // one value may be what it is anyway
    for (const std::size_t c : {std::size_t{0}, cases.size() / 2, cases.size() - 1})
      changes = changes || changes_joint(plan.factors[i], plan.cases[cases[c]].values[i]);
    of_joint_.push_back(changes);
  }
  for (const std::size_t c : cases) ++left_[joint_of(plan.cases[c])];
}

std::uint64_t JointUses::joint_of(const PlannedCase& c) const {
  std::string key = std::to_string(c.model);
  for (std::size_t i = 0; i < of_joint_.size(); ++i)
    if (of_joint_[i]) key += '\x1f' + c.values[i];
  return std::hash<std::string>{}(key);
}

bool JointUses::was_last(const PlannedCase& c) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto joint = left_.find(joint_of(c));
  if (joint == left_.end() || --joint->second > 0) return false;
  left_.erase(joint);
  return true;
}

}  // namespace dea
