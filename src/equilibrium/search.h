// src/equilibrium/search.h – how a search for equilibrium ends, what it may cost, and what it tells on its way.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/sentence.h"
#include "src/base/stop.h"

namespace dea {

enum class Outcome {
  Prescribed,           ///< no free dof: the motion was given
  Balanced,             ///< forces and moments of all free dofs balance to the tolerance
  BalancedToOneSpring,  ///< balanced up to the force of one spring that jumps on and off a rim
  SurfacesApart,        ///< the loads move the surfaces apart: no contact can carry them
  NoEquilibrium,        ///< a direction nothing resists is loaded
  NotConverged,         ///< none of the above was reached within the iterations
  BeyondStrainLimit,    ///< springs strained beyond 0.9 (C1): prescribed, balanced, or not to be balanced (message)
  NoContact,            ///< nothing loads a free body and nothing presses it: any place is a balance
  PressedTwice          ///< two partners press one place of a layer at once, and it carries more than kMostTwice
};
inline constexpr Outcome kLastOutcome = Outcome::PressedTwice;
inline const char* name(Outcome outcome) {
  return word_of(outcome, {"Prescribed", "Balanced", "BalancedToOneSpring", "SurfacesApart", "NoEquilibrium",
                           "NotConverged", "BeyondStrainLimit", "NoContact", "PressedTwice"});
}
inline bool solved(Outcome outcome) {
  return outcome == Outcome::Prescribed || outcome == Outcome::Balanced || outcome == Outcome::BalancedToOneSpring;
}

/// How far a search has come, for whoever watches; told before each pose that is tried.
struct SearchStatus {
  int iterations = 0;      ///< Newton steps begun
  int casts = 0;           ///< poses tried, with this one
  double residual = kNaN;  ///< unbalanced / applied force at the last iterate; NaN: none is known yet
};

/// How a search ended.
struct SearchEnd {
  Outcome outcome = Outcome::NotConverged;
  std::string message = {};          ///< one sentence with the numbers behind the outcome
  Sentence advice = {};              ///< what to do about it, goes on from the message; empty: nothing is known
  int iterations = 0;                ///< Newton steps
  std::vector<double> history = {};  ///< scaled residual / load at each iterate
};

struct EquilibriumOptions {
  double tolerance = 1e-9;  ///< unbalanced / applied force; far below the error of any mesh, and Newton gets there
  int max_iterations = 60;  ///< a stop for loads that no contact can carry
  int max_casts = 160;      ///< poses tried for one load case; solved ones need some ten, seldom a hundred
  int patience = 20;        ///< poses tried in which the residual falls by less than 7%: then the search is given up
  std::function<void(const SearchStatus&)> watch;  ///< may be empty; changes nothing
  const StopFlag* stop = nullptr;  ///< not owned; once it is set the search throws Stopped, also within a contact
};

}  // namespace dea
