// src/base/numbers.h – indices, and numbers with a name.
#pragma once
#include <cstddef>
#include <limits>

namespace dea {

/// An index of ours (signed, -1: none) as one of a standard container.
constexpr std::size_t at(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kDegreesPerRadian = 57.295779513082323;

}  // namespace dea
