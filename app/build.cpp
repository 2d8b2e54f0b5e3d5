// `dea build`: bones' and cartilages' surfaces become a joint model.
#include <fmt/format.h>

#include <stdlib.h>
#include <unistd.h>
#include <algorithm>

#include <cmath>
#include <filesystem>
#include <map>

#include <febiodea/app/build_request.h>
#include <febiodea/app/commands.h>
#include <febiodea/app/interrupt.h>
#include <febiodea/app/progress.h>
#include <febiodea/base/error.h>
#include <febiodea/io/build/joint_feb.h>
#include <febiodea/io/build/landmarks.h>
#include <febiodea/io/feb/read_feb.h>
#include <febiodea/io/files/held_outputs.h>
#include <febiodea/io/files/output.h>
#include <febiodea/run/analysis.h>
#include <febiodea/views/data/build_json.h>
#include <febiodea/views/data/json.h>
#include <febiodea/views/map/hip_picture.h>
#include <febiodea/views/text/build_text.h>

namespace dea {

namespace {

constexpr const char* kBuildFooter = R"(
Bones and cartilage are triangle surfaces in one frame: STL, OBJ, PLY, VTK (polydata), VTP. NAME is the bone's, of your
choice. The cartilage of a bone is one of
  --cartilage NAME=FILE   its segmented outer surface; the thickness is measured down to the bone
  --uniform NAME=T        one thickness, where the bone faces another
  --half-gap max=2,min=0.5  half the gap between the bones, bounded, for all bones that have none of the others
  --thickness-at NAME=FILE  a table with columns x, y, z, thickness; the nearest point counts
A bone with none of them is bare. The model has a step that seats the loaded bones where dea finds them in balance, and
one with the force. dea run solves it, and so does FEBio. What is inferred is told on standard error; docs/from_scans.md
has more.

Examples:
  dea build --bone pelvis=pelvis.stl --bone femur=femur.stl --half-gap max=2,min=0.5 --force femur=432,-262,1834 -o hip.feb
  dea build --bone socket=pelvis.stl --bone ball=femur.stl --uniform socket=2 --edge 1.5 --force ball=0,0,1000 -o joint.feb
  dea build --bone pelvis=pelvis.stl --bone femur=femur.stl --half-gap max=2,min=0.5 --landmarks landmarks.csv --force femur=frame:pelvis,250,1800,-400 --frames hip_frames.xml --hip-figure hip_figure.svg -o hip.feb
  dea build --bone pelvis=pelvis.stl --cartilage pelvis=acetabular_cartilage.stl --bone femur=femur.stl --cartilage femur=femoral_cartilage.stl --force femur=432,-262,1834 -o hip.feb)";

/// The pose that balances the load, by dea itself.
struct Seat {
  bool found = false;
  std::string words;
  std::vector<Vector3d> displacement;  ///< per body
  Headline headline;
};

Seat find_seat(const std::string& text, const BuiltJoint& built, Progress& progress) {
  progress.now("balance", "", "balance of the load");
  std::string name = (std::filesystem::temp_directory_path() / "dea_build_XXXXXX").string();
  const int file = ::mkstemp(name.data());
  if (file < 0) throw WriteError(name + ": no temporary file");
  ::close(file);
  struct Removed {
    std::string path;
    ~Removed() {
      std::error_code error;
      std::filesystem::remove(path, error);
    }
  } removed{name};
  write_text(name, text);
  JointModel model = read_feb(name);
  const std::vector<TimePoint> times = model_times(model);
  AnalysisOptions options;
  options.times = {times.back()};
  options.equilibrium.stop = stop_flag();
  Seat seat;
  seat.displacement.assign(built.bodies.size(), Vector3d::Zero());
  try {
    const Analysis analysis = analyse(recognise(std::move(model)), options);
    const StateResult& state = analysis.states.back();
    seat.found = solved(state.equilibrium.outcome);
    seat.words = state.equilibrium.message;
    for (std::size_t b = 0; b < built.bodies.size(); ++b)
      for (std::size_t j = 0; j < analysis.joint.bodies.size(); ++j)
        if (analysis.joint.bodies[j].name == built.bodies[b].name)
          seat.displacement[b] = state.equilibrium.poses[j].center - built.bodies[b].center;
    if (!state.statistics.empty()) seat.headline = state.statistics.front().headline;
  } catch (const InputError& e) {
    seat.words = line(e.fault);
  }
  return seat;
}

}  // namespace

