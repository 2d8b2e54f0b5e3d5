#include "views/text/remarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/time_text.h"
#include "src/joint/shared_ends.h"
#include "views/text/plausibility.h"
#include "views/text/table.h"
#include "views/text/words.h"

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

std::string run_line(const SolvedStates& result, const StateRun& run) {
  const auto time = [&](std::size_t i) { return time_text(result.states[i].when.time); };
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

/// How far force and peak were off on a sphere, by how many facets contact is wide (docs/layer_law.md, 4, Long facets).
struct CoarseError {
  double across;  ///< facets, at most
  const char* text;
};
constexpr CoarseError kCoarseErrors[] = {
    {1.5, "force may be 40%, peak 80% off and more"},
    {2.0, "force may be 40%, peak 70% off"},
    {2.5, "force may be 25%, peak 55% off"},
    {4.0, "force may be 10%, peak 30% off"},
};
constexpr double kFineFacets = 0.3;  // thicknesses
constexpr int kMostTimes = 16;       // more is no mesh to be mended by dividing it

/// The facets of a layer in thicknesses, as they are divided. 0: bare.
double facet_size(const ContactPair& pair, const Layer& layer) { return layer.facet_size() / pair.refine; }

/// "type --refine 3 (9 times the springs)": facets of half a thickness. Empty: no division mends that.
std::string finer_springs(const ContactPair& pair, double size, const Wording& wording) {
  const double times = std::ceil(size / 0.5);
  if (!(times <= kMostTimes)) return "";
  const int n = std::max(2, static_cast<int>(times));
  return fmt::format("type {} ({} times the springs)", wording({"refine", "", std::to_string(pair.refine * n)}), n * n);
}

/// Law layer follows what flows within the size of the facets: facets of half the thickness or less are within 2 %
/// where contact is 8 of them wide, facets as long as the cartilage is thick 7 % and 17 % off in force and peak where
/// it is 4 wide. How wide it is the result tells (add_narrow_contact). Empty: they are fine.
std::string coarse_facets(const JointModel& model, const ContactPair& pair, const Wording& wording) {
  constexpr double kCoarse = 1.05;  // thicknesses
  if (pair.law != Law::Layer) return "";
  double worst = 0.0;
  std::string sizes;
  for (const Layer& layer : pair.layers) {
    const double size = facet_size(pair, layer);
    if (!(size > kFineFacets)) continue;
    worst = std::max(worst, size);
    sizes += fmt::format("{}{:.2g} on \"{}\"", sizes.empty() ? "" : ", ", size, model.surfaces[at(layer.surface)].name);
  }
  if (worst == 0) return "";
  const std::string text =
      fmt::format("contact \"{}\": facets are long against the cartilage's thickness ({})", pair.name, sizes);
  const std::string finer = finer_springs(pair, worst, wording);
  if (finer.empty()) return fmt::format("warning: {}: mesh it finer, or is its thickness wrong?", text);
  if (worst <= kCoarse)
    return fmt::format(
        "note: {}: force, p99 and peak are right to about 3% where contact is 8 facets wide, less where it is "
        "narrower; area and mean need a finer mesh; "
        "dea converge or {} tell",
        text, wording({"refine", "", std::to_string(2 * pair.refine)}));
  return fmt::format(
      "note: {}: right to about 3% where contact is 8 facets wide, force may be 40%, peak 70% off where "
      "it is 2 wide; once solved, a warning tells if it is narrow; to be safe {}",
      text, finer);
}

/// Vertices without cartilage. Empty: there are none.
std::string no_thickness(const std::string& surface, const Layer& layer, const Wording& wording) {
  const int without = layer.without_thickness(), all = static_cast<int>(layer.thickness.size());
  if (without == 0) return "";
  const std::string text = fmt::format(
      "surface \"{}\": at {} of {} vertices its thickness is zero or next to it (less than {:g}% of the "
      "facets' size)",
      surface, without, all, 100 * kNoThickness);
  if (2 * without > all)
    return fmt::format(
        "warning: {}: this is hardly a layer of cartilage; check its bone surface and the units, or give {}", text,
        wording({"thickness", surface, "VALUE"}));
  return fmt::format("note: {}: no cartilage there, what is pressed there is as good as rigid", text);
}

/// Vertices whose thickness is the closest point's for want of a better one.
std::vector<std::size_t> doubtful_vertices(const Layer& layer) {
  std::vector<std::size_t> doubtful;
  for (std::size_t v = 0; v < layer.missed.size(); ++v)
    if (layer.missed[v]) doubtful.push_back(v);
  return doubtful;
}

/// "; `dea info hip.feb -o hip_check.xplt` shows where"; of a model without a file: nothing.
std::string shows_where(const JointModel& model) {
  if (model.files.empty()) return "";
  const std::string& file = model.files.front();
  const std::string out = std::filesystem::path(file).stem().string() + "_check.xplt";
  const auto pasted = [](const std::string& name) {
    return name.find_first_of(" \t'\"$&;()<>|*?") == std::string::npos ? name : "\"" + name + "\"";
  };
  return fmt::format("; `dea info {} -o {}` shows where", pasted(file), pasted(out));
}

/// Those of them that are farther than two thicknesses from any rim of the surface.
std::size_t far_from_rim(const Layer& layer, const std::vector<std::size_t>& vertices) {
  const SurfaceMesh& mesh = layer.spring_surface();
  if (mesh.vertices.size() != layer.missed.size()) return 0;
  const auto rim = rim_segments(mesh);
  const double near_by = 2 * layer.mean_thickness();
  std::size_t count = 0;
  for (const std::size_t v : vertices)
    count += std::none_of(rim.begin(), rim.end(), [&](const std::array<Vector3d, 2>& edge) {
      return distance_to_segment(mesh.vertices[v], edge[0], edge[1]) <= near_by;
    });
  return count;
}

/// What joins bones and is no layer: without it the contact has another load.
std::string unmodelled_part(const Joint& joint, const UnmodelledPart& part) {
  std::vector<std::string> names, bodies;
  for (const std::string& name : part.names) names.push_back(in_quotes(name));
  for (int b : part.bodies) bodies.push_back(in_quotes(joint.bodies[at(b)].name));
  const bool one = part.names.size() == 1;
  if (part.held != 0) {
    std::vector<std::string> components;
    for (unsigned k = 0; k < 3; ++k)
      if ((part.held >> k & 1u) != 0) components.emplace_back(1, "xyz"[k]);
    return fmt::format(
        "warning: {} {} ({} deformable element{}) {} body {} to nodes that are held in {}, and {} not modelled: the "
        "force {} as the body moves is missing in the balance; put springs between the body and the ground in {} place "
        "if it matters",
        one ? "part" : "parts", listed(names), part.elements, part.elements == 1 ? "" : "s", one ? "fastens" : "fasten",
        listed(bodies), listed(components), one ? "is" : "are", one ? "it carries" : "they carry",
        one ? "its" : "their");
  }
  return fmt::format(
      "warning: {} {} ({} deformable element{}) {} bodies {} and {} not modelled: the force {} as these bodies move is "
      "missing in the balance; put springs between the bodies in {} place if it matters",
      one ? "part" : "parts", listed(names), part.elements, part.elements == 1 ? "" : "s", one ? "joins" : "join",
      listed(bodies), one ? "is" : "are", one ? "it carries" : "they carry", one ? "its" : "their");
}

std::string dropped_tie(const Joint& joint, const DroppedTie& tie) {
  const auto body = [&](std::size_t i) { return joint.bodies[at(tie.bodies[i])].name; };
  if (tie.bodies.size() == 1)
    return fmt::format(
        "warning: {} fastens pieces of cartilage on body \"{}\" side by side, which is not modelled: each has a free "
        "edge there; mesh them so that they share nodes",
        tie.name, body(0));
  return fmt::format(
      "warning: {} fastens rigid bodies \"{}\" and \"{}\" to each other, which is not modelled: they move as if it "
      "were not there; give both one rigid material, or a rigid joint that locks them",
      tie.name, body(0), body(1));
}

/// Planes of symmetry of which nodes were forgotten.
void add_half_held(const std::string& surface, const Layer& layer, std::vector<std::string>& lines) {
  for (const HalfHeldPlane& plane : layer.half_held) {
    const char axis = "xyz"[plane.component];
    add_once(lines,
             fmt::format("warning: surface \"{}\": {} of {} edges of its rim in the plane {} = {:.6g} have nodes that "
                         "are not held in {}, as others of the layer in that plane are: they are free edges; hold "
                         "these nodes too if it is a plane of symmetry",
                         surface, plane.unheld, plane.edges, axis, plane.coordinate + 0.0, axis));
  }
}

/// As the model numbers them.
std::vector<int> node_numbers(const JointModel& model, const std::vector<int>& nodes) {
  std::vector<int> numbers;
  for (const int node : nodes) numbers.push_back(model.node_ids[at(node)]);
  return numbers;
}

/// Planes of symmetry that the model holds otherwise than it may have meant.
void add_ends(const JointModel& model, const std::string& surface, const Layer& layer,
              std::vector<std::string>& lines) {
  for (const PartEnd& end : layer.ends) {
    const char axis = "xyz"[end.plane.axis];
    const std::string plane = fmt::format("surface \"{}\", plane {} = {:.6g}", surface, axis, end.plane.at);
    if (end.instead >= 0)
      add_once(lines,
               fmt::format("warning: {}: where its layer ends, nodes are held in {}, not in {}: taken for a free "
                           "edge, without that hold; hold them in {} if it is a plane of symmetry",
                           plane, "xyz"[end.instead], axis, axis));
    if (!end.forgotten.empty()) {
      const std::vector<int> nodes = node_numbers(model, end.forgotten);
      add_once(lines, fmt::format("warning: {}: {} of {} nodes of its layer are not held in {} ({}): taken as held, "
                                  "as the others are; hold them too",
                                  plane, nodes.size(), end.nodes, axis, number_list(nodes)));
    }
    if (end.is_plane && end.steps.size() < model.steps.size()) {
      std::vector<std::string> steps;
      for (const int step : end.steps) steps.push_back(std::to_string(step + 1));
      add_once(lines, fmt::format("note: {}: its nodes are held in {} of {} steps, here in all of them", plane,
                                  steps.empty() ? "none" : "step " + listed(steps), model.steps.size()));
    }
  }
}

/// Nodes that the model holds where the layer's law has no place for it.
void add_held_elsewhere(const JointModel& model, const std::string& surface, const Layer& layer,
                        std::vector<std::string>& lines) {
  for (const HeldNodes& held : layer.held_elsewhere) {
    const std::vector<int> nodes = node_numbers(model, held.nodes);
    const char axis = "xyz"[held.component];
    add_once(lines, fmt::format("warning: surface \"{}\": {} node{} of its layer ({}) {} held in {}, in no plane of "
                                "symmetry across {}: that hold is left out, so the layer is softer there than in FEBio",
                                surface, nodes.size(), nodes.size() == 1 ? "" : "s", number_list(nodes),
                                nodes.size() == 1 ? "is" : "are", axis, axis));
  }
}

/// Nodes that are held where the springs give way.
void add_held_face(const JointModel& model, const Joint& joint, const std::string& surface, const Layer& layer,
                   std::vector<std::string>& lines) {
  for (const HeldFace& held : layer.held_face) {
    const std::vector<int> nodes = node_numbers(model, held.nodes);
    const bool one = nodes.size() == 1;
    const std::string which = fmt::format("surface \"{}\": {} node{} of its {} ({})", surface, nodes.size(),
                                          one ? "" : "s", held.on_face ? "pressed face" : "layer", number_list(nodes));
    const std::string& body = joint.bodies[at(held.body)].name;
    add_once(
        lines,
        held.on_face
            ? fmt::format("warning: {} {} held by its own body \"{}\", with cartilage under {}: that hold is left out, "
                          "and the face gives way there as elsewhere; hold the nodes of its bone face alone",
                          which, one ? "is" : "are", body, one ? "it" : "them")
            : fmt::format("warning: {} {} held by body \"{}\", not by its own, \"{}\": that hold is left out", which,
                          one ? "is" : "are", body, joint.bodies[at(layer.body)].name));
  }
}

}  // namespace

