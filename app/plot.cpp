// `dea plot`: maps of pressure on paper.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "app/animation.h"
#include "app/commands.h"
#include "io/files/output.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"
#include "src/base/unit_names.h"
#include "views/map/draw_map.h"
#include "views/map/map_figure.h"

namespace dea {

namespace {

constexpr const char* kPlotFooter = R"(
Files may be dea's or FEBio's, compressed or not. Exit code 1: a state on the picture is no solution (a warning names it).
Facets are drawn as they are, in the reference configuration. All panels have
one scale, that of all states of the files, as on the page of --report; colours have 128 steps. Lines of equal value, and
--smooth, are of nodal averages (area-weighted, of the facets around each node). With --smooth the edge of contact encloses as
much area as the facets with pressure do. Numbers of pressure are those of `dea run` and `dea compare`: of what is
above 5 % of the load's mean pressure. Numbers of other fields and of differences are of facets, with --smooth of nodes. Grey is
no contact, or a value of exactly 0.

Sockets and flat surfaces are seen along their mean normal; balls, and surfaces whose pressure would be out of sight,
against the force on them. --view unrolled is for balls and sockets: Lambert's equal-area map about the axis of the fitted
sphere, seen from the joint, with circles of equal angle from the axis. Files lie side by side, further surfaces and states
below them; --columns 1 stacks all panels.

--animate shows the states (all of the first file, or those of --at or --states) one after the other, in one scale and view. A
GIF has exactly the map's colours, and plays again and again. MP4 needs the program ffmpeg. A folder gets frame-0001.png,
frame-0002.png and so on.

Examples:
  dea plot hip_dea.xplt
  dea plot hip_dea.xplt hip.xplt --label dea --label FEBio --surface acetabular_articulating -o both.svg
  dea plot hip_dea.xplt --at 1,1.5,2 --smooth --title "Walking" -o walking.pdf
  dea plot hip_dea.xplt --minus hip.xplt -o difference.png
  dea plot knee_dea.xplt --surface medial_plateau --surface lateral_plateau --up 0,1,0 -o knee.png
  dea plot hip_dea.xplt --field "joint space" --view unrolled --max 3 -o space.svg
  dea plot hip_dea.xplt --load --up 0,0,1 --anterior 0,1,0 --side left -o load.svg
  dea plot hip_dea.xplt --animate walking.gif --fps 4)";

double number_option(const char* option, const std::string& text, double least, double most) {
  const double x = number_argument(option, text);
  if (!(x >= least && x <= most))
    throw wrong_word(option, text, fmt::format("a number from {:g} to {:g}", least, most));
  return x;
}

Vector3d direction(const char* option, const std::string& text, const char* expected,
                   const std::vector<std::string>& words = {}) {
  Vector3d v = Vector3d::Zero();
  try {
    v = parse_vector(text);
  } catch (const BadValue&) {
  }
  if (!(v.norm() > 0) || !std::isfinite(v.norm())) throw wrong_word(option, text, expected, words);
  return v;
}

MapOptions map_options(const PlotArguments& a) {
  MapOptions o;
  if (!a.field.empty()) o.field = a.field;
  for (const std::string& name : a.surfaces)
    if (std::find(o.surfaces.begin(), o.surfaces.end(), name) == o.surfaces.end()) o.surfaces.push_back(name);
  if (!a.at.empty() && !a.states.empty()) throw UsageError("--at and --states: found both, expected one of them");
  if (!a.at.empty()) {
    o.states = a.at;
    o.states_option = fmt::format("--at {}", a.at);
  } else if (!a.states.empty()) {
    o.states = a.states;
    o.states_option = fmt::format("--states {}", a.states);
  }
  if (a.view == "unrolled")
    o.unrolled = true;
  else if (!a.view.empty())
    o.toward = direction("view", a.view, "a direction x,y,z, or unrolled", {"unrolled"});
  if (!a.up.empty()) o.up = direction("up", a.up, "a direction x,y,z that is not 0");
  o.load = a.load;
  if (a.anterior.empty() && !a.side.empty()) throw UsageError(fmt::format("--side {}: belongs to --anterior", a.side));
  if (!a.anterior.empty()) {
    if (a.up.empty()) throw UsageError("--anterior: needs --up x,y,z, the direction to the top of the body");
    o.body = {o.up, direction("anterior", a.anterior, "a direction x,y,z that is not 0"), a.side};
    if (!(o.up.normalized().cross(o.body.anterior.normalized()).norm() > 1e-3))
      throw UsageError("--anterior: is along --up, expected a direction across it");
    if (!a.side.empty() && a.side != "left" && a.side != "right")
      throw wrong_word("side", a.side, "left or right", {"left", "right"});
  }
  if (!a.animate.empty() && o.states_option.empty()) o.states = "all";
  o.smooth = a.smooth;
  o.labelled = !a.labels.empty();
  if (!a.low.empty()) o.low = number_argument("min", a.low);
  if (!a.high.empty()) o.high = number_argument("max", a.high);
  if (o.low && !a.minus.empty())
    throw UsageError("--min and --minus: found both; a difference's scale goes from -max to max");
  if (o.high && !a.minus.empty() && !(*o.high > 0)) throw wrong_word("max", a.high, "a difference above 0");
  if (o.high && !(*o.high > o.low.value_or(-1e300)))
    throw wrong_word("max", a.high, fmt::format("more than --min {}", a.low));
  if (!a.scale.empty() && a.scale != "all" && a.scale != "shown")
    throw wrong_word("scale", a.scale, "all or shown", {"all", "shown"});
  o.scale_of_shown = a.scale == "shown";
  if (!a.colour_map.empty()) {
    const std::vector<std::string> known = colour_map_names();
    o.colours = colour_map_named(a.colour_map);
    if (!o.colours) throw wrong_word("colour-map", a.colour_map, name_list(known, a.colour_map), known);
  }
  if (a.contours == "none") {
    o.contours = std::vector<double>{};
  } else if (!a.contours.empty()) {
    try {
      o.contours = parse_numbers(a.contours);
    } catch (const BadValue&) {
    }
    if (!o.contours || o.contours->empty())
      throw wrong_word("contours", a.contours, "none or values v1,v2,...", {"none"});
  }
  return o;
}

/// One per file, then that of --minus.
std::vector<std::string> labels(const PlotArguments& a) {
  if (a.labels.empty()) {
    std::vector<std::string> names;
    for (const std::string& file : a.files) names.push_back(std::filesystem::path(file).stem().string());
    if (!a.minus.empty()) names.push_back(std::filesystem::path(a.minus).stem().string());
    return names;
  }
  const std::size_t expected = a.files.size() + (a.minus.empty() ? 0 : 1);
  if (a.labels.size() != expected)
    throw UsageError(fmt::format("--label: found {} labels, expected one per file ({}{})", a.labels.size(), expected,
                                 a.minus.empty() ? "" : ", the last for --minus"));
  return a.labels;
}

/// --units names those of a file that names none.
void name_units(ResultFile& file, const std::string& units) {
  if (units.empty()) return;
  const std::vector<std::string> known = unit_systems();
  if (std::find(known.begin(), known.end(), units) == known.end())
    throw wrong_word("units", units, name_list(known), known);
  if (!file.xplt.units.empty() && file.xplt.units != units)
    throw UsageError(fmt::format("--units {}: {} is in {}; leave --units out", units, file.path, file.xplt.units));
  file.xplt.units = units;
}

/// A picture or an animation, each under its own option's name.
void refuse_mixed_outputs(const PlotArguments& a) {
  if (!a.animate.empty() && !a.output.empty())
    throw UsageError("-o and --animate: found both, expected one of them: a picture or an animation");
  if (a.animate.empty() && !a.fps.empty())
    throw UsageError(fmt::format("--fps {}: belongs to --animate FILE.gif", a.fps));
  const std::string extension = extension_of(a.output);
  if (extension == ".gif" || extension == ".mp4")
    throw UsageError(fmt::format("-o {}: is an animation's name, expected --animate {}", a.output, a.output));
}

PictureOptions picture_options(const PlotArguments& a, const std::string& output) {
  PictureOptions look;
  look.format = a.animate.empty() ? picture_format("-o", output) : PictureFormat::Png;
  look.dark = a.dark;
  if (!a.animate.empty()) look.dpi = 120;
  if (!a.width.empty()) look.width = number_option("width", a.width, 20, 2000);
  if (!a.columns.empty()) look.columns = count_argument("columns", a.columns, 1, 100);
  if (!a.dpi.empty()) look.dpi = number_option("dpi", a.dpi, 20, 2400);
  if (!a.font_size.empty()) look.font_size = number_option("font-size", a.font_size, 3, 100);
  if (!a.text_as.empty() && a.text_as != "shapes" && a.text_as != "text")
    throw wrong_word("text-as", a.text_as, "shapes or text", {"shapes", "text"});
  if (!a.text_as.empty() && look.format != PictureFormat::Svg)
    throw UsageError(
        fmt::format("--text-as {}: belongs to SVG, found {}; letters of a PDF are text", a.text_as, output));
  look.text = a.text_as == "text";
  if (!a.dpi.empty() && look.format != PictureFormat::Png)
    throw UsageError(fmt::format("--dpi {}: belongs to PNG; {} has no pixels", a.dpi, output));
  return look;
}

Drawn draw_picture(const std::vector<ResultFile>& files, const ResultFile* minus, const MapOptions& options,
                   const PictureOptions& look, const std::string& title, const std::string& path) {
  MapFigure figure = make_map_figure(files, minus, options);
  figure.title = title;
  write_text(path, picture(figure, look));
  const std::size_t panels = figure.panels.size();
  return {fmt::format("{} panel{}", panels, panels == 1 ? "" : "s"), figure.remarks, all_solved(figure)};
}

}  // namespace

