// src/base/time_text.h – times as they were meant: one way for tables, messages, titles and pages.
#pragma once
#include <string>

namespace dea {

/// The time with nine digits at most and no zeros behind: "1.985", also of 1.9850000000000001 (a sum of time steps) and
/// of 1.98500001 (a plot file holds single precision). Not finite: "-".
std::string time_text(double time);

/// The number that time_text shows.
double time_meant(double time);

}  // namespace dea
