#include <febiodea/equilibrium/search.h>

#include <cassert>

namespace dea {

const char* name(Outcome outcome) {
  switch (outcome) {
    case Outcome::Prescribed:
      return "Prescribed";
    case Outcome::Balanced:
      return "Balanced";
    case Outcome::BalancedToOneSpring:
      return "BalancedToOneSpring";
    case Outcome::SurfacesApart:
      return "SurfacesApart";
    case Outcome::NoEquilibrium:
      return "NoEquilibrium";
    case Outcome::NotConverged:
      return "NotConverged";
    case Outcome::BeyondStrainLimit:
      return "BeyondStrainLimit";
  }
  assert(false);
  return "";
}

bool solved(Outcome outcome) {
  return outcome == Outcome::Prescribed || outcome == Outcome::Balanced || outcome == Outcome::BalancedToOneSpring;
}

}  // namespace dea
