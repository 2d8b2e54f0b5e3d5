#include "views/data/json.h"
#include "src/base/unit_names.h"

#include <cmath>

namespace dea {

Json json_number(double x) { return std::isfinite(x) ? Json(x + 0.0) : Json(nullptr); }  // + 0.0: no -0.0

Json json_vector(const Eigen::Vector3d& v) {
  return Json::array({json_number(v[0]), json_number(v[1]), json_number(v[2])});
}

Json headline_json(const Headline& h) {
  Json j;
  j["above"] = json_number(h.above);
  for (const HeadlineNumber& number : kHeadlineNumbers) j[number.name] = json_number(h.*number.value);
  return j;
}

Json json_word(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json units_json(const std::string& system) {
  const UnitNames units = unit_names(system);
  if (units.length.empty()) return nullptr;
  Json j;
  j["length"] = units.length;
  j["force"] = units.force;
  j["pressure"] = units.pressure;
  j["area"] = units.area;
  return j;
}

std::string json_text(const Json& json) { return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace dea
