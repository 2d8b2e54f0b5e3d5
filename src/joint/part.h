// src/joint/part.h – a deformable part of a joint that is no layer: its mesh, its material, who holds it.
#pragma once
#include <string>
#include <vector>

#include "src/base/finding.h"
#include "src/model/solid_element.h"

namespace dea {

/// The part's own mesh. Frame: its reference configuration, global axes.
struct PartMesh {
  std::vector<Vector3d> nodes;
  std::vector<ElementShape> shape;  ///< per element
  std::vector<int> begin = {0};     ///< nodes of element e: element_node[begin[e]] .. element_node[begin[e + 1]]
  std::vector<int> element_node;
  std::vector<int> material;      ///< per element: dilatations at nodes are averaged within one material
  std::vector<Matrix6d> elastic;  ///< per element, stress per strain [MPa]; one: of all
  int elements() const { return static_cast<int>(shape.size()); }
  int size() const { return static_cast<int>(nodes.size()); }
  std::vector<Vector3d> fibre;  ///< per element, along its first fibres; zero: there are none, or it is not known
  const Matrix6d& stiffness(int element) const { return elastic[elastic.size() == 1 ? 0 : at(element)]; }
  std::vector<Vector3d> corners(int element) const;  ///< where its nodes are
};

/// An element of the model.
struct PartElement {
  int domain = -1, place = -1;  ///< index into JointModel::domains, in it
};

/// A meniscus, a disc, a labrum: it gives way as its elements do (docs/parts.md).
struct SoftPart {
  std::string material;  ///< that most of its elements have
  std::string name;  ///< the material's; of several parts of one material that of the elements, or another of its own
  int body = -1;     ///< index into Joint::bodies: its frame moves with it
  int other = -1;    ///< a second body that holds it, -1: none
  PartMesh mesh;
  std::vector<PartElement> elements;  ///< per element of the mesh
  std::vector<int> model_nodes;       ///< per node of the mesh: index of the model's node, ascending
  std::vector<int> holder;            ///< per node: the body that holds it, -1: none
  std::vector<unsigned char> held;    ///< per node: bit k set, the ground holds it across axis k alone (symmetry)
  double depth = 0.0;                 ///< how deep a partner may stand in it where the search begins [mm]
  bool free() const;                  ///< nothing holds it: `body` is its own
  int node_of(int model_node) const;  ///< number in the mesh of a node of the model, -1: it is none of its
};

struct ModelParts;

/// The soft regions of a model, in their order. InputError: a material or an element of one has no known stiffness.
std::vector<SoftPart> make_parts(const ModelParts& parts);

/// What is taken of the fibres of a region of ModelParts::soft (`part-fibres`).
Findings fibre_findings(const ModelParts& parts, std::size_t region);

/// Whether the fluid in such a region has had time to get away (`part-fluid`).
Findings fluid_findings(const ModelParts& parts, std::size_t region);

}  // namespace dea
