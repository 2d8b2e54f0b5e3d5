// views/data/info_json.h – what was recognised in a model, as JSON.
#pragma once
#include "src/run/check.h"
#include "views/data/json.h"

namespace dea {

Json info_json(const JointModel& model, const Settings& settings, const JointCheck& check);

}  // namespace dea
