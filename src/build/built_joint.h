// src/build/built_joint.h – a joint made of surfaces: what a model file is written from.
#pragma once
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "src/geometry/triangle_surface.h"

namespace dea {

/// Cartilage bonded to a bone, as one sheet of prisms; or a part of a bare bone. Frame: global, reference.
struct BuiltLayer {
  std::string name;
  int body = -1;
  bool bare = false;                          ///< no cartilage: `articular` is the bone, `bone` is empty
  std::vector<Eigen::Vector3d> articular;     ///< per vertex
  std::vector<Eigen::Vector3d> bone;          ///< per vertex: beneath it
  std::vector<std::array<int, 3>> triangles;  ///< vertices, counter-clockwise seen from the joint space

  TriangleSurface face() const { return {articular, triangles}; }
};

/// A bone, and what holds and loads it.
struct BoneLoads {
  std::string name;
  bool fixed = true;
  std::array<bool, 3> held = {false, false, false};  ///< if not fixed: directions in which it is held all the same
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< in the last step, or of the table's first row
  std::vector<Eigen::Vector3d> forces;               ///< of a table, one per row; empty: `force` alone
};

struct BuiltBody : BoneLoads {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< where its force acts, and about which it turns
  std::string center_words;                          ///< how it was found
  TriangleSurface shell;                             ///< the bone, to be looked at and to carry the body; may be empty
};

struct BuiltContact {
  std::string name;
  int primary = -1, secondary = -1;  ///< layers
};

struct BuiltJoint {
  std::vector<BuiltBody> bodies;
  std::vector<BuiltLayer> layers;
  std::vector<BuiltContact> contacts;

  /// How many loads there are, one after the other: rows of the longest table, or 1.
  std::size_t loads() const {
    std::size_t count = 1;
    for (const BuiltBody& b : bodies) count = std::max(count, b.forces.size());
    return count;
  }
};

/// The force of a load, counted from 0.
inline const Eigen::Vector3d& force_of(const BuiltBody& body, std::size_t load) {
  return load < body.forces.size() ? body.forces[load] : body.force;
}

/// What the model file says beside the geometry.
struct BuiltModelSettings {
  int elements_through = 2;  ///< prisms between bone and articular surface
  double E = 11.85;          ///< of the cartilage, neo-Hookean [stress]
  double nu = 0.45;
  double penalty = 20;
  std::vector<Eigen::Vector3d> seat;  ///< per body: displacement at the end of the seating step
  std::string units = "mm-N-s";
  std::string comment;
};

}  // namespace dea
