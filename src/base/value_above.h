// src/base/value_above.h – a value of a list by its rank.
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace dea {

/// One of the values: this share of them lie below it (0.5: the middle one, of an even count the upper). `values`: not
/// empty. `share`: from 0 to less than 1.
inline double value_above(std::vector<double> values, double share) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace dea
