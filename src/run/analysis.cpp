#include <febiodea/run/analysis.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include <febiodea/base/error.h>
#include <febiodea/base/say.h>

namespace dea {

namespace {

constexpr int kLeastPatience = 5;  // poses: a warm start that is near its balance needs about four

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

void refuse_zero_thickness(const JointModel& model, const Joint& joint, const SpringBeds& beds, const Equilibrium& e) {
  for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
    const ContactPair& pair = joint.contacts[c];
    const double thin = 1e-6 * (pair.layers[0].mean_thickness() + pair.layers[1].mean_thickness());
    const SpringStates& s = e.springs[c];
    for (std::size_t i = 0; i < s.gap.size(); ++i) {
      if (s.triangle[i] < 0 || s.gap[i] > 0 || s.t_source[i] + s.t_target[i] > thin) continue;
      const Layer& source = pair.source_layer();
      const SurfaceMesh& mesh = source.spring_surface();
      const int vertex = mesh.triangles[static_cast<std::size_t>(beds.beds[c].springs.surface_triangle[i])][0];
      const Surface& surface = model.surfaces[static_cast<std::size_t>(source.surface)];
      const char* parameter = pair.source == 0 ? "primary_thickness" : "secondary_thickness";
      throw fault_at(
          model, surface.origin,
          say("contact \"{}\": there is no cartilage near node {} of surface \"{}\" where the bodies meet (thickness "
              "{:.2g});",
              pair.name, model.node_ids[static_cast<std::size_t>(mesh.model_nodes[static_cast<std::size_t>(vertex)])],
              surface.name, s.t_source[i] + s.t_target[i]),
          say("mend the mesh or give {}",
              NamedSetting{"thickness", surface.name, "VALUE",
                           model.contacts[static_cast<std::size_t>(pair.contact)].dea ? parameter : ""}));
    }
  }
}

Analysis analyse(const JointModel& model, const Settings& settings, const AnalysisOptions& options) {
  if (options.activity) options.activity({});
  return analyse(recognise(model, settings), options);
}

Analysis analyse(const Recognition& recognition, const AnalysisOptions& options) {
  throw_if_any(recognition.faults);
  const JointModel& model = recognition.model;
  const Settings& settings = recognition.settings;
  Analysis analysis;
  double clock = now();
  Activity activity;
  const auto tell = [&](Activity::Stage stage) {
    activity.stage = stage;
    if (options.activity) options.activity(activity);
  };
  analysis.joint = recognition.joint;
  const Joint& joint = analysis.joint;
  tell(Activity::Stage::Springs);
  const SpringBeds beds = make_spring_beds(joint);
  const FieldMaps maps = make_field_maps(model, joint);
  analysis.seconds_joint = recognition.seconds + now() - clock;

  clock = now();
  const std::vector<TimePoint> times = options.times.empty() ? model_times(model) : options.times;
  EquilibriumOptions search = options.equilibrium;
  if (options.activity) {
    search.watch = [&](const SearchStatus& status) {
      if (options.equilibrium.watch) options.equilibrium.watch(status);
      activity.search = status;
      tell(Activity::Stage::State);
    };
  }
  activity.count = times.size();
  std::vector<Pose> poses = reference_poses(joint), step_start = poses;  // `poses`: of the last state that was solved
  std::vector<Vector6> reaction(joint.bodies.size(), Vector6::Zero()), step_reaction = reaction;
  std::vector<PressMemory> memory;
  int step = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i].step != step) {
      search.patience = options.equilibrium.patience;
      step = times[i].step;
      step_start = poses;
      step_reaction = reaction;
    }
    activity.index = i;
    activity.search = {};
    tell(Activity::Stage::State);
    const LoadCase conditions = make_load_case(model, joint, settings, times[i].step, times[i].time, &step_reaction);
    StateResult state;
    state.when = times[i];
    const bool reference = i == 0 && times[i].time <= 0.0;
    state.equilibrium = reference ? state_at(joint, beds, conditions, poses, &memory)
                                  : solve_equilibrium(joint, beds, conditions, poses, step_start, search, &memory);
    // A load that cannot be carried may have moved a body far away: the next state starts from the last one that was
    // solved.
    const Outcome outcome = state.equilibrium.outcome;
    const auto& history = state.equilibrium.history;
    const bool balanced = history.empty() || history.back() <= 1e3 * options.equilibrium.tolerance;
    if (solved(outcome) || (outcome == Outcome::BeyondStrainLimit && balanced)) {
      poses = state.equilibrium.poses;
      reaction = state.equilibrium.reaction;
    }
    // Loads that follow one without a balance start where it did: they are searched again, but not as long.
    if (solved(outcome))
      search.patience = options.equilibrium.patience;
    else if (outcome == Outcome::NoEquilibrium || outcome == Outcome::NotConverged)
      search.patience = std::max(std::min(kLeastPatience, search.patience), search.patience / 3);
    refuse_zero_thickness(model, joint, beds, state.equilibrium);
    const bool wanted = options.wanted.empty() || options.wanted[i];
    if (wanted) {
      state.fields = contact_fields(joint, beds, maps, state.equilibrium);
      state.statistics = contact_statistics(joint, beds, state.equilibrium, state.fields);
      state.displacements = node_displacements(model, joint, maps, state.equilibrium, state.fields, settings.squash);
    }
    if (options.progress) options.progress(state, i, times.size());
    state.equilibrium.springs.clear();  // the bulk of the memory; fields and statistics hold what is reported
    if (wanted) analysis.states.push_back(std::move(state));
  }
  for (const auto& entry : settings.force) {
    const LoadCase last = make_load_case(model, joint, settings, times.back().step, times.back().time);
    const auto& dofs = last.bodies[static_cast<std::size_t>(joint.find_body(model, entry.first))].dofs;
    if (std::count(dofs.begin(), dofs.begin() + 3, DofState::Free) == 0)
      analysis.joint.findings.push_back(
          say("{}: the body is not free to move in the last step; the force has no effect",
              NamedSetting{.setting = "force", .of = entry.first, .bare = true}));
  }
  analysis.seconds_solve = now() - clock;
  return analysis;
}

