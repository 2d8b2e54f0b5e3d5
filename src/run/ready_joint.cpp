#include "src/run/ready_joint.h"

#include <fmt/format.h>

#include <map>
#include <utility>
#include <variant>
#include <vector>

#include "src/base/error.h"
#include "src/model/settings_table.h"
#include "src/rules/rules.h"
#include "src/run/states.h"

namespace dea {

namespace {

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

/// The end of the model's last step, from the reference; nothing where that is no solution.
std::optional<KnownBalance> solve_end_of_model(const ReadyJoint& ready, const StopFlag* stop) {
  Settings settings = ready.settings;
  settings.skip_steps = true;
  EquilibriumOptions options;
  options.tolerance = 1e-4;  // others start from it
  options.stop = stop;
  try {
    const TimePoint end = row_states(ready.model, settings, parse_states("last"), "").times.back();
    const LoadCase loads = make_load_case(ready.model, ready.prepared.joint, settings, end.step, end.time);
    KnownBalance balance;
    const Equilibrium e = solve(ready.prepared, loads, at_rest(ready.prepared), options, &balance.memory);
    if (!solved(e.outcome)) return std::nullopt;
    balance.poses = e.poses;
    return balance;
  } catch (const InputError&) {  // a case's own loads may still be possible
    return std::nullopt;
  }
}

/// A text that differs where any setting does.
std::string key_of(const Settings& settings) {
  std::string key;
  for (const SettingOption& option : setting_options()) {
    key += '\x1e';
    const SettingContent content = option.content(settings);
    if (const SettingItem* item = std::get_if<SettingItem>(&content)) {
      key += text_of(*item);
      continue;
    }
    for (const auto& entry : std::get<std::map<std::string, SettingItem>>(content))
      key += entry.first + '\x1d' + text_of(entry.second) + '\x1d';
  }
  return key;
}

}  // namespace

std::string joint_key(const Settings& settings) { return key_of(joint_settings(settings)); }

bool is_its_joint(const Settings& settings) { return key_of(settings) == joint_key(settings); }

std::shared_ptr<const ReadyJoint> make_ready_joint(Recognition recognition, const StopFlag* stop) {
  const auto ready = std::make_shared<ReadyJoint>();
  ready->warnings = warnings(model_findings(recognition.model, recognition.joint));
  ready->settings = recognition.settings;
  ready->prepared = prepare(std::move(recognition), stop);
  ready->model = std::move(recognition.model);  // NOLINT(bugprone-use-after-move): `prepare` takes its joint alone
  ready->maps = make_field_maps(ready->model, ready->prepared.joint);
  return ready;
}

const KnownBalance* ReadyJoint::end_of_model(const StopFlag* stop) const {
  std::call_once(end_solved_, [&] { end_of_model_ = solve_end_of_model(*this, stop); });
  return end_of_model_ ? &*end_of_model_ : nullptr;
}

const InsideMaps& ReadyJoint::inside() const {
  std::call_once(looked_inside_, [&] { inside_ = make_inside_maps(model, settings, prepared.joint, prepared.beds); });
  return inside_;
}

}  // namespace dea
