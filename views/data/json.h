// views/data/json.h – values as JSON.
#pragma once
#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>

#include "src/base/finding.h"
#include "src/results/headline.h"

namespace dea {

using Json = nlohmann::ordered_json;

Json json_number(double x);  ///< null when not finite
Json json_vector(const Eigen::Vector3d& v);
/// The threshold and what is above it.
Json headline_json(const Headline& h);
template <class List, class Get>
Json list_json(const List& list, Get get) {
  Json j = Json::array();
  for (const auto& item : list) j.push_back(get(item));
  return j;
}
/// The numbers that a table (kHeadlineNumbers) names, by their names.
template <class Of, class Numbers>
Json numbers_json(const Of& of, const Numbers& numbers) {
  Json j;
  for (const auto& number : numbers) j[number.name] = json_number(of.*number.value);
  return j;
}
/// null for an empty text.
Json json_word(const std::string& text);
/// Names of units: length, force, pressure, area; null: the system is none of FEBio's, or not named.
Json units_json(const std::string& system);

/// A list of objects: code, severity, place, contact, surface, body, time, values by their names, text. What does not
/// apply is null. Settings as the command line has them.
Json findings_json(const Findings& findings);

/// The JSON text, numbers such that they read back the same, with a line feed at the end. Text that is not UTF-8 is
/// mended.
std::string json_text(const Json& json);

}  // namespace dea