std::vector<std::string> model_remarks(const JointModel& model, const Joint& joint, const Wording& wording) {
  std::vector<std::string> lines;
  const auto add = [&](const char* kind, const Remark& r) {
    add_once(lines, fmt::format("{}: {}{}{}", kind, where(model, r.origin), r.what,
                                r.count > 1 ? fmt::format(" ({} times)", r.count) : ""));
  };
  for (const Remark& r : model.ignored) add("ignored", r);
  for (const Remark& r : model.assumed) add("note", r);
  for (const ContactPair& pair : joint.contacts) {
    const Contact& contact = model.contacts[at(pair.contact)];
    for (const std::string& what : contact.ignored)
      add_once(lines, fmt::format("ignored: {}contact \"{}\": {}", where(model, contact.origin), contact.name, what));
  }
  for (const Sentence& finding : joint.findings) add_once(lines, "note: " + worded(finding, wording));
  for (const std::string& odd : implausible_numbers(model, joint, wording)) add_once(lines, odd);
  for (const UnmodelledPart& part : joint.unmodelled) add_once(lines, unmodelled_part(joint, part));
  for (const DroppedTie& tie : joint.dropped_ties) add_once(lines, dropped_tie(joint, tie));
  for (const std::string& doubt : joint.doubts) add_once(lines, "warning: " + doubt);
  for (const ContactPair& pair : joint.contacts) {
    const std::string coarse = coarse_facets(model, pair, wording);
    if (!coarse.empty()) add_once(lines, coarse);
  }
  for (const ContactPair& pair : joint.contacts) {
    for (const Layer& layer : pair.layers) {
      const std::string& surface = model.surfaces[at(layer.surface)].name;
      add_half_held(surface, layer, lines);
      add_ends(model, surface, layer, lines);
      add_held_elsewhere(model, surface, layer, lines);
      add_held_face(model, joint, surface, layer, lines);
      const std::string without = no_thickness(surface, layer, wording);
      if (!without.empty()) add_once(lines, without);
      const std::vector<std::size_t> doubtful = doubtful_vertices(layer);
      if (doubtful.empty()) continue;
      const std::size_t far = far_from_rim(layer, doubtful);
      add_once(lines,
               fmt::format("{}: surface \"{}\": at {} of {} vertices the thickness is the distance to the nearest "
                           "point of the bone, for their normals meet no bone ({}{})",
                           far == 0 ? "note" : "warning", surface, doubtful.size(), layer.missed.size(),
                           far == 0 ? "usual at rims"
                                    : fmt::format("{} of them farther than two thicknesses from its rim: does its bone "
                                                  "have a hole, or end too soon?",
                                                  far),
                           shows_where(model)));
    }
  }
  return lines;
}

