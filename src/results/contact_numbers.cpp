#include "src/results/contact_numbers.h"

#include <fmt/format.h>

namespace dea {

namespace {

template <class Of>
using Numbers = std::vector<NamedNumber<Of>>;

/// NAMEx, NAMEy, NAMEz.
template <class Of>
void add_vector(Numbers<Of>& numbers, const std::string& name, Vector3d Of::*vector) {
  for (int k = 0; k < 3; ++k) numbers.push_back({name + "xyz"[k], [=](const Of& of) { return (of.*vector)[k]; }});
}

/// Those of the headline that is a member of `Of`.
template <class Of>
void add_headline(Numbers<Of>& numbers) {
  for (const NamedNumber<Headline>& n : headline_columns())
    numbers.push_back({n.name, [value = n.value](const Of& of) { return value(of.headline); }});
}

}  // namespace

const Numbers<ContactStatistics>& spring_numbers() {
  using S = ContactStatistics;
  static const Numbers<S> all = [] {
    Numbers<S> numbers;
    const auto add_count = [&](const char* name, int S::*n) {
      numbers.push_back({name, [=](const S& s) { return static_cast<double>(s.*n); }, true});
    };
    const auto add = [&](const char* name, double S::*x) {
      numbers.push_back({name, [=](const S& s) { return s.*x; }});
    };
    add_count("springs", &S::springs);
    add_count("springs_hit", &S::springs_hit);
    add_count("springs_active", &S::springs_active);
    add("peak_pressure", &S::peak);
    add("p99_pressure", &S::p99);
    add("mean_pressure", &S::mean);
    add("median_pressure", &S::median);
    add("p5_pressure", &S::p5);
    add("p25_pressure", &S::p25);
    add("p75_pressure", &S::p75);
    add("p95_pressure", &S::p95);
    add("contact_area", &S::contact_area);
    add("facet_peak_pressure", &S::facet_peak);
    add("nodal_peak_pressure", &S::nodal_peak);
    add("nodal_mean_pressure", &S::nodal_mean);
    add("nodal_median_pressure", &S::nodal_median);
    add("facet_contact_area", &S::facet_contact_area);
    add_vector(numbers, "center_of_pressure_", &S::center_of_pressure);
    add_vector(numbers, "force_", &S::force);
    add_vector(numbers, "moment_", &S::moment);
    add("largest_strain", &S::largest_strain);
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
    const auto add = [&](const char* name, double Headline::*x) {
      numbers.push_back({std::string("headline_") + name, [=](const Headline& h) { return h.*x; }});
    };
    for (const HeadlineNumber& n : kHeadlineNumbers) add(n.name, n.value);
    add("above", &Headline::above);
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

const Numbers<CompartmentLoad>& compartment_numbers() {
  static const Numbers<CompartmentLoad> all = [] {
    Numbers<CompartmentLoad> numbers;
    add_headline(numbers);
    add_vector(numbers, "force_", &CompartmentLoad::force);
    add_vector(numbers, "center_of_pressure_", &CompartmentLoad::center_of_pressure);
    return numbers;
  }();
  return all;
}

}  // namespace dea
