#include "views/data/result_schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>

#include "io/settings/settings_xml.h"
#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/model/settings_table.h"
#include "views/data/results_page.h"
#include "views/data/run_json.h"

namespace dea {

namespace {

/// What a row of the page says of a key.
struct Row {
  std::string what, unit, null;
};

/// A key, and those in it. Its values may be entries, of a list or of an object by names from the model.
struct Key {
  std::string name;
  bool list = false, by_name = false;
  std::optional<Row> row = {};  ///< none: all that is said of it are the keys in it
  std::vector<Key> keys = {};
};

Key& found_or_added(std::vector<Key>& keys, const std::string& name) {
  const auto found = std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.name == name; });
  return found != keys.end() ? *found : keys.emplace_back(Key{name});
}

/// What stands in `...`.
std::vector<std::string> code_spans(const std::string& text) {
  const std::vector<std::string> parts = split(text, '`');
  std::vector<std::string> spans;
  for (std::size_t i = 1; i < parts.size(); i += 2) spans.push_back(parts[i]);
  return spans;
}

/// The names that "{a,b}_c" stands for. "bodies{}" is one name.
std::vector<std::string> each(const std::string& name) {
  std::size_t open = name.find('{');
  while (open != name.npos && name[open + 1] == '}') open = name.find('{', open + 1);
  if (open == name.npos) return {name};
  const std::size_t close = name.find('}', open);
  std::vector<std::string> names;
  for (const std::string& one : split_at_commas(name.substr(open + 1, close - open - 1)))
    for (const std::string& whole : each(name.substr(0, open) + one + name.substr(close + 1))) names.push_back(whole);
  return names;
}

/// File and place in it, "run.json" and "states[].bodies{}", of a line such as: In `run.json` at `states[]`; in
/// `run.csv`
std::vector<std::pair<std::string, std::string>> places(const std::string& line) {
  std::vector<std::pair<std::string, std::string>> found;
  for (const std::string& part : split(line, ';')) {
    const std::vector<std::string> spans = code_spans(part);
    if (spans.size() == 1) found.emplace_back(spans[0], "");
    for (std::size_t i = 1; i < spans.size(); ++i)
      for (const std::string& place : each(spans[i])) found.emplace_back(spans[0], place);
  }
  return found;
}

/// `path`: "states[].bodies{}.force"
void add(Key& result, const std::string& path, const Row& row) {
  Key* key = &result;
  for (std::string name : split(path, '.')) {
    const bool list = name.ends_with("[]"), by_name = name.ends_with("{}");
    if (list || by_name) name.resize(name.size() - 2);
    key = &found_or_added(key->keys, name);
    key->list |= list;
    key->by_name |= by_name;
  }
  key->row = row;
}

/// Of each NAME.json the keys that the page names.
std::vector<Key> read_results_page() {
  std::vector<Key> results;
  std::vector<std::pair<std::string, std::string>> at_places;
  std::vector<std::string> heads;
  for (const std::string& line : split(std::string(results_page()), '\n')) {
    if (line.starts_with("In `")) at_places = places(line);
    std::vector<std::string> cells = split(line, '|');
    for (std::string& cell : cells) cell = trimmed(cell);
    if (!line.starts_with("|"))
      heads.clear();
    else if (heads.empty())
      heads = cells;
    else if (const auto json = std::find(heads.begin(), heads.end(), "JSON"); json != heads.end()) {
      const std::size_t last = heads.size() - 2;  // behind it is the end of the line
      const Row row = {cells[last - 2], cells[last - 1], cells[last]};
      for (const auto& [file, place] : at_places) {
        if (!file.ends_with(".json")) continue;
        Key& result = found_or_added(results, file.substr(0, file.size() - 5));
        for (const std::string& names : code_spans(cells[static_cast<std::size_t>(json - heads.begin())]))
          for (const std::string& name : each(names)) add(result, place.empty() ? name : place + "." + name, row);
      }
    }
  }
  return results;
}

bool may_be_absent(const Row& row) { return row.null.starts_with("absent"); }

bool may_be_null(const Row& row) {
  const bool empty_instead = row.unit.starts_with("list") && row.null.find("empty") != row.null.npos;
  return row.null != "–" && !may_be_absent(row) && !row.null.starts_with("CSV:") && !empty_instead;
}