namespace {

using Lines = std::vector<std::string>;

/// States that are no solution or stand on the brink, neighbours together.
void add_outcomes(const SolvedStates& result, const Wording& wording, Lines& lines) {
  std::vector<StateRun> runs;
  for (std::size_t i = 0; i < result.states.size(); ++i) {
    const Equilibrium& e = result.states[i].equilibrium;
    if (!solved(e.outcome)) add_state(runs, fmt::format("{}", name(e.outcome)), i, outcome_text(e, wording));
    if (e.unstable)
      add_state(runs, "the balance is unstable", i, fmt::format("least stiffness {:.3g}", e.least_stiffness));
  }
  for (const StateRun& run : runs) lines.push_back(run_line(result, run));
}

void add_held_motions(const SolvedStates& result, Lines& lines) {
  int count = 0;
  const StateResult* last = nullptr;  // the axes turn a little from state to state: those of the last one stand for all
  for (const StateResult& state : result.states) {
    if (state.equilibrium.held.empty()) continue;
    ++count;
    last = &state;
  }
  if (last == nullptr) return;
  std::string directions;
  for (const std::string& held : last->equilibrium.held) directions += (directions.empty() ? "" : ", ") + held;
  add_once(lines,
           fmt::format("note: in {} of {} states motions were held that nothing resists or loads; at time {}: {}",
                       count, result.states.size(), time_text(last->when.time), directions));
}

/// Bodies that have turned far although nobody wants them to.
void add_large_turns(const JointModel& model, const Joint& joint, const SolvedStates& result, const Wording& wording,
                     Lines& lines) {
  const Equilibrium& e = result.states.back().equilibrium;
  if (!solved(e.outcome) || e.outcome == Outcome::Prescribed) return;
  const double prescribed = prescribed_turn(model, joint, e);
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    if (!result.free_to_turn[b]) continue;
    const Eigen::AngleAxisd turn(e.poses[b].rotation * result.start[b].rotation.transpose());
    const double degrees = turn.angle() * kDegreesPerRadian;
    if (!(degrees > 20.0 + prescribed)) continue;
    const bool jointed = std::any_of(joint.connectors.begin(), joint.connectors.end(), [&](const Connector& c) {
      return c.body_a == static_cast<int>(b) || c.body_b == static_cast<int>(b);
    });
    const std::string turned =
        fmt::format("\"{}\" has turned by {:.0f} degrees about ({:.2f}, {:.2f}, {:.2f})", joint.bodies[b].name, degrees,
                    turn.axis().x(), turn.axis().y(), turn.axis().z());
    if (jointed)  // to hold its rotations would lock the joint
      add_once(lines, fmt::format("warning: {}, as its joints let it", turned));
    else
      add_once(lines, fmt::format("warning: {}: its rotations are hardly resisted; to hold them type {}", turned,
                                  wording({"free", joint.bodies[b].name, "x,y,z"})));
  }
}

