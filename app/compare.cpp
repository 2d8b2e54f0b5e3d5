// `dea compare`: results of the same joint side by side.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/commands.h"
#include "app/progress.h"
#include "io/files/output.h"
#include "io/results/existing_file.h"
#include "src/base/error.h"
#include "src/base/parse.h"
#include "views/compare/compare_files.h"
#include "views/data/compare_json.h"
#include "views/page/write_page.h"
#include "views/text/compare_text.h"

namespace dea {

namespace {

constexpr const char* kCompareFooter = R"(
The LAST file is the reference, usually FEBio's result: differences are (FILE - LAST) / LAST. Files may be dea's or FEBio's,
compressed or not. Nothing is solved. Exit code 1: a compared state is no solution (a warning names it).

Compared is the `contact pressure` per facet of every file, in the reference configuration. "nodes" are area-weighted
averages of the facets around each node; the area of a node is a quarter of each quad around it and a third of each triangle.
Single facets of finite elements are noisy: trust the averages.

p99, mean, area and peak have one definition for every result, that of `dea run`: of what is above 5 % of the load's mean
pressure (the sum of p^2 A over the sum of p A, of the whole surface). Area and mean are those within the edge of contact, which
runs through facets: in each facet there pressure falls linearly to 0, as the facets around it say, and the facet keeps its
force. p99 and peak are of nodes, weighted by area. --details adds peak, mean, median and percentiles of nodes and of facets,
area-weighted, over places with p > 0 or above a --threshold. "resultant" is |sum of p A n|.

Correlation (Pearson), rms, mean and largest difference are of nodes where either pressure is above 0, area-weighted. Dice is
twice the common contact area over the sum of both areas. If meshes differ, nodal values are carried to the reference's nodes
from the closest point, with linear interpolation. JSON also has facet_correlation (same mesh only: all facets, also those
without pressure, each counted once) and p99_unweighted (every node or facet counts once).

Areas are those of the mesh. With --areas deformed they are those of the facets with the nodes moved by the file's own
displacement in the compared state (also in sums over time). dea's pressure is force per area of the mesh, so its files keep
those. The pressure of FEBio's sliding-elastic contact is per deformed area: its contact force is the sum of p A n with deformed
areas only. sliding-facet-on-facet and sliding-node-on-facet integrate over the reference areas. "resultant, % of it" and notes
say which areas fit a file, and if an interpolated map does not carry all of its contact force.

A penalty contact gives way by gap / pressure, like one more spring in series. If a file has both, this is printed per surface,
with the --interface-stiffness that makes `dea run` give way as much.

Exposure is the integral of p dt, dose that of max(0, p - P) dt with P of --dose-above, from a file's first state to the
compared one. In static models t is the time of the steps. Between files with different states these agree only as closely as
the states lie in time.

Examples:
  dea compare hip_dea.xplt hip.xplt
  dea compare articular.xplt bone.xplt hip.xplt --label articular --label bone --label FEBio --json hip.json
  dea compare layer.xplt linear.xplt fea.xplt --report maps.html
  dea compare hip_dea.xplt hip.xplt --areas deformed --json -
  dea compare a.xplt b.xplt --surface "socket=acetabulum" --at 1 -o both.xplt
  dea compare hip_dea.xplt hip.xplt --regions anterior-superior-posterior --up 0,0,1 --anterior 0,1,0 --csv - > thirds.csv
  dea compare ball_dea.xplt ball.xplt --profile --axis 0,0,1 --center 0,0,0 --bin 2)";

constexpr const char* kLayouts = "socket|anterior-superior-posterior|sectors=N";

CompareOptions compare_options(const CompareArguments& a) {
  CompareOptions o;
  if (!a.at.empty()) o.at = number_argument("at", a.at);
  if (!a.areas.empty() && a.areas != "reference" && a.areas != "deformed")
    throw wrong_word("areas", a.areas, "reference or deformed", {"reference", "deformed"});
  if (a.areas == "deformed") o.areas = CompareAreas::Deformed;
  o.surfaces = a.surfaces;
  if (!a.thresholds.empty()) o.thresholds.clear();
  for (const std::string& text : a.thresholds) {
    const double t = number_argument("threshold", text);
    if (!(t > 0)) throw wrong_word("threshold", text, "a pressure above 0 (0 is always there)");
    if (std::find(o.thresholds.begin(), o.thresholds.end(), t) == o.thresholds.end()) o.thresholds.push_back(t);
  }
  std::sort(o.thresholds.begin(), o.thresholds.end());
  for (const std::string& list : a.regions) {
    for (const std::string& name : split(list, ',')) {
      if (name.empty()) throw UsageError(fmt::format("--regions {}: found an empty name", list));
      const bool before = o.layout.any();
      if (!read_region_layout(name, o.layout))
        o.regions.push_back(name);
      else if (before)
        throw UsageError(fmt::format("--regions {}: found two of {}, expected one", list, kLayouts));
    }
  }
  const bool up = !a.up.empty(), anterior = !a.anterior.empty();
  if (o.layout.any() ? !up || (o.layout.needs_anterior() && !anterior) : up || anterior)
    throw UsageError(fmt::format(
        "--regions {}, --up x,y,z and --anterior x,y,z go together (sectors=N needs --up alone)", kLayouts));
  if (up) o.up = direction_argument("up", a.up);
  if (anterior) o.anterior = direction_argument("anterior", a.anterior);
  if (!a.dose_above.empty()) o.dose_above = number_argument("dose-above", a.dose_above);
  o.profile = a.profile;
  if (!a.axis.empty()) o.axis = direction_argument("axis", a.axis);
  if (!a.center.empty()) o.center = vector_argument("center", a.center);
  if (!o.profile && !o.layout.any() && (o.axis || o.center))
    throw UsageError(fmt::format("--axis and --center belong to --profile or --regions {}", kLayouts));
  if (!a.bin.empty()) {
    if (!o.profile) throw UsageError("--bin belongs to --profile");
    o.bin = number_argument("bin", a.bin);
    if (!(o.bin >= 0.1 && o.bin <= 180)) throw wrong_word("bin", a.bin, "degrees from 0.1 to 180");
  }
  return o;
}

/// One per file, all different. Field names have room for 63 bytes.
std::vector<std::string> make_labels(const CompareArguments& a) {
  constexpr std::size_t kLongest = 40;
  if (!a.labels.empty() && a.labels.size() != a.files.size())
    throw UsageError(
        fmt::format("--label: found {} labels, expected one per file ({})", a.labels.size(), a.files.size()));
  std::vector<std::string> labels;
  for (std::size_t i = 0; i < a.files.size(); ++i) {
    std::string label = a.labels.empty() ? std::filesystem::path(a.files[i]).stem().string() : a.labels[i];
    if (!a.labels.empty() && (label.empty() || label.size() > kLongest))
      throw UsageError(fmt::format("--label {}: found {} bytes, expected 1 to {}", label, label.size(), kLongest));
    if (!a.labels.empty() && std::find(labels.begin(), labels.end(), label) != labels.end())
      throw UsageError(fmt::format("--label {}: given twice", label));
    label = label.substr(0, kLongest);
    for (int n = 2; std::find(labels.begin(), labels.end(), label) != labels.end(); ++n) {
      const std::string number = fmt::format(" {}", n);
      label = std::filesystem::path(a.files[i]).stem().string().substr(0, kLongest - number.size()) + number;
    }
    labels.push_back(label);
  }
  return labels;
}

}  // namespace