Json or_null(Json type, bool null) {
  if (!null) return type;
  if (type.contains("enum"))
    type["enum"].push_back(nullptr);
  else if (type.contains("anyOf"))
    type["anyOf"].push_back({{"type", "null"}});
  else
    type["type"] = {type["type"], "null"};
  return type;
}

Json numbers_type(int count, bool null) {
  return {{"type", "array"}, {"items", or_null({{"type", "number"}}, null)}, {"minItems", count}, {"maxItems", count}};
}

/// Words of a cell: its code spans, but those that name a page or an option.
Json words_of(const std::string& what) {
  Json words = Json::array();
  for (const std::string& span : code_spans(what))
    if (!span.ends_with(".md") && !span.starts_with("-")) words.push_back(span);
  return words;
}

/// Of a value that holds no keys. `unit`: "length", "vector, length", "list of words".
Json value_type(const std::string& unit, const std::string& what, bool null) {
  if (const std::size_t other = unit.find(", or "); unit.starts_with("list") && other != unit.npos) {
    Json either = {value_type(unit.substr(0, other), what, false), value_type(unit.substr(other + 5), what, false)};
    return or_null({{"anyOf", std::move(either)}}, null);
  }
  if (unit.starts_with("list ") || unit.starts_with("list, "))
    return or_null({{"type", "array"}, {"items", value_type(unit.substr(unit[4] == ',' ? 6 : 8), what, null)}}, null);
  if (unit.starts_with("vector")) return or_null(numbers_type(3, null), null);
  if (unit.starts_with("pair")) return or_null(numbers_type(2, null), null);
  if (unit.starts_with("word")) return or_null({{"enum", words_of(what)}}, null);
  if (unit.starts_with("text") || unit.starts_with("name")) return or_null({{"type", "string"}}, null);
  if (unit == "count") return or_null({{"type", "integer"}, {"minimum", 0}}, null);
  if (unit == "true, false") return or_null({{"type", "boolean"}}, null);
  if (unit == "object") return or_null({{"type", "object"}}, null);
  return or_null({{"type", "number"}}, null);
}

/// The unit of numbers alone: that of "vector, length" is length. "": it has none.
std::string unit_alone(std::string unit) {
  for (const char* form : {"list of vectors, ", "list, ", "vector, "})
    if (unit.starts_with(form)) unit.erase(0, std::string(form).size());
  return value_type(unit, "", false) == value_type("length", "", false) ? unit : "";
}

Json schema_of(const Key& key);

Json object_of(const std::vector<Key>& keys) {
  Json properties = Json::object(), required = Json::array();
  for (const Key& key : keys) {
    properties[key.name] = schema_of(key);
    if (!key.row || !may_be_absent(*key.row)) required.push_back(key.name);
  }
  return {{"type", "object"}, {"properties", std::move(properties)}, {"required", std::move(required)}};
}

Json schema_of(const Key& key) {
  Json j = Json::object();
  const bool null = key.row && may_be_null(*key.row);
  if (key.row) {
    const bool told = key.row->null != "–" && !key.row->null.starts_with("CSV:");
    j["description"] = key.row->what + (told ? fmt::format(" ({}{})", null ? "null: " : "", key.row->null) : "");
    if (const std::string unit = unit_alone(key.row->unit); key.keys.empty() && !unit.empty()) j["unit"] = unit;
  }
  if (key.keys.empty())
    j.update(value_type(key.row->unit, key.row->what, null));
  else if (key.list)
    j.update(Json{{"type", "array"}, {"items", or_null(object_of(key.keys), null)}});
  else if (key.by_name)
    j.update(Json{{"type", "object"}, {"additionalProperties", object_of(key.keys)}});
  else
    j.update(or_null(object_of(key.keys), null));
  return j;
}

/// "neo-Hookean", "1"; not BODY, x,y,z or "..."
bool is_word(const std::string& text) {
  return (std::islower(static_cast<unsigned char>(text[0])) || std::isdigit(static_cast<unsigned char>(text[0]))) &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isalnum(c) || c == '-'; });
}

