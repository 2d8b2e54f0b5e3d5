// views/data/csv.h – cells of CSV.
#pragma once
#include <string>

namespace dea {

/// As it is, or in quotes where a comma, a quote or the end of a line is in it.
std::string csv_word(const std::string& text);
/// The shortest text that reads back as the same number; empty: undefined.
std::string csv_number(double x);

}  // namespace dea
