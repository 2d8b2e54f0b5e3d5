// febiodea/views/text/build_text.h – what dea build made, as tables.
#pragma once
#include <string>

#include <febiodea/views/data/build_json.h>

namespace dea {

std::string build_text(const BuildSummary& summary);

}  // namespace dea
