#include "io/study/ready_joints.h"

#include <algorithm>
#include <exception>
#include <functional>
#include <utility>

#include "io/feb/read_feb.h"
#include "io/files/free_memory.h"
#include "io/run/spring_memory.h"
#include "io/run/wanted_states.h"
#include "io/settings/settings_xml.h"
#include "io/tables/read_tables.h"
#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/base/stop.h"
#include "src/run/cost.h"

namespace dea {

namespace {

constexpr double kShareOfFree = 0.5;  // the rest is for what solving takes

std::string key_of(const std::string& path, const Settings& settings) { return path + joint_key(settings); }

/// `make_room`: is told how many bytes the joint will take, before it takes them.
std::shared_ptr<const ReadyJoint> make_ready(const std::string& path, Settings settings, const StopFlag* stop,
                                             const std::function<void(double)>& make_room) {
  JointModel read = read_feb(path);
  settle_units(read, settings);
  read_thickness(read, settings);
  Recognition recognition = recognise_joint(std::move(read), settings);  // its loads are the cases' matter
  throw_if_any(recognition.faults);
  make_room(kept_bytes(recognition.model, recognition.joint));
  spring_cost_note(recognition);
  return make_ready_joint(std::move(recognition), stop);
}

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

ReadyCase ready_case(const ReadyJoint& ready, Settings settings, const OutputSettings& asked) {
  read_tables(ready.model, settings);
  check_body_names(ready.model, ready.prepared.joint.bodies, settings);
  Loading loading = check_loading(ready.model, ready.prepared.joint, settings);
  throw_if_any(loading.faults);
  States states = wanted_states(ready.model, settings, asked, "");
  return {std::move(settings), std::move(states), std::move(loading.findings)};
}

std::shared_ptr<const ReadyJoint> ReadyJoints::get(const std::string& path, const Settings& settings,
                                                   const StopFlag* stop) {
  const std::string key = key_of(path, settings);
  std::promise<std::shared_ptr<const ReadyJoint>> promise;
  Made made;
  bool mine = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    Entry& entry = entries_[key];
    mine = !entry.made.valid();
    if (mine) entry.made = promise.get_future().share();
    entry.used = ++clock_;
    made = entry.made;
  }
  if (!mine) return made.get();
  try {
    promise.set_value(make_ready(path, joint_settings(settings), stop, [&](double bytes) { make_room(key, bytes); }));
  } catch (...) {
    promise.set_exception(std::current_exception());
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  try {
    made.get();
    entries_[key].ready = true;
  } catch (const Stopped&) {
    entries_.erase(key);  // whoever asks next has it made
    throw;
  } catch (...) {
    entries_[key].bytes = 0.0;  // the fault is all there is to keep
    throw;
  }
  return made.get();
}

void ReadyJoints::forget(const std::string& path, const Settings& settings) {
  const std::string key = key_of(path, settings);
  const std::lock_guard<std::mutex> lock(mutex_);
  entries_.erase(key);
}

void ReadyJoints::make_room(const std::string& key, double bytes) {
  const std::lock_guard<std::mutex> lock(mutex_);
  entries_[key].bytes = bytes;
  double all = 0.0, ready = 0.0;
  for (const auto& entry : entries_) {
    all += entry.second.bytes;
    if (entry.second.ready) ready += entry.second.bytes;
  }
  const double most = std::min(most_, kShareOfFree * (free_memory() + ready));  // others may have taken memory since
  while (all > most) {
    auto oldest = entries_.end();
    for (auto it = entries_.begin(); it != entries_.end(); ++it)
      if (it->second.ready && (oldest == entries_.end() || it->second.used < oldest->second.used)) oldest = it;
    if (oldest == entries_.end()) return;
    all -= oldest->second.bytes;
    entries_.erase(oldest);
  }
}

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