/// What a load is measured against: modulus times area of the stiffest layer.
double stiffest_layer(const Joint& joint) {
  double most = 0.0;
  for (const ContactPair& pair : joint.contacts)
    for (const Layer& layer : pair.layers)
      if (!layer.rigid) most = std::max(most, layer.elasticity.E * surface_extent(layer.articular).area);
  return most;
}

/// Nothing presses a free body, and the surfaces have parted: no forces but such as are none against the cartilage's
/// modulus.
bool parted(const Joint& joint, const StateResult& state) {
  constexpr double kNothing = 1e-9;
  return state.equilibrium.outcome == Outcome::Balanced && state.equilibrium.load <= kNothing * stiffest_layer(joint);
}

/// The largest force that the tables show of a state, of contacts, bodies, ligaments and cables.
double largest_shown_force(const StateResult& state) {
  double largest = 0.0;
  const auto look_at = [&](double force) { largest = std::max(largest, std::abs(force)); };
  for (const ContactStatistics& contact : state.statistics) look_at(contact.force.norm());
  for (const Vector6& on_body : state.equilibrium.reaction) look_at(on_body.head<3>().norm());
  for (const double force : state.equilibrium.ligament_force) look_at(force);
  for (const double force : state.equilibrium.cable_force) look_at(force);
  return largest;
}

/// Loads too small for any joint in all states: 1 kPa over the whole surface of cartilage of 10 MPa. 2.5 for 2500 N are
/// such.
void add_tiny_load(const Joint& joint, const SolvedStates& result, Lines& lines) {
  constexpr double kTiny = 1e-4;
  double load = 0.0, shown = 0.0;
  for (const StateResult& state : result.states) {
    load = std::max(load, state.equilibrium.load);
    shown = std::max(shown, largest_shown_force(state));
  }
  const double stiffest = stiffest_layer(joint);
  if (result.states.back().equilibrium.outcome != Outcome::Balanced || !(load < kTiny * stiffest)) return;
  lines.push_back(fmt::format(
      "warning: forces of at most {:.3g} are next to nothing for this cartilage ({:.2g} of its modulus times "
      "its area): is the load in another unit, as kN?",
      shown > 0 ? shown : load, (shown > 0 ? shown : load) / stiffest));
}