CLI::App* add_build(CLI::App& app, BuildArguments& a) {
  CLI::App* c = app.add_subcommand("build", "Make a joint model of bones' and cartilages' surfaces");
  c->footer(kBuildFooter);
  add_repeated(*c, "--bone", a.bones, "NAME=FILE", "Surfaces", "A bone's surface; twice or more");
  add_repeated(*c, "--cartilage", a.cartilages, "NAME=FILE", "Surfaces", "The outer surface of a bone's cartilage");
  add_repeated(*c, "--uniform", a.uniform, "NAME=T", "Surfaces", "Cartilage of one thickness");
  add_once(*c, "--half-gap", a.half_gap, "max=A,min=B", "Surfaces", "Cartilage of half the gap between the bones");
  add_repeated(*c, "--thickness-at", a.thickness_at, "NAME=FILE", "Surfaces",
               "Cartilage thickness at points: x, y, z, thickness");
  add_once(*c, "--units", a.units, "mm|cm|m", "Surfaces", "Units of the files [mm, if the size fits]");
  add_once(*c, "--scale", a.scale, "FACTOR", "Surfaces", "Coordinates are multiplied by it, to mm");
  add_repeated(*c, "--region", a.regions, "NAME=FILE|sphere:x,y,z,r|plane:x,y,z,nx,ny,nz", "Regions",
               "Where the cartilage is: near a surface, in a sphere; a plane trims what is found, its normal towards "
               "the cartilage; sphere:frame:NAME,x,y,z,r and the like count from a frame's origin along its axes");
  add_once(*c, "--reach", a.reach, "LENGTH", "Regions",
           "Bones that face each other within it bear cartilage [3 times the thickest layer]");
  add_once(*c, "--rim", a.rim, "LENGTH", "Regions", "Over which rims and thicknesses are smoothed [2 mm]");
  add_once(*c, "--fade", a.fade, "WIDTH", "Regions",
           "Layers made here thin out at their rims over it; 0: they end [half gap: 2 mm, others: 0]");
  c->add_flag("--keep-holes", a.keep_holes, "Holes in a region stay open, as the acetabular fossa")->group("Regions");
  add_once(*c, "--edge", a.edge, "LENGTH", "Mesh", "Remesh to triangles with edges near it [triangles stay]");
  add_once(*c, "--layers", a.layers, "N", "Mesh", "Elements between bone and articular surface [2]");
  add_once(*c, "--least", a.least, "T", "Mesh", "Least thickness of segmented cartilage [a tenth of its mean]");
  add_once(*c, "--bones", a.bone_shells, "shell|none|N", "Mesh",
           "Whole bones as rigid shells, of N triangles, or left out but for what bears the cartilage [shell]");
  add_repeated(*c, "--force", a.forces, "BODY=[frame:NAME,]x,y,z", "Model",
               "Force on a bone in the last step, along a frame's axes if one is named; all others are held");
  add_repeated(*c, "--center", a.centers, "BODY=x,y,z", "Model",
               "Centre of a bone, where its force acts [of a sphere, if it is a ball]");
  add_repeated(*c, "--landmarks", a.landmarks, "FILE", "Anatomy",
               "Points with names (CSV: name, x, y, z; Slicer's .csv, .fcsv) that give frames of pelvis, femur, tibia; "
               "numbers may be along their axes: frame:pelvis,x,y,z");
  c->add_flag("--flip-landmarks", a.flip_landmarks,
              "Turn over x and y of the landmarks: they are RAS and the bones LPS, or the other way round")
      ->group("Anatomy");
  add_once(*c, "--side", a.side, "left|right", "Anatomy",
           "Of the body [by the landmarks, else by where a hip's socket opens]");
  add_once(*c, "--scan-axes", a.scan_axes, "LPS|RAS", "Anatomy",
           "What x, y, z of the bones are where no landmarks of the pelvis say it [those in which the socket opens to "
           "the side, or forwards]");
  add_once(*c, "--hip", a.hip, "SOCKET,HEAD|none", "Anatomy",
           "Bones of a hip, whose spheres, rim and angles are measured [two that are a ball in a socket]");
  add_once(*c, "--E", a.E, "MODULUS", "Model", "Cartilage's modulus [11.85 MPa]");
  add_once(*c, "--nu", a.nu, "RATIO", "Model", "Cartilage's Poisson's ratio [0.45]");
  add_once(*c, "--penalty", a.penalty, "FACTOR", "Model", "Of FEBio's contact [20]");
  add_once(*c, "--primary", a.primary, "BODY", "Model", "Whose surfaces are primary [the smaller of each contact]");
  add_once(*c, "-o", a.output, "FILE.feb", "Output", "The model");
  add_once(*c, "--json", a.json, "FILE|-", "Output", "Also write JSON, \"-\" to standard output instead of the table");
  add_once(*c, "--frames", a.frames, "FILE.xml", "Output",
           "Also write the frames as a settings file for dea run and dea study: --settings FILE.xml");
  add_once(*c, "--hip-figure", a.hip_figure, "FILE.svg|png|pdf", "Output", "Also draw what was measured of a hip");
  add_quiet_flag(*c, a.quiet);
  add_once(*c, "--threads", a.threads, "N", "Output", "Threads [all cores]");
  return c;
}

