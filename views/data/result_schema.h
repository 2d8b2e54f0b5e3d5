// views/data/result_schema.h – JSON Schemas (draft 2020-12) of what dea writes as JSON, for other programs.
//
// They are made of the tables of docs/results.md, which name every key, and of the table of settings. Of a table's row
// the column "unit" says the type (the page tells how), the last one whether the key may be null or absent.
#pragma once
#include <string>
#include <vector>

#include "views/data/json.h"

namespace dea {

/// "run", "info", ...: each NAME.json that docs/results.md has; then "settings".
std::vector<std::string> schema_names();

/// Of one of these names; throws UsageError. Keys that the page does not name are allowed, as later versions add some.
Json result_schema(const std::string& name);

}  // namespace dea
