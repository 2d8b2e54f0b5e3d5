// views/page/page_charts.h – curves over time on the page of a run.
#pragma once
#include <string>
#include <vector>

#include "src/run/analysis.h"

namespace dea {

/// A curve over time of `dea run`.
struct PageChart {
  std::string title, caption;
  std::string quantity;   ///< of the axis
  std::string dimension;  ///< "pressure", "force", "length", "area", "degrees", "": pure number
  bool logarithmic = false;
  std::vector<double> times;
  std::vector<std::string> names;
  std::vector<std::vector<double>> values;  ///< per name; NaN: a gap
};

/// Force, pressures and area of contacts; motion of bodies; tension of ligaments; how well all balances.
std::vector<PageChart> run_charts(const Analysis& analysis);

}  // namespace dea
