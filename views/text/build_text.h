// views/text/build_text.h – what dea build made, as tables.
#pragma once
#include <string>
#include <vector>

#include "views/data/build_json.h"
#include "views/text/table.h"

namespace dea {

/// Where layers are not as they were wanted, a line each.
std::vector<std::string> layer_changes(const BuildSummary& summary);
/// Layers, rims, contacts, balances, frames and angles; the page has the same.
std::vector<TitledTable> build_tables(const BuildSummary& summary);

std::string build_text(const BuildSummary& summary);

}  // namespace dea
