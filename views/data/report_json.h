// febiodea/views/data/report_json.h – results as JSON and CSV. Undefined numbers are null in JSON, empty in CSV.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include <febiodea/run/analysis.h>
#include <febiodea/run/convergence.h>

namespace dea {

using Json = nlohmann::ordered_json;

/// Where the time of a run went, in seconds.
struct Timings {
  double read = 0.0, joint = 0.0, solve = 0.0, write = 0.0, total = 0.0;
};

Json settings_json(const Settings& settings);
Json run_json(const JointModel& model, const Settings& settings, const Analysis& analysis, const Timings& timings);
Json converge_json(const JointModel& model, const Settings& settings, const std::vector<Convergence>& studies,
                   double target, int max_springs);

/// The JSON text, numbers such that they read back the same, with a line feed at the end. Text that is not UTF-8 is
/// mended.
std::string json_text(const Json& json);

/// Parts that several reports share.
Json json_vector(const Vector3d& v);
Json json_number(double x);  ///< null when not finite

/// One line per wanted state and contact, under a line of names.
std::string run_csv(const JointModel& model, const Analysis& analysis);

/// One line per wanted state, contact, side (primary, secondary) and facet of its surface, under a line of names.
/// Facets count from 1 in the model's surface. `area` and `reference_x,y,z` (centroid): of the facet's triangles in the
/// reference configuration; `x,y,z`: that centroid moved with the surface's body, not compressed; `thickness`: mean
/// over the facet. The rest: SideFields.
std::string facets_csv(const JointModel& model, const Analysis& analysis);

}  // namespace dea