std::vector<Convergence> converge(const JointModel& model, Settings settings, double target, int max_springs,
                                  const std::function<void(const ConvergenceRow&)>& progress,
                                  const std::function<void(const Activity&)>& activity) {
  std::vector<Convergence> result;
  const std::vector<TimePoint> times = model_times(model, true);  // only the last is looked at
  for (int refine = 1;; refine *= 2) {
    settings.refine = refine;
    AnalysisOptions options;
    options.times = times;
    options.wanted.assign(times.size(), 0);
    options.wanted.back() = 1;
    options.activity = activity;
    const Analysis analysis = analyse(model, settings, options);
    const StateResult& last = analysis.states.back();
    int springs = 0;
    bool done = refine > 1;
    for (std::size_t c = 0; c < last.statistics.size(); ++c) {
      const ContactStatistics& s = last.statistics[c];
      if (result.size() <= c) {
        result.emplace_back();
        result.back().contact = analysis.joint.contacts[c].name;
      }
      ConvergenceRow row;
      row.refine = refine;
      row.springs = s.springs;
      row.springs_hit = s.springs_hit;
      row.springs_active = s.springs_active;
      row.peak = s.peak;
      row.mean = s.mean;
      row.area = s.contact_area;
      row.outcome = last.equilibrium.outcome;
      const auto change = [&](double now_value, double before) {
        return before != 0 ? std::abs(now_value - before) / std::abs(before) : std::numeric_limits<double>::quiet_NaN();
      };
      if (result[c].rows.empty()) {
        row.change_peak = row.change_mean = row.change_area = std::numeric_limits<double>::quiet_NaN();
      } else {
        const ConvergenceRow& before = result[c].rows.back();
        row.change_peak = change(row.peak, before.peak);
        row.change_mean = change(row.mean, before.mean);
        row.change_area = change(row.area, before.area);
      }
      done = done && row.change_peak < target && row.change_mean < target && row.change_area < target;
      springs = std::max(springs, row.springs);
      result[c].rows.push_back(row);
      if (progress) progress(row);
    }
    const double next = 4.0 * springs;
    if (done || next > max_springs) break;
  }
  for (Convergence& c : result) {
    const auto reached = [&](double limit) {
      // the row before the first small change already was fine enough, if all later changes stay small
      int springs = -1;
      for (std::size_t i = c.rows.size(); i-- > 1;) {
        const ConvergenceRow& r = c.rows[i];
        if (!(r.change_peak < limit && r.change_mean < limit && r.change_area < limit)) break;
        springs = c.rows[i - 1].springs;
      }
      return springs;
    };
    c.springs_5_percent = reached(0.05);
    c.springs_1_percent = reached(0.01);
  }
  return result;
}

}  // namespace dea
