// views/data/results_page.h – docs/results.md, as it stands in the program.
#pragma once
#include <string_view>

namespace dea {

std::string_view results_page();

}  // namespace dea
