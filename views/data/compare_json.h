// views/data/compare_json.h – a comparison as JSON and CSV. Undefined numbers are null and empty.
#pragma once
#include <string>

#include "views/compare/compare_files.h"
#include "views/data/json.h"

namespace dea {

Json compare_json(const Comparison& comparison);
/// One line per surface, region and file, under a line of names; the reference's differences are empty.
std::string compare_csv(const Comparison& comparison);

}  // namespace dea
