#include "views/study_page/study_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "io/files/output.h"
#include "src/base/error.h"
#include "views/page/page.h"
#include "views/page/page_data.h"
#include "views/study_page/study_subjects.h"

namespace dea {

namespace {

constexpr std::size_t kMostGroups = 60;

/// Of options, inputs, messages: names of files, not where they were; of models as much as tells them apart.
void hide_folders(StudyNumbers& n, std::vector<StudyWarning>& warnings) {
  const std::vector<std::string> models = n.head.models, names = short_names(models);
  std::vector<std::string> others;
  for (const auto& input : n.head.identity.inputs)
    if (std::find(models.begin(), models.end(), input[0]) == models.end()) others.push_back(input[0]);
  const auto hide = [&](std::string& text) {
    if (text.find('/') == std::string::npos) return;
    for (std::size_t i = 0; i < models.size(); ++i)
      if (names[i] != models[i]) replace_all(text, models[i], names[i]);
    text = without_folders(text, others);
  };
  for (std::string& option : n.head.identity.options) hide(option);
  for (StudyCase& c : n.cases) hide(c.message);
  for (StudyWarning& w : warnings) hide(w.text);
  for (auto& input : n.head.identity.inputs) hide(input[0]);
  n.head.models = names;
}

int group_column(const StudyNumbers& n, const StudyPageOptions& o) {
  if (o.group.empty()) return -1;
  const int column = study_column(n, o.names.group, o.group);
  const std::size_t levels = n.columns[static_cast<std::size_t>(column)].levels.size();
  if (levels > kMostGroups)
    throw UsageError(fmt::format("{} {}: found {} different values, expected groups, {} at most", o.names.group,
                                 o.group, levels, kMostGroups));
  return column;
}

/// Maps and all that comes of stored pressures; regions are places by now.
void add_maps(const std::string& study, const StudyNumbers& n, const StudyFields& fields, const StudyPageOptions& o,
              int group, Json& page, PageArrays& arrays, std::vector<std::string>& notes) {
  Json meshes = Json::array();
  page["maps"] = maps_json(study, n, fields, o.maps, notes, meshes, arrays);
  page["means"] = page["maps"].is_null()
                      ? Json(nullptr)
                      : mean_maps_json(study, n, fields, group, o.maps.regions.up.value_or(Vector3d::Zero()), notes,
                                       meshes, arrays);
  page["meshes"] = std::move(meshes);
}

void require_fields(const StudyFields& fields, const StudyPageOptions& o) {
  if (!fields.fields.empty()) return;
  const char* what = o.maps.dose_above ? "a dose" : o.maps.regions.any() ? "regions" : nullptr;
  if (what != nullptr)
    throw UsageError(
        fmt::format("{}: found no stored pressures in the study, expected one that was solved with "
                    "pressures at nodes kept (fields)",
                    what));
}

}  // namespace

StudyNumbers study_numbers_with(const std::string& study, const std::optional<CaseTable>& subjects) {
  StudyNumbers n = read_study_numbers(study);
  if (subjects) add_subjects(*subjects, n);
  return n;
}

std::vector<std::string> write_study_page(const std::string& path, const std::string& study,
                                          const StudyPageOptions& o) {
  std::vector<std::string> notes;
  StudyNumbers n = study_numbers_with(study, o.subjects);
  std::vector<StudyWarning> warnings = read_warnings(study);
  const int group = group_column(n, o);
  const StudyPairs pairs =
      o.pair.empty() ? StudyPairs{} : study_pairs(n, o.names.pair, o.pair, o.names.pair_by, o.pair_by);
  check_dose(n, o.maps, o.names.cycle_seconds);
  const StudyFields fields = study_fields(study, n);
  require_fields(fields, o);
  if (o.maps.regions.any()) add_regions(study, fields, o.maps.regions, n);
  hide_folders(n, warnings);
  const ShownCases shown = shown_cases(n);
  if (!shown.all)
    notes.push_back(fmt::format("figures and tables show {} of {} cases; statistics are of all", shown.cases.size(),
                                n.cases.size()));
  PageArrays arrays;
  Json page;
  page["schema"] = "dea.report/1";
  page["kind"] = "study";
  page["title"] = std::filesystem::path(study).stem().string();
  page["command"] = command_text(o.words, {study, path, o.subjects ? o.subjects->path : std::string()});
  page["subjects"] = o.subjects ? Json(without_folders(o.subjects->path, {o.subjects->path})) : Json(nullptr);
  page["contacts"] = list_json(read_contacts(study), [](const StudyContact& c) -> Json {
    return {c.contact, c.source, c.target};
  });
  add_page_head(n.units, page);
  page["time_name"] = n.time_name;
  page["study"] = study_head_json(n);
  page["failures"] = failures_json(n, warnings);
  add_numbers(n, shown, page, arrays);
  page["headline"] = headline_words();
  page["summary"] = headline_table_json(n);
  page["bands"] = bands_json(n, shown, arrays);
  page["influence"] = influence_json(n);
  page["groups"] = groups_json(n, group);
  page["pairs"] = pairs_json(n, pairs, shown);
  if (pairs.column >= 0 && !o.pair_by.empty()) page["pairs"]["by"] = o.pair_by;
  add_maps(study, n, fields, o, group, page, arrays, notes);
  page["notes"] = notes;
  const std::string main = fmt::format("{}\n{}\n{}", page::study_figures(), page::study_maps(), page::study_main());
  write_text(path, page_text(page["title"].get<std::string>(), page, arrays, page::study_style(), main));
  return notes;
}

}  // namespace dea
