#include "views/data/finding_json.h"

#include "io/settings/setting_words.h"
#include "src/rules/rules.h"

namespace dea {

namespace {

struct ValueJson {
  const Wording& wording;
  Json operator()(double number) const { return json_number(number); }
  Json operator()(const std::string& name) const { return name; }
  Json operator()(const std::vector<std::string>& names) const { return names; }
  Json operator()(const std::vector<int>& numbers) const { return numbers; }
  Json operator()(const NamedSetting& setting) const { return wording(setting); }
  Json operator()(const Sentence& words) const { return worded(words, wording); }
};

}  // namespace

Json findings_json(const Findings& findings) {
  const Wording wording = command_line_wording();
  Json list = Json::array();
  for (const Finding& f : findings) {
    Json values = Json::object();
    for (const NamedValue& v : f.values) values[v.name] = std::visit(ValueJson{wording}, v.value.is);
    const Subject& s = f.subject;
    list.push_back({{"code", f.code},
                    {"severity", name(severity(f))},
                    {"place", json_word(f.place)},
                    {"contact", json_word(s.contact)},
                    {"surface", json_word(s.surface)},
                    {"body", json_word(s.body)},
                    {"time", s.time ? json_number(*s.time) : Json(nullptr)},
                    {"values", values},
                    {"text", worded(f, wording)}});
  }
  return list;
}

}  // namespace dea
