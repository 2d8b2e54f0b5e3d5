// io/cli/main.cpp – the program `dea`: reads the command line, runs a command, turns faults into exit codes.
#include <fmt/format.h>

#include <csignal>
#include <exception>
#include <sstream>

#include "commands.h"
#include "error.h"
#include "output.h"

namespace {

using namespace dea;

constexpr const char* kFooter = R"(
Exit codes: 0 solved; 1 a valid answer that is no solution (not converged, surfaces apart); 2 wrong use; 3 input
refused; 4 output cannot be written; 70 a fault of the program.

Examples:
  dea run hip.feb                    pressure in every state, written beside the model as hip_dea.xplt
  dea info hip.feb                   what is recognised in the model, without solving
  dea converge hip.feb               how many springs the result needs
  dea convert hip.feb                the same joint for FEBio with the plugin, as hip_dea.feb
  dea plugin-build /opt/febio        the plugin for the FEBio that is installed there
  dea compare hip_dea.xplt hip.xplt  how far that is from FEBio's result
  dea run --help                     all options of a command)";

/// A fault is always one line, whatever names it quotes.
int refuse(const std::string& prefix, std::string what, int code) {
  for (char& c : what)
    if (c == '\n' || c == '\r') c = ' ';
  log(prefix + what);
  return code;
}

int parse_and_run(int argc, char** argv) {
  CLI::App app("Discrete element analysis of joint contact: FEBio model in, pressure on its surfaces out.", "dea");
  app.footer(kFooter);
  app.set_version_flag("--version", version_text(), "Version, commit and libraries");
  app.require_subcommand(1);
  RunArguments run_arguments;
  InfoArguments info_arguments;
  ConvergeArguments converge_arguments;
  ConvertArguments convert_arguments;
  CompareArguments compare_arguments;
  PluginBuildArguments plugin_build_arguments;
  run_arguments.words = compare_arguments.words = {argv, argv + argc};
  const CLI::App* run_command = add_run(app, run_arguments);
  const CLI::App* info_command = add_info(app, info_arguments);
  const CLI::App* converge_app = add_converge(app, converge_arguments);
  const CLI::App* convert_app = add_convert(app, convert_arguments);
  const CLI::App* compare_app = add_compare(app, compare_arguments);
  const CLI::App* plugin_build_app = add_plugin_build(app, plugin_build_arguments);
  for (CLI::App* command : app.get_subcommands(nullptr)) command->get_formatter()->column_width(38);

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {  // --help, --version
    std::ostringstream out;
    app.exit(e, out, out);
    print(out.str());
    return kSolved;
  } catch (const CLI::ParseError& e) {
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    const std::string command = chosen.empty() ? "dea" : "dea " + chosen.front()->get_name();
    return refuse(command + ": ", fmt::format("{} ({} --help lists the options)", e.what(), command), kWrongUse);
  }

  if (run_command->parsed()) return run(run_arguments);
  if (info_command->parsed()) return info(info_arguments);
  if (converge_app->parsed()) return converge_command(converge_arguments);
  if (convert_app->parsed()) return convert(convert_arguments);
  if (compare_app->parsed()) return compare_command(compare_arguments);
  if (plugin_build_app->parsed()) return plugin_build(plugin_build_arguments);
  return kWrongUse;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on file size then fails the write, like a full disk, and is reported
  try {
    return parse_and_run(argc, argv);
  } catch (const UsageError& e) {
    return refuse("dea: ", e.what(), kWrongUse);
  } catch (const InputError& e) {
    return refuse("", e.what(), kInputRefused);
  } catch (const WriteError& e) {
    return refuse("dea: cannot write ", e.what(), kCannotWrite);
  } catch (const std::exception& e) {
    return refuse("internal error: ", std::string(e.what()) + ", please report", kInternalError);
  } catch (...) {
    return refuse("internal error: ", "unknown, please report", kInternalError);
  }
}
