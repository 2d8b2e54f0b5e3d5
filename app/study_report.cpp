#include "app/study_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/files/output.h"
#include "io/tables/table.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/parse.h"
#include "views/page/write_page.h"
#include "views/study_page/study_subjects.h"

namespace dea {

namespace {

StudyRegionOptions region_options(const StudyArguments& a) {
  StudyRegionOptions o;
  if (!a.regions.empty() && !read_region_layout(a.regions, o))
    throw wrong_word("regions", a.regions, "socket, anterior-superior-posterior or sectors=N",
                     {"socket", "anterior-superior-posterior", "sectors=6"});
  if (!a.up.empty()) o.up = direction_argument("up", a.up);
  if (!a.anterior.empty()) o.anterior = direction_argument("anterior", a.anterior);
  if (!a.axis.empty()) o.axis = direction_argument("axis", a.axis);
  if (!a.center.empty()) o.center = vector_argument("center", a.center);
  if (o.any() && !o.up) throw UsageError("--regions needs --up x,y,z, the direction to the top");
  if (o.needs_anterior() && !o.anterior)
    throw UsageError(fmt::format("--regions {} needs --anterior x,y,z, the direction to the front", a.regions));
  if (!o.any() && (o.anterior || o.axis || o.center))
    throw UsageError("--anterior, --axis and --center belong to --regions");
  return o;
}

void read_dose_options(const StudyArguments& a, StudyMapOptions& o) {
  if (!a.dose_above.empty()) {
    o.dose_above = number_argument("dose-above", a.dose_above);
    if (!(*o.dose_above >= 0)) throw wrong_word("dose-above", a.dose_above, "a pressure of 0 or more");
  }
  if (!a.cycles_per_year.empty()) o.cycles_per_year = positive_argument("cycles-per-year", a.cycles_per_year);
  if (!a.years.empty()) o.years = positive_argument("years", a.years);
  if (!a.cycle_seconds.empty()) o.cycle_seconds = positive_argument("cycle-seconds", a.cycle_seconds);
  if (o.cycles_per_year.has_value() != o.years.has_value())
    throw UsageError("--cycles-per-year and --years go together");
  if (!o.dose_above && (o.years || o.cycle_seconds))
    throw UsageError("--cycles-per-year, --years and --cycle-seconds belong to --dose-above");
}

}  // namespace

void add_study_report_options(CLI::App& c, StudyArguments& a) {
  const char* group = "Page";
  add_once(c, "--report", a.report, "FILE.html", group, "Write the study as one page for any browser");
  add_once(c, "--subjects", a.subjects, "FILE", group,
           "Table about the models (or values of a factor, or cases by case_id), one per row; its columns (subject, "
           "sex, side, "
           "...) can be used on the page");
  add_once(c, "--group", a.group, "COLUMN", group,
           "Compare groups: the values of a factor, of \"model\" or of a column of --subjects");
  add_once(c, "--pair", a.pair, "COLUMN[=A,B]", group,
           "Compare pairs: cases that differ in this column (values A and B) and are alike in all others");
  add_once(c, "--pair-by", a.pair_by, "COLUMN", group,
           "The only column of --subjects that must be alike in a pair, such as subject [all]");
  add_once(c, "--regions", a.regions, "socket|anterior-superior-posterior|sectors=N", group,
           "Numbers by region: six of a socket, its thirds, or N sectors about its axis; needs a study with --keep "
           "fields");
  add_once(c, "--up", a.up, "x,y,z", group, "Direction to the top; sectors begin there");
  add_once(c, "--anterior", a.anterior, "x,y,z", group, "Direction to the front");
  add_once(c, "--axis", a.axis, "x,y,z", group, "Axis of regions [mean normal of the surface]");
  add_once(c, "--center", a.center, "x,y,z", group, "Centre of regions [that of the surface's sphere]");
  add_once(c, "--dose-above", a.dose_above, "P", group,
           "Exposure over the cycle, and overpressure above this pressure; needs a study with --keep fields");
  add_once(c, "--cycles-per-year", a.cycles_per_year, "N", group, "Cycles per year, for the dose of --years");
  add_once(c, "--years", a.years, "N", group, "Years of cycles that the dose is for");
  add_once(c, "--cycle-seconds", a.cycle_seconds, "S", group,
           "How long a cycle takes [from the first state to the last, in seconds]");
}

StudyPageOptions study_page_options(const StudyArguments& a) {
  StudyPageOptions o;
  require_page_name("--report", a.report);
  if (!a.subjects.empty() && !a.report.empty()) o.subjects = read_case_table(a.subjects);
  o.group = a.group;
  o.pair = a.pair;
  o.pair_by = a.pair_by;
  if (!a.pair_by.empty() && (a.pair.empty() || a.subjects.empty()))
    throw UsageError(fmt::format("--pair-by {}: belongs to --pair and --subjects", a.pair_by));
  o.maps.regions = region_options(a);
  read_dose_options(a, o.maps);
  o.words = a.words;
  if (!a.report.empty()) return o;
  const std::pair<const char*, const std::string*> belonging[] = {
      {"--subjects", &a.subjects}, {"--group", &a.group}, {"--pair", &a.pair},
      {"--regions", &a.regions},   {"--up", &a.up},       {"--dose-above", &a.dose_above}};
  for (const auto& [name, text] : belonging)
    if (!text->empty()) throw UsageError(fmt::format("{} {}: belongs to --report FILE.html", name, *text));
  return o;
}

void check_study_columns(const StudyArguments& a, const Plan& plan) {
  std::vector<std::string> names = {"model"};
  for (const Factor& f : plan.factors) names.push_back(f.name);
  if (!a.subjects.empty()) {
    const CaseTable table = read_case_table(a.subjects);
    for (std::size_t i : subject_columns(table, plan.factors).others) names.push_back(table.names[i]);
  }
  for (const auto& [option, text] : {std::pair("--group", &a.group), std::pair("--pair", &a.pair)}) {
    const std::string name = text->substr(0, text->find('='));
    const auto same = [&name](const std::string& known) { return lower_case(known) == lower_case(name); };
    if (!text->empty() && std::none_of(names.begin(), names.end(), same))
      throw UsageError(fmt::format("{} {}: found no column \"{}\"{}, expected one of {}", option, *text, name,
                                   did_you_mean(name, names), name_list(names, name)));
  }
}

void write_study_report(const StudyArguments& a, const std::string& study) {
  if (a.report.empty()) return;
  const std::vector<std::string> notes = write_study_page(a.report, study, study_page_options(a));
  if (!quiet_altogether(a.findings)) log(a.report + ": the page");
  for (const std::string& note : notes) log(fmt::format("note: {}: {}", a.report, note));
}

}  // namespace dea