CLI::App* add_plot(CLI::App& app, PlotArguments& a) {
  CLI::App* c = app.add_subcommand("plot", "Draw the pressure map of plot files: PNG, SVG or PDF");
  c->footer(kPlotFooter);
  c->add_option("FILES", a.files, "Plot files (.xplt), a panel each")->required()->type_name("");
  add_once(*c, "-o", a.output, draws_pixels() ? "FILE.png|svg|pdf" : "FILE.svg", "Output",
           fmt::format("Picture [the first file's name with {}, beside it]", picture_ending()).c_str());
  add_once(
      *c, "--animate", a.animate, "FILE.gif|FILE.mp4|FOLDER", "Output",
      "Instead of one picture, show the states one after the other: a GIF, an MP4 (by ffmpeg) or a folder of PNGs");
  add_once(*c, "--fps", a.fps, "N", "Output", "States per second of --animate [12]");
  add_overwrite_flag(*c, a.overwrite);
  add_quiet_flag(*c, a.quiet);
  add_repeated(*c, "--surface", a.surfaces, "NAME", "What",
               "Surface to draw; may be repeated [the one with springs, or else with the highest pressure]");
  add_once(*c, "--field", a.field, "NAME", "What", "Field of the surface [contact pressure]");
  add_once(*c, "--at", a.at, "TIME,TIME", "What",
           "States at these times, a panel each [the last state of each file; all for --animate]");
  add_once(*c, "--states", a.states, "all|last|t1,t2,...", "What", "The same, or all states");
  add_once(*c, "--minus", a.minus, "REF.xplt", "What", "Difference: the files' values minus those of this one");
  add_repeated(*c, "--label", a.labels, "NAME", "What",
               "Title of a file's panels, once per file in their order, then --minus [file names]");
  add_once(*c, "--units", a.units, "SYSTEM", "What",
           "The files' system of units, if they name none: FEBio's SI, mm-N-s, CGS, ...");
  add_once(*c, "--view", a.view, "x,y,z|unrolled", "View",
           "Direction from which the surface is seen, or unrolled [sockets: mean normal; balls: against the force]");
  add_once(*c, "--up", a.up, "x,y,z", "View", "What is up in the picture [z, or y if z is too nearly along the view]");
  add_once(
      *c, "--anterior", a.anterior, "x,y,z", "View",
      "Direction to the front of the body: names directions at the edges of maps; --up is then the top of the body");
  add_once(*c, "--side", a.side, "left|right", "View", "Side of the joint: medial and lateral are named too");
  c->add_flag("--load", a.load, "An arrow for the force that presses the surface, and its size")->group("Look");
  c->add_flag("--smooth", a.smooth, "Draw nodal averages instead of facets as they are")->group("Look");
  add_once(*c, "--contours", a.contours, "none|v1,v2,...", "Look",
           "Lines of equal value [at the colour bar's numbers]");
  add_once(*c, "--max", a.high, "VALUE", "Look",
           "Upper end of the colours [the largest value; joint space: the value that 95 % of the area is below]");
  add_once(*c, "--min", a.low, "VALUE", "Look", "Lower end of the colours [0; other fields also their least value]");
  add_once(*c, "--scale", a.scale, "all|shown", "Look",
           "The colours cover the values of all states of the files, or only of the states shown [all]");
  add_once(*c, "--title", a.title, "TEXT", "Look", "Title above all panels");
  add_once(*c, "--width", a.width, "MM", "Look",
           "Width on paper; letters keep their size [130 to 230, depending on the panels]");
  add_once(*c, "--columns", a.columns, "N", "Look", "Panels side by side [as many as there are files, or as fit]");
  add_once(*c, "--dpi", a.dpi, "DPI", "Look", "Pixels per inch of a PNG [200; 120 for --animate]");
  add_once(*c, "--font-size", a.font_size, "PT", "Look", "Size of letters on paper; lines and marks follow [11.25]");
  add_once(*c, "--colour-map", a.colour_map, "NAME", "Look",
           "dea, viridis, cividis or gray; for differences blue-white-red [dea]");
  add_once(*c, "--text-as", a.text_as, "shapes|text", "Look",
           "Letters of an SVG: shapes that look the same everywhere, or text that can be edited [shapes]");
  c->add_flag("--dark", a.dark, "Dark paper")->group("Look");
  return c;
}

