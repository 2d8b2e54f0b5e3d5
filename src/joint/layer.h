// src/joint/layer.h – a layer of cartilage: its two surfaces, thickness, modulus, the body it moves with.
#pragma once
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "src/base/finding.h"
#include "src/facts/symmetry_planes.h"
#include "src/geometry/surface_mesh.h"
#include "src/joint/layer_face.h"
#include "src/model/elasticity.h"
#include "src/model/settings.h"

namespace dea {

struct ModelParts;

/// An edge of a bare surface's rim: from corner `edge` of a triangle to the next.
struct BareRimEdge {
  int triangle = -1, edge = -1;
  bool goes_on = false;  ///< the body's own mesh goes on there, turned by less than 40 degrees, unselected
};

/// Pieces of an articular surface that hang together, such as a tibia's plateaus (compartments.h).
struct Compartments {
  std::vector<std::string> names;  ///< empty: the surface is one piece
  std::vector<int> of_triangle;    ///< per triangle of Layer::articular; empty as the names
  int size() const { return static_cast<int>(names.size()); }
};

/// Of the facets' size: cartilage that is thinner is none.
inline constexpr double kNoThickness = 0.01;
/// Of the facets' size: what the layer law's pressures have an answer for. Measured: blocks give the right pressure at
/// 0.0025, and numbers without sense at 0.002.
inline constexpr double kLayerLawThickness = 0.005;

/// A layer of cartilage between an articular surface and its bone, or the bare surface of a rigid body.
struct Layer {
  int surface = -1;         ///< index into JointModel::surfaces: the articular surface
  int body = -1;            ///< index into Joint::bodies
  std::string attached_by;  ///< the rule that found the body, as a sentence
  int material = -1;        ///< index into JointModel::materials; -1 for a bare rigid surface
  Elasticity elasticity;    ///< of the cartilage
  bool rigid = false;       ///< a bare rigid surface, or that of a part: thickness 0
  int part = -1;            ///< index into Joint::parts: the surface gives way with it; -1: none
  SurfaceMesh articular;    ///< normals out of the layer, towards the other side; facets left out have no triangles
  SurfaceMesh bone;         ///< normals out of the bone, into the layer; equals `articular` when rigid
  SpringsAt springs_at = SpringsAt::Articular;
  std::vector<double> thickness;  ///< per vertex of spring_surface(); 0 when rigid
  std::vector<char> missed;       ///< per vertex: its ray found no opposing face near enough; closest point used
  bool thickness_given = false;   ///< by the user, not measured
  std::string thickness_from;     ///< the user's file of thickness per node; empty: none
  double thickness_scale = 1.0;   ///< thickness is what was measured or given times this
  std::vector<unsigned char>
      mirror;  ///< per articular vertex: bit k set, held in component k alone: on a symmetry plane
  std::vector<SymmetryPlane> planes;  ///< of symmetry, of its contact: surfaces go on behind them
  std::vector<int> region_nodes;      ///< nodes of the deformable elements of the layer
  std::vector<FaceKind> facet_kinds;  ///< per facet: all but Open are left out; empty: all are kept
  std::vector<char> turned;           ///< of a bare surface, per facet: it looks the other way than the model winds it
  std::unordered_map<int, int> stands_for;  ///< of a bare surface: node -> the one at its place that `articular` has
  std::vector<BareRimEdge> bare_rim;        ///< of a bare surface
  Compartments compartments;
  Findings findings;  ///< what the user should know of it
  LayerFace face;     ///< of a layer whose springs stand on the articular surface; else empty

  /// The surface thickness and springs live on.
  const SurfaceMesh& spring_surface() const { return springs_at == SpringsAt::Bone ? bone : articular; }
  /// Area-weighted mean over the articular triangles of their size over the thickness there: sqrt(2 area), the edge of
  /// the quadrilateral they halve. 0 when rigid. Triangles without thickness are left out.
  double facet_size() const;
  /// Vertices whose thickness is at most this part of the facets' size there.
  int without_thickness(double part = kNoThickness) const;
  double min_thickness() const;
  double max_thickness() const;
  double mean_thickness() const;  ///< area-weighted
  int missed_count() const;
};

/// The layer under one surface of a contact that has both: 0: primary, 1: secondary. InputError: there is none; what
/// else is known to be missing follows the first fault. Throws UsageError for a setting of this surface that cannot be
/// followed.
Layer make_layer(const ModelParts& parts, const Contact& contact, int side);

/// Vertex of the articular surface at each of its nodes.
std::unordered_map<int, int> articular_vertices(const Layer& layer);

}  // namespace dea
