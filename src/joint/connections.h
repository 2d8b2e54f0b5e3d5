// src/joint/connections.h – what joins bodies besides contact, and nodal forces on them.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "src/base/finding.h"
#include "src/facts/bodies.h"
#include "src/model/joint_model.h"

namespace dea {

struct ModelParts;

/// A force along the line between points of two bodies: spring, ligament, muscle. L: its length now, L0: free_length.
struct Ligament : Condition {
  enum class Law {
    Linear,   ///< stiffness (L - L0); tension_only: never pushes
    Curve,    ///< scale * curve(measure of L and L0)
    Constant  ///< scale, whatever the length
  };
  int body_a = -1, body_b = -1;
  Vector3d point_a = Vector3d::Zero(), point_b = Vector3d::Zero();  ///< reference positions
  std::array<int, 2> part_node = {-1, -1};  ///< model's nodes of its ends where they are a part's own; -1: the body's
  Law law = Law::Linear;
  double stiffness = 0.0;    ///< force per elongation
  double free_length = 0.0;  ///< > 0
  bool tension_only = false;
  std::optional<LoadController> curve = {};  ///< of Law::Curve, tension > 0
  DiscreteSprings::Measure measure = DiscreteSprings::Measure::Elongation;
  Scaled scale = {1.0, -1};
  std::string where = {};  ///< the same as text, before a fault: "hip.feb:12: "
};

/// A cable with the same tension everywhere, through points of bodies; beyond the last point it pulls along
/// `direction`.
struct Cable : Condition {
  struct Point {
    int body = -1;
    Vector3d position = Vector3d::Zero();  ///< reference
  };
  std::vector<Point> points = {};
  Scaled force = {};                      ///< the tension
  Vector3d direction = Vector3d::Zero();  ///< unit, fixed in space; zero: the cable ends at its last point
};

/// Two bodies joined at a point (docs/theory.md, section 4: J1-J4), of the joint's two materials. Columns of `axes`: a
/// frame that both bodies carry, at `joint_origin`, and that coincides in the reference. Motion: of B as seen from A,
/// along and about A's axes.
struct Connector : RigidJoint {
  int body_a = -1, body_b = -1;
};

/// A force with a fixed direction at a point of a body.
struct PointLoad : Condition {
  int body = -1;
  Vector3d point = Vector3d::Zero();  ///< reference position; moves with the body
  Vector3d value = Vector3d::Zero();
  int controller = -1;  ///< scales the vector
};

struct Connections {
  std::vector<Ligament> ligaments;
  std::vector<Cable> cables;
  std::vector<Connector> connectors;
  std::vector<PointLoad> point_loads;  ///< nodal forces
};

/// `node_body`: per model node, the body that carries it, -1: none. Adds to `findings`. InputError: one of them cannot
/// be what the model says.
Connections find_connections(const ModelParts& parts, const std::vector<int>& node_body, Findings& findings);

}  // namespace dea
