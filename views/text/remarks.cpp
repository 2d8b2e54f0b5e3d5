#include <febiodea/views/text/remarks.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <febiodea/base/numbers.h>
#include <febiodea/views/text/table.h>

namespace dea {

namespace {

void add_once(std::vector<std::string>& lines, const std::string& line) {
  if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
}

/// Neighbouring states about which the same is to be said; what they differ in is told of the last one.
struct StateRun {
  std::string what, detail;
  std::size_t first = 0, last = 0;  ///< indices of states
};

void add_state(std::vector<StateRun>& runs, const std::string& what, std::size_t index, const std::string& detail) {
  if (!runs.empty() && runs.back().what == what && runs.back().last + 1 == index) {
    runs.back().last = index;
    runs.back().detail = detail;
  } else {
    runs.push_back({what, detail, index, index});
  }
}

std::string run_line(const Analysis& analysis, const StateRun& run) {
  const auto time = [&](std::size_t i) { return number_text(analysis.states[i].when.time); };
  if (run.first == run.last) return fmt::format("warning: time {}: {}: {}", time(run.last), run.what, run.detail);
  return fmt::format("warning: times {} to {} ({} states): {}; at time {}: {}", time(run.first), time(run.last),
                     run.last - run.first + 1, run.what, time(run.last), run.detail);
}

/// How far bodies are meant to turn [degrees]: the sum of all rotations that the model prescribes, of bodies and in
/// joints; a body may follow any of them.
double prescribed_turn(const JointModel& model, const Joint& joint, const Equilibrium& last) {
  double sum = 0.0;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const bool prescribed =
        std::any_of(model.rigid_prescribed.begin(), model.rigid_prescribed.end(), [&](const RigidPrescribed& p) {
          const auto& own = joint.bodies[b].materials;
          return p.dof >= 3 && std::find(own.begin(), own.end(), p.material) != own.end();
        });
    if (prescribed) sum += Eigen::AngleAxisd(last.poses[b].rotation).angle() * kDegreesPerRadian;
  }
  for (std::size_t c = 0; c < joint.connectors.size() && c < last.connector_motion.size(); ++c)
    for (int k = 3; k < kDofs; ++k)
      if (joint.connectors[c].motion[at(k)] == RigidJoint::Motion::Prescribed)
        sum += std::abs(last.connector_motion[c][k]) * kDegreesPerRadian;
  return sum;
}

/// Law layer follows what flows within the size of the facets. Measured on a sphere (docs/layer_law.md, section 6):
/// facets of half the thickness or less are within 2 % where contact is 8 of them wide, facets as long as the cartilage
/// is thick 7 % and 17 % off in force and peak. Empty: they are fine.
std::string coarse_facets(const JointModel& model, const ContactPair& pair, const Wording& wording) {
  constexpr double kFine = 0.3, kCoarse = 1.05;  // thicknesses
  if (pair.law != Law::Layer) return "";
  double worst = 0.0;
  std::string sizes;
  for (const Layer& layer : pair.layers) {
    const double size = layer.facet_size() / pair.refine;
    if (!(size > kFine)) continue;
    worst = std::max(worst, size);
    sizes += fmt::format("{}{:.2g} on \"{}\"", sizes.empty() ? "" : ", ", size, model.surfaces[at(layer.surface)].name);
  }
  if (worst == 0) return "";
  const int refine = pair.refine * static_cast<int>(std::ceil(worst / 0.5));
  const std::string text =
      fmt::format("contact \"{}\": facets are long against the cartilage's thickness ({})", pair.name, sizes);
  if (worst > kCoarse)
    return fmt::format("warning: {}: force and peak may be 20% off; type {} ({} times the springs)", text,
                       wording({"refine", "", std::to_string(refine)}), refine * refine / (pair.refine * pair.refine));
  return fmt::format(
      "note: {}: right to about 3% where contact is 8 facets wide, less where it is narrower; "
      "dea converge or {} tell",
      text, wording({"refine", "", std::to_string(2 * pair.refine)}));
}

/// Vertices whose thickness is the closest point's for want of a better one. On a plane of symmetry the closest point
/// is the better one: of a curved surface the normal is known from one side only there.
int doubtful_vertices(const Layer& layer) {
  const bool planes = layer.springs_at == SpringsAt::Articular && layer.mirror.size() == layer.missed.size();
  int count = 0;
  for (std::size_t v = 0; v < layer.missed.size(); ++v) count += layer.missed[v] && !(planes && layer.mirror[v]);
  return count;
}

}  // namespace

