#include "views/ready_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <functional>
#include <utility>

#include "io/feb/read_feb.h"
#include "io/files/free_memory.h"
#include "io/run/spring_memory.h"
#include "io/tables/read_tables.h"
#include "src/base/error.h"
#include "src/base/stop.h"
#include "src/model/settings_table.h"
#include "src/rules/rules.h"
#include "src/run/cost.h"
#include "src/run/states.h"

namespace dea {

namespace {

constexpr double kShareOfFree = 0.5;  // the rest is for what solving takes

std::string text_of(const SettingItem& item) {
  struct {
    std::string operator()(std::monostate) const { return ""; }
    std::string operator()(bool b) const { return b ? "true" : "false"; }
    std::string operator()(int i) const { return std::to_string(i); }
    std::string operator()(double x) const { return fmt::format("{}", x); }
    std::string operator()(const std::string& s) const { return s; }
    std::string operator()(const std::vector<std::string>& list) const {
      std::string all;
      for (const std::string& s : list) all += s + '\x1f';
      return all;
    }
    std::string operator()(const Eigen::Vector3d& v) const { return fmt::format("{},{},{}", v.x(), v.y(), v.z()); }
  } words;
  return std::visit(words, item);
}

/// Different where any setting differs.
std::string key_of(const std::string& path, const Settings& joint) {
  std::string key = path;
  for (const SettingOption& option : setting_options()) {
    key += '\x1e';
    const SettingContent content = option.content(joint);
    if (const SettingItem* item = std::get_if<SettingItem>(&content)) {
      key += text_of(*item);
      continue;
    }
    for (const auto& entry : std::get<std::map<std::string, SettingItem>>(content))
      key += entry.first + '\x1d' + text_of(entry.second) + '\x1d';
  }
  return key;
}

/// The end of the model's last step, from the reference; nothing where that is no solution.
std::optional<Begin> solve_begin(const ReadyJoint& ready, const StopFlag* stop) {
  Settings settings = ready.settings;
  settings.skip_steps = true;
  EquilibriumOptions options;
  options.stop = stop;
  try {
    const TimePoint end = row_states(ready.model, settings, parse_states("last"), "").times.back();
    const LoadCase loads = make_load_case(ready.model, ready.prepared.joint, settings, end.step, end.time);
    Begin begin;
    const Equilibrium e = solve(ready.prepared, loads, at_rest(ready.prepared), options, &begin.memory);
    if (!solved(e.outcome)) return std::nullopt;
    begin.poses = e.poses;
    return begin;
  } catch (const InputError&) {  // a case's own loads may still be possible
    return std::nullopt;
  }
}

/// `make_room`: is told how many bytes the joint will take, before it takes them.
std::shared_ptr<const ReadyJoint> make_ready(const std::string& path, Settings settings, const StopFlag* stop,
                                             const std::function<void(double)>& make_room) {
  JointModel read = read_feb(path);
  settle_units(read, settings);
  read_thickness(read, settings);
  Recognition recognition = recognise_joint(std::move(read), settings);  // its loads are the cases' matter
  throw_if_any(recognition.faults);
  const double bytes = kept_bytes(recognition.model, recognition.joint);
  make_room(bytes);
  spring_cost_note(recognition);
  const auto ready = std::make_shared<ReadyJoint>();
  ready->warnings = warnings(model_findings(recognition.model, recognition.joint));
  ready->bytes = bytes;
  ready->prepared = prepare(std::move(recognition), stop);
  ready->model = std::move(recognition.model);  // NOLINT(bugprone-use-after-move): `prepare` takes its joint alone
  ready->maps = make_field_maps(ready->model, ready->prepared.joint);
  ready->settings = std::move(settings);
  return ready;
}

}  // namespace

std::string joint_key(const std::string& path, const Settings& settings) {
  return key_of(path, joint_settings(settings));
}

const Begin* ReadyJoint::begin(const StopFlag* stop) const {
  std::call_once(begun_, [&] { begin_ = solve_begin(*this, stop); });
  return begin_ ? &*begin_ : nullptr;
}

const InsideMaps& ReadyJoint::inside() const {
  std::call_once(looked_inside_, [&] { inside_ = make_inside_maps(model, settings, prepared.joint, prepared.beds); });
  return inside_;
}

std::shared_ptr<const ReadyJoint> ReadyJoints::get(const std::string& path, const Settings& settings,
                                                   const StopFlag* stop) {
  const Settings own = joint_settings(settings);
  const std::string key = key_of(path, own);
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
    promise.set_value(make_ready(path, own, stop, [&](double bytes) { make_room(key, bytes); }));
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
  const std::string key = joint_key(path, settings);
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

}  // namespace dea