int plot_command(const PlotArguments& a) {
  refuse_mixed_outputs(a);
  const MapOptions options = map_options(a);
  const std::vector<std::string> names = labels(a);
  std::string output = a.output;
  if (output == "-") throw UsageError("-o -: found no file name, expected one that ends in .png, .svg or .pdf");
  if (output.empty()) output = std::filesystem::path(a.files.front()).replace_extension(picture_ending()).string();
  const PictureOptions look = picture_options(a, output);
  Animation animation;
  if (!a.animate.empty()) {
    output = a.animate;
    animation = animation_asked(a.animate);
    if (!a.fps.empty()) animation.fps = number_option("fps", a.fps, 0.1, 50);
    if (!a.fps.empty() && animation.format == Animation::Format::Folder)
      throw UsageError(fmt::format("--fps {}: belongs to GIF and MP4; pictures in a folder have no time", a.fps));
  }
  std::vector<NamedPath> inputs;
  for (const std::string& file : a.files) inputs.push_back({file, file});
  if (!a.minus.empty()) inputs.push_back({"--minus", a.minus});

  std::vector<ResultFile> files, minus;
  for (std::size_t i = 0; i < a.files.size(); ++i) files.push_back(read_result(a.files[i], names[i]));
  if (!a.minus.empty()) minus.push_back(read_result(a.minus, names.back()));
  for (std::vector<ResultFile>* some : {&files, &minus})
    for (ResultFile& file : *some) name_units(file, a.units);
  const bool folder = !a.animate.empty() && animation.format == Animation::Format::Folder;
  const std::vector<NamedPath> outputs = {{a.animate.empty() ? "-o" : "--animate", output, folder}};
  const HeldOutputs held = claim_outputs(inputs, outputs);
  if (!a.overwrite) refuse_to_replace(outputs);
  const ResultFile* taken = minus.empty() ? nullptr : &minus.front();
  const Drawn drawn = a.animate.empty() ? draw_picture(files, taken, options, look, a.title, output)
                                        : animate(files, taken, options, look, a.title, animation, a.quiet);
  for (const std::string& remark : a.quiet ? no_solution_warnings(drawn.remarks) : drawn.remarks) log(remark);
  if (!a.quiet) log(fmt::format("{}: {}", output, drawn.what));
  return drawn.solved ? kSolved : kNoSolution;
}

}  // namespace dea
