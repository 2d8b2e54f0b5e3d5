// febiodea/joint/joint.h – the joint behind a model: rigid bodies, cartilage layers, what holds and moves them.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include <febiodea/geometry/surface_mesh.h>
#include <febiodea/joint/bodies.h>
#include <febiodea/joint/layer_face.h>
#include <febiodea/model/elasticity.h>
#include <febiodea/model/joint_model.h>
#include <febiodea/model/settings.h>

namespace dea {

/// A layer of cartilage between an articular surface and its bone, or the bare surface of a rigid body.
struct Layer {
  int surface = -1;         ///< index into JointModel::surfaces: the articular surface
  int body = -1;            ///< index into Joint::bodies
  std::string attached_by;  ///< the rule that found the body, as a sentence
  int material = -1;        ///< index into JointModel::materials; -1 for a bare rigid surface
  Elasticity elasticity;    ///< of the cartilage
  bool rigid = false;       ///< a bare rigid surface: thickness 0
  SurfaceMesh articular;    ///< normals out of the layer, towards the other side; facets left out have no triangles
  SurfaceMesh bone;         ///< normals out of the bone, into the layer; equals `articular` when rigid
  SpringsAt springs_at = SpringsAt::Articular;
  std::vector<double> thickness;  ///< per vertex of spring_surface(); 0 when rigid
  std::vector<char> missed;       ///< per vertex: its ray found no opposing face near enough; closest point used
  bool thickness_given = false;   ///< by the user, not measured
  std::vector<unsigned char>
      mirror;                     ///< per articular vertex: bit k set, held in component k alone: on a symmetry plane
  std::vector<int> region_nodes;  ///< nodes of the deformable elements of the layer
  std::vector<FaceKind> facet_kinds;  ///< per facet: all but Open are left out; empty: all are kept
  std::vector<std::string> notes;     ///< what the user should know of it, a sentence each
  LayerFace face;                     ///< of a layer whose springs stand on the articular surface; else empty

  /// The surface thickness and springs live on.
  const SurfaceMesh& spring_surface() const { return springs_at == SpringsAt::Bone ? bone : articular; }
  /// Area-weighted mean over the articular triangles of their size over the thickness there: sqrt(2 area), the edge of
  /// the quadrilateral they halve. 0 when rigid.
  double facet_size() const;
  double min_thickness() const;
  double max_thickness() const;
  double mean_thickness() const;  ///< area-weighted
  int missed_count() const;
};

/// Two layers that slide on each other. layers[source] carries the springs, layers[1 - source] is their target.
struct ContactPair {
  std::string name;
  int contact = -1;  ///< index into JointModel::contacts
  Layer layers[2];   ///< primary, secondary
  int source = 0;
  Law law = Law::Linear;
  LayerFit layer_fit = LayerFit::TwoTerms;
  double interface_compliance = 0.0;  ///< gap per pressure in series with the layers (S9)
  Facets facets = Facets::Curved;
  /// Each spring triangle, and with Law::Layer each triangle of both layers' faces, is divided into refine^2.
  int refine = 1;
  int step = -1;  ///< active only in this step; -1: in all
  const Layer& source_layer() const { return layers[source]; }
  const Layer& target_layer() const { return layers[1 - source]; }
};

/// A force along the line between points of two bodies: spring, ligament, muscle. L: its length now, L0: free_length.
struct Ligament {
  enum class Law {
    Linear,   ///< stiffness (L - L0); tension_only: never pushes
    Curve,    ///< scale * curve(measure of L and L0)
    Constant  ///< scale, whatever the length
  };
  std::string name;
  int body_a = -1, body_b = -1;
  Vector3d point_a = Vector3d::Zero(), point_b = Vector3d::Zero();  ///< reference positions
  Law law = Law::Linear;
  double stiffness = 0.0;    ///< force per elongation
  double free_length = 0.0;  ///< > 0
  bool tension_only = false;
  std::optional<LoadController> curve;  ///< of Law::Curve, tension > 0
  DiscreteSprings::Measure measure = DiscreteSprings::Measure::Elongation;
  Scaled scale = {1.0, -1};
  int step = -1;
  Origin origin;
  std::string where;  ///< the same as text, before a fault: "hip.feb:12: "
};

/// A cable with the same tension everywhere, through points of bodies; beyond the last point it pulls along
/// `direction`.
struct Cable {
  struct Point {
    int body = -1;
    Vector3d position = Vector3d::Zero();  ///< reference
  };
  std::string name;
  std::vector<Point> points;
  Scaled force;                           ///< the tension
  Vector3d direction = Vector3d::Zero();  ///< unit, fixed in space; zero: the cable ends at its last point
  int step = -1;
  Origin origin;
};

/// Two bodies joined at a point (docs/theory.md, section 4: J1-J4). Columns of `axes`: a frame that both bodies carry,
/// at `point`, and that coincides in the reference.
struct Connector {
  std::string name, type;
  int body_a = -1, body_b = -1;
  Vector3d point = Vector3d::Zero();                   ///< reference position
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< orthonormal
  std::array<RigidJoint::Motion, kDofs> motion = {};   ///< of B as seen from A: along and about A's axes
  std::array<Scaled, kDofs> value;  ///< Prescribed: the motion; Free: force or moment on A, its opposite acts on B
  int step = -1;
  Origin origin;
};

/// A force with a fixed direction at a point of a body.
struct PointLoad {
  std::string name;
  int body = -1;
  Vector3d point = Vector3d::Zero();  ///< reference position; moves with the body
  Vector3d value = Vector3d::Zero();
  int controller = -1;  ///< scales the vector
  int step = -1;
  Origin origin;
};

struct Joint {
  std::vector<Body> bodies;
  std::vector<ContactPair> contacts;
  std::vector<Ligament> ligaments;
  std::vector<Cable> cables;
  std::vector<Connector> connectors;
  std::vector<PointLoad> point_loads;  ///< nodal forces
  std::vector<int> node_body;          ///< per model node: body that carries it, -1: none (stays where it is)
  std::vector<std::string> findings;   ///< what was concluded or left out, a sentence each, in order

  /// Index of the body with this name (of any of its materials), -1: none.
  int find_body(const JointModel& model, const std::string& name) const;
};

/// Finds bodies, layers, thicknesses and moduli (docs/theory.md, section 2). Throws InputError with the place in
/// the model when the joint cannot be made of it, UsageError when an override names nothing in the model.
Joint make_joint(const JointModel& model, const Settings& settings);

/// Why a model has no contact that DEA could solve, where no sliding contact is there at all: names those that are.
std::string no_sliding_contact(const JointModel& model);

}  // namespace dea
