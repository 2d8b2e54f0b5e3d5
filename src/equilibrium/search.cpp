#include "src/equilibrium/search.h"

#include "src/base/names.h"

namespace dea {

const char* name(Outcome outcome) {
  return word_of(outcome, {"Prescribed", "Balanced", "BalancedToOneSpring", "SurfacesApart", "NoEquilibrium",
                           "NotConverged", "BeyondStrainLimit", "NoContact"});
}

bool solved(Outcome outcome) {
  return outcome == Outcome::Prescribed || outcome == Outcome::Balanced || outcome == Outcome::BalancedToOneSpring;
}

}  // namespace dea
