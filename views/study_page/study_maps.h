// views/study_page/study_maps.h – stored pressures of a study as maps of its page: per case and state, what
// each place bears over the cycle, means of many cases.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "src/study/dose.h"
#include "views/page/page_parts.h"
#include "views/study_page/study_surfaces.h"

namespace dea {

/// What is asked of stored pressures beside showing them.
struct StudyMapOptions {
  StudyRegionOptions regions;
  std::optional<double> dose_above;       ///< threshold of overpressure
  std::optional<double> cycles_per_year;  ///< both or none: else the dose is of one cycle
  std::optional<double> years;
  std::optional<double> cycle_seconds;  ///< how long a cycle takes; none: the states' span, over years in seconds
};

/// More seconds than a cycle of a joint takes: then the model's time is no time in seconds (percent, steps).
inline constexpr double kLongestCycle = 10.0;
/// Throws UsageError: how long a cycle takes must be said, by the option `cycle_seconds`.
void check_dose(const StudyNumbers& numbers, const StudyMapOptions& options, const std::string& cycle_seconds);

/// What a place bears over a cycle: the largest pressure and, as exposure, the mean; none: a state of it is missing.
std::optional<TimeSums> cycle_sums(const std::vector<double>& times, const std::vector<std::vector<double>>& pressure);

/// Meshes, and the fields of as many cases as the page can hold (thinned_cases); null: there are none. `meshes`: of the
/// whole page.
Json maps_json(const std::string& path, const StudyNumbers& numbers, const StudyFields& fields,
               const StudyMapOptions& options, std::vector<std::string>& notes, Json& meshes, PageArrays& arrays);

/// Means and deviations over cases, per state and over the cycle; `column` >= 0: of each of its levels too, and their
/// differences from the first. Of each surface; of a contact with several meshes on one grid (common_grid, `up`), which
/// joins `meshes`, where all of them can be unrolled. null: no surface and no grid has two cases.
Json mean_maps_json(const std::string& path, const StudyNumbers& numbers, const StudyFields& fields, int column,
                    const Vector3d& up, std::vector<std::string>& notes, Json& meshes, PageArrays& arrays);

}  // namespace dea
