// src/model/joint_model.h – what a model says: mesh, materials, rigid conditions, contacts, loads, steps.
//
// Neutral between file formats and versions: `io/` fills it from a .feb file, `plugin/` from FEBio's own
// model. It holds statements, not conclusions: which body a cartilage layer belongs to, which thickness
// it has, which contact is a joint, is found later by make_joint (src/joint/joint.h).
// Frame: global. Units: whatever the model uses; they pass through unchanged.
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/model/element_shape.h"
#include "src/model/settings.h"
#include "src/model/stiffness.h"

namespace dea {

/// A place in the model's files: `files[file]`, 1-based `line`. line 0: no place (not from a text file).
struct Origin {
  int file = 0;
  int line = 0;
};

/// One set of elements of one shape and one material (an `Elements` section).
struct Domain {
  std::string name;
  ElementShape shape = ElementShape::Hex8;
  int material = -1;                    ///< index into JointModel::materials; -1: the model gives none
  std::vector<int> element_ids;         ///< as in the file
  std::vector<int> nodes;               ///< node indices (zero-based), nodes_per_element(shape) each
  std::vector<double> shell_thickness;  ///< one per element node; empty: none given
  /// Per element, along its fibres, in the material's axes; zero: none given. By Fibres::path.
  std::map<std::string, std::vector<Vector3d>> fibre;
  std::vector<Eigen::Matrix3d> axes;  ///< per element, its own axes as columns; zero: none given
  Origin origin;
};

/// A list of facets of 3, 4, 6, 7, 8, 9 or 10 nodes. Facet i: nodes[begin[i]] .. nodes[begin[i + 1]].
struct FacetList {
  std::vector<int> begin = {0};  ///< facets + 1 entries
  std::vector<int> nodes;        ///< node indices (zero-based)
  int size() const { return static_cast<int>(begin.size()) - 1; }
  std::vector<int> facet(int i) const { return {nodes.begin() + begin[at(i)], nodes.begin() + begin[at(i) + 1]}; }
  void add(const std::vector<int>& facet) {
    nodes.insert(nodes.end(), facet.begin(), facet.end());
    begin.push_back(static_cast<int>(nodes.size()));
  }
};

struct Surface : FacetList {
  std::string name;
  Origin origin;
};

struct NodeSet {
  std::string name;
  std::vector<int> nodes;  ///< node indices (zero-based)
  Origin origin;
};

struct ElementSet {
  std::string name;
  std::vector<int> element_ids;  ///< element ids as in the file
  Origin origin;
};

/// Pairs of nodes joined by discrete springs.
struct DiscreteSet {
  std::string name;
  std::vector<std::array<int, 2>> pairs;  ///< node indices (zero-based)
  Origin origin;
};

/// A material, reduced to what rigid-body contact needs.
struct Material {
  int id = 0;  ///< 1-based id of the file
  std::string name;
  std::string type;  ///< FEBio's type word, nested types after a slash: "biphasic/neo-Hookean"
  bool rigid = false;
  double density = 1.0;
  std::optional<Vector3d> center_of_mass;  ///< rigid: given explicitly; otherwise integrated from the elements
  double E = kNaN;                         ///< small-strain Young's modulus; NaN: see `note`
  double nu = kNaN;                        ///< small-strain Poisson's ratio; NaN: see `note`
  std::string note;                        ///< how E and nu were found ("drained solid"), or why there are none
  std::vector<Fibres> fibres;              ///< what E and nu leave out; only parts have use for it
  std::vector<StiffnessInAxes> stiffness;  ///< where no E and nu tell it: their sum, in their axes
  bool fluid = false;                      ///< fluid fills it: what is here is its drained solid
  Origin origin;
};

/// A number of the model that a load controller may scale: factor * controller(t).
struct Scaled {
  double factor = 0.0;
  int controller = -1;  ///< index into JointModel::controllers; -1: constant
};

/// A function of time given by points. See src/model/load_curve.h for its value.
struct LoadController {
  enum class Interpolate { Linear, Step, Smooth, CubicSpline, ControlPoints, Approximation, SmoothStep, C2Smooth };
  enum class Extend { Constant, Extrapolate, Repeat, RepeatOffset };
  int id = 0;  ///< 1-based id of the file
  std::string name;
  Interpolate interpolate = Interpolate::Linear;
  Extend extend = Extend::Constant;
  std::vector<std::array<double, 2>> points;  ///< (t, value)
  std::string expression;                     ///< not empty: value = expression in `variable`, in place of points
  std::string variable = "t";                 ///< its name in the expression
  std::string unsupported;  ///< not empty: a kind of controller we cannot evaluate; refused where it is used
  Origin origin;
};

/// Degrees of freedom of a rigid body: translation of the centre of mass along global x, y, z, then the
/// components of rotation about global x, y, z (Ru, Rv, Rw). Also the order of every 6-vector in this code.
inline constexpr int kDofs = 6;
inline constexpr const char* kDofNames[kDofs] = {"x", "y", "z", "Ru", "Rv", "Rw"};
/// FEBio's u is about x.
inline constexpr Alias kDofAliases[] = {{"Rx", "Ru"}, {"Ry", "Rv"}, {"Rz", "Rw"},
                                        {"u", "Ru"},  {"v", "Rv"},  {"w", "Rw"}};

/// What every condition below has. `material` of one: index of a rigid material (the body is the one that material
/// became).
struct Condition {
  int step = -1;  ///< active only in this step; -1: in all
  std::string name;
  Origin origin;
  bool acts(int in_step) const { return step < 0 || step == in_step; }
};

struct RigidFixed : Condition {
  int material = -1;
  std::array<bool, kDofs> dofs = {};
};

/// Prescribed motion of one dof: COM translation, or component of the rotation vector [rad].
struct RigidPrescribed : Condition {
  int material = -1;
  int dof = 0;
  Scaled value;
  bool relative = false;  ///< from the pose at the start of the step instead of the reference pose
};

/// Force (dof 0-2) or moment (dof 3-5) on a rigid body at its centre of mass.
struct RigidLoad : Condition {
  enum class Kind {
    Dead,
    Follower,  ///< the vector turns with the body
    Target     ///< grows over the step, in proportion to time, from the reaction at its start to `value`
  };
  int material = -1;
  int dof = 0;
  Scaled value;
  Kind kind = Kind::Dead;
  bool relative = false;  ///< Dead: the reaction at the start of the step is added
};

/// Force at a point of a rigid body, or moment, whose vector turns with the body.
struct RigidFollower : Condition {
  int material = -1;
  bool moment = false;
  Vector3d insertion = Vector3d::Zero();  ///< of a force: reference coordinates
  bool from_center = false;               ///< `insertion` is counted from the centre of mass
  Vector3d value = Vector3d::Zero();
  int controller = -1;  ///< scales the whole vector; -1: constant
};

/// Force along the line between points of two rigid bodies, > 0 pulls them together.
struct RigidAxialForce : Condition {
  int material_a = -1, material_b = -1;
  Vector3d point_a = Vector3d::Zero(), point_b = Vector3d::Zero();  ///< reference coordinates
  bool from_centers = false;                                        ///< the points are counted from the centres of mass
  Scaled force;
};

/// Cable through points of rigid bodies with the same tension everywhere; at its last point the force `value` acts.
struct RigidCable : Condition {
  struct Point {
    int material = -1;
    Vector3d position = Vector3d::Zero();  ///< reference coordinates
  };
  std::vector<Point> points;
  bool from_centers = false;  ///< positions are counted from the centres of mass
  Scaled force;
  Vector3d direction = Vector3d::Zero();  ///< of the force beyond the last point
};

/// Two bodies joined at a point. Its frame: columns of `axes`, fixed in both bodies in their reference pose. Motion of
/// B relative to A, in A's current columns: translation of B's joint point from A's along them, and the rotation vector
/// of B relative to A. A force or moment of a Free motion acts along A's column on A, its opposite on B, as in FEBio
/// (so > 0 drives the motion backwards). Columns by FEBio's type:
/// * revolute: 0 rotation_axis, 1 transverse_axis; free: rotation about 0
/// * prismatic: 0 translation_axis, 1 transverse_axis; free: translation along 0
/// * cylindrical: 0 joint_axis, 1 transverse_axis; free: both along and about 0
/// * planar: 0 rotation_axis, 1 translation_axis_1, 2 normal to both; free: rotation about 0, translations along 1, 2
/// * lock: 0 first_axis, 1 second_axis; free: none
/// * spherical, `rigid joint`: global x, y, z; free: all rotations
/// * generic: global x, y, z; free: what is not prescribed
///
/// Prescribed rotations of a spherical joint are global: read only where A does not rotate. Its moments are global too:
/// RigidLoads on A and B.
///
/// Column 1 is made normal to column 0 in the plane of the two given directions; column 2 = column 0 x column 1.
struct RigidJoint : Condition {
  enum class Motion { Held, Free, Prescribed };
  int material_a = -1, material_b = -1;
  std::string type;  ///< FEBio's word
  Vector3d joint_origin = Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< orthonormal, global reference directions
  std::array<Motion, kDofs> motion = {};               ///< all Held
  std::array<Scaled, kDofs> value;                     ///< Prescribed: length or angle [rad]; Free: force or moment
};

/// Force on nodes, each its own: acts on the body that holds the node, at the node.
struct NodalForce : Condition {
  std::vector<int> nodes;
  Vector3d value = Vector3d::Zero();
  int controller = -1;  ///< scales the whole vector; -1: constant
};

/// Line spring between points of two rigid bodies (global reference coordinates). It pushes when shortened.
struct RigidSpring : Condition {
  int material_a = -1, material_b = -1;
  Vector3d insertion_a = Vector3d::Zero(), insertion_b = Vector3d::Zero();
  double k = 1.0;            ///< force per elongation
  double free_length = 0.0;  ///< 0: the reference distance
};

/// Springs between nodes along their line, with L the distance of the nodes and L0 that in the reference:
/// force = stiffness (L - L0), tension_only: never pushes; or, where `force` is there, scale * force(measure).
struct DiscreteSprings : Condition {
  enum class Measure { Elongation, Strain, Stretch };  ///< L - L0, L/L0 - 1, L/L0
  int set = -1;                                        ///< index into JointModel::discrete_sets
  double stiffness = 1.0;
  bool tension_only = false;
  std::optional<LoadController> force;  ///< a function of the measure in place of time; > 0: tension
  Measure measure = Measure::Elongation;
  Scaled scale = {1.0, -1};  ///< of `force`
};

/// Nodes held by the ground in the flagged components.
struct FixedNodes : Condition {
  std::vector<int> nodes;
  std::array<bool, 3> xyz = {};
};

/// Nodes whose displacement is given in one component. None of them is a rigid body's (FEBio refuses that). Named as
/// the condition, else as its node set.
struct PrescribedNodes : Condition {
  std::vector<int> nodes;
  int component = 0;      ///< 0 x, 1 y, 2 z (global)
  Scaled value;           ///< displacement, for all nodes alike
  bool relative = false;  ///< from the position at the start of the step instead of the reference position
};

/// Nodes that move with a rigid body.
struct RigidNodes : Condition {
  int material = -1;
  std::vector<int> nodes;
};

/// What a contact of type "dea" says of the layer under one of its surfaces. The cartilage's elements are rigid there,
/// of their bone's own material, so modulus and thickness are the contact's.
struct DeaLayer {
  std::optional<double> E, nu;        ///< of the cartilage
  std::optional<double> thickness;    ///< constant; 0: a bare rigid surface
  std::vector<double> thickness_map;  ///< one per entry of Surface::nodes; empty: none
                                      ///  neither constant nor map: measured through the elements under the surface
};

/// A plane across an axis behind which the model's mirror image is to be imagined.
struct SymmetryPlane {
  int axis = 0;  ///< 0 x, 1 y, 2 z
  double at = 0.0;
  bool operator==(const SymmetryPlane& other) const { return axis == other.axis && at == other.at; }
};

/// A contact of type "dea": the spring bed, stated in the model. Empty: as the settings or their defaults have it.
struct DeaContact {
  std::optional<Law> law;
  std::optional<Facets> facets;
  std::optional<int> refine;
  int source = 0;                              ///< the side that carries the springs: 0 primary, 1 secondary
  DeaLayer layers[2];                          ///< primary, secondary
  std::vector<SymmetryPlane> symmetry_planes;  ///< of cartilage that is rigid with its bone: no node is held in them
};

struct Contact : Condition {
  enum class Kind { Sliding, Tied };
  std::string type;  ///< FEBio's word
  Kind kind = Kind::Sliding;
  int primary = -1, secondary = -1;  ///< indices into JointModel::surfaces
  double max_distance = 0.0;         ///< tied: facets farther apart are not tied; 0: no limit
  bool closes_gap = false;           ///< tied: FEBio pulls the nodes onto the surface they are tied to
  std::vector<std::string>
      ignored;                    ///< parameters away from their defaults that DEA has no use for: "fric_coeff = 0.2"
  std::optional<DeaContact> dea;  ///< of a contact of type "dea" (kind Sliding)
};

struct Step {
  std::string name;
  double duration = 0.0;
  double step_size = 0.0;
  std::vector<double> must_points;  ///< absolute times inside the step that a result must have
  Origin origin;
};

/// Something the file has and we do not use, listed once with how often it occurs.
struct Remark {
  std::string what;
  int count = 1;
  Origin origin;         ///< first occurrence
  Sentence advice = {};  ///< what to do about it, for what is unsupported; empty: take it out
};

struct JointModel {
  std::vector<std::string> files;  ///< as the user named them; files[0] is the model, then its includes
  std::string version;             ///< "4.0"
  std::string module;              ///< "solid"; empty: not given
  std::string units;               ///< FEBio's name of the unit system; empty: not given

