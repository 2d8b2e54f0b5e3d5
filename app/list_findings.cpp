// `dea findings`: what dea may tell, by its code.
#include <fmt/format.h>

#include "app/commands.h"
#include "io/files/output.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/rules/rules.h"

namespace dea {

namespace {

/// "warning"; "warning or note", where the words of some forms are one and of others the other.
std::string severities(const Rule& rule) {
  std::string all = name(rule.words.front().severity);
  for (const Words& words : rule.words)
    if (all.find(name(words.severity)) == std::string::npos) all += fmt::format(" or {}", name(words.severity));
  return all;
}

std::string rule_row(const Rule& rule) {
  return fmt::format("| `{}` | {}{} | {} | {} |\n", rule.code, severities(rule),
                     rule.quiet ? ", not on the terminal" : "", rule.acts, template_text(rule.words.front()));
}

constexpr const char* kFindingsFooter = R"(
Prints a table of all that dea may tell of a model and its results: the code behind each line in brackets, how severe it is,
what to do, and the words. With a code, the row of that one.

Examples:
  dea findings narrow-contact
  dea run hip.feb --error-on narrow-contact
  dea run hip.feb --quiet facets-left-out)";

}  // namespace

CLI::App* add_findings(CLI::App& app, FindingsListArguments& a) {
  CLI::App* c = app.add_subcommand("findings", "List what dea may warn of, by its code");
  c->footer(kFindingsFooter);
  c->add_option("CODE", a.code, "Code of a finding: narrow-contact");
  return c;
}

int list_findings(const FindingsListArguments& a) {
  if (!a.code.empty() && find_rule(a.code) == nullptr)
    throw UsageError(
        fmt::format("found \"{}\", expected the code of a finding{}", a.code, did_you_mean(a.code, rule_codes())));
  std::string text = a.code.empty() ? "| code | severity | what to do | words |\n|---|---|---|---|\n" : "";
  for (const Rule& rule : rules())
    if (a.code.empty() || a.code == rule.code) text += rule_row(rule);
  print(text);
  return kSolved;
}

}  // namespace dea
