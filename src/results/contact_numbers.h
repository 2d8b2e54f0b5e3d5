// src/results/contact_numbers.h – the numbers of a contact by their names: JSON, CSV, a study's file and Python share
// these, in this order.
#pragma once
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "src/results/part_results.h"
#include "src/results/statistics.h"

namespace dea {

/// A number with its name; a vector is three of them: "force_x", "force_y", "force_z".
template <class Of>
struct NamedNumber {
  std::string name;
  std::function<double(const Of&)> value;  ///< NaN: undefined
  bool count = false;                      ///< a whole number
};

/// A count, number or vector of a contact by its name in JSON.
struct SpringNumber {
  const char* name;
  std::variant<int ContactStatistics::*, double ContactStatistics::*, Vector3d ContactStatistics::*> value;
};
/// Of springs and facets: "springs" to "largest_strain".
const std::vector<SpringNumber>& spring_table();
/// The same, each component of a vector by itself.
const std::vector<NamedNumber<ContactStatistics>>& spring_numbers();
/// "headline_p99", ..., "headline_above".
const std::vector<NamedNumber<Headline>>& headline_columns();

/// spring_numbers, then those of the headline.
const std::vector<NamedNumber<ContactStatistics>>& contact_numbers();
/// Those of the headline, then "force_x", ..., "center_of_pressure_z".
const std::vector<NamedNumber<CompartmentLoad>>& compartment_numbers();

/// Those of the headline, then "force".
const std::vector<NamedNumber<LayerStatistics>>& layer_numbers();

/// Of a part that gives way: "first_principal_stress_p99" to "largest_displacement".
const std::vector<NamedNumber<PartStress>>& part_numbers();

/// Of the inside of both layers: "source_bone_max_shear_stress_peak", ...; NaN: not asked for, or no layer.
const std::vector<NamedNumber<ContactStatistics>>& inside_numbers();
/// Of a compartment's layer: "bone_max_shear_stress_peak", ...
const std::vector<NamedNumber<CompartmentLoad>>& compartment_inside_numbers();

}  // namespace dea
