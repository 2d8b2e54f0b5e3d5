// src/build/ligament.h – a bundle of a ligament: a line between points of two bones that only pulls.
// Points: in the joint's axes, where the bones are placed. Lengths: the joint's; stiffness: force per strain.
#pragma once
#include <Eigen/Core>
#include <string>

namespace dea {

/// Of many ligaments: strain where the straight part of the curve begins, 2 e_l (Blankevoort and Huiskes 1991,
/// J Biomech Eng 113:263).
inline constexpr double kToeStrain = 0.06;

struct BuiltLigament {
  std::string name;
  int bone_a = -1, bone_b = -1;
  Eigen::Vector3d point_a = Eigen::Vector3d::Zero(), point_b = Eigen::Vector3d::Zero();
  double stiffness = 0.0;          ///< k, force per strain beyond the toe, > 0
  double slack_length = 0.0;       ///< > 0
  double toe_strain = kToeStrain;  ///< 2 e_l; 0: no toe, straight from the slack length on
};

/// As it is built.
inline double length_of(const BuiltLigament& l) { return (l.point_b - l.point_a).norm(); }

/// From the slack length: e = L / L_slack - 1.
inline double strain_of(const BuiltLigament& l, double length) { return length / l.slack_length - 1; }

/// The slack length of a ligament that has a strain at a length: the reference strain e_r at L_r.
inline double slack_length(double reference_length, double reference_strain) {
  return reference_length / (1 + reference_strain);
}

/// f = 0 below the slack length; k e^2 / (4 e_l) up to the toe's end e = 2 e_l; beyond it k (e - e_l), which goes on
/// with the same force and slope. Without a toe k e.
inline double force_of(const BuiltLigament& l, double length) {
  const double e = strain_of(l, length), k = l.stiffness, e_l = l.toe_strain / 2;
  if (e <= 0) return 0.0;
  return e < l.toe_strain ? k * e * e / (4 * e_l) : k * (e - e_l);
}

}  // namespace dea
