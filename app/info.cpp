// `dea info`: what is recognised in a model, to be looked at before it is believed.
#include <fmt/format.h>

#include "app/commands.h"
#include "io/feb/read_feb.h"
#include "io/files/output.h"
#include "io/results/existing_file.h"
#include "io/results/plot_file.h"
#include "io/run/spring_memory.h"
#include "io/tables/read_tables.h"
#include "src/base/error.h"
#include "views/data/run_json.h"
#include "views/text/info_text.h"

namespace dea {

namespace {

constexpr const char* kInfoFooter = R"(
All units are the model's own. Options are those of dea run, so dea info prints what dea run would use with them. A model
that dea run refuses is printed as far as possible, followed by all reasons; the exit code is then 3.

The plot file of -o shows the contact surfaces with
  cartilage thickness, and the initial gap ("joint space")
  missed normals: places whose normal meets no bone
  "rim", what is beyond the rim: 1 nothing, a free edge; 2 more of the layer; 3 a plane of symmetry; 4 cartilage bonded to bone
  "left out", facets that are not used: 1 side wall; 2 bonded to bone
and, as lines, the springs that face something within five thicknesses.

Examples:
  dea info hip.feb
  dea info hip.feb -o check.xplt
  dea info hip.feb --attach femoral_articulating=femur --json -)";

}  // namespace

CLI::App* add_info(CLI::App& app, InfoArguments& a) {
  CLI::App* c = add_model_command(
      app, "info", "Print what dea recognises in a model: bodies, cartilage, springs, loads", kInfoFooter, a);
  add_once(*c, "-o", a.output, "check.xplt", "Output",
           "Plot file of what was recognised: thickness, gap, missed normals, rims, facets left out, springs");
  add_overwrite_flag(*c, a.overwrite);
  add_once(*c, "--json", a.json, "FILE|-", "Output", "Also write JSON, \"-\" to standard output instead of the text");
  add_solving_options(*c, a.settings, a.threads, {"squash", "inside"});
  return c;
}

int info(const InfoArguments& a) {
  require_file("-o", a.output);
  const auto threads = limit_threads(a.threads);
  Settings settings = effective_settings(a.settings);
  JointModel read = read_feb(a.model);
  const HeldOutputs held = claim_outputs(input_files(a, settings), {{"-o", a.output}, {"--json", a.json}});
  if (!a.overwrite) {
    refuse_to_replace("-o", a.output, why_kept(a.output, PlotKind::Check));
    refuse_to_replace({{"--json", a.json}});
  }
  settle_units(read, settings);
  read_tables(read, settings);
  const Recognition recognition = recognise(std::move(read), settings);
  const std::string cost = spring_cost_note(recognition);
  if (!cost.empty()) log(cost);
  const JointModel& model = recognition.model;
  const JointCheck check = check_joint(recognition);
  if (!a.output.empty() && check.recognised) write_xplt(a.output, make_check_file(model, check));
  if (!a.json.empty()) write_text(a.json, json_text(info_json(model, settings, check)));
  if (a.json != "-") print(info_text(model, settings, check));
  throw_if_any(check.errors);
  return kSolved;
}

}  // namespace dea