/// Prescribed motions that bring a body through the other one: its springs see nothing, as if the surfaces were apart.
/// Asked where a contact ends, and in the last state. True: it is told.
bool add_passed_through(const Joint& joint, const SolvedStates& result, Lines& lines) {
  const auto active = [&](std::size_t state, std::size_t c) {
    return result.states[state].statistics[c].springs_active > 0;
  };
  bool told = false;
  for (std::size_t c = 0; c < joint.contacts.size(); ++c)
    for (std::size_t i = 0; i < result.states.size(); ++i) {
      const StateResult& state = result.states[i];
      const bool ends = !active(i, c) && (i + 1 == result.states.size() || (i > 0 && active(i - 1, c)));
      if (!ends || state.equilibrium.outcome != Outcome::Prescribed ||
          !passed_through(joint, joint.contacts[c], state.equilibrium.poses))
        continue;
      add_once(
          lines,
          fmt::format("warning: contact \"{}\": at time {} the surfaces have passed through each other, by more than "
                      "four times their thickness: that is no contact any more, and none is shown; check the "
                      "motion that is prescribed, and its units",
                      joint.contacts[c].name, time_text(state.when.time)));
      told = true;
      break;
    }
  return told;
}

/// Surfaces that do not touch, at the end or ever.
void add_no_contact(const Joint& joint, const SolvedStates& result, const Wording& wording, Lines& lines) {
  const auto touches = [](const StateResult& state) {
    return std::any_of(state.statistics.begin(), state.statistics.end(),
                       [](const ContactStatistics& s) { return s.springs_active > 0; });
  };
  const StateResult& last = result.states.back();
  if (parted(joint, last)) {
    std::vector<std::string> free;
    for (std::size_t b = 0; b < joint.bodies.size(); ++b)
      if (b < result.free_to_move.size() && result.free_to_move[b]) free.push_back(joint.bodies[b].name);
    const bool one = free.size() == 1;
    std::vector<std::string> names;
    for (const std::string& name : free) names.push_back(in_quotes(name));
    const std::string unloaded = one            ? "body " + listed(names) + ", though it is free to move"
                                 : free.empty() ? "a free body"
                                                : "bodies " + listed(names) + ", though they are free to move";
    add_once(lines, fmt::format("warning: at time {} nothing loads {}{}: there is no contact to look at; "
                                "give a load with {}, or hold or prescribe the motion",
                                time_text(last.when.time), unloaded,
                                touches(last) ? ", and the surfaces have parted" : ", and nothing touches",
                                wording({"force", one ? free.front() : "BODY", "x,y,z", "", !one})));
  }
  if (solved(last.equilibrium.outcome) && last.equilibrium.outcome != Outcome::Prescribed && !parted(joint, last) &&
      !touches(last))
    add_once(lines, fmt::format(
                        "warning: at time {} no contact carries any load, though the bodies balance: joints, ligaments "
                        "or what holds the bodies take all of it; look at the load's direction and at the joints",
                        time_text(last.when.time)));
  if (add_passed_through(joint, result, lines)) return;
  if (last.equilibrium.outcome == Outcome::Prescribed &&
      std::none_of(result.states.begin(), result.states.end(), touches))
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
                         pair.name, active, time_text(state.when.time), wording({"refine"}), wording({"source"})));
  else if (active < 60 && active > 0 && pair.law == Law::Layer)
    add_once(lines,
             fmt::format("warning: contact \"{}\": at time {} only {} springs carry, too few to follow how the layers "
                         "flow: force and peak may be 10% too high; divide them with "
                         "{}",
                         pair.name, time_text(state.when.time), active,
                         wording({"refine", "", std::to_string(2 * pair.refine)})));
}

/// A force that rests on a handful of springs though more are pressed: the map is one of the mesh.
void add_crowded_force(const ContactPair& pair, const StateResult& state, std::size_t contact, const Wording& wording,
                       Lines& lines) {
  constexpr int kHandful = 8;
  const ContactStatistics& s = state.statistics[contact];
  if (s.springs_active < 20 || s.springs_most >= kHandful) return;  // fewer: add_few_springs
  add_once(
      lines,
      fmt::format("warning: contact \"{}\": at time {} {} of {} springs carry nine tenths of the force, too few for a "
                  "pressure map: facets stand out of their surface, or they are long against the contact; look at "
                  "the mesh, or divide them with {}",
                  pair.name, time_text(state.when.time), s.springs_most, s.springs_active,
                  wording({"refine", "", std::to_string(2 * pair.refine)})));
}

/// A map whose facets are too long to show what presses them: averages at its nodes spread the pressure over
/// neighbouring facets, which the springs see apart.
void add_smeared_map(const JointModel& model, const ContactPair& pair, const StateResult& state, std::size_t contact,
                     Lines& lines) {
  constexpr double kFar = 1.2;  // pressure that fades out over a dozen facets: 1.1; a block of 10 facets: 1.21
  const ContactStatistics& s = state.statistics[contact];
  if (s.springs_active == 0 || !(s.headline.area > kFar * s.contact_area)) return;
  add_once(lines,
           fmt::format(
               "warning: contact \"{}\": at time {} the facets of surface \"{}\" are too long for this contact's map: "
               "averages at its nodes give area {:.3g}, mean {:.3g}, p99 {:.3g}, the springs themselves {:.3g}, "
               "{:.3g}, {:.3g}; "
               "mesh this surface finer",
               pair.name, time_text(state.when.time), model.surfaces[at(pair.source_layer().surface)].name,
               s.headline.area, s.headline.mean, s.headline.p99, s.contact_area, s.mean, s.p99));
}

