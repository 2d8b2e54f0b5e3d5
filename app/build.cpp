// `dea build`: bones' and cartilages' surfaces become a joint model.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "app/build_request.h"
#include "app/commands.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "io/build/joint_feb.h"
#include "io/build/landmarks.h"
#include "io/feb/read_feb.h"
#include "io/files/existing_model.h"
#include "io/files/held_outputs.h"
#include "io/files/output.h"
#include "io/files/system.h"
#include "io/settings/setting_words.h"
#include "src/base/error.h"
#include "src/build/remesh.h"
#include "src/run/analysis.h"
#include "views/build_page/build_page.h"
#include "views/data/build_json.h"
#include "views/data/json.h"
#include "views/map/hip_picture.h"
#include "views/page/write_page.h"
#include "views/text/build_text.h"

namespace dea {

namespace {

constexpr const char* kBuildFooter = R"(
Bones and cartilage are triangle surfaces in one coordinate system: STL, OBJ, PLY, VTK (polydata), VTP. NAME is your name for
the bone. The cartilage of a bone is one of
  --cartilage NAME=FILE   its segmented outer surface; the thickness is measured down to the bone
  --uniform NAME=T        one thickness, where the bone faces another
  --half-gap max=2,min=0.5  half the gap between the bones, within these bounds, for all bones without another option
  --thickness-at NAME=FILE  a table with columns x, y, z, thickness; the nearest point counts
A bone with none of them is bare. The first step of the model seats the loaded bones where dea finds them in balance; the
second has the force, or the forces of a table row by row. dea run solves the model, and so does FEBio. Notes on standard error
say what dea inferred; docs/from_scans.md has more.

In frame:pelvis x points forwards, y up and z to the right of the body, for a left hip too.

Examples:
  dea build --bone pelvis=pelvis.stl --bone femur=femur.stl --half-gap max=2,min=0.5 --force femur=432,-262,1834 -o hip.feb
  dea build --bone socket=pelvis.stl --bone ball=femur.stl --uniform socket=2 --edge 1.5 --force ball=0,0,1000 -o joint.feb --report joint.html
  dea build --bone pelvis=pelvis.stl --bone femur=femur.stl --half-gap max=2,min=0.5 --landmarks landmarks.csv --force femur=frame:pelvis,250,1800,-400 --frames hip_frames.xml --hip-figure hip_figure.svg -o hip.feb
  dea build --bone pelvis=pelvis.stl --cartilage pelvis=acetabular_cartilage.stl --bone femur=femur.stl --cartilage femur=femoral_cartilage.stl --force femur=432,-262,1834 -o hip.feb)";

/// Forces along directions in which their bone is held reach no cartilage. Throws UsageError: nothing else is left.
void tell_held_forces(const BuildRequest& request, std::vector<std::string>& findings) {
  for (const BoneRequest& bone : request.bones) {
    const std::vector<Vector3d> forces = bone.forces.empty() ? std::vector<Vector3d>{bone.force} : bone.forces;
    for (const Vector3d& force : forces) {
      if (bone.fixed || force.isZero(0)) continue;
      Vector3d held = Vector3d::Zero();
      for (int c = 0; c < 3; ++c)
        if (bone.held[at(c)]) held[c] = force[c];
      if (held.isZero(0)) continue;
      if (held == force)
        throw UsageError(fmt::format("--hold {}: found a force {} that is held altogether, expected one that presses",
                                     bone.name, vector_text(force)));
      findings.push_back(
          fmt::format("{}: {} of the force {} goes into what holds the bone (--hold), not into the joint", bone.name,
                      vector_text(held), vector_text(force)));
    }
  }
}

/// The pose that balances each load, by dea itself.
std::vector<BuildBalance> find_balances(const std::string& text, const BuiltJoint& built, Progress& progress) {
  progress.now("balance", "", built.loads() > 1 ? "balance of the loads" : "balance of the load");
  std::filesystem::path name;
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  const int file = error ? -1 : create_temporary(folder, name);
  if (file < 0) throw WriteError("a temporary file: set TMPDIR to a folder that takes one");
  close_file(file);
  const Temporary temporary(name);
  write_text(temporary.path, text);
  JointModel model = read_feb(temporary.path);
  const std::vector<TimePoint> times = model_times(model);
  AnalysisOptions options;
  options.times.assign(times.end() - static_cast<std::ptrdiff_t>(built.loads()), times.end());
  options.equilibrium.stop = stop_flag();
  std::vector<BuildBalance> balances(built.loads());
  for (std::size_t i = 0; i < balances.size(); ++i) {
    balances[i].time = options.times[i].time;
    balances[i].displacement.assign(built.bodies.size(), Vector3d::Zero());
  }
  try {
    const Analysis analysis = analyse(recognise(std::move(model)), options);
    for (std::size_t i = 0; i < balances.size(); ++i) {
      const StateResult& state = analysis.states.at(i);
      balances[i].found = solved(state.equilibrium.outcome);
      std::string& words = balances[i].words;
      words = state.equilibrium.message;
      const Sentence& advice = state.equilibrium.advice;
      if (!words.empty() && words.back() == ';') words.pop_back();  // dea run's advice would follow: its options
      if (!advice.empty() && advice.settings.empty()) words += " " + worded(advice, command_line_wording());
      for (std::size_t b = 0; b < built.bodies.size(); ++b)
        for (std::size_t j = 0; j < analysis.joint.bodies.size(); ++j)
          if (analysis.joint.bodies[j].name == built.bodies[b].name)
            balances[i].displacement[b] = state.equilibrium.poses[j].center - built.bodies[b].center;
      for (std::size_t c = 0; c < state.statistics.size(); ++c)
        balances[i].contacts.push_back({analysis.joint.contacts[c].name, state.statistics[c].headline});
    }
  } catch (const InputError& e) {
    for (BuildBalance& balance : balances) balance.words = line(e.fault);
  }
  return balances;
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
  write_build_page(a.report, page);
}

}  // namespace

