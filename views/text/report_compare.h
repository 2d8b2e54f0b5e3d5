// febiodea/views/text/report_compare.h – a comparison as table, JSON and CSV. Undefined numbers are "-", null and
// empty.
#pragma once
#include <string>

#include <febiodea/views/compare/compare_files.h>
#include <febiodea/views/data/report_json.h>
#include <febiodea/views/text/report_text.h>

namespace dea {

/// Per surface and region the numbers and the patterns' differences; profiles; bodies.
std::vector<TitledTable> compare_tables(const Comparison& comparison);
/// Units and files, then these tables.
std::string compare_text(const Comparison& comparison);
Json compare_json(const Comparison& comparison);
/// One line per surface, region and file, under a line of names; the reference's differences are empty.
std::string compare_csv(const Comparison& comparison);

}  // namespace dea
