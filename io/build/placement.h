// io/build/placement.h – poses of bones from files: how points in a bone's own axes come to where the bone stands.
#pragma once
#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace dea {

struct FilePose {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< as it stands in the file: p' = rotation p + translation
  bool itk = false;        ///< an ITK transform, as Slicer's .tfm: in mm and LPS axes, from where a point comes
  double corrected = 0.0;  ///< by how much the rotation's numbers were off; it is exact now
};

/// A 4x4 matrix as text (16 numbers, row by row, between white space, commas, semicolons or brackets; lines that begin
/// with # or % are passed over), or an ITK text file with one linear transform. Throws InputError: another file, a
/// matrix that scales, shears or mirrors, a last row that is not 0 0 0 1.
FilePose read_pose(const std::string& path);

/// A pose of 16 numbers, row by row. Throws BadValue.
FilePose pose_of(const std::vector<double>& numbers);

}  // namespace dea
