// views/map/map_scale.h – the one rule for the scale of maps: where its ends are, which lines of equal value
// are drawn. For pictures (`dea plot`) and for the page, which gets the numbers.
#pragma once
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "src/results/comparison.h"
#include "views/map/colour_map.h"

namespace dea {

/// Pressures between surfaces, never below 0; not every field with such a name is one (`pressure gap`).
bool is_pressure(const std::string& field);
/// Stress inside the cartilage.
bool is_stress(const std::string& field);
/// Fields of `dea compare -o` that are differences.
bool is_difference(const std::string& field);
/// Fields that are 0 where there is no contact; in others 0 stands for "none", as plot files have no undefined values.
bool zero_without_contact(const std::string& field);

/// What is shown of a field: NaN where there is nothing.
struct MapValues {
  std::vector<double> facets, vertices;  ///< vertices: area-weighted averages of the facets around that have a value
};
/// `facets`: the file's values. Those that are not finite are none, and so is 0 in fields without contact's zero.
MapValues map_values(const ResultSurface& surface, const std::string& field, std::vector<double> facets);

/// Least and largest of the values that a scale is for.
struct ValueRange {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  bool empty() const { return !(most >= least); }
  void add(double x);  ///< passes over what is not finite
  void add(const std::vector<double>& values);
  void add(const ValueRange& other);
};

/// Adds value and area of each facet to `found`; values of 0 or none do not count.
void add_areas(const ResultSurface& surface, const std::vector<double>& facets,
               std::vector<std::pair<double, double>>& found);
/// The value that 95 % of the area stays below; 0: there is no area.
double most_of_area_below(std::vector<std::pair<double, double>> found);

struct MapScale {
  double low = 0.0, high = 1.0;
  double step = 0.2;   ///< from one number of the colour bar to the next, and from line to line
  bool empty = false;  ///< not one value: ends mean nothing
};
/// What is known of a field before its values are: see map_scale.
struct ScaleKind {
  ColourMap map = ColourMap::Sequential;
  bool pressure = true;  ///< begins at 0
  double usual = 0.0;    ///< the upper end where the largest value means little (joint space); 0: it is the end
  std::optional<double> low, high;  ///< what the user says
};
/// Differences: from minus to plus the largest size. Else from 0, from the least value if that is below 0 or (no
/// pressure) above half of the largest, to the largest. `high` - `low` > 0 unless the user's ends leave no width.
MapScale map_scale(const ScaleKind& kind, const ValueRange& range);

/// Numbers 1, 2 or 5 times a power of ten apart, at most this many steps from end to end.
constexpr int kScaleSteps = 6;
constexpr std::array<double, 4> kScaleMultiples = {1, 2, 5, 10};
double scale_step(double low, double high);
/// Multiples of the step from end to end.
std::vector<double> scale_ticks(const MapScale& scale);
/// Lines of equal value: at the numbers between the ends. At 0 only where values go on below it, and not in
/// differences, where it is everywhere beside contact.
std::vector<double> scale_lines(const MapScale& scale, ColourMap map);

/// Whether a line on this colour is white, else black.
bool white_line(const Rgb& under);

}  // namespace dea
