// src/facts/bodies.h – rigid bodies of a model, and which nodes they hold.
#pragma once
#include <string>
#include <vector>

#include "src/model/joint_model.h"
#include "src/model/settings.h"

namespace dea {

/// Which material is rigid: rigid in the model, or taken as rigid by the user.
/// Throws UsageError when a name in settings.rigid is no material of the model.
std::vector<char> rigid_materials(const JointModel& model, const Settings& settings);

/// A rigid body: one or more rigid materials whose elements share nodes, or the ground.
struct Body {
  std::string name;                            ///< of the first of its materials; "ground"
  std::vector<int> materials;                  ///< indices into JointModel::materials; empty: ground, or moved nodes
  Vector3d center_of_mass = Vector3d::Zero();  ///< reference position; given, or integrated from the elements
  bool center_given = false;
  double mass = 0.0;
  bool ground = false;  ///< never moves
  /// Indices into JointModel::prescribed_nodes: nodes that are moved together, a bone that the model leaves out. It has
  /// no material and does not turn; `center_of_mass` is the mean of the nodes.
  std::vector<int> moved_by;
};

/// One body per set of rigid materials whose elements share nodes, in the order of their first material; then the
/// ground. The centre of mass is the given one, or integrated from the elements (solids: volume, shells: twice area
/// times thickness, as FEBio counts them; a body without any mass has it at the origin, as in FEBio). Where the model
/// has some of a body's materials rigid, they alone count; where a density is not one number, all of the body's are 1.
struct Bodies {
  std::vector<Body> bodies;      ///< the last one is the ground
  std::vector<int> of_material;  ///< per material: body, -1: not rigid
  std::vector<int> of_node;      ///< per node: body whose rigid elements contain it, -1: none
  int ground() const { return static_cast<int>(bodies.size()) - 1; }
};
/// `layer_domains`: per domain, elements of a rigid material that are cartilage all the same (of a contact of type
/// "dea"): part of the body, but their nodes are not the bone's. Empty: none.
Bodies find_bodies(const JointModel& model, const std::vector<char>& rigid,
                   const std::vector<char>& layer_domains = {});

/// Puts a body of no material before the ground; another of its name gets a number. Returns its index.
int add_body(Bodies& bodies, Body body);

/// The first of its materials that is rigid in the model, -1: the user takes all of them as rigid, or it has none.
int rigid_in_model(const JointModel& model, const Body& body);

/// Does the user take some of the body as rigid? FEBio ignores fixed nodes of its own rigid bodies.
bool taken_as_rigid(const JointModel& model, const Body& body);

/// Signed volume of a solid element (> 0 when its nodes are in FEBio's order) and its centroid.
struct ElementVolume {
  double volume = 0.0;
  Vector3d centroid = Vector3d::Zero();
};
ElementVolume element_volume(const JointModel& model, const Domain& domain, int element);

}  // namespace dea
