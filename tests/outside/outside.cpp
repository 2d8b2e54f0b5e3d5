// Usage: outside MODEL.feb RESULT.xplt. Prints peak pressure and force of the last state.
#include <febiodea/febiodea.h>
#include <cmath>
#include <cstdio>

int main(int, char** arguments) {
  const dea::Recognition found = dea::recognise(dea::read_feb(arguments[1]));
  for (const dea::Fault& fault : found.faults) std::fprintf(stderr, "%s\n", dea::line(fault).c_str());
  if (!found.faults.empty()) return 3;
  const dea::Analysis result = dea::analyse(found);
  dea::write_xplt(arguments[2], dea::make_plot_file(found, result));
  const dea::ContactStatistics& contact = result.states.back().statistics.front();
  std::printf("%.17g %.17g\n", contact.peak, contact.force.norm());
  // the last pose again, pressed by itself: the same force, as far as the pressures are known
  const dea::Prepared joint = dea::prepare(found);
  const dea::Pressed pressed = dea::press(joint, result.states.back().equilibrium.poses);
  const double force = pressed.contacts.front().on_target.head<3>().norm();
  if (std::abs(force - contact.force.norm()) > 1e-6 * contact.force.norm()) return 4;
  return dea::solved(result.states.back().equilibrium.outcome) ? 0 : 1;
}
