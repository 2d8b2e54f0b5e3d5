// io/build/ligaments.h – bundles of ligaments from a table.
#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "src/build/ligament.h"

namespace dea {

struct LigamentRow {
  std::string name;
  std::string bone_a, bone_b;              ///< bones' names, not looked up yet
  Eigen::Vector3d point_a, point_b;        ///< each in the axes and unit of its bone's file
  double stiffness = 0.0;                  ///< force per strain, > 0
  std::optional<double> slack_length;      ///< in the unit of the files; one of these two is there
  std::optional<double> reference_strain;  ///< where the bones stand as they are placed
  double toe_strain = kToeStrain;
  int line = 0;
};

/// CSV with the columns name, body_a, x_a, y_a, z_a, body_b, x_b, y_b, z_b, stiffness, one of slack_length and
/// reference_strain in each row (both columns may be there), and, where they are wanted, curve (blankevoort or linear)
/// and toe_strain. `length`: unit of the files, as a column's name may say it; empty: unknown. Throws InputError.
std::vector<LigamentRow> read_ligaments(const std::string& path, const std::string& length);

}  // namespace dea
