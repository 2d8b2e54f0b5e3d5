// febiodea/views/data/info_json.h – what was recognised in a model, as JSON.
#pragma once
#include <febiodea/run/check.h>
#include <febiodea/views/data/json.h>

namespace dea {

Json info_json(const JointModel& model, const Settings& settings, const JointCheck& check);

}  // namespace dea