int build(const BuildArguments& a) {
  const auto threads = limit_threads(a.threads);
  if (a.output.empty()) throw UsageError("-o is missing, expected the name of the model, -o joint.feb");
  const PictureFormat figure_format =
      a.hip_figure.empty() ? PictureFormat::Svg : picture_format("--hip-figure", a.hip_figure);
  if (a.output == "-") throw UsageError("-o -: the table goes to standard output, give the model a name");
  BuildInputs inputs = build_inputs(a);
  std::vector<NamedPath> outputs = {{"-o", a.output}};
  if (!a.json.empty()) outputs.push_back({"--json", a.json});
  if (!a.frames.empty()) outputs.push_back({"--frames", a.frames});
  if (!a.hip_figure.empty()) outputs.push_back({"--hip-figure", a.hip_figure});
  const HeldOutputs held = claim_outputs(inputs.files, outputs);
  Progress progress(progress_style(a.quiet, false));
  progress.now("reading surfaces", "", "reading surfaces");
  BuildReport report;
  report.findings = read_surfaces(a, inputs);
  progress.now("anatomy", "", "frames and measures");
  turn_open_bones(inputs.request, report);
  const Anatomy anatomy = find_anatomy(inputs.request.bones, inputs.anatomy);
  leave_frames(inputs.request, anatomy);
  if (!a.hip_figure.empty() && !anatomy.hip)
    throw InputError(
        fmt::format("--hip-figure {}: found nothing measured of a hip, expected a ball in a socket that opens sideways",
                    a.hip_figure));
  report.findings.insert(report.findings.end(), anatomy.findings.begin(), anatomy.findings.end());
  progress.now("cartilage", "", "cartilage and its mesh");
  const BuiltJoint joint = build_joint(inputs.request, report);

  inputs.model.elements_through = inputs.request.elements_through;
  inputs.model.comment = fmt::format("Made by dea build of {} surfaces.", inputs.files.size());
  const Seat seat = find_seat(joint_feb(joint, inputs.model), joint, progress);
  if (seat.found) inputs.model.seat = seat.displacement;
  progress.now("writing " + file_name(a.output), "", "writing " + file_name(a.output));
  write_text(a.output, joint_feb(joint, inputs.model));
  if (!a.frames.empty()) write_text(a.frames, frames_as_settings(anatomy.frames));
  if (!a.hip_figure.empty()) write_text(a.hip_figure, hip_picture(*anatomy.hip, figure_format));
  progress.clear();
  if (!a.quiet)
    for (const std::string& finding : report.findings) log("note: " + finding);
  const BuildSummary summary{a.output,          joint,         report, inputs.model, seat.found, seat.words,
                             seat.displacement, seat.headline, anatomy};
  if (!a.json.empty()) write_text(a.json, json_text(build_json(summary)));
  if (!a.quiet && a.json != "-") print(build_text(summary));
  if (!seat.found) log("warning: dea finds no balance under the force: " + seat.words);
  return seat.found ? kSolved : kNoSolution;
}

}  // namespace dea
