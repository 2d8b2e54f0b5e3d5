// src/build/built_joint.h – a joint made of surfaces: what a model file is written from.
#pragma once
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "src/build/ligament.h"
#include "src/geometry/triangle_surface.h"
#include "src/model/joint_model.h"

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

/// Flags per dof, in the order of kDofNames: displacement of the centre along x, y, z, rotation about them.
using DofFlags = std::array<bool, kDofs>;

/// A bone, and what holds, moves and loads it.
struct BoneLoads {
  std::string name;
  bool fixed = true;                                        ///< held as a whole
  DofFlags held = {false, false, false, true, true, true};  ///< if not fixed: dofs in which it is held all the same
  DofFlags moved = {};                                      ///< if not fixed: dofs that follow `motion`
  Eigen::Vector3d force = Eigen::Vector3d::Zero();          ///< in the last step, or of the table's first row
  std::vector<Eigen::Vector3d> forces;                      ///< of a table, one per row; empty: `force` alone
  std::vector<Eigen::Vector3d> moments;                     ///< of a table, about the centre; empty: none
  std::vector<Eigen::Matrix<double, kDofs, 1>> motion;      ///< of a table, one per row: displacement of the centre,
                                                            ///< rotation vector [rad], from the pose as built
  bool about_origin = false;  ///< the motion turns the bone about the global origin, then moves it

  bool free(std::size_t dof) const { return !fixed && !held[dof] && !moved[dof]; }
  bool turns_freely() const { return free(3) || free(4) || free(5); }
};

struct BuiltBody : BoneLoads {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< where its force acts, and about which it turns
  std::string center_words;                          ///< how it was found
  bool ball = false;                                 ///< its joint surface is one
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
  std::vector<BuiltLigament> ligaments;

  /// How many loads or poses there are, one after the other: rows of the longest table, or 1.
  std::size_t loads() const {
    std::size_t count = 1;
    for (const BuiltBody& b : bodies) count = std::max({count, b.forces.size(), b.motion.size()});
    return count;
  }
};

/// The force of a load, counted from 0.
inline const Eigen::Vector3d& force_of(const BuiltBody& body, std::size_t load) {
  return load < body.forces.size() ? body.forces[load] : body.force;
}

/// The moment about the centre of the same load.
inline Eigen::Vector3d moment_of(const BuiltBody& body, std::size_t load) {
  return load < body.moments.size() ? body.moments[load] : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

/// What the model file says beside the geometry.
struct BuiltModelSettings {
  int elements_through = 2;  ///< prisms between bone and articular surface
  double E = 11.85;          ///< of the cartilage, neo-Hookean [stress]
  double nu = 0.45;
  double penalty = 20;
  std::vector<Eigen::Vector3d> seat;       ///< per body: displacement at the end of the seating step; empty: none
  std::vector<Eigen::Vector3d> seat_turn;  ///< per body: its rotation vector there [rad]; empty: none
  std::string units = "mm-N-s";
  std::string comment;
};

}  // namespace dea
