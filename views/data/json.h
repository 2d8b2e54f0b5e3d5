// views/data/json.h – values as JSON.
#pragma once
#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>

#include "src/results/headline.h"

namespace dea {

using Json = nlohmann::ordered_json;

Json json_number(double x);  ///< null when not finite
Json json_vector(const Eigen::Vector3d& v);
/// The threshold and what is above it.
Json headline_json(const Headline& h);
/// null for an empty text.
Json json_word(const std::string& text);
/// Names of units: length, force, pressure, area; null: the system is none of FEBio's, or not named.
Json units_json(const std::string& system);

/// The JSON text, numbers such that they read back the same, with a line feed at the end. Text that is not UTF-8 is
/// mended.
std::string json_text(const Json& json);

}  // namespace dea
