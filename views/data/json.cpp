#include "views/data/json.h"

#include <cmath>

#include "io/settings/settings_xml.h"
#include "src/base/unit_names.h"
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

Json json_number(double x) { return std::isfinite(x) ? Json(x + 0.0) : Json(nullptr); }  // + 0.0: no -0.0

Json json_vector(const Eigen::Vector3d& v) {
  return Json::array({json_number(v[0]), json_number(v[1]), json_number(v[2])});
}

Json headline_json(const Headline& h) {
  Json j = {{"above", json_number(h.above)}};
  j.update(numbers_json(h, kHeadlineNumbers));
  return j;
}

Json json_word(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json units_json(const std::string& system) {
  const UnitNames units = unit_names(system);
  if (units.length.empty()) return nullptr;
  return {{"length", units.length}, {"force", units.force}, {"pressure", units.pressure}, {"area", units.area}};
}

Json findings_json(const Findings& findings) {
  const Wording wording = command_line_wording();
  return list_json(findings, [&](const Finding& f) -> Json {
    Json values = Json::object();
    for (const NamedValue& v : f.values) values[v.name] = std::visit(ValueJson{wording}, v.value.is);
    const Subject& s = f.subject;
    return {{"code", f.code},
            {"severity", name(severity(f))},
            {"place", json_word(f.place)},
            {"contact", json_word(s.contact)},
            {"surface", json_word(s.surface)},
            {"body", json_word(s.body)},
            {"time", s.time ? json_number(*s.time) : Json(nullptr)},
            {"values", values},
            {"text", worded(f, wording)}};
  });
}

std::string json_text(const Json& json) { return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace dea