/// Contact of a few facets that are long against the cartilage: what flows between springs is not followed.
void add_narrow_contact(const JointModel& model, const ContactPair& pair, const StateResult& state, std::size_t contact,
                        const Wording& wording, Lines& lines) {
  if (pair.law != Law::Layer) return;
  double least = kInfinity;
  const Layer* narrow = nullptr;
  for (int side = 0; side < 2; ++side) {
    const Layer& layer = pair.layers[side];
    if (!(facet_size(pair, layer) > kFineFacets)) continue;
    const std::vector<double>& pressure = state.fields[contact].sides[side].pressure;
    if (pressure.empty()) continue;
    const double across = pair.refine * facets_across(layer, pressure, state.statistics[contact].headline.above);
    if (!(across > 0) || !(across < least)) continue;
    least = across;
    narrow = &layer;
  }
  const auto* off = std::find_if(std::begin(kCoarseErrors), std::end(kCoarseErrors),
                                 [&](const CoarseError& e) { return least <= e.across; });
  if (off == std::end(kCoarseErrors)) return;
  const std::string finer = finer_springs(pair, facet_size(pair, *narrow), wording);
  add_once(lines,
           fmt::format("warning: contact \"{}\": at time {} contact is {:.1f} facets wide on surface \"{}\", and "
                       "these are long against the cartilage ({:.2g} of its thickness): {}; {}",
                       pair.name, time_text(state.when.time), least, model.surfaces[at(narrow->surface)].name,
                       facet_size(pair, *narrow), off->text, finer.empty() ? "mesh it finer" : finer));
}

/// Cartilage pressed together by more than half, in any state.
void add_large_strains(const ContactPair& pair, const SolvedStates& result, std::size_t contact, Lines& lines) {
  constexpr double kLarge = 0.5;
  const StateResult* worst = nullptr;
  const auto strain = [&](const StateResult& s) { return s.statistics[contact].largest_strain; };
  for (const StateResult& state : result.states)
    if (solved(state.equilibrium.outcome) && strain(state) > (worst ? strain(*worst) : kLarge)) worst = &state;
  if (worst == nullptr) return;
  add_once(lines, fmt::format("warning: contact \"{}\": at time {} cartilage is pressed together by {:.0f}% of its "
                              "thickness: check load, modulus, thickness and units if that is not meant",
                              pair.name, time_text(worst->when.time), 100 * strain(*worst)));
}

/// A material that FEBio softens where cartilage stiffens: beyond small strains dea's laws are another material.
void add_softening_material(const JointModel& model, const ContactPair& pair, const SolvedStates& result,
                            std::size_t contact, Lines& lines) {
  constexpr double kSmall = 0.03;
  double most = 0.0;
  for (const StateResult& state : result.states)
    if (solved(state.equilibrium.outcome)) most = std::max(most, state.statistics[contact].largest_strain);
  if (!(most > kSmall)) return;
  for (const Layer& layer : pair.layers) {
    if (layer.rigid || layer.material < 0 || model.materials[at(layer.material)].type != "isotropic elastic") continue;
    add_once(lines, fmt::format(
                        "warning: contact \"{}\": cartilage is pressed together by {:.0f}%, and its material \"{}\" is "
                        "\"isotropic elastic\", which in FEBio gets softer as it is compressed, where dea's laws get "
                        "stiffer or stay as they are: p99 was 14% above FEBio's at 5%, 60% at 15%; neo-Hookean agrees",
                        pair.name, 100 * most, model.materials[at(layer.material)].name));
  }
}

