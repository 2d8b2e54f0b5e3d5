// src/joint/layer_face.h – the whole face of a cartilage layer: the facets that slide, and where the cartilage
// goes on beyond.
//
// Which facets slide and what is beyond their rim is read from the layer's own elements (docs/theory.md, section 2).
// Lists of facets are oriented out of their elements; a facet may be empty.
#pragma once
#include <string>
#include <vector>

#include "src/geometry/surface_mesh.h"

namespace dea {

/// What is beyond an edge of a layer's face.
enum class Rim {
  Free,      ///< nothing, the bulge escapes: q = 0 in the first term; the second as in Continues, and (L7)
  Wall,      ///< its mirror image (plane of symmetry): dq/dn = 0
  Continues  ///< more of the layer, without load: beta t^3 dq/dn = -sqrt(beta) t^2 q
};

/// A face runs into a plane, not along it, where its outward direction at the edge is more along the plane's normal.
inline constexpr double kIntoPlane = 0.7;

/// Unit, in the surface, away from it at the edge from corner k of triangle t to the next.
Vector3d outward_at(const SurfaceMesh& mesh, int t, int k);

/// Is an edge one of planes of symmetry? `held`: bit i set, both its ends are held across axis i; `outward`: of the
/// edge. The surface must run into the plane, not along it.
bool mirrored(int held, const Vector3d& outward);

/// The face of a layer, reference frame. It begins with the vertices and triangles of Layer::articular, in their order;
/// triangles behind these are cartilage that was not selected for the contact: it carries no pressure, but what is
/// squeezed flows into it.
struct LayerFace {
  struct Edge {
    int triangle = -1, edge = -1;  ///< from corner `edge` of the triangle to the next
    Rim rim = Rim::Free;
    bool bonded = false;  ///< a wall for the layer goes on there, but bonded to bone: nothing flows under it
    bool shared = false;  ///< the layer goes on beyond, and another contact presses it there (shared_layers.h)
    double step = 0.0;    ///< Free: height of a step in the layer [mm], beyond which its face goes on alike; 0: none
    double wall = 0.5 * kPi;  ///< Free: by how much the surface turns down into the layer's side wall [rad]; a right
                              ///< angle, too, where no elements say it
  };
  SurfaceMesh mesh;
  int pressed = 0;                      ///< triangles of Layer::articular: the first ones
  std::vector<char> pressed_by_others;  ///< per triangle: other contacts press it (shared_layers.h); empty: none
  std::vector<double> thickness;        ///< per vertex of `mesh`, >= 0
  std::vector<Edge> edges;              ///< of one triangle alone, sorted by triangle and edge
  double bevelled = 0.0;                ///< length of the selection's rim where the next face turns by 20 to 40 degrees
};

/// What a face of the layer's elements is.
enum class FaceKind : unsigned char {
  Open,     ///< neither of the next two: the articular face, and whatever goes on from it
  Bonded,   ///< the bone holds it with all its nodes
  SideWall  ///< it looks away from the articular face, down to the bone
};

/// An element of a layer.
struct LayerElement {
  int domain, element;
};

/// The faces that one element of the layer alone has, in the elements' order.
struct LayerBoundary {
  FacetList faces;              ///< out of the elements
  std::vector<FaceKind> kinds;  ///< per face
  std::vector<char> node_held;  ///< per node of the model: bonded to the layer's bone
};

/// Kinds: Open or Bonded.
LayerBoundary find_layer_boundary(const JointModel& model, const std::vector<LayerElement>& elements,
                                  std::vector<char> node_held);

/// Facets of the articular surface all of whose nodes lie where the layer runs out to the bone are held, too, but they
/// are not bone: from them one looks through the layer at bone. Sets these Open.
void open_feather_facets(const JointModel& model, const FacetList& selected, LayerBoundary& boundary);

/// The bonded faces, turned round: normals out of the bone, into the layer. `node_planes`: as make_surface_mesh has it.
SurfaceMesh bonded_surface(const JointModel& model, const LayerBoundary& boundary,
                           const std::vector<unsigned char>& node_planes);

/// The faces of the boundary without these facets.
FacetList faces_without(const LayerBoundary& boundary, const FacetList& facets);

/// Finds the side walls: faces that turn away by more than 60 degrees from the bone next to them (normals into the
/// layer) and do not look through the layer at bone, where a patch of them reaches down to held nodes.
void find_side_walls(const JointModel& model, const SurfaceMesh& bone, LayerBoundary& boundary);
/// The same without a bone surface: patches bounded by edges sharper than 40 degrees, other than the one that most of
/// the selected area lies in, that reach held nodes.
void find_side_walls(const JointModel& model, const FacetList& selected, LayerBoundary& boundary);

/// Per facet: what it is. Open, if it is no face of the boundary.
std::vector<FaceKind> kinds_of(const LayerBoundary& boundary, const FacetList& facets);

/// The facets that are Open, the others without nodes; no kinds: all.
FacetList kept_facets(const FacetList& facets, const std::vector<FaceKind>& kinds);

/// Why a selection is no articular surface: most of it would be left out. Empty: it is one.
std::string mostly_left_out(const JointModel& model, const FacetList& facets, const std::vector<FaceKind>& kinds);

/// How far a face is followed beyond the selection, in greatest thicknesses: beyond, nothing is felt.
inline constexpr double kFaceReach = 5.0;

/// The face of a layer whose selected facets make up the mesh `articular` (cut from `selected`): goes on over open
/// faces across edges that turn by less than 40 degrees, kFaceReach times `deepest`, the greatest thickness, from the
/// selection; `whole`: to its end. `mirror`: per node of the model, bit k set: held in component k alone.
/// `node_planes`: as make_surface_mesh has it. Thickness: left empty.
LayerFace grow_face(const JointModel& model, const LayerBoundary& boundary, const FacetList& selected,
                    const SurfaceMesh& articular, double deepest, bool whole, const std::vector<unsigned char>& mirror,
                    const std::vector<unsigned char>& node_planes);

/// The face of a layer of which no elements are known: it ends where the selection does.
LayerFace selected_face(const SurfaceMesh& articular, const std::vector<unsigned char>& mirror);

/// What is beyond the rim of the selected facets [length], and how much of the layer goes on there [length^2].
struct RimLengths {
  double free = 0.0, goes_on = 0.0, symmetry = 0.0, bonded = 0.0, shared = 0.0;
  double area_beyond = 0.0;  ///< of the face without the selection, as far as it is followed
};
RimLengths rim_lengths(const LayerFace& face);

/// Of the selection's rim: what is beyond each edge. `goes_on`: a triangle of the face, or Rim::Continues.
struct SelectionEdge {
  int vertices[2];
  bool goes_on = false;  ///< without another contact that presses it
  LayerFace::Edge edge;
};
std::vector<SelectionEdge> selection_rim(const LayerFace& face);

}  // namespace dea
