#include <febiodea/io/files/unit_names.h>

namespace dea {

UnitNames unit_names(const std::string& system) {
  UnitNames u;
  u.system = system;
  struct System {
    const char *name, *length, *force, *pressure;
    double metres, newtons;
  };
  static constexpr System kSystems[] = {
      {"SI", "m", "N", "Pa", 1, 1},
      {"mm-N-s", "mm", "N", "MPa", 1e-3, 1},
      {"mm-kg-s", "mm", "mN", "kPa", 1e-3, 1e-3},
      {"um-nN-s", "µm", "nN", "kPa", 1e-6, 1e-9},
      {"CGS", "cm", "dyn", "dyn/cm²", 1e-2, 1e-5},
      {"mm-g-s", "mm", "µN", "Pa", 1e-3, 1e-6},
      {"mm-mg-s", "mm", "nN", "mPa", 1e-3, 1e-9},
  };
  for (const System& s : kSystems) {
    if (system != s.name) continue;
    u.length = s.length;
    u.force = s.force;
    u.pressure = s.pressure;
    u.area = u.length + "²";
    u.metres = s.metres;
    u.newtons = s.newtons;
  }
  return u;
}

}  // namespace dea
