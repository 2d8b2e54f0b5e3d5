// views/data/finding_json.h – findings as JSON.
#pragma once
#include "src/base/finding.h"
#include "views/data/json.h"

namespace dea {

/// A list of objects: code, severity, place, contact, surface, body, time, values by their names, text. What does not
/// apply is null. Settings as the command line has them.
Json findings_json(const Findings& findings);

}  // namespace dea
