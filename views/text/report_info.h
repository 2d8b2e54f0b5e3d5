// febiodea/views/text/report_info.h – what was recognised in a model: everything `dea info` says, as values, text and
// JSON.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include <febiodea/run/check.h>

namespace dea {

std::string info_text(const JointModel& model, const Settings& settings, const JointCheck& check);
nlohmann::ordered_json info_json(const JointModel& model, const Settings& settings, const JointCheck& check);

}  // namespace dea