  std::vector<int> node_ids;
  std::vector<Vector3d> nodes;  ///< reference positions
  std::vector<Domain> domains;
  std::vector<Surface> surfaces;
  std::vector<NodeSet> node_sets;
  std::vector<ElementSet> element_sets;
  std::vector<DiscreteSet> discrete_sets;
  std::vector<Material> materials;

  std::vector<RigidFixed> rigid_fixed;
  std::vector<RigidPrescribed> rigid_prescribed;
  std::vector<RigidLoad> rigid_loads;
  std::vector<RigidFollower> rigid_followers;
  std::vector<RigidAxialForce> rigid_axial_forces;
  std::vector<RigidCable> rigid_cables;
  std::vector<RigidJoint> rigid_joints;
  std::vector<NodalForce> nodal_forces;
  std::vector<RigidSpring> rigid_springs;
  std::vector<DiscreteSprings> discrete_springs;
  std::vector<FixedNodes> fixed_nodes;
  std::vector<PrescribedNodes> prescribed_nodes;
  std::vector<RigidNodes> rigid_nodes;
  std::vector<Contact> contacts;
  std::vector<LoadController> controllers;
  std::vector<Step> steps;  ///< at least one

  std::vector<Remark> ignored;      ///< harmless: does not change the joint
  std::vector<Remark> assumed;      ///< what FEBio takes where the file leaves it unsaid, or says it twice
  std::vector<Remark> unsupported;  ///< changes the mechanics and cannot be taken into account: refused by `dea run`
};

/// "hip.feb:214", or "hip.feb" when the line is unknown.
std::string place_of(const JointModel& model, Origin origin);
/// The same before a message: "hip.feb:214: ".
std::string where(const JointModel& model, Origin origin);
/// A fault at a place of a model that has been read. `found` ends in the mark that leads to `expected`.
Fault make_fault(const JointModel& model, Origin origin, Sentence found, Sentence expected = {});
/// The same, to be thrown.
InputError fault_at(const JointModel& model, Origin origin, Sentence found, Sentence expected = {});

/// Do conditions of these steps (-1: all) act at the same time?
inline bool at_same_time(int step, int other) { return step == other || step < 0 || other < 0; }

/// Nodes of its facets, each once, in order.
std::vector<int> nodes_of_surface(const Surface& surface);

/// Ties whose search_radius is a length that gaps must be shorter than (FENormalProjection::Project2); of others
/// max_distance is, where FEBio knows it.
bool ties_by_search_radius(const std::string& type);

/// Do two contacts join the same surfaces at the same time? They would share the load between them.
bool double_contact(const Contact& a, const Contact& b);

}  // namespace dea
