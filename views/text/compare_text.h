// views/text/compare_text.h – a comparison as tables. Undefined numbers are "-".
#pragma once
#include <string>
#include <vector>

#include "views/compare/compare_files.h"
#include "views/text/table.h"

namespace dea {

/// Per surface and region the headline numbers (`details`: then all others, each named in full) and the patterns'
/// differences; profiles; bodies.
std::vector<TitledTable> compare_tables(const Comparison& comparison, bool details);
/// Units and files, then these tables.
std::string compare_text(const Comparison& comparison, bool details);

}  // namespace dea
