#include "src/geometry/coincident.h"

#include <cmath>

namespace dea {

namespace {

struct CellHash {
  std::size_t operator()(const GridCell& c) const {
    std::uint64_t h = 0;
    for (const std::int64_t i : c) h = (h ^ static_cast<std::uint64_t>(i)) * 0x9e3779b97f4a7c15ull, h ^= h >> 29;
    return static_cast<std::size_t>(h);
  }
};

}  // namespace

GridCell grid_cell(const Vector3d& x, double width) {
  constexpr double kOutermost = 1e18;  // fits, and so do its neighbours
  GridCell cell;
  for (std::size_t k = 0; k < 3; ++k)  // fmin and fmax are numbers also of NaN
    cell[k] = static_cast<std::int64_t>(
        std::fmax(-kOutermost, std::fmin(kOutermost, std::floor(x[static_cast<int>(k)] / width))));
  return cell;
}

std::unordered_map<int, int> coincident_nodes(const std::vector<int>& nodes, const std::vector<Vector3d>& positions,
                                              double tolerance) {
  std::unordered_map<int, int> stands_for;
  if (!(tolerance > 0)) return stands_for;
  const double size = 4 * tolerance;
  std::unordered_map<GridCell, std::vector<int>, CellHash> cells;
  std::unordered_map<int, char> seen;
  for (const int node : nodes) {
    if (!seen.try_emplace(node, 1).second) continue;
    const Vector3d& x = positions[at(node)];
    // the cells that the cube of the tolerance around x touches: one, seldom more
    const Vector3d reach = Vector3d::Constant(tolerance);
    const GridCell low = grid_cell(x - reach, size), high = grid_cell(x + reach, size);
    int first = -1;
    for (std::int64_t i = low[0]; i <= high[0]; ++i)
      for (std::int64_t j = low[1]; j <= high[1]; ++j)
        for (std::int64_t k = low[2]; k <= high[2]; ++k) {
          const auto found = cells.find({i, j, k});
          if (found == cells.end()) continue;
          for (const int other : found->second)
            if (first < 0 && (positions[at(other)] - x).norm() <= tolerance) first = other;
        }
    if (first >= 0) {
      stands_for[node] = first;
      continue;
    }
    cells[grid_cell(x, size)].push_back(node);
  }
  return stands_for;
}

}  // namespace dea
