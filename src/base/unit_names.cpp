#include "src/base/unit_names.h"

namespace dea {

namespace {

struct UnitSystem {
  const char *name, *length, *force, *pressure;
  double metres, newtons;
};
constexpr UnitSystem kUnitSystems[] = {
    {"SI", "m", "N", "Pa", 1, 1},
    {"mm-N-s", "mm", "N", "MPa", 1e-3, 1},
    {"mm-kg-s", "mm", "mN", "kPa", 1e-3, 1e-3},
    {"um-nN-s", "µm", "nN", "kPa", 1e-6, 1e-9},
    {"CGS", "cm", "dyn", "dyn/cm²", 1e-2, 1e-5},
    {"mm-g-s", "mm", "µN", "Pa", 1e-3, 1e-6},
    {"mm-mg-s", "mm", "nN", "mPa", 1e-3, 1e-9},
};

}  // namespace

UnitNames unit_names(const std::string& system) {
  for (const UnitSystem& s : kUnitSystems)
    if (system == s.name)
      return {system, s.length, s.force, s.pressure, s.length + std::string("²"), s.metres, s.newtons};
  return {system, "", "", "", ""};
}

std::vector<std::string> unit_systems() {
  std::vector<std::string> names;
  for (const UnitSystem& s : kUnitSystems) names.push_back(s.name);
  return names;
}

std::string unit_of(const UnitNames& of, Dimension dimension) {
  const std::string moment = of.force.empty() ? "" : of.force + " " + of.length;
  const std::string units[] = {"", of.pressure, of.area, of.force, moment, of.length};  // in Dimension's order
  return units[static_cast<std::size_t>(dimension)];
}

std::string with_unit(const std::string& name, const UnitNames& units, Dimension dimension) {
  const std::string unit = unit_of(units, dimension);
  return unit.empty() ? name : name + " [" + unit + "]";
}

}  // namespace dea