/// Contacts side by side of which one presses at the line they share and the other does not, in any state.
void add_uneven_neighbours(const JointModel& model, const Joint& joint, const SolvedStates& result, std::size_t contact,
                           Lines& lines) {
  const UnevenNeighbour* worst = nullptr;
  double time = 0.0;
  const auto size = [](const UnevenNeighbour& n) { return std::abs(n.own - n.beyond); };
  for (const StateResult& state : result.states) {
    const std::optional<UnevenNeighbour>& found = state.statistics[contact].uneven;
    if (!found || !solved(state.equilibrium.outcome) || (worst != nullptr && size(*found) <= size(*worst))) continue;
    worst = &*found;
    time = state.when.time;
  }
  if (worst == nullptr) return;
  add_once(
      lines,
      fmt::format("warning: contact \"{}\": at time {} it presses surface \"{}\" with {:.3g} within two thicknesses "
                  "of the line where contact \"{}\" begins, and that one presses there with {:.3g}; each is solved "
                  "as if the other pressed alike: force may be 15%, pressures near the line a third off; one "
                  "contact with one surface of both tells it right",
                  joint.contacts[contact].name, time_text(time), model.surfaces[at(worst->surface)].name, worst->own,
                  joint.contacts[at(worst->other)].name, worst->beyond));
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

/// Layers whose greatest shear is where the law of the inside knows least.
void add_inside_edges(const Joint& joint, const StateResult& state, std::size_t contact, Lines& lines) {
  const ContactPair& pair = joint.contacts[contact];
  for (const int side : {0, 1}) {
    const std::optional<InsideEnds>& inside = state.statistics[contact].inside[side];
    if (!inside || !inside->peak_near_free_edge) continue;
    const Layer& layer = side == 0 ? pair.source_layer() : pair.target_layer();
    add_once(lines,
             fmt::format("warning: contact \"{}\": at time {} the greatest shear inside the cartilage of {} is "
                         "within {:g} thicknesses of its free edge, where it may be a third off (docs/inside.md)",
                         pair.name, time_text(state.when.time), joint.bodies[at(layer.body)].name, kNearEdge));
  }
}

/// Vertices under pressure whose thickness is doubtful.
void add_doubtful_pressure(const JointModel& model, const ContactPair& pair, const StateResult& state,
                           std::size_t contact, const Wording& wording, Lines& lines) {
  for (int side = 0; side < 2; ++side) {
    const Layer& layer = pair.layers[side];
    const std::vector<double>& pressure = state.fields[contact].sides[side].vertex_pressure;
    if (layer.springs_at == SpringsAt::Bone || pressure.size() != layer.missed.size()) continue;
    int count = 0;
    double most = 0.0;
    for (const std::size_t v : doubtful_vertices(layer)) {
      if (!(pressure[v] > kFelt * state.statistics[contact].peak)) continue;
      ++count;
      most = std::max(most, pressure[v]);
    }
    if (count == 0) continue;
    const std::string& surface = model.surfaces[at(layer.surface)].name;
    add_once(lines,
             fmt::format("warning: surface \"{}\": at time {} {} of the vertices whose normals meet no bone carry "
                         "pressure, up to {:.3g}: it is only as good as the distance to the nearest point of the "
                         "bone is a thickness; complete the bone under them, or give {}",
                         surface, time_text(state.when.time), count, most, wording({"thickness", surface, "VALUE"})));
  }
}

/// Bare surfaces that end under pressure though the cartilage goes on.
void add_pressed_rims(const JointModel& model, const ContactPair& pair, const StateResult& state, std::size_t contact,
                      Lines& lines) {
  for (int side = 0; side < 2; ++side) {
    const Layer &layer = pair.layers[side], &partner = pair.layers[1 - side];
    if (!layer.rigid || layer.bare_rim.empty()) continue;
    const PressedRim& rim = state.statistics[contact].pressed_rim[side];
    const double length = rim.selection + rim.mesh, facet = partner.facet_size() * partner.mean_thickness();
    if (!(length > 0) || !(length > facet)) continue;
    const std::string where =
        rim.mesh == 0 ? "where its body's mesh goes on"
        : rim.selection == 0
            ? "where its mesh ends"
            : fmt::format("where its mesh ends ({:.3g}) or goes on unselected ({:.3g})", rim.mesh, rim.selection);
    const char* advice = rim.mesh == 0        ? "select the facets beyond as well"
                         : rim.selection == 0 ? "mesh more of it if the body goes on there"
                                              : "select the facets beyond, mesh more of it if the body goes on there";
    add_once(lines,
             fmt::format("warning: at time {} pressure reaches the end of bare surface \"{}\" along {:.3g} ({:.0f}% "
                         "of its rim), {}: there is no contact beyond, and its edge presses like a punch's; {}",
                         time_text(state.when.time), model.surfaces[at(layer.surface)].name, length,
                         100 * length / rim.whole, where, advice));
  }
}

/// Largest pressure of both surfaces where they end in one plane.
double pressure_at(const SharedEnd& end, const ContactPair& pair, const ContactFields& fields) {
  double most = 0.0;
  for (int side = 0; side < 2; ++side) {
    const SurfaceMesh& mesh = pair.layers[side].articular;
    const std::vector<double>& pressure = fields.sides[side].vertex_pressure;
    if (pressure.size() != mesh.vertices.size()) continue;
    for (std::size_t v = 0; v < pressure.size(); ++v)
      if (std::abs(mesh.vertices[v][end.plane.axis] - end.plane.at) <= end.tolerance)
        most = std::max(most, pressure[v]);
  }
  return most;
}

/// Half a joint whose cut is not held: both surfaces end in one plane under pressure, and not in another one opposite,
/// as two plates of one size do.
void add_cut_faces(const ContactPair& pair, const StateResult& state, std::size_t contact, Lines& lines) {
  std::vector<std::pair<SharedEnd, double>> pressed;
  for (const SharedEnd& end : shared_ends(pair)) {
    const double most = pressure_at(end, pair, state.fields[contact]);
    if (most > kFelt * state.statistics[contact].peak) pressed.push_back({end, most});
  }
  for (const auto& [end, most] : pressed) {
    const int axis = end.plane.axis;
    const auto ends = std::count_if(pressed.begin(), pressed.end(),
                                    [axis](const auto& other) { return other.first.plane.axis == axis; });
    if (end.symmetry || ends > 1) continue;
    add_once(lines,
             fmt::format("warning: contact \"{}\": at time {} both surfaces end in the plane {} under pressure, up to "
                         "{:.3g}, and the cartilage's nodes are not held across it: taken for free edges; if the joint "
                         "goes on behind it as its mirror image, hold these nodes in {}",
                         pair.name, time_text(state.when.time), in_words(std::vector<SymmetryPlane>{end.plane}), most,
                         "xyz"[axis]));
  }
}

/// Selections that end under pressure though the cartilage goes on.
void add_pressed_ends(const JointModel& model, const ContactPair& pair, const StateResult& state, std::size_t contact,
                      Lines& lines) {
  for (int side = 0; side < 2; ++side) {
    const Layer& layer = pair.layers[side];
    const double length = pressed_end_of_selection(layer, state.fields[contact].sides[side].pressure,
                                                   kFelt * state.statistics[contact].peak);
    if (!(length > 2 * layer.facet_size() * layer.mean_thickness())) continue;
    add_once(lines,
             fmt::format("warning: surface \"{}\": at time {} pressure reaches the end of the selected facets "
                         "along {:.3g} of its rim, where the cartilage goes on: it is that of an edge there, too "
                         "high if the other surface covers what is beyond; select the facets beyond as well",
                         model.surfaces[at(layer.surface)].name, time_text(state.when.time), length));
  }
}

}  // namespace