std::vector<std::string> model_remarks(const JointModel& model, const Joint& joint, const Wording& wording) {
  std::vector<std::string> lines;
  for (const Remark& r : model.ignored)
    add_once(lines, fmt::format("ignored: {}{}{}", where(model, r.origin), r.what,
                                r.count > 1 ? fmt::format(" ({} times)", r.count) : ""));
  for (const ContactPair& pair : joint.contacts) {
    const Contact& contact = model.contacts[at(pair.contact)];
    for (const std::string& what : contact.ignored)
      add_once(lines, fmt::format("ignored: {}contact \"{}\": {}", where(model, contact.origin), contact.name, what));
  }
  for (const Sentence& finding : joint.findings) add_once(lines, "note: " + worded(finding, wording));
  for (const ContactPair& pair : joint.contacts) {
    const std::string coarse = coarse_facets(model, pair, wording);
    if (!coarse.empty()) add_once(lines, coarse);
  }
  for (const ContactPair& pair : joint.contacts) {
    for (const Layer& layer : pair.layers) {
      const int doubtful = doubtful_vertices(layer);
      if (doubtful == 0) continue;
      add_once(lines, fmt::format("warning: surface \"{}\": at {} of {} vertices the thickness is the distance to the "
                                  "nearest point of the bone, "
                                  "for their normals meet no bone (usual at rims; `dea info -o` shows where)",
                                  model.surfaces[at(layer.surface)].name, doubtful, layer.missed.size()));
    }
  }
  return lines;
}

namespace {

using Lines = std::vector<std::string>;

/// States that are no solution or stand on the brink, neighbours together.
void add_outcomes(const Analysis& analysis, const Wording& wording, Lines& lines) {
  std::vector<StateRun> runs;
  for (std::size_t i = 0; i < analysis.states.size(); ++i) {
    const Equilibrium& e = analysis.states[i].equilibrium;
    if (!solved(e.outcome)) add_state(runs, fmt::format("{}", name(e.outcome)), i, outcome_text(e, wording));
    if (solved(e.outcome) && e.least_stiffness < 0)
      add_state(runs, "the balance is unstable", i, fmt::format("least stiffness {:.3g}", e.least_stiffness));
  }
  for (const StateRun& run : runs) lines.push_back(run_line(analysis, run));
}

void add_held_motions(const Analysis& analysis, Lines& lines) {
  int count = 0;
  const StateResult* last = nullptr;  // the axes turn a little from state to state: those of the last one stand for all
  for (const StateResult& state : analysis.states) {
    if (state.equilibrium.held.empty()) continue;
    ++count;
    last = &state;
  }
  if (last == nullptr) return;
  std::string directions;
  for (const std::string& held : last->equilibrium.held) directions += (directions.empty() ? "" : ", ") + held;
  add_once(lines,
           fmt::format("note: in {} of {} states motions were held that nothing resists or loads; at time {}: {}",
                       count, analysis.states.size(), number_text(last->when.time), directions));
}

/// Bodies that have turned far although nobody wants them to.
void add_large_turns(const JointModel& model, const Joint& joint, const Equilibrium& e, const Wording& wording,
                     Lines& lines) {
  if (!solved(e.outcome) || e.outcome == Outcome::Prescribed) return;
  const double prescribed = prescribed_turn(model, joint, e);
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const Eigen::AngleAxisd turn(e.poses[b].rotation);
    const double degrees = turn.angle() * kDegreesPerRadian;
    if (degrees > 20.0 + prescribed)
      add_once(
          lines,
          fmt::format(
              "warning: \"{}\" has turned by {:.0f} degrees about ({:.2f}, {:.2f}, {:.2f}): its rotations are hardly "
              "resisted; to hold them type {}",
              joint.bodies[b].name, degrees, turn.axis().x(), turn.axis().y(), turn.axis().z(),
              wording({"free", joint.bodies[b].name, "x,y,z"})));
  }
}

