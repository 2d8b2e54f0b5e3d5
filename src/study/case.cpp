#include "src/study/case.h"

#include <fmt/format.h>

#include <utility>

#include "src/base/numbers.h"
#include "src/rules/rules.h"
#include "src/run/ready_joint.h"

namespace dea {

namespace {

CaseState case_state(const Joint& joint, StateResult&& state, bool keep_fields, const Wording& wording) {
  CaseState out;
  out.time = state.when.time;
  out.outcome = state.equilibrium.outcome;
  out.message = outcome_text(state.equilibrium, wording);
  out.iterations = state.equilibrium.iterations;
  out.residual_force = state.equilibrium.residual_force;
  out.residual_moment = state.equilibrium.residual_moment;
  out.statistics = std::move(state.statistics);
  out.layers = std::move(state.layers);
  for (LayerStatistics& layer : out.layers) layer.pressure = {};
  out.parts = std::move(state.parts);
  for (PartStress& part : out.parts) part.stress = part.strain = {};
  out.poses = std::move(state.equilibrium.poses);
  out.reactions = std::move(state.equilibrium.reaction);
  for (std::size_t c = 0; keep_fields && c < state.fields.size(); ++c) {
    const std::vector<double>& p = state.fields[c].sides[joint.contacts[c].source].vertex_pressure;
    out.fields.emplace_back(p.begin(), p.end());
  }
  return out;
}

/// Names and, where fields are kept, the surfaces that they stand on.
void describe(const JointModel& model, const Joint& joint, bool with_surfaces, CaseResult& result) {
  for (const Body& body : joint.bodies) result.bodies.push_back(body.name);
  for (const SharedLayer& layer : joint.shared_layers) result.layers.push_back(layer.name);
  for (const SoftPart& part : joint.parts) result.parts.push_back(part.name);
  for (const ContactPair& pair : joint.contacts) {
    const auto body = [&](const Layer& layer) { return joint.bodies[at(layer.body)].name; };
    result.contacts.push_back(
        {pair.name, body(pair.source_layer()), body(pair.target_layer()), compartment_names(pair)});
    if (!with_surfaces) continue;
    const Layer& source = pair.source_layer();
    result.surfaces.push_back(
        {model.surfaces[at(source.surface)].name, source.articular.vertices, source.articular.triangles});
  }
}

}  // namespace

void add_states(const ReadyJoint& ready, SolvedStates&& solved_states, bool keep_fields, const Wording& wording,
                CaseResult& result) {
  const Joint& joint = ready.prepared.joint;
  result.warnings = ready.warnings;
  add_once(result.warnings, warnings(result_findings(ready.model, joint, solved_states)));
  describe(ready.model, joint, keep_fields, result);
  result.outcome = CaseResult::Outcome::Solved;
  for (StateResult& state : solved_states.states) {
    const bool answer = is_answer(solved_states, state);
    result.states.push_back(case_state(joint, std::move(state), keep_fields, wording));
    const CaseState& last = result.states.back();
    if (answer || result.outcome == CaseResult::Outcome::Failed) continue;
    result.outcome = CaseResult::Outcome::Failed;
    result.message = fmt::format("time {:g}: {}: {}", last.time, name(last.outcome), last.message);
  }
}

}  // namespace dea
