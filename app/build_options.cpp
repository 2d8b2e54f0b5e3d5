// The options of `dea build`, for --help, manual pages and completion; the program dea-build does the work.
#include "app/commands.h"

namespace dea {

namespace {

constexpr const char* kBuildFooter = R"(
Bones and cartilage are triangle surfaces in one coordinate system: STL, OBJ, PLY, VTK (polydata), VTP. NAME is your name for
the bone. The cartilage of a bone is one of
  --cartilage NAME=FILE   its segmented outer surface; the thickness is measured down to the bone
  --uniform NAME=T        one thickness, where the bone faces another
  --half-gap max=2,min=0.5  half the gap between the bones, within these bounds, for all bones without another option
  --thickness-at NAME=FILE  a table with columns x, y, z, thickness; the nearest point counts
A bone with none of them is bare. --place puts a bone where it stands before anything is measured. The first step of the
model seats the loaded bones where dea finds them in balance; the second has the force, or the forces of a table row by row.
--free says in which motions a bone is free (Ru: the turn about x), --motion moves one bone, --ligaments joins them. dea run
solves the model, and so does FEBio; with --states 2:5 it shows four rows of a table without the states that seat the bones. Notes
on standard error say what dea inferred; docs/from_scans.md has more.

In frame:pelvis x points forwards, y up and z to the right of the body, for a left hip too.

Examples:
  dea build --bone pelvis=pelvis.stl --bone femur=femur.stl --half-gap max=2,min=0.5 --force femur=432,-262,1834 -o hip.feb
  dea build --bone socket=pelvis.stl --bone ball=femur.stl --uniform socket=2 --edge 1.5 --force ball=0,0,1000 -o joint.feb --report joint.html
  dea build --bone pelvis=pelvis.stl --bone femur=femur.stl --half-gap max=2,min=0.5 --landmarks landmarks.csv --force femur=frame:pelvis,250,1800,-400 --frames hip_frames.xml --hip-figure hip_figure.svg -o hip.feb
  dea build --bone pelvis=pelvis.stl --cartilage pelvis=acetabular_cartilage.stl --bone femur=femur.stl --cartilage femur=femoral_cartilage.stl --force femur=432,-262,1834 -o hip.feb
  dea build --bone pelvis=pelvis.stl --bone femur=femur.stl --uniform pelvis=2 --place femur=femur_pose.txt --free femur=x,z --force femur=432,-262,1834 -o placed.feb
  dea build --bone pelvis=pelvis.stl --bone femur=femur.stl --uniform pelvis=2 --place pelvis=bones.csv:1 --place-columns pelvis=pelvis_T --place-units pelvis=m --motion femur=moves.csv --motion-rotation zxy --motion-units deg-mm -o moved.feb
  dea build --bone femur=knee_femur.stl --cartilage femur=knee_femoral_cartilage.stl --bone tibia=knee_tibia.stl --cartilage tibia=knee_tibial_cartilage.stl --center femur=0,0,0 --motion femur=knee_flexion.csv --motion-rotation zxy --motion-units deg-mm --ligaments knee_ligaments.csv --force tibia=0,0,700 -o made_knee.feb)";

// Of a table of poses, whose rows move a bone or place one.
constexpr const char* kPoseRotation =
    "Its rotations: a rotation vector, or the sequence of three angles; must be given if it has any";
constexpr const char* kPoseUnits =
    "Its units: deg-mm, rad-m; of matrices m; must be given if it has rotations by angles [mm; OpenSim's: m]";

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
  add_repeated(*c, "--place", a.places, "NAME=FILE|FILE:ROW|x,y,z|16 numbers", "Surfaces",
               "Where a bone stands, with all that its files give: a 4x4 matrix as text, Slicer's linear transform "
               "(.tfm), a row of a table of poses, a translation, or a matrix row by row; inverse:FILE: the other way "
               "round [as in its file]");
  add_repeated(*c, "--place-columns", a.place_columns, "NAME=TX,TY,TZ,RX,RY,RZ|NAME_T[,OTHER_T]", "Surfaces",
               "Columns of the table of --place NAME=FILE:ROW; NAME_T: of 4x4 matrices [found by name]");
  add_repeated(*c, "--place-rotation", a.place_rotations, "NAME=vector|zxy", "Surfaces", kPoseRotation);
  add_repeated(*c, "--place-units", a.place_units, "NAME=ANGLE-LENGTH|LENGTH", "Surfaces", kPoseUnits);
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
  add_repeated(*c, "--free", a.frees, "BODY=x,y,z,Ru,Rv,Rw", "Model",
               "Motions of a bone to solve for, as dea run --free (\"none\": no motion); all others are held [a ball: "
               "x,y,z; two compartments and ligaments: all but flexion; a bone without a force: none]");
  add_repeated(*c, "--hold", a.holds, "BODY=x,y", "Model",
               "Motions in which a bone is held, of those that dea would leave free");
  add_repeated(*c, "--motion", a.motions, "BODY=FILE", "Model",
               "Poses of one bone from a table, row by row, as dea run --motion reads it: from where it stands, about "
               "its centre; once: a second bone is free (--free), loaded (--force, --loads) or held");
  add_once(*c, "--motion-columns", a.motion_columns, "TX,TY,TZ,RX,RY,RZ|NAME_T[,OTHER_T]", "Model",
           "Columns of the table; NAME_T: of 4x4 matrices, NAME_T,OTHER_T: relative to another bone's [found by name]");
  add_once(*c, "--motion-rotation", a.motion_rotation, "vector|zxy", "Model", kPoseRotation);
  add_once(*c, "--motion-units", a.motion_units, "ANGLE-LENGTH", "Model", kPoseUnits);
  add_once(*c, "--motion-start", a.motion_start, "own-frame|TIME[,ground]", "Model",
           "Of matrices: where the bone's files have it, as dea run --motion-start [own-frame]");
  add_once(*c, "--ligaments", a.ligaments, "FILE.csv", "Model",
           "Ligaments: name, body_a, x_a, y_a, z_a, body_b, x_b, y_b, z_b, stiffness [N per strain], slack_length or "
           "reference_strain; curve (blankevoort or linear), toe_strain [blankevoort, 0.06]");
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
           "forwards]; with --place NAME=FILE.tfm [LPS]");
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
  add_overwrite_flag(*c, a.overwrite);
  add_quiet_flag(*c, a.quiet);
  add_once(*c, "--threads", a.threads, "N", "Output", "Number of threads [all cores]");
  return c;
}

}  // namespace dea
