// app/main.cpp – the program `dea`: its commands.
#include <algorithm>

#include "app/command_line.h"
#include "app/commands.h"

namespace {

using namespace dea;

constexpr const char* kFooter = R"(
Exit codes: 0 solved; 1 not all results are solutions (not converged, surfaces apart): do not use those; 2 wrong use; 3 input refused; 4 output cannot be written; 70 a fault of the program, please report; 130 stopped by Ctrl-C
(143: by SIGTERM).

Examples:
  dea run hip.feb                    pressure in every state: a table, and hip_dea.xplt beside the model
  dea study hip.feb --vary "E: E={8|12}" -o moduli.db  thousands of cases into one file
  dea info hip.feb                   what is recognised in the model, without solving
  dea converge hip.feb               how many springs the result needs
  dea convert hip.feb                the same joint for FEBio with the plugin, as hip_dea.feb
  dea build --help                   a model from surfaces of bones and cartilage
  dea plugin-build /opt/febio        the plugin for the FEBio in this folder
  dea compare hip_dea.xplt hip.xplt  differences between dea's result and FEBio's
  dea plot hip_dea.xplt              its pressure map as hip_dea.png
  dea cite hip.feb                   a paragraph for the methods of a paper, with references
  dea run --help                     all options of a command
  dea man run | man -l -             the same as a manual page)";

/// "dea help" and "dea help run" as "dea --help" and "dea run --help".
std::vector<std::string> help_words(int argc, char** argv) {
  std::vector<std::string> words(argv, argv + argc);
  if (argc < 2 || words[1] != "help") return words;
  words.erase(words.begin() + 1);
  words.resize(std::min<std::size_t>(words.size(), 2));
  words.push_back("--help");
  return words;
}

int parse_and_run(const std::vector<std::string>& words) {
  CLI::App app(kAbout, "dea");
  app.footer(kFooter);
  app.set_version_flag("--version", version_text(), "Version, commit and libraries");
  app.require_subcommand(1);
  RunArguments run_arguments;
  StudyArguments study_arguments;
  InfoArguments info_arguments;
  ConvergeArguments converge_arguments;
  ConvertArguments convert_arguments;
  CompareArguments compare_arguments;
  PlotArguments plot_arguments;
  BuildArguments build_arguments;
  PluginBuildArguments plugin_build_arguments;
  FindingsListArguments findings_arguments;
  CiteArguments cite_arguments;
  ManArguments man_arguments;
  CompletionArguments completion_arguments;
  run_arguments.words = compare_arguments.words = study_arguments.words = words;
  const CLI::App* run_command = add_run(app, run_arguments);
  const CLI::App* study_app = add_study(app, study_arguments);
  const CLI::App* info_command = add_info(app, info_arguments);
  const CLI::App* converge_app = add_converge(app, converge_arguments);
  const CLI::App* convert_app = add_convert(app, convert_arguments);
  const CLI::App* compare_app = add_compare(app, compare_arguments);
  const CLI::App* plot_app = add_plot(app, plot_arguments);
  const CLI::App* build_app = add_build(app, build_arguments);
  const CLI::App* plugin_build_app = add_plugin_build(app, plugin_build_arguments);
  const CLI::App* cite_app = add_cite(app, cite_arguments);
  const CLI::App* findings_app = add_findings(app, findings_arguments);
  const CLI::App* man_app = add_man(app, man_arguments);
  const CLI::App* completion_app = add_completion(app, completion_arguments);

  if (const std::optional<int> code = parse(app, words)) return *code;
  if (run_command->parsed()) return run(run_arguments);
  if (study_app->parsed()) return study(study_arguments);
  if (info_command->parsed()) return info(info_arguments);
  if (converge_app->parsed()) return converge_command(converge_arguments);
  if (convert_app->parsed()) return convert(convert_arguments);
  if (compare_app->parsed()) return compare_command(compare_arguments);
  if (plot_app->parsed()) return plot_command(plot_arguments);
  if (build_app->parsed()) return start_build(words);
  if (plugin_build_app->parsed()) return plugin_build(plugin_build_arguments);
  if (cite_app->parsed()) return cite(cite_arguments);
  if (findings_app->parsed()) return list_findings(findings_arguments);
  if (man_app->parsed()) return man(app, man_arguments);
  if (completion_app->parsed()) return completion(app, completion_arguments);
  return kWrongUse;
}

}  // namespace

int main(int argc, char** argv) {
  return run_program([&] { return parse_and_run(with_joined_codes(help_words(argc, argv))); });
}
