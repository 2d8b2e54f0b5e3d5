// `dea run --live`: the joint and all that it is solved with, for the page that has the program in it.
#include "app/live_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "app/process.h"
#include "io/files/output.h"
#include "io/tables/read_tables.h"
#include "src/base/error.h"
#include "src/model/settings_table.h"
#include "views/page/live_page.h"

namespace dea {

namespace fs = std::filesystem;

std::string live_program() {
  const fs::path program = own_path();
  const std::vector<fs::path> places = {program.parent_path() / "dea.html",
                                        program.parent_path().parent_path() / "share/febiodea/dea.html"};
  std::error_code unknown;
  for (const fs::path& place : places)
    if (!program.empty() && fs::is_regular_file(place, unknown)) return place.string();
  throw UsageError(
      fmt::format("--live: found no dea.html beside the program ({}) or in {}; put the page dea.html of this version "
                  "there (docs/portable.md)",
                  places[0].string(), places[1].string()));
}

namespace {

/// The page has no folders: what the model or a settings file names by itself has to lie beside it.
PageFile beside(const std::string& what, const std::string& kind, const std::string& path, const std::string& first) {
  if (fs::path(path).parent_path().lexically_normal() != fs::path(first).parent_path().lexically_normal())
    throw UsageError(
        fmt::format("--live: {}, {}, is in another folder than {}, expected the same one: a page has no folders", what,
                    path, first));
  return {file_name(path), path, kind};
}

}  // namespace

std::string live_page_of(const std::string& program, const ModelArguments& a, const JointModel& model,
                         const Settings& settings, const std::string& states) {
  std::vector<PageFile> files = {{file_name(a.model), a.model, "model"}};
  for (std::size_t i = 1; i < model.files.size(); ++i)
    files.push_back(beside("a file of the model", "part", model.files[i], a.model));
  if (!a.settings.file.empty()) files.push_back({file_name(a.settings.file), a.settings.file, "settings"});
  std::vector<NamedPath> tables = table_files(settings);
  std::vector<std::string> words;
  for (const CaseOption& typed : in_their_order(a.settings)) {
    const SettingOption& option = *find_setting_option(typed.name);
    if (option.help_off != nullptr) {
      words.push_back((typed.text == "true" ? "--" : "--no-") + typed.name);
      continue;
    }
    std::string text = typed.text;
    const std::string key = option.key == nullptr ? "" : text.substr(0, text.rfind('=') + 1);
    const std::string path = text.substr(key.size());
    if (std::erase_if(tables, [&](const NamedPath& t) { return t.path == path; }) > 0)
      files.push_back({file_name(path), path, "table"});
    const auto in_page = std::find_if(files.begin() + 1, files.end(),
                                      [&](const PageFile& f) { return f.kind == "table" && f.path == path; });
    if (in_page != files.end()) text = key + in_page->name;
    words.insert(words.end(), {"--" + typed.name, text});
  }
  if (!states.empty()) words.insert(words.end(), {"--states", states});
  for (const NamedPath& table : tables) files.push_back(beside(table.option, "table", table.path, a.settings.file));
  std::set<std::string> names;
  for (const PageFile& file : files)
    if (!names.insert(file.name).second)
      throw UsageError(
          fmt::format("--live: found two files of the name {}, expected names of their own: a page has no "
                      "folders",
                      file.name));
  return live_page(program, files, words);
}

}  // namespace dea