CLI::App* add_compare(CLI::App& app, CompareArguments& a) {
  CLI::App* c = app.add_subcommand("compare", "Compare plot files: dea with FEBio, one setting with another");
  c->footer(kCompareFooter);
  c->add_option("FILES", a.files, "Plot files (.xplt), two or more; the last is the reference")
      ->required()
      ->type_name("");
  add_repeated(*c, "--label", a.labels, "NAME", "Comparison",
               "Name of a file in tables and fields, once per file in their order [file names]");
  add_repeated(
      *c, "--surface", a.surfaces, "NAME|A=B", "Comparison",
      "Compare only this surface; A=B if its name differs between the files; may be repeated [surfaces that all files "
      "have, with pressure in at least one]");
  add_once(*c, "--at", a.at, "TIME", "Comparison", "Compare the states at this time [the last state of each file]");
  add_repeated(
      *c, "--threshold", a.thresholds, "PRESSURE", "Comparison",
      "Pressure above which Dice and, in --details, JSON and CSV, all numbers are given too; may be repeated [0.1 and "
      "0.5]");
  add_once(*c, "--areas", a.areas, "reference|deformed", "Comparison",
           "Facet areas of the mesh, or with the nodes moved by each file's own displacement [reference]");
  add_once(*c, "--dose-above", a.dose_above, "PRESSURE", "Comparison",
           "Also the dose: what exceeds this pressure, integrated over time");
  add_repeated(
      *c, "--regions", a.regions, "NAME,NAME", "Regions and profiles",
      "The same numbers for facet sets, surfaces or element sets of the files; or for anterior-superior-posterior: the "
      "thirds of a socket (Abraham et al. 2013), socket: their inner and outer halves, with --up and --anterior; or "
      "sectors=N about its axis, with --up; may be repeated");
  add_once(*c, "--up", a.up, "x,y,z", "Regions and profiles", "Direction to the top of the socket");
  add_once(*c, "--anterior", a.anterior, "x,y,z", "Regions and profiles", "Direction to the front of the socket");
  c->add_flag("--profile", a.profile, "Mean pressure against the angle from an axis")->group("Regions and profiles");
  add_once(*c, "--axis", a.axis, "x,y,z", "Regions and profiles",
           "Axis of such regions and of the profile [mean normal of the reference's surface]");
  add_once(*c, "--center", a.center, "x,y,z", "Regions and profiles",
           "Centre of such regions and of the profile [that of the reference surface's sphere]");
  add_once(*c, "--bin", a.bin, "DEGREES", "Regions and profiles", "Width of the profile's bins [5]");
  add_once(
      *c, "-o", a.output, "both.xplt", "Output",
      "Plot file with all pressures and their differences on the first file's mesh, at the times that all files have");
  add_once(*c, "--report", a.report, "FILE.html", "Output",
           "Also write a page for any browser: maps side by side, differences, box plots, scatter, curves, tables");
  c->add_flag("--time-fields", a.time_fields, "In -o also peak, exposure and dose up to each state")->group("Output");
  add_compress_flag(*c, a.compress);
  add_overwrite_flag(*c, a.overwrite);
  add_once(*c, "--json", a.json, "FILE|-", "Output", "Also write JSON, \"-\" to standard output instead of the table");
  add_once(*c, "--csv", a.csv, "FILE|-", "Output",
           "Also write CSV, a line per surface, region and file, \"-\" to standard output instead of the table");
  add_quiet_flag(*c, a.quiet);
  c->add_flag("--details", a.details, "Print more numbers of every surface and region, with their full names")
      ->group("Output");
  return c;
}

