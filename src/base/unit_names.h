// src/base/unit_names.h – names of units in FEBio's systems of units, for axes and scales.
#pragma once
#include <string>
#include <vector>

namespace dea {

/// Empty: the files name no units, and nothing is claimed.
struct UnitNames {
  std::string system;  ///< as the file has it
  std::string length, force, pressure, area;
  double metres = 0.0, newtons = 0.0;  ///< of a unit of length, of force; 0: the system is none of FEBio's
};
/// Of FEBio's systems ("mm-N-s": mm, N, MPa); others: the name alone.
UnitNames unit_names(const std::string& system);

/// "SI", "mm-N-s", ...
std::vector<std::string> unit_systems();

/// What a number is, as far as its unit goes.
enum class Dimension { None, Pressure, Area, Force, Moment, Length };
/// Empty: it has none, or nobody names one.
std::string unit_of(const UnitNames& units, Dimension dimension);
/// "peak [MPa]"; without a unit: "peak".
std::string with_unit(const std::string& name, const UnitNames& units, Dimension dimension);

}  // namespace dea