/// Surfaces that do not touch, at the end or ever.
void add_no_contact(const Analysis& analysis, const Wording& wording, Lines& lines) {
  const auto touches = [](const StateResult& state) {
    return std::any_of(state.statistics.begin(), state.statistics.end(),
                       [](const ContactStatistics& s) { return s.springs_active > 0; });
  };
  const StateResult& last = analysis.states.back();
  if (!touches(last) && last.equilibrium.outcome == Outcome::Balanced && last.equilibrium.load == 0.0)
    add_once(
        lines,
        fmt::format(
            "warning: at time {} nothing loads a free body and nothing touches: there is no contact to look at; "
            "give a load with {}",
            number_text(last.when.time), wording({.setting = "force", .of = "BODY", .value = "x,y,z", .bare = true})));
  if (last.equilibrium.outcome == Outcome::Prescribed &&
      std::none_of(analysis.states.begin(), analysis.states.end(), touches))
    add_once(lines,
             "warning: the surfaces touch in no state: the motions that are prescribed bring them nowhere together");
}

void add_few_springs(const ContactPair& pair, const StateResult& state, std::size_t contact, const Wording& wording,
                     Lines& lines) {
  const int active = state.statistics[contact].springs_active;
  if (active < 20 && state.fields[contact].sides[1 - pair.source].contact_area > 0)
    add_once(lines,
             fmt::format("warning: contact \"{}\": only {} springs carry at time {}, too few for a pressure "
                         "map; divide them with {}, or let the other "
                         "body's finer surface carry them with {}",
                         pair.name, active, number_text(state.when.time), wording({"refine"}), wording({"source"})));
  else if (active < 60 && active > 0 && pair.law == Law::Layer)
    add_once(lines,
             fmt::format("warning: contact \"{}\": at time {} only {} springs carry, too few to follow how the layers "
                         "flow: force and peak may be 10% too high; divide them with "
                         "{}",
                         pair.name, number_text(state.when.time), active,
                         wording({"refine", "", std::to_string(2 * pair.refine)})));
}

/// Maps that do not carry the whole force.
void add_incomplete_maps(const JointModel& model, const ContactPair& pair, const ContactFields& fields, Lines& lines) {
  for (int side = 0; side < 2; ++side) {
    const double factor = fields.sides[side].resultant_factor;
    if (!(std::abs(factor - 1.0) > 0.02)) continue;
    add_once(
        lines,
        fmt::format("note: surface \"{}\": its pressure map is interpolated and carries {:.1f}% of the contact force",
                    model.surfaces[at(pair.layers[side].surface)].name, 100.0 * factor));
  }
}

/// Selections that end under pressure though the cartilage goes on.
void add_pressed_ends(const JointModel& model, const ContactPair& pair, const StateResult& state, std::size_t contact,
                      Lines& lines) {
  constexpr double kFelt = 0.2;  // of the peak
  for (int side = 0; side < 2; ++side) {
    const Layer& layer = pair.layers[side];
    const double length = pressed_end_of_selection(layer, state.fields[contact].sides[side].pressure,
                                                   kFelt * state.statistics[contact].peak);
    if (!(length > 2 * layer.facet_size() * layer.mean_thickness())) continue;
    add_once(lines,
             fmt::format("warning: surface \"{}\": at time {} pressure reaches the end of the selected facets "
                         "along {:.3g} of its rim, where the cartilage goes on: it is that of an edge there, too "
                         "high if the other surface covers what is beyond; select the facets beyond as well",
                         model.surfaces[at(layer.surface)].name, number_text(state.when.time), length));
  }
}

}  // namespace

std::string outcome_text(const Equilibrium& e, const Wording& wording) {
  return e.message + (e.advice.empty() ? "" : " " + worded(e.advice, wording));
}

std::vector<std::string> result_remarks(const JointModel& model, const Analysis& analysis, const Wording& wording) {
  std::vector<std::string> lines;
  if (analysis.states.empty()) return lines;
  add_outcomes(analysis, wording, lines);
  add_held_motions(analysis, lines);
  const Joint& joint = analysis.joint;
  const StateResult& last = analysis.states.back();  // stands for all: turns and factors change slowly
  add_large_turns(model, joint, last.equilibrium, wording, lines);
  add_no_contact(analysis, wording, lines);
  for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
    add_few_springs(joint.contacts[c], last, c, wording, lines);
    add_incomplete_maps(model, joint.contacts[c], last.fields[c], lines);
    add_pressed_ends(model, joint.contacts[c], last, c, lines);
  }
  return lines;
}

std::vector<std::string> run_remarks(const JointModel& model, const Analysis& analysis, const Wording& wording) {
  std::vector<std::string> lines = model_remarks(model, analysis.joint, wording);
  for (const std::string& line : result_remarks(model, analysis, wording)) lines.push_back(line);
  return lines;
}

}  // namespace dea
