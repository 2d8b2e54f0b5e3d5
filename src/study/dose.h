// src/study/dose.h – what each place of a surface bears over a cycle, and over years of cycles.
//
// With the pressure p(t) of a place, linear in time between states, and a threshold p_d:
//     exposure      integral of p dt
//     overpressure  integral of max(0, p - p_d) dt, exact also where p crosses p_d between two states
// Pressure summed over time, above a threshold, as what cartilage bears is due to Hadley, Brown and Weinstein (1990)
// and Maxian, Brown and Weinstein (1995). Russell et al. (2006, 10.1186/1749-799X-1-6) report it in MPa-years, for 2
// million cycles a year, 20 years and p_d = 2 MPa. That p_d is an assumption about cartilage: there is no default.
#pragma once
#include <cstddef>
#include <vector>

namespace dea {

/// Per place (facet or vertex). NaN: a state's pressure of this place is.
struct Dose {
  std::vector<double> exposure, overpressure;
};

/// Of one cycle, from the first state to the last [pressure x the model's time]. `times`: of two or more states,
/// rising. `pressures`: per state one value per place. Nothing is added between the last state and the first of the
/// next cycle. Throws UsageError: other times, states of different sizes, a threshold that is negative or no number.
Dose cycle_dose(const std::vector<double>& times, const std::vector<std::vector<double>>& pressures, double threshold);

/// How often a cycle was gone through.
struct LoadingHistory {
  double cycle_seconds = 0.0;    ///< how long the first state to the last takes, whatever the model's unit of time
  double cycles_per_year = 0.0;  ///< 2e6 in Russell et al. 2006
  double years = 0.0;            ///< 20 there
};
inline constexpr double kSecondsPerYear = 31557600.0;  ///< of 365.25 days

/// Of all cycles [pressure x years]: that of one cycle times its share of a second per unit of the model's time, the
/// number of cycles, and years per second. Every cycle counts the same. Throws UsageError as cycle_dose, and for a
/// history with a negative number or none.
Dose chronic_dose(const std::vector<double>& times, const std::vector<std::vector<double>>& pressures, double threshold,
                  const LoadingHistory& history);

/// Share of the area, 0 to 1, with a value above a threshold: sum of A where value > threshold over sum of A. Places
/// with NaN count in neither; NaN: no area is left. `areas`: one per value, not negative, else UsageError.
double share_above(const std::vector<double>& values, const std::vector<double>& areas, double threshold);

}  // namespace dea
