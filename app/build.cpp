// `dea build`: bones' and cartilages' surfaces become a joint model.
#include <fmt/format.h>

#include <algorithm>

#include "app/build_request.h"
#include "app/build_standing.h"
#include "app/commands.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "io/build/joint_feb.h"
#include "io/build/landmarks.h"
#include "io/feb/read_feb.h"
#include "io/files/output.h"
#include "io/results/existing_file.h"
#include "io/settings/settings_xml.h"
#include "src/base/error.h"
#include "src/base/rotations.h"
#include "src/build/free_dofs.h"
#include "src/build/remesh.h"
#include "src/rules/rules.h"
#include "src/run/analysis.h"
#include "src/springs/spring_law.h"
#include "views/build_page/build_page.h"
#include "views/data/build_json.h"
#include "views/data/json.h"
#include "views/map/hip_picture.h"
#include "views/page/write_page.h"
#include "views/text/build_text.h"

namespace dea {

namespace {

/// A fault without advice that names options of dea run, which dea build has not.
std::string without_options(Fault fault) {
  if (!fault.expected.settings.empty()) fault.expected = {};
  std::string words = line(fault, command_line_wording());
  if (!words.empty() && words.back() == ';') words.pop_back();
  return words;
}

/// A spring that is strained too far where a layer is thin or its facets lean. The search knows of no places, and takes
/// the load or the whole layer for the reason.
struct OddSpring {
  std::size_t contact = 0;
  int side = 0;                       ///< of the thinner layer, as a part of its mean; 0: primary, 1: secondary
  double part = 1.0;                  ///< of its mean thickness
  double lean = 0.0;                  ///< between the spring and the normal of the surface opposite [rad]
  double strain = 0.0;                ///< infinite: the layers are not as thick as the surfaces lie in each other
  Vector3d where = Vector3d::Zero();  ///< in that layer, as it was built

