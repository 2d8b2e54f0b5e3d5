#include "src/results/contact_numbers.h"

#include <fmt/format.h>

namespace dea {

namespace {

template <class Of>
using Numbers = std::vector<NamedNumber<Of>>;

void add(Numbers<ContactStatistics>& numbers, const std::string& name, int ContactStatistics::*count) {
  numbers.push_back({name, [=](const ContactStatistics& s) { return static_cast<double>(s.*count); }, true});
}

template <class Of>
void add(Numbers<Of>& numbers, const std::string& name, double Of::*number) {
  numbers.push_back({name, [=](const Of& of) { return of.*number; }});
}

void add(Numbers<PartStress>& numbers, const std::string& name, PartNumber PartStress::*of,
         double PartNumber::*number) {
  numbers.push_back({name, [=](const PartStress& s) { return s.*of.*number; }});
}

/// NAME_x, NAME_y, NAME_z.
template <class Of>
void add(Numbers<Of>& numbers, const std::string& name, Vector3d Of::*vector) {
  for (int k = 0; k < 3; ++k) numbers.push_back({name + '_' + "xyz"[k], [=](const Of& of) { return (of.*vector)[k]; }});
}

/// Those of the headline that is a member of `Of`.
template <class Of>
void add_headline(Numbers<Of>& numbers) {
  for (const NamedNumber<Headline>& n : headline_columns())
    numbers.push_back({n.name, [value = n.value](const Of& of) { return value(of.headline); }});
}

}  // namespace

const std::vector<SpringNumber>& spring_table() {
  using S = ContactStatistics;
  static const std::vector<SpringNumber> table = {{"springs", &S::springs},
                                                  {"springs_hit", &S::springs_hit},
                                                  {"springs_active", &S::springs_active},
                                                  {"peak_pressure", &S::peak},
                                                  {"p99_pressure", &S::p99},
                                                  {"mean_pressure", &S::mean},
                                                  {"median_pressure", &S::median},
                                                  {"p5_pressure", &S::p5},
                                                  {"p25_pressure", &S::p25},
                                                  {"p75_pressure", &S::p75},
                                                  {"p95_pressure", &S::p95},
                                                  {"contact_area", &S::contact_area},
                                                  {"facet_peak_pressure", &S::facet_peak},
                                                  {"nodal_peak_pressure", &S::nodal_peak},
                                                  {"nodal_mean_pressure", &S::nodal_mean},
                                                  {"nodal_median_pressure", &S::nodal_median},
                                                  {"facet_contact_area", &S::facet_contact_area},
                                                  {"center_of_pressure", &S::center_of_pressure},
                                                  {"force", &S::force},
                                                  {"moment", &S::moment},
                                                  {"largest_strain", &S::largest_strain}};
  return table;
}

const Numbers<ContactStatistics>& spring_numbers() {
  static const Numbers<ContactStatistics> all = [] {
    Numbers<ContactStatistics> numbers;
    for (const SpringNumber& row : spring_table())
      std::visit([&](auto value) { add(numbers, row.name, value); }, row.value);
    return numbers;
  }();
  return all;
}

namespace {

/// All numbers of both ends of a layer. `ends`: of what they are.
template <class Of, class Ends>
void add_inside(Numbers<Of>& numbers, const std::string& before, Ends ends) {
  for (const InsideEnd& end : kInsideEnds)
    for (const InsideMeasure& measure : kInsideMeasures)
      for (const InsideNumber& number : kInsideNumbers)
        numbers.push_back({fmt::format("{}{}_{}_{}", before, end.name, measure.name, number.name), [=](const Of& of) {
                             const std::optional<InsideEnds>& there = ends(of);
                             return there ? (*there).*end.value.*measure.value.*number.value : kNaN;
                           }});
}

}  // namespace

const Numbers<ContactStatistics>& inside_numbers() {
  static const Numbers<ContactStatistics> all = [] {
    Numbers<ContactStatistics> numbers;
    for (const int side : {0, 1})
      add_inside(numbers, side == 0 ? "source_" : "target_",
                 [side](const ContactStatistics& s) -> const std::optional<InsideEnds>& { return s.inside[side]; });
    return numbers;
  }();
  return all;
}

const Numbers<CompartmentLoad>& compartment_inside_numbers() {
  static const Numbers<CompartmentLoad> all = [] {
    Numbers<CompartmentLoad> numbers;
    add_inside(numbers, "", [](const CompartmentLoad& c) -> const std::optional<InsideEnds>& { return c.inside; });
    return numbers;
  }();
  return all;
}

const Numbers<Headline>& headline_columns() {
  static const Numbers<Headline> all = [] {
    Numbers<Headline> numbers;
    for (const HeadlineNumber& n : kHeadlineNumbers) add(numbers, std::string("headline_") + n.name, n.value);
    add(numbers, "headline_above", &Headline::above);
    return numbers;
  }();
  return all;
}

const Numbers<ContactStatistics>& contact_numbers() {
  static const Numbers<ContactStatistics> all = [] {
    Numbers<ContactStatistics> numbers = spring_numbers();
    add_headline(numbers);
    return numbers;
  }();
  return all;
}

const Numbers<LayerStatistics>& layer_numbers() {
  static const Numbers<LayerStatistics> all = [] {
    Numbers<LayerStatistics> numbers;
    add_headline(numbers);
    add(numbers, "force", &LayerStatistics::force);
    return numbers;
  }();
  return all;
}

const Numbers<PartStress>& part_numbers() {
  static const Numbers<PartStress> all = [] {
    Numbers<PartStress> numbers;
    add(numbers, "first_principal_stress_p99", &PartStress::principal, &PartNumber::p99);
    add(numbers, "first_principal_stress_peak", &PartStress::principal, &PartNumber::peak);
    add(numbers, "fibre_stress_p99", &PartStress::fibre, &PartNumber::p99);
    add(numbers, "fibre_stress_peak", &PartStress::fibre, &PartNumber::peak);
    add(numbers, "largest_strain", &PartStress::largest_strain);
    add(numbers, "largest_turn", &PartStress::largest_turn);
    add(numbers, "largest_displacement", &PartStress::largest_displacement);
    return numbers;
  }();
  return all;
}

const Numbers<CompartmentLoad>& compartment_numbers() {
  static const Numbers<CompartmentLoad> all = [] {
    Numbers<CompartmentLoad> numbers;
    add_headline(numbers);
    add(numbers, "force", &CompartmentLoad::force);
    add(numbers, "center_of_pressure", &CompartmentLoad::center_of_pressure);
    return numbers;
  }();
  return all;
}

}  // namespace dea