std::vector<std::string> warnings_in(const std::vector<std::string>& lines) {
  const std::string start = "warning: ";
  std::vector<std::string> warnings;
  for (const std::string& line : lines)
    if (line.rfind(start, 0) == 0) warnings.push_back(line.substr(start.size()));
  return warnings;
}

std::string outcome_text(const Equilibrium& e, const Wording& wording) {
  return e.message + (e.advice.empty() ? "" : " " + worded(e.advice, wording));
}

std::vector<std::string> no_solution_lines(const Analysis& analysis, const Wording& wording) {
  std::vector<std::string> lines;
  for (const StateResult& state : analysis.states) {
    const Equilibrium& e = state.equilibrium;
    if (!solved(e.outcome))
      lines.push_back(fmt::format("warning: time {}: {}: {}", time_text(state.when.time), name(e.outcome),
                                  outcome_text(e, wording)));
  }
  if (!lines.empty())
    lines.push_back(fmt::format("warning: no solution in {} of {} states", lines.size(), analysis.states.size()));
  return lines;
}

std::vector<std::string> idle_load_lines(const SolvedStates& result, const Wording& wording) {
  std::vector<std::string> lines;
  for (const Sentence& words : result.idle) lines.push_back("warning: " + worded(words, wording));
  return lines;
}

std::vector<std::string> result_remarks(const JointModel& model, const Joint& joint, const SolvedStates& result,
                                        const Wording& wording) {
  std::vector<std::string> lines;
  if (result.states.empty()) return lines;
  for (const std::string& line : idle_load_lines(result, wording)) add_once(lines, line);
  add_outcomes(result, wording, lines);
  add_held_motions(result, lines);
  const StateResult& last = result.states.back();  // stands for all: turns and factors change slowly
  add_large_turns(model, joint, result, wording, lines);
  add_no_contact(joint, result, wording, lines);
  if (parted(joint, last)) return lines;
  add_tiny_load(joint, result, lines);
  for (std::size_t c = 0; c < joint.contacts.size(); ++c) {
    add_large_strains(joint.contacts[c], result, c, lines);
    add_softening_material(model, joint.contacts[c], result, c, lines);
    add_uneven_neighbours(model, joint, result, c, lines);
    if (!solved(last.equilibrium.outcome)) continue;  // no map to be judged, and no mesh to be blamed
    add_few_springs(joint.contacts[c], last, c, wording, lines);
    add_crowded_force(joint.contacts[c], last, c, wording, lines);
    add_smeared_map(model, joint.contacts[c], last, c, lines);
    add_narrow_contact(model, joint.contacts[c], last, c, wording, lines);
    add_incomplete_maps(model, joint.contacts[c], last.fields[c], lines);
    add_pressed_ends(model, joint.contacts[c], last, c, lines);
    add_pressed_rims(model, joint.contacts[c], last, c, lines);
    add_cut_faces(joint.contacts[c], last, c, lines);
    add_inside_edges(joint, last, c, lines);
    add_doubtful_pressure(model, joint.contacts[c], last, c, wording, lines);
  }
  return lines;
}

std::vector<std::string> result_remarks(const JointModel& model, const Analysis& analysis, const Wording& wording) {
  return result_remarks(model, analysis.joint, analysis, wording);
}

std::vector<std::string> run_remarks(const JointModel& model, const Analysis& analysis, const Wording& wording) {
  std::vector<std::string> lines = model_remarks(model, analysis.joint, wording);
  for (const std::string& line : result_remarks(model, analysis, wording)) lines.push_back(line);
  return lines;
}

}  // namespace dea