  bool thin() const { return part < 0.5; }
  bool odd() const { return thin() || lean > 30 / kDegreesPerRadian; }
};

OddSpring spring_at(const Joint& joint, const Equilibrium& e, std::size_t contact, std::size_t spring) {
  const ContactPair& pair = joint.contacts[contact];
  const SpringStates& s = e.springs[contact];
  OddSpring found;
  found.contact = contact;
  found.lean = std::acos(std::clamp(-s.direction[spring].dot(s.normal[spring]), -1.0, 1.0));
  found.strain = s.too_deep[spring] ? kInfinity : s.strain[spring];
  const double thickness[] = {s.t_source[spring], s.t_target[spring]};
  const Vector3d ends[] = {s.foot[spring], s.end[spring]};
  for (const int end : {0, 1}) {
    const int side = end == 0 ? pair.source : 1 - pair.source;
    const Layer& layer = pair.layers[side];
    const double part = layer.rigid ? kInfinity : thickness[end] / layer.mean_thickness();
    if (end == 1 && part >= found.part) continue;
    const Pose& pose = e.poses[at(layer.body)];
    found.side = side;
    found.part = part;
    found.where = joint.bodies[at(layer.body)].center_of_mass + pose.rotation.transpose() * (ends[end] - pose.center);
  }
  return found;
}

/// Goes on from the words of a balance that ended at strained springs; empty: few of them are at such places.
std::string strained_places(const Joint& joint, const Equilibrium& e, const BuiltJoint& built) {
  if (e.outcome != Outcome::BeyondStrainLimit) return "";
  std::size_t strained = 0, odd = 0;
  OddSpring worst;
  for (std::size_t c = 0; c < e.springs.size(); ++c)
    for (std::size_t i = 0; i < e.springs[c].strain.size(); ++i) {
      if (!(e.springs[c].strain[i] > kStrainLimit) && !e.springs[c].too_deep[i]) continue;
      const OddSpring spring = spring_at(joint, e, c, i);
      ++strained;
      if (!spring.odd()) continue;
      if (odd++ == 0 || spring.strain > worst.strain) worst = spring;
    }
  if (odd == 0 || 2 * odd < strained) return "";
  const ContactPair& pair = joint.contacts[worst.contact];
  std::string name = pair.name;
  for (const BuiltContact& c : built.contacts)
    if (c.name == pair.name) name = built.layers[at(worst.side == 0 ? c.primary : c.secondary)].name;
  const double mean = pair.layers[worst.side].mean_thickness();
  const std::string place =
      worst.thin() ? fmt::format("where {} is thin, {:.3g} mm at {} ({:.3g} in the mean)", name, worst.part * mean,
                                 vector_text(worst.where), mean)
                   : fmt::format("on a facet that leans by {:.0f} degrees to the surface opposite, at {} of {}",
                                 worst.lean * kDegreesPerRadian, vector_text(worst.where), name);
  return fmt::format(
      "; {} at a thin or rough place, {}{}: that may be the reason rather than the load; smoother "
      "surfaces, other triangles (--edge){} may do",
      strained == 1 ? "it is" : fmt::format("{} of them are", odd), strained == 1 ? "" : "the worst ", place,
      worst.thin() ? " or a greater least thickness (--least)" : "");
}

/// The pose that balances each load, by dea itself. `findings`: what dea run would tell of model and results.
std::vector<BuildBalance> find_balances(const std::string& text, const std::string& path, const BuiltJoint& built,
                                        Progress& progress, Findings& findings) {
  progress.now("balance", "", built.loads() > 1 ? "balance of the loads" : "balance of the load");
  JointModel model = read_feb_text(text, path);
  const std::vector<TimePoint> times = model_times(model);
  AnalysisOptions options;
  options.times.assign(times.end() - static_cast<std::ptrdiff_t>(built.loads()), times.end());
  options.equilibrium.stop = stop_flag();
  std::vector<BuildBalance> balances(built.loads());
  for (std::size_t i = 0; i < balances.size(); ++i) {
    balances[i].time = options.times[i].time;
    balances[i].displacement.assign(built.bodies.size(), Vector3d::Zero());
    balances[i].turn.assign(built.bodies.size(), Vector3d::Zero());
  }
  try {
    const Recognition recognition = recognise(std::move(model));
    std::vector<std::string> places(balances.size());
    options.progress = [&](const StateResult& state, std::size_t i, std::size_t) {  // who keeps no springs afterwards
      places[i] = strained_places(recognition.joint, state.equilibrium, built);
    };
    const Analysis analysis = analyse(recognition, options);
    findings = analysis.findings;
    for (std::size_t i = 0; i < balances.size(); ++i) {
      const StateResult& state = analysis.states.at(i);
      balances[i].found = solved(state.equilibrium.outcome);
      std::string& words = balances[i].words;
      words = state.equilibrium.message;
      const Sentence& advice = state.equilibrium.advice;
      if (!words.empty() && words.back() == ';') words.pop_back();  // the advice would follow
      if (!advice.empty() && advice.settings.empty()) words += " " + worded(advice, command_line_wording());
      words += places[i];
      for (std::size_t b = 0; b < built.bodies.size(); ++b)
        for (std::size_t j = 0; j < analysis.joint.bodies.size(); ++j)
          if (analysis.joint.bodies[j].name == built.bodies[b].name) {
            balances[i].displacement[b] = state.equilibrium.poses[j].center - built.bodies[b].center;
            balances[i].turn[b] = rotation_vector(state.equilibrium.poses[j].rotation);
          }
      for (std::size_t c = 0; c < state.statistics.size(); ++c)
        balances[i].contacts.push_back({analysis.joint.contacts[c].name, state.statistics[c].headline});
    }
  } catch (const InputError& e) {
    for (BuildBalance& balance : balances) balance.words = without_options(e.fault);
  }
  return balances;
}

/// What dea run warns of and dea build does not say by itself: modulus_question, load_questions (a load that is tiny
/// for its modulus is either's matter), balances not found.
Findings warnings_of_run(const Findings& findings, bool modulus_or_load) {
  Findings found = warnings(findings);
  std::erase_if(found, [&](const Finding& f) {
    return f.code == "no-solution" || f.code == "nothing-loads" ||
           (f.code == "odd-units" && f.form == 0) ||  // of a modulus
           (f.code == "tiny-load" && modulus_or_load);
  });
  return found;
}

void add_findings(const std::vector<std::string>& more, std::vector<std::string>& findings) {
  findings.insert(findings.end(), more.begin(), more.end());
}

/// So many triangles of bones at most are drawn on the page.
constexpr std::size_t kMostPageTriangles = 60000;

void write_page(const BuildArguments& a, const BuildSummary& summary, const BuildInputs& inputs) {
  BuildPageInput page{summary, inputs.request, {}, a.words, {}};
  for (const BoneRequest& bone : inputs.request.bones)
    page.bones.push_back(decimated(bone.surface, kMostPageTriangles / inputs.request.bones.size()));
  for (const NamedPath& file : inputs.files) page.files.push_back(file.path);
  page.files.push_back(a.output);
  page.files.push_back(a.report);
  write_text(a.report, build_page_html(page));
}

}  // namespace

int build(const BuildArguments& a) {
  const auto threads = limit_threads(a.threads);
  if (a.output.empty()) throw UsageError("-o is missing, expected the name of the model, -o joint.feb");
  const PictureFormat figure_format =
      a.hip_figure.empty() ? PictureFormat::Svg : picture_format("--hip-figure", a.hip_figure);
  if (a.output == "-") throw UsageError("-o -: the table goes to standard output, give the model a name");
  BuildInputs inputs = build_inputs(a);
  require_page_name("--report", a.report);
  const std::vector<NamedPath> others = {
      {"--json", a.json}, {"--report", a.report}, {"--frames", a.frames}, {"--hip-figure", a.hip_figure}};
  std::vector<NamedPath> outputs = others;
  outputs.insert(outputs.begin(), {"-o", a.output});
  const HeldOutputs held = claim_outputs(inputs.files, outputs);
  if (!a.overwrite) {
    refuse_to_replace("-o", a.output, why_kept_model(a.output, ModelOf::Build));
    refuse_to_replace(others);
  }
  Progress progress(progress_style(a.quiet, false));
  std::vector<std::string> questions;  // told before what may take long
  if (const std::string odd = modulus_question(inputs.model); !odd.empty()) {
    questions.push_back(odd);
    log("warning: " + odd);
  }
  progress.now("reading surfaces", "", "reading surfaces");
  BuildReport report;
  report.findings = read_loads(inputs);
  const std::vector<std::string> placed = read_placements(a, inputs);
  add_findings(placed, report.findings);
  add_findings(read_surfaces(a, inputs), report.findings);
  const Findings units = doubtful_matrices(inputs);
  for (const std::string& question : coded_words(units, command_line_wording())) {
    questions.push_back(question);
    log("warning: " + question);
  }
  progress.now("anatomy", "", "frames and measures");
  turn_open_bones(inputs.request, report);
  const Anatomy anatomy = find_anatomy(inputs.request.bones, inputs.anatomy);
  leave_frames(inputs.request, anatomy);
  add_findings(held_forces(inputs.request), report.findings);
  if (!a.hip_figure.empty() && !anatomy.hip)
    throw InputError(
        fmt::format("--hip-figure {}: found nothing measured of a hip, expected a ball in a socket that opens sideways",
                    a.hip_figure));
  add_findings(anatomy.findings, report.findings);
  progress.now("cartilage", "", "cartilage and its mesh");
  const auto built = [&] {
    try {
      return build_joint(inputs.request, report);
    } catch (const InputError&) {  // a bone that was placed elsewhere may be why
      progress.clear();
      for (const std::string& finding : placed)
        if (!a.quiet) log("note: " + finding);
      throw;
    }
  };
  BuiltJoint joint = built();
  count_motion_from_centers(joint);
  choose_dofs(inputs.request, joint, report);

  inputs.model.elements_through = inputs.request.elements_through;
  inputs.model.comment = fmt::format("{} of {} surfaces.", kBuiltMark, inputs.files.size());
  for (const std::string& question : load_questions(joint, report)) {
    questions.push_back(question);
    log("warning: " + question);
  }
  Findings findings;
  const std::vector<BuildBalance> balances =
      find_balances(joint_feb(joint, inputs.model), a.output, joint, progress, findings);
  Findings of_run = units;
  add_once(of_run, warnings_of_run(findings, questions.size() > units.size()));
  add_findings(coded_words(of_code(findings, "motion-held"), command_line_wording()), report.findings);
  if (balances.front().found) {
    inputs.model.seat = balances.front().displacement;
    inputs.model.seat_turn = balances.front().turn;
  }
  progress.now("writing " + file_name(a.output), "", "writing " + file_name(a.output));
  write_text(a.output, joint_feb(joint, inputs.model));
  if (!a.frames.empty()) write_text(a.frames, frames_as_settings(anatomy.frames));
  if (!a.hip_figure.empty()) write_text(a.hip_figure, hip_picture(*anatomy.hip, figure_format));
  const BuildSummary summary{a.output, joint, report, inputs.model, balances, inputs.load_times, anatomy, of_run};
  if (!a.report.empty()) {
    progress.now("writing " + file_name(a.report), "", "writing " + file_name(a.report));
    write_page(a, summary, inputs);
  }
  progress.clear();
  if (!a.quiet)
    for (const std::string& finding : report.findings) log("note: " + finding);
  if (!a.json.empty()) write_text(a.json, json_text(build_json(summary)));
  if (!a.quiet && a.json != "-") print(build_text(summary));
  for (const std::string& warning : a.quiet ? own_warnings(summary) : build_warnings(summary))  // as dea run -q
    if (std::find(questions.begin(), questions.end(), warning) == questions.end()) log("warning: " + warning);
  return all_balanced(summary) ? kSolved : kNoSolution;
}

}  // namespace dea
