// views/data/csv.h – cells of CSV.
#pragma once
#include <string>

namespace dea {

/// A name or a sentence as it is, or in quotes where a comma or a quote is in it. Control characters are shown
/// (names.h), so that a row is a line; what a spreadsheet would take for a formula has a ' before it, and what it has
/// no room for is shortened.
std::string csv_word(const std::string& text);
/// The shortest text that reads back as the same number; empty: undefined.
std::string csv_number(double x);

}  // namespace dea
