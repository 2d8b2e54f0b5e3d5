// febiodea/views/text/compare_text.h – a comparison as tables. Undefined numbers are "-".
#pragma once
#include <string>
#include <vector>

#include <febiodea/views/compare/compare_files.h>
#include <febiodea/views/text/table.h>

namespace dea {

/// Per surface and region the numbers and the patterns' differences; profiles; bodies.
std::vector<TitledTable> compare_tables(const Comparison& comparison);
/// Units and files, then these tables.
std::string compare_text(const Comparison& comparison);

}  // namespace dea
