// views/page/page_context.h – the rest of the mesh, which a page draws as a veil around the surfaces.
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/results/result_file.h"

namespace dea {

/// A rigid motion from the reference configuration: x -> rotation x + translation.
struct PagePose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vector3d translation = Vector3d::Zero();
};

/// Outside of the first result's elements, coarse enough to be drawn as a veil.
struct PageContext {
  std::vector<float> vertices;            ///< 3 each
  std::vector<std::int32_t> triangles;    ///< 3 each
  std::vector<std::string> parts;         ///< per domain of the mesh its material: bodies that move apart may share one
  std::vector<std::size_t> domains;       ///< which these are
  std::vector<std::int32_t> begin = {0};  ///< per part + 1: range of its triangles
  std::string note;                       ///< why there is none
  /// Where the parts, and the page's surfaces, stand in each state; none: the state has no displacement. Empty: nothing
  /// turns or moves.
  std::vector<std::vector<std::optional<PagePose>>> parts_move, surfaces_move;
};

/// Triangles of faces that belong to one solid element only, and of shells.
PageContext make_context(const XpltMesh& mesh);

/// The rigid motion that is nearest to the `displacement` of nodes in a state (least squares: a rigid body's own, and
/// of what is deformed its mean); none: the state has none, or the nodes lie on a line.
std::optional<PagePose> motion_of(const ResultFile& file, int state, const std::vector<int>& nodes);
/// Adds how the context of the mesh of `state`, and surfaces of it (their indices), move in the file's states.
void add_motion(const ResultFile& file, int state, const std::vector<int>& surfaces, PageContext& context);

}  // namespace dea
