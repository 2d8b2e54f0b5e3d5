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

/// `get` of each entry of a list that has one per file.
template <class List, class Get>
Quantity quantity(const std::string& name, const List& list, Get get, Dimension dimension = Dimension::Pressure) {
  Quantity q{name, {}, true, dimension};
  for (const auto& of_file : list) q.values.push_back(get(of_file));
  return q;
}

/// One of the headline numbers.
inline Quantity headline_quantity(const HeadlineNumber& number, const ComparedRegion& region) {
  const bool area = number.value == &Headline::area;
  return quantity(
      number.name, region.headlines, [&](const Headline& h) { return h.*number.value; },
      area ? Dimension::Area : Dimension::Pressure);
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
