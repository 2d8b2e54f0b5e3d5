// app/commands.h – the commands of the program: how each is spelled, and what it does.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "app/findings.h"
#include "app/options.h"

namespace dea {

/// Exit codes. UsageError, InputError and WriteError end as 2, 3 and 4 (main.cpp).
enum ExitCode { kSolved = 0, kNoSolution = 1, kWrongUse = 2, kInputRefused = 3, kCannotWrite = 4, kInternalError = 70 };

/// What --help begins with.
inline constexpr const char* kAbout =
    "Discrete element analysis of joint contact: FEBio model in, pressure on its surfaces out.";

struct RunArguments : ModelArguments {
  std::vector<std::string> words;  ///< the command line, for the page
  OutputSettings outputs;          ///< as typed
  std::string times_from;
  std::string live;  ///< page
  FindingsArguments findings;
  bool verbose = false, details = false, overwrite = false, compress = false;
};
CLI::App* add_run(CLI::App& app, RunArguments& arguments);
int run(const RunArguments& arguments);

struct StudyArguments {
  std::vector<std::string> words;  ///< the command line, for the page
  std::vector<std::string> files;  ///< models, or a study
  SettingsArguments settings;      ///< `values` and `order` have "vary" and "factor" too
  std::string cases, sample, count, seed, states, again, shard, output, csv, hdf5, threads;
  std::vector<std::string> keep;
  std::string report, subjects, group, pair, pair_by, regions, up, anterior, axis, center;
  std::string dose_above, cycles_per_year, years, cycle_seconds;
  bool merge = false, dry_run = false, overwrite = false, verbose = false;
  FindingsArguments findings;
};
CLI::App* add_study(CLI::App& app, StudyArguments& arguments);
int study(const StudyArguments& arguments);

struct InfoArguments : ModelArguments {
  std::string output, json;
  bool overwrite = false;
};
CLI::App* add_info(CLI::App& app, InfoArguments& arguments);
int info(const InfoArguments& arguments);

struct ConvergeArguments : ModelArguments {
  std::string target = "0.01", max_springs = "400000", json;
  bool overwrite = false, quiet = false, verbose = false;
};
CLI::App* add_converge(CLI::App& app, ConvergeArguments& arguments);
int converge_command(const ConvergeArguments& arguments);

struct ConvertArguments : ModelArguments {
  std::string output, linear_solver;
  bool overwrite = false, quiet = false;
};
CLI::App* add_convert(CLI::App& app, ConvertArguments& arguments);
int convert(const ConvertArguments& arguments);

struct BuildArguments {
  std::vector<std::string> words;  ///< the command line, for the page
  std::vector<std::string> bones, cartilages, uniform, thickness_at, regions, forces, centers, holds, landmarks;
  std::vector<std::string> places, place_columns, place_rotations, place_units, frees, motions;
  std::string half_gap, units, scale, reach, rim, fade, edge, layers, least, bone_shells, E, nu, penalty, primary;
  std::string side, scan_axes, hip, frames, hip_figure, landmark_units;
  std::string mirror, loads, load_columns, load_units, body_weight;
  std::string motion_columns, motion_rotation, motion_units, motion_start, ligaments;
  std::string output, json, report, threads;
  bool keep_holes = false, flip_landmarks = false, overwrite = false, quiet = false;
};
CLI::App* add_build(CLI::App& app, BuildArguments& arguments);
/// The command: in the program dea-build alone.
int build(const BuildArguments& arguments);
/// The same from dea: it becomes dea-build, and returns only where there is none.
int start_build(const BuildArguments& arguments);

struct PluginBuildArguments {
  std::string febio, output, threads;
  bool overwrite = false, untested = false, verbose = false;
};
CLI::App* add_plugin_build(CLI::App& app, PluginBuildArguments& arguments);
int plugin_build(const PluginBuildArguments& arguments);

struct CompareArguments {
  std::vector<std::string> words;  ///< the command line, for the page
  std::vector<std::string> files, labels, surfaces, thresholds, regions;
  std::string at, areas, dose_above, up, anterior, axis, center, bin;
  bool profile = false;
  std::string output, json, csv, report;
  bool time_fields = false, overwrite = false, compress = false, quiet = false, details = false;
};
CLI::App* add_compare(CLI::App& app, CompareArguments& arguments);
int compare_command(const CompareArguments& arguments);

struct PlotArguments {
  std::vector<std::string> files, surfaces, labels;
  std::string output, animate, fps, field, at, states, minus, view, up, anterior, side, contours, low, high, scale,
      title, width, dpi, columns, font_size, colour_map, text_as, units;
  bool smooth = false, dark = false, load = false, overwrite = false, quiet = false;
};
CLI::App* add_plot(CLI::App& app, PlotArguments& arguments);
int plot_command(const PlotArguments& arguments);

struct FindingsListArguments {
  std::string code;
};
CLI::App* add_findings(CLI::App& app, FindingsListArguments& arguments);
int list_findings(const FindingsListArguments& arguments);

struct SchemaArguments {
  std::string name;
};
CLI::App* add_schema(CLI::App& app, SchemaArguments& arguments);
int schema(const SchemaArguments& arguments);

struct CiteArguments : ModelArguments {
  std::string compared;
  bool bibtex = false;
};
CLI::App* add_cite(CLI::App& app, CiteArguments& arguments);
int cite(const CiteArguments& arguments);

struct ManArguments {
  const CLI::App* program = nullptr;  ///< with all its commands
  std::string command, output;
  bool overwrite = false;
};
CLI::App* add_man(CLI::App& app, ManArguments& arguments);
int man(const ManArguments& arguments);

struct CompletionArguments {
  const CLI::App* program = nullptr;  ///< with all its commands
  std::string shell;
};
CLI::App* add_completion(CLI::App& app, CompletionArguments& arguments);
int completion(const CompletionArguments& arguments);

/// Version, commit and libraries, a line each.
std::string version_text();

}  // namespace dea
