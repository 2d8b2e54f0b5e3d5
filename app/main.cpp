// app/main.cpp – the program `dea`: its commands.
#include <algorithm>
#include <functional>
#include <memory>

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
  app.allow_windows_style_options(false);  // "/models/hip.feb" is a file there too
  std::function<int()> chosen;
  const auto add = [&]<class Arguments>(CLI::App* (*options)(CLI::App&, Arguments&), int (*run)(const Arguments&)) {
    const auto arguments = std::make_shared<Arguments>();
    if constexpr (requires { arguments->words; }) arguments->words = words;
    options(app, *arguments)->callback([&chosen, run, arguments] {
      chosen = [run, arguments] { return run(*arguments); };
    });
  };
  add(add_run, run);
  add(add_study, study);
  add(add_info, info);
  add(add_converge, converge_command);
  add(add_convert, convert);
  add(add_compare, compare_command);
  add(add_plot, plot_command);
  add(add_build, start_build);
  add(add_plugin_build, plugin_build);
  add(add_cite, cite);
  add(add_findings, list_findings);
  add(add_schema, schema);
  add(add_man, man);
  add(add_completion, completion);

  const std::optional<int> code = parse(app, words);
  return code ? *code : chosen();
}

}  // namespace

int main(int argc, char** argv) {
  return run_program([&] { return parse_and_run(with_joined_codes(help_words(argc, argv))); });
}