CLI::App* add_build(CLI::App& app, BuildArguments& a) {
  CLI::App* c = app.add_subcommand("build", "Make a joint model from surfaces of bones and cartilage");
  c->footer(kBuildFooter);
  add_repeated(*c, "--bone", a.bones, "NAME=FILE", "Surfaces", "Surface of a bone; give two or more");
  add_repeated(*c, "--cartilage", a.cartilages, "NAME=FILE", "Surfaces",
               "Segmented outer surface of a bone's cartilage");
  add_repeated(*c, "--uniform", a.uniform, "NAME=T", "Surfaces", "Cartilage of one thickness");
  add_once(*c, "--half-gap", a.half_gap, "max=A,min=B", "Surfaces", "Cartilage of half the gap between the bones");
  add_repeated(*c, "--thickness-at", a.thickness_at, "NAME=FILE", "Surfaces",
               "Cartilage thickness at points: x, y, z, thickness");
  add_once(*c, "--units", a.units, "mm|cm|m", "Surfaces", "Units of the files [mm, if the size fits]");
  add_once(*c, "--scale", a.scale, "FACTOR", "Surfaces", "Factor from the files' coordinates to mm");
  add_once(*c, "--mirror", a.mirror, "x=0,y=0", "Surfaces",
           "The files have one side of these planes of symmetry: add the other and build the whole joint");
  add_repeated(
      *c, "--region", a.regions, "NAME=FILE|sphere:x,y,z,r|plane:x,y,z,nx,ny,nz", "Regions",
      "Where the cartilage is: near a surface or in a sphere. A plane trims what was found to the side of its normal. "
      "sphere:frame:NAME,x,y,z,r and plane:frame:NAME,... count from a frame's origin along its axes");
  add_once(*c, "--reach", a.reach, "LENGTH", "Regions",
           "Cartilage is where bones face each other within this distance [3 times the thickest layer]");
  add_once(*c, "--rim", a.rim, "LENGTH", "Regions", "Length over which rims and thicknesses are smoothed [2 mm]");
  add_once(
      *c, "--fade", a.fade, "WIDTH", "Regions",
      "Width over which layers thin out before their rims, also segmented ones; 0: they end thick [half gap: as --rim; "
      "others: 0]");
  c->add_flag("--keep-holes", a.keep_holes, "Do not fill holes in a region, such as the acetabular fossa")
      ->group("Regions");
  add_once(*c, "--edge", a.edge, "LENGTH", "Mesh",
           "Remesh to triangles with edges of about this length [triangles stay]");
  add_once(*c, "--layers", a.layers, "N", "Mesh", "Elements between bone and articular surface [2]");
  add_once(*c, "--least", a.least, "T", "Mesh", "Least thickness of segmented cartilage [a tenth of its mean]");
  add_once(*c, "--bones", a.bone_shells, "shell|none|N", "Mesh",
           "Bones as rigid shells: whole, simplified to N triangles, or none but what bears the cartilage [shell]");
  add_repeated(
      *c, "--force", a.forces, "BODY=[frame:NAME,]x,y,z", "Model",
      "Force on a bone in the last step, along a frame's axes if one is named; bones without a force are held");
  add_once(*c, "--loads", a.loads, "BODY=FILE", "Model",
           "Forces on a bone from a table, row by row, as dea run --loads reads it");
  add_once(*c, "--load-columns", a.load_columns, "FX,FY,FZ", "Model", "Columns of the table [found by name]");
  add_once(*c, "--load-units", a.load_units, "FORCE-LENGTH", "Model", "Units of the table [N-mm; OpenSim's: N-m]");
  add_once(*c, "--body-weight", a.body_weight, "FORCE", "Model", "The table is in % of this body weight");
  add_repeated(*c, "--hold", a.holds, "BODY=x,y", "Model", "Directions in which a bone with a force is held");
  add_repeated(*c, "--center", a.centers, "BODY=x,y,z", "Model",
               "Centre of a bone, where its force acts [a ball's: that of its sphere]");
  add_repeated(*c, "--landmarks", a.landmarks, "FILE", "Anatomy",
               "Named points (CSV: name, x, y, z; Slicer's .csv, .fcsv, .mrk.json) that give frames of pelvis, femur "
               "and tibia; forces and regions may then be given along their axes: frame:pelvis,x,y,z");
  add_once(*c, "--landmark-units", a.landmark_units, "mm|cm|m", "Anatomy", "Units of the landmarks [the bones']");
  c->add_flag("--flip-landmarks", a.flip_landmarks,
              "Change the sign of x and y of the landmarks: they are RAS and the bones LPS, or the other way round")
      ->group("Anatomy");
  add_once(*c, "--side", a.side, "left|right", "Anatomy",
           "Side of the body [from the landmarks, else from where the hip's socket opens to]");
  add_once(*c, "--scan-axes", a.scan_axes, "LPS|RAS", "Anatomy",
           "Axes of the bones if there are no landmarks of the pelvis [those in which the socket opens to its side and "
           "forwards]");
  add_once(*c, "--hip", a.hip, "SOCKET,HEAD|none", "Anatomy",
           "Bones of a hip whose spheres, rim and angles to measure [two that are a ball in a socket]");
  add_once(*c, "--E", a.E, "MODULUS", "Model", "Young's modulus of the cartilage [11.85 MPa]");
  add_once(*c, "--nu", a.nu, "RATIO", "Model", "Poisson's ratio of the cartilage [0.45]");
  add_once(*c, "--penalty", a.penalty, "FACTOR", "Model", "Penalty of FEBio's contact [20]");
  add_once(*c, "--primary", a.primary, "BODY", "Model",
           "Body whose surfaces are primary [the smaller of each contact]");
  add_once(*c, "-o", a.output, "FILE.feb", "Output", "The model; must be given");
  add_once(*c, "--json", a.json, "FILE|-", "Output", "Also write JSON, \"-\" to standard output instead of the table");
  add_once(*c, "--report", a.report, "FILE.html", "Output",
           "Also write a page for any browser: bones and cartilage, gaps, elements, what was inferred");
  add_once(*c, "--frames", a.frames, "FILE.xml", "Output",
           "Also write the frames as a settings file for dea run and dea study: --settings FILE.xml");
  add_once(*c, "--hip-figure", a.hip_figure, "FILE.svg|png|pdf", "Output", "Also draw what was measured in the hip");
  add_model_overwrite_flag(*c, a.overwrite, "one that dea build made");
  add_quiet_flag(*c, a.quiet);
  add_once(*c, "--threads", a.threads, "N", "Output", "Number of threads [all cores]");
  return c;
}

