// views/compare/quantities.h – the numbers of a comparison by name, for tables, JSON and CSV.
#pragma once
#include <string>
#include <vector>

#include "src/base/unit_names.h"
#include "views/compare/compare_files.h"

namespace dea {

/// A number that exists for every file, and how to call it.
struct Quantity {
  std::string name;  ///< of the table's line, or of the column of CSV
  std::vector<double> values;
  bool compared = true;  ///< false: a difference of two of them says nothing
  Dimension dimension = Dimension::Pressure;
};

template <class Get>
Quantity quantity(const std::string& name, const ComparedRegion& region, Get get,
                  Dimension dimension = Dimension::Pressure) {
  Quantity q{name, {}, true, dimension};
  for (const SurfaceMeasures& m : region.results) q.values.push_back(get(m));
  return q;
}

/// One of the headline numbers.
inline Quantity headline_quantity(const HeadlineNumber& number, const ComparedRegion& region) {
  Quantity q{number.name, {}};
  if (number.value == &Headline::area) q.dimension = Dimension::Area;
  for (const Headline& h : region.headlines) q.values.push_back(h.*number.value);
  return q;
}

/// The numbers of a distribution of pressure.
struct DistributionNumber {
  const char* name;
  double Distribution::*value;
};
inline constexpr DistributionNumber kDistributionNumbers[] = {
    {"peak", &Distribution::peak}, {"p99", &Distribution::p99}, {"mean", &Distribution::mean},
    {"p5", &Distribution::p5},     {"p25", &Distribution::p25}, {"median", &Distribution::median},
    {"p75", &Distribution::p75},   {"p95", &Distribution::p95}, {"p99_unweighted", &Distribution::p99_unweighted},
    {"area", &Distribution::area}};

/// The numbers over time: by their names in JSON, CSV and the table; not all are in that.
struct TimeNumber {
  const char *name, *key, *words;
  double TimeMeasures::*value;
};
inline constexpr TimeNumber kTimeNumbers[] = {
    {"max_peak", "max_peak_over_time", nullptr, &TimeMeasures::max_peak},
    {"mean_peak", "mean_peak_over_time", "peak over time, mean of nodes", &TimeMeasures::mean_peak},
    {"max_exposure", "max_exposure", "exposure, largest of nodes", &TimeMeasures::max_exposure},
    {"mean_exposure", "mean_exposure", "exposure, mean of nodes", &TimeMeasures::mean_exposure},
    {"max_dose", "max_dose", "dose, largest of nodes", &TimeMeasures::max_dose},
    {"mean_dose", "mean_dose", "dose, mean of nodes", &TimeMeasures::mean_dose}};

}  // namespace dea
