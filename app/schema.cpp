// `dea schema`: JSON Schemas of what dea writes as JSON.
#include <fmt/format.h>

#include "app/commands.h"
#include "io/files/output.h"
#include "views/data/result_schema.h"

namespace dea {

namespace {

constexpr const char* kSchemaFooter = R"(
Prints a JSON Schema (draft 2020-12) of what a command writes with --json: the keys of docs/results.md, their types, units and meanings,
and when they are null. `settings` is that of the settings, with their defaults and how each is given. Without a name, lists what there is.

Examples:
  dea schema                      the names
  dea schema run > run.schema.json
  dea schema settings)";

}  // namespace

CLI::App* add_schema(CLI::App& app, SchemaArguments& a) {
  CLI::App* c = app.add_subcommand("schema", "Print a JSON Schema of results or settings");
  c->footer(kSchemaFooter);
  c->add_option("SCHEMA", a.name, "What a command writes (run, info, ...), or settings");
  return c;
}

int schema(const SchemaArguments& a) {
  if (a.name.empty()) {
    for (const std::string& name : schema_names())
      print(fmt::format("{:<10}{}\n", name, result_schema(name)["title"].get<std::string>()));
    return kSolved;
  }
  print(json_text(result_schema(a.name)));
  return kSolved;
}

}  // namespace dea
