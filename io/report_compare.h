// io/report_compare.h – a comparison as table, JSON and CSV. Undefined numbers are "-", null and empty.
#pragma once
#include <string>

#include "compare_files.h"
#include "report_json.h"

namespace dea {

std::string compare_text(const Comparison& comparison);
Json compare_json(const Comparison& comparison);
/// One line per surface, region and file, under a line of names; the reference's differences are empty.
std::string compare_csv(const Comparison& comparison);

}  // namespace dea