int compare_command(const CompareArguments& a) {
  if (a.files.size() < 2)
    throw UsageError(fmt::format(
        "compare {}: found one file, expected two or more, the last to compare the others with", a.files.front()));
  const CompareOptions options = compare_options(a);
  const std::vector<std::string> labels = make_labels(a);
  std::vector<NamedPath> inputs;
  for (const std::string& file : a.files) inputs.push_back({file, file});
  require_file("-o", a.output);
  if (a.output.empty() && (a.time_fields || a.compress))
    throw UsageError(fmt::format("--{} belongs to -o", a.time_fields ? "time-fields" : "compress"));
  require_page_name("--report", a.report);

  std::vector<ResultFile> files;
  Progress progress(progress_style(a.quiet, false));
  for (std::size_t i = 0; i < a.files.size(); ++i) {
    progress.now("reading " + file_name(a.files[i]), "", "", i, a.files.size());
    files.push_back(read_result(a.files[i], labels[i]));
    progress.step(fmt::format("{} of {} files read", i + 1, a.files.size()), "", i + 1, a.files.size());
  }
  const std::vector<NamedPath> others = {{"--json", a.json}, {"--csv", a.csv}, {"--report", a.report}};
  std::vector<NamedPath> outputs = others;
  outputs.insert(outputs.begin(), {"-o", a.output});
  const HeldOutputs held = claim_outputs(inputs, outputs);
  if (!a.overwrite) {
    refuse_to_replace("-o", a.output, why_kept(a.output, PlotKind::Comparison));
    refuse_to_replace(others);
  }
  progress.now("comparing", "", "");
  const Comparison comparison = compare_files(files, options);
  progress.now("writing", "", "");
  if (!a.output.empty()) write_xplt(a.output, make_compare_file(files, options, comparison, a.time_fields, a.compress));
  if (!a.json.empty()) write_text(a.json, json_text(compare_json(comparison)));
  if (!a.csv.empty()) write_text(a.csv, compare_csv(comparison));
  if (!a.report.empty()) write_text(a.report, page_html(compare_page(files, options, comparison, a.words)));
  progress.clear();
  const bool all_solved =
      std::all_of(comparison.solved.begin(), comparison.solved.end(), [](char solved) { return solved != 0; });
  for (const std::string& line : a.quiet ? no_solution_warnings(comparison.warnings) : comparison.warnings) log(line);
  if (!a.quiet && a.json != "-" && a.csv != "-") print(compare_text(comparison, a.details));
  return all_solved ? kSolved : kNoSolution;
}

}  // namespace dea
