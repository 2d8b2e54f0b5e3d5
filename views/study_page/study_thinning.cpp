#include "views/study_page/study_thinning.h"

#include <algorithm>

#include "src/base/numbers.h"

namespace dea {

namespace {

/// Levels that are left of each own column.
struct KeptLevels {
  std::vector<std::vector<char>> kept;

  explicit KeptLevels(const StudyNumbers& n) {
    for (std::size_t k = 0; k < n.own_columns(); ++k) kept.emplace_back(n.columns[k].levels.size(), 1);
  }
  bool has(const StudyNumbers& n, std::size_t c) const {
    for (std::size_t k = 0; k < kept.size(); ++k)
      if (kept[k][at(n.columns[k].level[c])] == 0) return false;
    return true;
  }
  /// False: no column has more than two levels left.
  bool thin() {
    std::size_t longest = 0, most = 2;
    for (std::size_t k = 0; k < kept.size(); ++k) {
      const auto left = static_cast<std::size_t>(std::count(kept[k].begin(), kept[k].end(), 1));
      if (left <= most) continue;
      most = left;
      longest = k;
    }
    if (most == 2) return false;
    std::vector<std::size_t> left;
    for (std::size_t l = 0; l < kept[longest].size(); ++l)
      if (kept[longest][l] != 0) left.push_back(l);
    for (std::size_t i = 1; i + 1 < left.size(); i += 2) kept[longest][left[i]] = 0;
    return true;
  }
};

}  // namespace

std::vector<char> thinned_cases(const StudyNumbers& n, const std::vector<char>& may,
                                const std::function<bool(const std::vector<char>& kept)>& fits) {
  std::vector<char> kept = may;
  KeptLevels levels(n);
  while (!fits(kept) && n.grid && levels.thin())
    for (std::size_t c = 0; c < may.size(); ++c) kept[c] = may[c] != 0 && levels.has(n, c) ? 1 : 0;
  const std::vector<char> before = kept;
  for (std::size_t every = 2; !fits(kept) && every <= may.size(); every *= 2) {
    std::size_t i = 0;
    for (std::size_t c = 0; c < may.size(); ++c) kept[c] = before[c] != 0 && i++ % every == 0 ? 1 : 0;
  }
  return kept;
}

}  // namespace dea