int build(const BuildArguments& a) {
  const auto threads = limit_threads(a.threads);
  if (a.output.empty()) throw UsageError("-o is missing, expected the name of the model, -o joint.feb");
  const PictureFormat figure_format =
      a.hip_figure.empty() ? PictureFormat::Svg : picture_format("--hip-figure", a.hip_figure);
  if (a.output == "-") throw UsageError("-o -: the table goes to standard output, give the model a name");
  BuildInputs inputs = build_inputs(a);
  require_page_name("--report", a.report);
  std::vector<NamedPath> outputs = {{"-o", a.output}};
  if (!a.json.empty()) outputs.push_back({"--json", a.json});
  if (!a.report.empty()) outputs.push_back({"--report", a.report});
  if (!a.frames.empty()) outputs.push_back({"--frames", a.frames});
  if (!a.hip_figure.empty()) outputs.push_back({"--hip-figure", a.hip_figure});
  const HeldOutputs held = claim_outputs(inputs.files, outputs);
  if (!a.overwrite) refuse_to_replace(a.output, why_kept_model(a.output, ModelOf::Build));
  Progress progress(progress_style(a.quiet, false));
  std::vector<std::string> questions;  // told before what may take long
  if (const std::string odd = modulus_question(inputs.model); !odd.empty()) {
    questions.push_back(odd);
    log("warning: " + odd);
  }
  progress.now("reading surfaces", "", "reading surfaces");
  BuildReport report;
  report.findings = read_loads(inputs);
  for (std::string& finding : read_surfaces(inputs)) report.findings.push_back(std::move(finding));
  progress.now("anatomy", "", "frames and measures");
  turn_open_bones(inputs.request, report);
  const Anatomy anatomy = find_anatomy(inputs.request.bones, inputs.anatomy);
  leave_frames(inputs.request, anatomy);
  tell_held_forces(inputs.request, report.findings);
  if (!a.hip_figure.empty() && !anatomy.hip)
    throw InputError(
        fmt::format("--hip-figure {}: found nothing measured of a hip, expected a ball in a socket that opens sideways",
                    a.hip_figure));
  report.findings.insert(report.findings.end(), anatomy.findings.begin(), anatomy.findings.end());
  progress.now("cartilage", "", "cartilage and its mesh");
  const BuiltJoint joint = build_joint(inputs.request, report);

  inputs.model.elements_through = inputs.request.elements_through;
  inputs.model.comment = fmt::format("{} of {} surfaces.", kBuiltMark, inputs.files.size());
  for (const std::string& question : load_questions(joint, report)) {
    questions.push_back(question);
    log("warning: " + question);
  }
  const std::vector<BuildBalance> balances = find_balances(joint_feb(joint, inputs.model), joint, progress);
  if (balances.front().found) inputs.model.seat = balances.front().displacement;
  progress.now("writing " + file_name(a.output), "", "writing " + file_name(a.output));
  write_text(a.output, joint_feb(joint, inputs.model));
  if (!a.frames.empty()) write_text(a.frames, frames_as_settings(anatomy.frames));
  if (!a.hip_figure.empty()) write_text(a.hip_figure, hip_picture(*anatomy.hip, figure_format));
  const BuildSummary summary{a.output, joint, report, inputs.model, balances, inputs.load_times, anatomy};
  if (!a.report.empty()) {
    progress.now("writing " + file_name(a.report), "", "writing " + file_name(a.report));
    write_page(a, summary, inputs);
  }
  progress.clear();
  if (!a.quiet)
    for (const std::string& finding : report.findings) log("note: " + finding);
  if (!a.json.empty()) write_text(a.json, json_text(build_json(summary)));
  if (!a.quiet && a.json != "-") print(build_text(summary));
  for (const std::string& warning : build_warnings(summary))
    if (std::find(questions.begin(), questions.end(), warning) == questions.end()) log("warning: " + warning);
  return all_balanced(summary) ? kSolved : kNoSolution;
}

}  // namespace dea
