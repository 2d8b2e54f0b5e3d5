// febiodea/views/page/page_charts.h – curves over time on the page of a run.
#pragma once
#include <vector>

#include <febiodea/run/analysis.h>
#include <febiodea/views/page/page_data.h>

namespace dea {

/// Force, pressures and area of contacts; motion of bodies; tension of ligaments; how well all balances.
std::vector<PageChart> run_charts(const Analysis& analysis);

}  // namespace dea
