// src/results/headline.h – the one set of numbers that a pressure map is summed up by, wherever it comes from:
// docs/theory.md, 6. Tables, JSON, CSV, pictures and pages show these first, and all have them from here.
#pragma once
#include <vector>

#include "src/base/numbers.h"
#include "src/model/joint_model.h"
#include "src/results/comparison.h"

namespace dea {

/// Of what is above a threshold; NaN, and area 0: nothing is. Area and mean: of where pressure is above it within
/// facets (within_facets.h). p99 and peak: of nodal averages, as single facets of finite elements are noisy; weighted
/// by the nodes' areas, and no less than the mean, which nodes at the edge of a contact of one facet would be.
struct Headline {
  double above = kNaN;  ///< the threshold (H1)
  double p99 = kNaN, mean = kNaN, area = 0.0, peak = kNaN;
};

/// The threshold over the mean pressure of the load (H1).
inline constexpr double kHeadlineShare = 0.05;

/// By their names, in the order in which they are shown.
struct HeadlineNumber {
  const char* name;
  double Headline::*value;
};
inline constexpr HeadlineNumber kHeadlineNumbers[] = {
    {"p99", &Headline::p99}, {"mean", &Headline::mean}, {"area", &Headline::area}, {"peak", &Headline::peak}};

/// `pressure`: per facet. With a mask the numbers are of these facets' shares; the threshold is that of the surface.
Headline headline(const ResultSurface& surface, const std::vector<double>& pressure, const FacetMask& mask = {});

/// A surface and values on it as a plot file holds them, in single precision; what is not finite is 0 there. Numbers of
/// a run are measured on these, so that they are those of its file to the last digit.
ResultSurface plotted_surface(const JointModel& model, const Surface& surface);
std::vector<double> plotted_values(std::vector<double> values);

}  // namespace dea
