#include <febiodea/io/files/unit_names.h>

namespace dea {

UnitNames unit_names(const std::string& system) {
  UnitNames u;
  u.system = system;
  struct System {
    const char *name, *length, *force, *pressure;
  };
  static constexpr System kSystems[] = {{"SI", "m", "N", "Pa"},          {"mm-N-s", "mm", "N", "MPa"},
                                        {"mm-kg-s", "mm", "mN", "kPa"},  {"um-nN-s", "µm", "nN", "kPa"},
                                        {"CGS", "cm", "dyn", "dyn/cm²"}, {"mm-g-s", "mm", "µN", "Pa"},
                                        {"mm-mg-s", "mm", "nN", "mPa"}};
  for (const System& s : kSystems) {
    if (system != s.name) continue;
    u.length = s.length;
    u.force = s.force;
    u.pressure = s.pressure;
    u.area = u.length + "²";
  }
  return u;
}

}  // namespace dea
