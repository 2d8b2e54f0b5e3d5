// `dea convert`: a model for FEBio with the plugin, whose contact is the spring bed.
#include <fmt/format.h>

#include "app/commands.h"
#include "io/convert/convert_feb.h"
#include "io/convert/linear_solver.h"
#include "io/feb/read_feb.h"
#include "io/files/output.h"
#include "io/results/existing_file.h"
#include "io/settings/settings_xml.h"
#include "io/tables/read_tables.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/rules/rules.h"

namespace dea {

namespace {

constexpr const char* kConvertFooter = R"(
Writes the same joint for FEBio with the FEBioDEA plugin: its contacts are of type dea, the spring bed of dea run, and the
cartilage is rigid with its bone. The contacts get the modulus and the thickness that dea finds. A model of version 4.0 is
edited, and all else in it stays byte for byte; an older one is written anew as 4.0. Standard output lists what changed.
docs/convert.md has more.

Options are those of dea run. A converted file cannot hold --springs-at bone, --free, --force, --load-at, --set, --skip-steps,
--interface-stiffness, --layer-terms and tables of loads and motion: they are refused.

Examples:
  dea convert hip.feb
  dea convert hip.feb -o hip_springs.feb --law neo-Hookean
  dea convert hip.feb --linear-solver skyline
  dea convert hip.feb --attach femoral_articulating=femur --thickness femoral_articulating=1.8
  dea run hip_dea.feb                the same pressures as dea run hip.feb)";

/// As FEBio spells it; "": none is asked for.
std::string linear_solver(const ConvertArguments& a) {
  if (a.linear_solver.empty()) return "";
  const std::vector<std::string> names = linear_solver_names();
  for (const std::string& name : names)
    if (lower_case(name) == lower_case(a.linear_solver)) return name;
  throw wrong_word("linear-solver", a.linear_solver, fmt::format("{}", fmt::join(names, ", ")), names);
}

}  // namespace

CLI::App* add_convert(CLI::App& app, ConvertArguments& a) {
  CLI::App* c = add_model_command(app, "convert", "Write a model of the same joint for FEBio with the FEBioDEA plugin",
                                  kConvertFooter, a);
  add_once(*c, "-o", a.output, "FILE.feb", "Output",
           "Converted model [MODEL without .feb + _dea.feb, beside the model]");
  add_once(
      *c, "--linear-solver", a.linear_solver, "NAME", "Output",
      fmt::format("FEBio's linear solver in the new model: {}; a FEBio without MKL has skyline [the model's; where "
                  "it names none, FEBio takes its default]",
                  fmt::join(linear_solver_names(), ", "))
          .c_str());
  add_overwrite_flag(*c, a.overwrite);
  add_quiet_flag(*c, a.quiet);
  add_solving_options(*c, a.settings, a.threads, {"squash", "inside"});
  return c;
}

int convert(const ConvertArguments& a) {
  const std::string output = a.output.empty() ? default_output(a.model, ".feb") : a.output;
  if (output == "-") throw UsageError("-o -: the list of changes goes to standard output, give the model a name");
  const std::string solver = linear_solver(a);
  const auto threads = limit_threads(a.threads);
  Settings settings = effective_settings(a.settings);
  std::vector<NamedPath> inputs = input_files(a, settings);
  JointModel model = read_feb(a.model);
  settle_units(model, settings);
  read_thickness(model, settings);
  for (std::size_t i = 1; i < model.files.size(); ++i) inputs.push_back({"a file of the model", model.files[i]});
  const HeldOutputs held = claim_outputs(inputs, {{"-o", output}});
  if (!a.overwrite) refuse_to_replace("-o", output, why_kept_model(output, ModelOf::Convert));

  const Conversion conversion = convert_feb(model, settings, output, solver);
  write_text(output, conversion.text);
  if (a.quiet) return kSolved;
  std::string text = output + "\n";
  const Wording wording = command_line_wording();
  for (const Sentence& change : conversion.changes) text += message_line(worded(change, wording)) + "\n";
  print(text);
  for (const std::string& line : coded_lines(warnings(model_findings(model, conversion.joint)), wording)) log(line);
  for (const Sentence& note : conversion.notes) log("note: " + worded(note, wording));
  return kSolved;
}

}  // namespace dea
