#include "views/live/live_joint.h"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "src/base/numbers.h"
#include "src/rules/rules.h"
#include "views/data/run_json.h"

namespace dea {

namespace {

/// Does what loads and moves the bodies at this time depend on where they were before?
bool counts_from_before(const ReadyJoint& ready, const Settings& settings, const TimePoint& when) {
  const Joint& joint = ready.prepared.joint;
  const std::vector<Pose> start = starting_poses(ready.model, joint, settings);
  const LoadCase load_case = when.row >= 0 ? make_row_case(ready.model, joint, settings, when.row, start, start)
                                           : make_load_case(ready.model, joint, settings, when.step, when.time);
  return std::any_of(load_case.bodies.begin(), load_case.bodies.end(), [](const BodyConditions& b) {
    return b.on_reaction || std::find(b.relative.begin(), b.relative.end(), true) != b.relative.end();
  });
}

/// Where the bodies of an earlier answer are. A body that it has not is where it is in the model.
KnownBalance balance_of(const Json& from, const Joint& joint) {
  KnownBalance known{reference_poses(joint), {}};
  for (const Json& body : from)
    for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
      if (body["name"] != joint.bodies[b].name) continue;
      Eigen::Matrix3d turned;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) turned(i, j) = body["rotation"][at(i)][at(j)].get<double>();
        known.poses[b].center[i] = body["center"][at(i)].get<double>();
      }
      known.poses[b].rotation = turned * known.poses[b].rotation;
    }
  return known;
}

Json matrix_json(const Eigen::Matrix3d& m) {
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i) rows.push_back(json_vector(m.row(i)));
  return rows;
}

Json bodies_json(const Joint& joint, const std::vector<Pose>& poses) {
  const std::vector<Pose> reference = reference_poses(joint);
  Json bodies = Json::array();
  for (std::size_t b = 0; b < joint.bodies.size(); ++b)
    bodies.push_back({{"name", joint.bodies[b].name},
                      {"rotation", matrix_json(poses[b].rotation * reference[b].rotation.transpose())},
                      {"reference_center", json_vector(reference[b].center)},
                      {"center", json_vector(poses[b].center)}});
  return bodies;
}

/// Appends the pressures of all surfaces that contacts press, each once.
Json surfaces_json(const JointModel& model, const Joint& joint, const StateResult& state,
                   std::map<std::string, LiveJoint::Drawn>& drawn, std::vector<float>& pressure) {
  std::map<int, std::vector<const SideFields*>> sides;  // by surface
  std::map<int, int> body;
  for (std::size_t c = 0; c < state.fields.size(); ++c)
    for (std::size_t side = 0; side < 2; ++side) {
      const Layer& layer = joint.contacts[c].layers[side];
      std::vector<const SideFields*>& of = sides[layer.surface];
      if (of.empty() || of.front()->pressure.size() == state.fields[c].sides[side].pressure.size())
        of.push_back(&state.fields[c].sides[side]);
      body[layer.surface] = layer.body;
    }
  Json surfaces = Json::array();
  for (const auto& [surface, of] : sides) {
    const Surface& s = model.surfaces[at(surface)];
    std::vector<double> facets = of.front()->pressure;
    for (std::size_t k = 1; k < of.size(); ++k)
      for (std::size_t f = 0; f < facets.size(); ++f) facets[f] += of[k]->pressure[f];
    auto shape = drawn.find(s.name);
    if (shape == drawn.end()) {
      LiveJoint::Drawn made{make_result_surface(s.name, s.begin, s.nodes, model.nodes), {}};
      made.map = make_map_mesh(made.surface);
      shape = drawn.emplace(s.name, std::move(made)).first;
    }
    const double edge = edge_level(shape->second.map, facets,
                                   point_values(shape->second.map, nodal_average(shape->second.surface, facets)));
    surfaces.push_back({{"name", s.name},
                        {"body", joint.bodies[at(body.at(surface))].name},
                        {"edge", json_number(edge)},
                        {"begin", pressure.size()},
                        {"count", facets.size()}});
    pressure.insert(pressure.end(), facets.begin(), facets.end());
  }
  return surfaces;
}

}  // namespace

LiveAnswer live_answer(LiveJoint& live, const LiveRequest& request) {
  const std::shared_ptr<const ReadyJoint> ready = live.joints.get(request.model, request.settings, nullptr);
  const Joint& joint = ready->prepared.joint;
  ReadyCase of = ready_case(*ready, request.settings, request.outputs);
  AnalysisOptions solving;
  solving.times = of.states.times;
  solving.keep_state = of.states.wanted;
  solving.displacements = false;
  const std::string key = request.model + joint_key(of.settings);
  KnownBalance known;
  if (!request.from.is_null()) {
    known = balance_of(request.from, joint);
    if (request.quick && live.memory_key == key) known.memory = std::move(live.memory);
    solving.known_balance = [&known] { return &known; };
    solving.follow = true;
    if (!counts_from_before(*ready, of.settings, solving.times.back())) {
      solving.times = {solving.times.back()};
      solving.keep_state = {1};
    }
  }
  if (request.quick) {
    constexpr double kQuick = 1e-3;  // of the load
    solving.equilibrium.tolerance = kQuick;
    solving.memory = &live.memory;
    live.memory_key.clear();
  }
  const SolvedStates solved_states = solve_states(ready->model, of.settings, ready->prepared, ready->maps, solving);
  const StateResult& state = solved_states.states.back();
  if (request.quick && solved(state.equilibrium.outcome)) live.memory_key = key;
  if (live.drawn_model != request.model) {
    live.drawn_model = request.model;
    live.drawn.clear();
  }
  LiveAnswer answer;
  Findings findings = of.findings;
  add_once(findings, ready->warnings);
  add_once(findings, warnings(result_findings(ready->model, joint, solved_states)));
  answer.text = {{"schema", "dea.live/1"},
                 {"quick", request.quick},
                 {"solved", solved(state.equilibrium.outcome)},
                 {"state", state_json(ready->model, joint, state)},
                 {"bodies", bodies_json(joint, state.equilibrium.poses)},
                 {"surfaces", surfaces_json(ready->model, joint, state, live.drawn, answer.pressure)},
                 {"findings", findings_json(findings)}};
  return answer;
}

}  // namespace dea
