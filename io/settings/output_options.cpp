#include "io/settings/output_options.h"

#include <fmt/format.h>

namespace dea {

const std::vector<OutputOption>& output_options() {
  using O = OutputSettings;
  using Kind = OutputOption::Kind;
  static const std::vector<OutputOption> options = {
      {"output", &O::output, Kind::File, "a file name", "FILE.xplt",
       "Plot file [MODEL without .feb + _dea.xplt, beside the model]"},
      {"json", &O::json, Kind::File, "a file name", "FILE|-", "Also write JSON, \"-\" to standard output"},
      {"csv", &O::csv, Kind::File, "a file name", "FILE|-",
       "Also write CSV, a line per state and contact, \"-\" to standard output"},
      {"compartments-csv", &O::compartments_csv, Kind::File, "a file name", "FILE|-",
       "Also write CSV, a line per state, contact and compartment, for surfaces in several pieces; \"-\" to standard "
       "output"},
      {"facets-csv", &O::facets_csv, Kind::File, "a file name", "FILE|-",
       "Also write CSV, a line per state, contact and facet: pressure, joint space, overlap; \"-\" to standard output"},
      {"report", &O::report, Kind::File, "a file name", "FILE.html",
       "Also write a page for any browser: maps, curves, tables, what was recognised"},
      {"vtu", &O::vtu, Kind::Folder, "the name of a folder", "FOLDER",
       "Also write files for ParaView into this folder: open its results.pvd"},
      {"no-xplt", &O::no_xplt, Kind::Switch, "true or false", "",
       "Write no plot file, only the outputs that are named"},
      {"states", &O::states, Kind::States, "all, last, times t1,t2,... or ranges t1:t2", "all|last|t1,t2:t3,...",
       "States to solve and write: all, last, times t1,t2,... or ranges t1:t2; ends of steps before them are "
       "followed too "
       "[all; about 1000 if there are more than 10000]"},
  };
  return options;
}

std::string command_line_name(const OutputOption& option) {
  return option.text == &OutputSettings::output ? "-o" : fmt::format("--{}", option.name);
}

OutputSettings over(const OutputSettings& stronger, const OutputSettings& weaker) {
  OutputSettings all = weaker;
  for (const OutputOption& o : output_options())
    if (!(stronger.*o.text).empty()) all.*o.text = stronger.*o.text;
  if (!stronger.states.empty()) all.states_given = stronger.states_given;
  return all;
}

std::string given_as(std::string OutputSettings::*text, const OutputSettings& typed) {
  for (const OutputOption& o : output_options())
    if (o.text == text) return (typed.*text).empty() ? fmt::format("<{}>", o.name) : command_line_name(o);
  return "";
}

std::vector<NamedPath> named_outputs(const OutputSettings& typed, const OutputSettings& file) {
  const OutputSettings all = over(typed, file);
  std::vector<NamedPath> outputs;
  for (const OutputOption& o : output_options())
    if ((o.kind == OutputOption::Kind::File || o.kind == OutputOption::Kind::Folder) && !(all.*o.text).empty())
      outputs.push_back({given_as(o.text, typed), all.*o.text, o.kind == OutputOption::Kind::Folder});
  return outputs;
}

}  // namespace dea