/// Of one value of a setting, by its form (SettingOption::value).
Json setting_type(const SettingOption& option) {
  Json any = Json::array(), words = Json::array();
  for (const std::string& part : split(option.value, '|')) {
    if (part == "NUMBER" || part == "STRAIN")
      any.push_back({{"type", "number"}});
    else if (part == "N")
      any.push_back({{"type", "integer"}});
    else if (part == "x,y,z")
      any.push_back(numbers_type(3, false));
    else if (part == "x,y,z,Ru,Rv,Rw")
      any.push_back({{"type", "array"}, {"items", {{"enum", kDofNames}}}});
    else if (!is_word(part))
      return {{"type", "string"}};
    else if (std::isdigit(static_cast<unsigned char>(part[0])))
      words.push_back(std::stoi(part));
    else
      words.push_back(part);
  }
  if (std::string(option.help).find("frame:NAME,") != std::string::npos)
    any.push_back({{"type", "string"}, {"pattern", "^frame:"}});
  if (!words.empty()) any.push_back({{"enum", words}});
  return any.size() == 1 ? any[0] : Json::object({{"anyOf", any}});
}

/// A setting as the results' `settings` have it, and how it is given. `without`: its value where nothing is given.
Json setting_schema(const SettingOption& option, const Json& without) {
  std::string help;
  for (const std::string& part : split(option.help, '{')) {  // {load-at}
    const std::size_t end = part.find('}');
    help += end == part.npos ? part : setting_keyword(part.substr(0, end)) + part.substr(end + 1);
  }
  Json j = {{"description", help}, {"default", without}};
  j["commandLine"] = option.help_off != nullptr ? fmt::format("--{0}, --no-{0}", option.name)
                                                : fmt::format("--{} {}", option.name, value_form(option));
  j["settingsFile"] = settings_file_wording()({option.name, option.key == nullptr ? "" : key_form(option),
                                               option.help_value ? option.help_value : option.value});
  if (without.is_boolean())
    j["type"] = "boolean";
  else if (without.is_array())
    j.update(Json{{"type", "array"}, {"items", {{"type", "string"}}}});
  else if (option.key != nullptr)
    j.update(Json{{"type", "object"}, {"additionalProperties", setting_type(option)}});
  else
    j.update(or_null(setting_type(option), without.is_null()));
  return j;
}

/// `of_page`: an object of those keys of `settings` that the page names.
Json settings_schema(const Json& of_page) {
  Json j = {{"description",
             "What was given on the command line or in the settings file; null, an empty list or object: it was not. "
             "`commandLine` and `settingsFile` are how each is given; an entry \"\" holds for all surfaces."}};
  j.update(of_page);
  const Json without = settings_json(Settings{});
  for (const SettingOption& option : setting_options()) {
    const std::string key = setting_keyword(option.name);
    j["properties"][key] = setting_schema(option, without[key]);
    j["required"].push_back(key);
  }
  return j;
}

}  // namespace

std::vector<std::string> schema_names() {
  std::vector<std::string> names;
  for (const Key& result : read_results_page()) names.push_back(result.name);
  names.push_back("settings");
  return names;
}

Json result_schema(const std::string& name) {
  const std::vector<std::string> names = schema_names();
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw UsageError(
        fmt::format("schema: {}", bad_value(name, fmt::format("{}", fmt::join(names, ", ")), names).what()));
  Json j = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}};
  if (name == "settings") {
    j["title"] = "settings of dea.run";
    j.update(result_schema("run")["properties"]["settings"]);
    return j;
  }
  std::vector<Key> results = read_results_page();
  Json object = object_of(found_or_added(results, name).keys);
  Json& schema = object["properties"]["schema"];
  const std::string begin = fmt::format("dea.{}/", name);
  for (const Json& word : schema["enum"])
    if (word.get<std::string>().starts_with(begin)) j["title"] = word;
  schema["enum"] = Json::array({j["title"]});
  j["description"] = fmt::format("What `dea {} --json` writes. Later versions may add keys.", name);
  if (Json& properties = object["properties"]; properties.contains("settings")) {
    properties["settings"] = settings_schema(properties["settings"]);
    if (name == "converge") {  // it is what varies
      properties["settings"]["properties"].erase("refine");
      Json& required = properties["settings"]["required"];
      required.erase(std::find(required.begin(), required.end(), "refine"));
    }
  }
  j.update(object);
  return j;
}

}  // namespace dea
