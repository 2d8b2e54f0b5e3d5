#include "app/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/options.h"
#include "io/settings/settings_xml.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/rules/rules.h"

namespace dea {

namespace {

constexpr const char* kAll = "true";  // CLI11's value of a flag by itself
constexpr const char* kAnyWarning = "warning";

bool holds(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

void check(const char* option, const std::string& code, const char* besides) {
  if (code == besides || find_rule(code) != nullptr) return;
  throw UsageError(
      Fault{.place = option,
            .found = "found \"" + code + "\",",
            .expected = fmt::format("expected the code of a finding, as [narrow-contact] behind its line{}; "
                                    "docs/findings.md has them all",
                                    did_you_mean(code, rule_codes()))});
}

}  // namespace

void add_findings_options(CLI::App& command, FindingsArguments& a) {
  command
      .add_option("--error-on", a.error_on,
                  "End with code 1 if there is a finding of this code, or any \"warning\"; may be repeated")
      ->type_name("CODE")
      ->group("Output");
  command
      .add_flag("-q,--quiet", a.quiet,
                "Print only errors, and what has no solution; with a code, --quiet CODE, all but the findings of this "
                "code; may be repeated")
      ->group("Output");
}

void check_codes(const FindingsArguments& a, bool verbose) {
  if (verbose && quiet_altogether(a)) throw UsageError("-q and -v: found both, expected one of them");
  for (const std::string& code : a.quiet) check("--quiet", code, kAll);
  for (const std::string& code : a.error_on) check("--error-on", code, kAnyWarning);
}

void check_warning_codes(const FindingsArguments& a) {
  for (const std::string& code : a.error_on) {
    const Rule* rule = find_rule(code);
    if (rule == nullptr || std::any_of(rule->words.begin(), rule->words.end(),
                                       [](const Words& words) { return words.severity == Severity::Warning; }))
      continue;
    throw UsageError(
        fmt::format("--error-on {}: found a note, which a study does not keep; expected the code of a "
                    "warning, or warning (docs/findings.md)",
                    code));
  }
}

bool quiet_altogether(const FindingsArguments& a) { return holds(a.quiet, kAll); }

void tell(const Findings& findings, const FindingsArguments& a) {
  Findings wanted;
  for (const Finding& f : findings)
    if (!find_rule(f.code)->quiet && !holds(a.quiet, f.code)) wanted.push_back(f);
  for (const std::string& line : coded_lines(wanted, command_line_wording())) log(line);
}

void tell_quietly(const Analysis& result) {
  Findings findings = result.idle;
  for (const char* code : {"no-solution", "nothing-loads"}) add_once(findings, of_code(result.findings, code));
  for (const std::string& line : coded_lines(findings, command_line_wording())) log(line);
  if (all_solved(result)) return;
  const auto unsolved = std::count_if(result.states.begin(), result.states.end(),
                                      [](const StateResult& s) { return !solved(s.equilibrium.outcome); });
  log(fmt::format("warning: no solution in {} of {} states", unsolved, result.states.size()));
}

bool refused_codes(const std::vector<std::string>& codes, const FindingsArguments& a) {
  std::vector<std::string> refused;
  for (const std::string& code : codes)
    if (holds(a.error_on, code) && !holds(refused, code)) refused.push_back(code);
  if (!refused.empty()) log(fmt::format("error: found {}, which --error-on refuses", fmt::join(refused, ", ")));
  return !refused.empty();
}

std::vector<std::string> codes_of(const Findings& findings) {
  std::vector<std::string> codes;
  for (const Finding& f : findings) {
    codes.push_back(f.code);
    if (severity(f) == Severity::Warning) codes.emplace_back(kAnyWarning);
  }
  return codes;
}

bool tell_refused(const Findings& findings, const FindingsArguments& a) { return refused_codes(codes_of(findings), a); }

std::vector<std::string> with_joined_codes(const std::vector<std::string>& words) {
  std::vector<std::string> joined;
  for (const std::string& word : words) {
    std::error_code unknown;
    const bool code = !word.empty() && word[0] != '-' && word.find('.') == std::string::npos &&
                      !std::filesystem::exists(word, unknown);
    if (!joined.empty() && joined.back() == "--quiet" && code)
      joined.back() += "=" + word;
    else
      joined.push_back(word);
  }
  return joined;
}

}  // namespace dea
