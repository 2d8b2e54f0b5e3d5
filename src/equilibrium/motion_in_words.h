// src/equilibrium/motion_in_words.h – motions of bodies in words, for messages.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "src/equilibrium/forces.h"

namespace dea {

/// A motion of the unknowns (unknowns.h): "rotation of "femur" about (0.000, 0.000, 1.000)".
std::string direction_in_words(const Problem& problem, const Evaluation& e, const Eigen::VectorXd& direction);

/// How far a search has taken the body it moved most, and which way.
struct Travel {
  double reached = 0.0;  ///< of a point of its articular surface, at most
  std::string words;
};
Travel travel(const Problem& problem, const std::vector<Pose>& from, const std::vector<Pose>& to);

/// Nothing resists a motion: which one, how far it was followed. `unbalanced`: of the load, along it.
std::string says_nothing_resists(const Problem& problem, const std::vector<Pose>& started, const Evaluation& e,
                                 const Eigen::VectorXd& motion, double unbalanced);
/// What to do about it.
Sentence against_free_motion();

}  // namespace dea
