// io/tables/pose_matrices.h – rows of 4x4 matrices, as OpenSim-JAM writes where bodies are: columns NAME11 to NAME44.
#pragma once
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "io/tables/table.h"

namespace dea {

/// Names of the matrices that the table has whole, whatever their order: "femur_T" of femur_T11 to femur_T44.
std::vector<std::string> matrix_names(const NumberTable& table);

/// Its columns NAME14, NAME24, NAME34, which are lengths. Throws UsageError, in the name of the setting that has
/// `given`: columns of this matrix are missing.
std::vector<int> place_columns(const NumberTable& table, const std::string& name, const char* setting,
                               const std::string& given);

/// A pose per row, of a matrix that is there: X_G = rotation X_body + place, place times `length`. The rotation is the
/// nearest one. Throws InputError, with line and columns: a matrix that is none of a pose to 1e-3.
std::vector<Eigen::Isometry3d> poses_of(const NumberTable& table, const std::string& name, double length);

/// What the rows move the body by, in the model's axes, from where it starts:
///   empty start:       T              the model has the body in its own frame
///   row s:             T T_s^-1       as row s has it; T: of the body, relative to the other one where there is one
///   row s, in ground:  O_s O^-1 T T_s^-1 with T, O of body and other in the table's axes: as row s has both
/// `other`: empty, or of the body that is held, a pose per row.
struct PoseStart {
  int row = -1;  ///< -1: own frames
  bool in_ground = false;
};
std::vector<Eigen::Isometry3d> moves_from(const PoseStart& start, const std::vector<Eigen::Isometry3d>& body,
                                          const std::vector<Eigen::Isometry3d>& other);

}  // namespace dea
