// src/facts/parts.h – the parts of a model: rigid bodies, deformable parts, what holds these; element faces.
#pragma once
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "src/base/fault.h"
#include "src/base/finding.h"
#include "src/facts/bodies.h"
#include "src/facts/holders.h"
#include "src/facts/node_holds.h"
#include "src/model/element_faces.h"
#include "src/model/joint_model.h"
#include "src/model/settings.h"

namespace dea {

/// A face of an element, found by its corner nodes.
struct ElementFace {
  int domain, element, face;
};
using FaceMap = std::unordered_map<FaceKey, std::vector<ElementFace>, FaceKeyHash>;

/// A deformable region that gives way as its elements do.
struct SoftRegion {
  int region = -1;       ///< its root node; beyond all nodes: it shares nodes with a layer
  int within = -1;       ///< the root node of both
  std::string material;  ///< that most of its elements have
  std::string name;   ///< the material's; of several parts of one material that of the elements, or another of its own
  int body = -1;      ///< index into Bodies::bodies: what holds it; where nothing does, a body of its own
  int other = -1;     ///< a second body that holds it, -1: none
  bool free = false;  ///< nothing holds it
  int form = 0;                        ///< how it was told: of the rule `part-recognised`
};

/// Everything that recognition looks up again and again. Model and settings must outlive it.
struct ModelParts {
  const JointModel& model;
  const Settings& settings;
  std::vector<char> rigid;          ///< per material
  std::vector<char> layer_domains;  ///< per domain: cartilage of a rigid material (contacts of type "dea")
  Bodies bodies;
  std::vector<int> region;  ///< per node: root node of its deformable part, -1: in no deformable solid element
  /// By root and material, the region of a part that shares nodes with a layer: these count to the layer.
  std::map<std::pair<int, int>, int> beside;
  FaceMap faces;  ///< element faces all of whose corners are nodes of a contact surface
  NodeHolds node_holds;
  std::vector<int> moved;  ///< per node: body of nodes that are moved together, -1: none
  Holders holders;
  std::vector<SoftRegion> soft;  ///< deformable regions that are no layers
  Findings findings;             ///< what was concluded
  std::vector<Fault> faults;     ///< nodes that are moved otherwise than a bone can be
};

/// Cartilage: of a deformable material, or rigid with its bone under a contact that knows its modulus.
bool deformable(const ModelParts& parts, const Domain& domain);

/// A fault for each body that the user takes as rigid and that is several bones in the model: pieces without a common
/// node, of which more than one has something to do with the rest (cartilage, a contact, a load, a spring, a hold), and
/// are not all held or moved in every step by their nodes or by a rigid body of the model. FEBio moves each by itself.
std::vector<Fault> separate_pieces(const ModelParts& parts);

/// The element faces at these nodes; nullptr: none.
const std::vector<ElementFace>* find_face(const ModelParts& parts, const int* nodes, int count);
const std::vector<ElementFace>* find_face(const ModelParts& parts, const Surface& surface, int facet);

/// The element that carries a facet: a deformable solid before a rigid solid before a shell; nullptr: none.
const ElementFace* carrier(const ModelParts& parts, const std::vector<ElementFace>* candidates);

/// Body of a rigid material; no material: the ground.
int body_of_material(const ModelParts& parts, int material);

/// Index of the body with this name (of any of its materials), -1: none.
int body_by_name(const JointModel& model, const std::vector<Body>& bodies, const std::string& name);
/// Is this the name of that body? An empty one is of none.
bool names_body(const JointModel& model, const std::vector<Body>& bodies, const std::string& name, int body);

/// The region of an element of a deformable part.
int region_of(const ModelParts& parts, const Domain& domain, int element);

/// Index into ModelParts::soft of a region, -1: it is none.
int soft_region(const ModelParts& parts, int region);

/// -1: none.
int surface_index(const JointModel& model, const std::string& name);

}  // namespace dea
