// src/results/fields.h – results on the model's own surfaces and nodes.
#pragma once
#include <array>
#include <vector>

#include "src/equilibrium/equilibrium.h"
#include "src/results/comparison.h"

namespace dea {

/// Fields of one side of a contact. Facets and vertices are those of the layer's articular surface; the facets are in
/// the order of the model's surface. Frame: global, current.
struct SideFields {
  // per facet
  std::vector<double> pressure;  ///< area-weighted mean over the facet, >= 0
  std::vector<double>
      joint_space;  ///< signed g: > 0 apart, < 0 overlap; where no ray meets the other side, the closest distance
  std::vector<double> overlap;  ///< Delta >= 0
  std::vector<double> strain;   ///< of this layer, >= 0
  // per vertex
  std::vector<double> vertex_pressure;    ///< area-weighted average of the facets around the vertex
  std::vector<double> vertex_thickness;   ///< cartilage thickness
  std::vector<double> vertex_shortening;  ///< this layer's share of the overlap, >= 0
  Vector3d force = Vector3d::Zero();      ///< of the contact on this side
  bool springs = false;                   ///< it is this side that they stand on
  double contact_area = 0.0;              ///< of whole facets with pressure > 0, current
  // per facet, where the inside of the layer was asked for, else empty: max shear stress, first and third principal
  // strain at the bone and at the articular surface, mean over the facet
  std::vector<double> bone_max_shear, bone_first_strain, bone_third_strain;
  std::vector<double> surface_max_shear, surface_first_strain, surface_third_strain;
  double resultant_factor =
      1.0;  ///< |sum of p A n over these facets| / |force|: 1 = the map carries the whole force; NaN without force
};

/// The fields per facet by name. Plot file, VTU and CSV walk through them: a new one is a member of SideFields and a
/// row.
struct FacetField {
  const char* name;    ///< "contact pressure", in the plot file
  const char* column;  ///< "pressure", in CSV
  const char* unit;    ///< FEBio's dimension code: "P", "L", "": none
  std::vector<double> SideFields::*values;
};
const std::vector<FacetField>& facet_fields();
/// The same of the inside of a layer.
const std::vector<FacetField>& inside_facet_fields();

struct ContactFields {
  SideFields sides[2];  ///< primary, secondary
};

/// What several contacts do to one surface: pressures, forces and areas add up; what else a facet or vertex has is that
/// of the contact that presses it hardest, or, where none does, of the nearest. `sides`: not empty, of the same facets
/// and vertices.
SideFields added_sides(const std::vector<const SideFields*>& sides);

/// What fields need of a joint again and again: closest points between surfaces, depth of cartilage nodes.
struct FieldMaps {
  struct LayerMap {
    std::vector<int> articular_vertex_facet_begin;  // per vertex: range in the next
    std::vector<int> articular_vertex_facets;       // facets around each vertex
    std::vector<double> facet_area;
    std::vector<SurfacePoint> articular_to_bone;  // per articular vertex: closest bone point (bone variant)
    std::vector<double> vertex_thickness;         // per articular vertex
    std::vector<SurfacePoint> node_to_articular;  // per region node: closest articular point
    std::vector<double> node_depth;               // per region node: 0 at the bone, 1 at the articular surface
  };
  struct ContactMap {
    LayerMap layers[2];      // primary, secondary
    RayCaster articular[2];  // primary, secondary
    ResultSurface plotted;   // the source's surface, as a plot file holds it
  };
  /// A layer that several contacts press: the facets of all their surfaces, those that several have once.
  struct SharedMap {
    ResultSurface plotted;                ///< as a plot file would hold it
    std::vector<std::vector<int>> facet;  ///< per use of the layer, per facet of its surface: number in `plotted`
  };
  std::vector<ContactMap> contacts;
  std::vector<SharedMap> shared;  ///< one per shared layer of the joint
};
FieldMaps make_field_maps(const JointModel& model, const Joint& joint);

/// Fields of every contact at an equilibrium. The source's facets carry the springs' own force exactly (articular
/// springs); the target's facets get the law at their own overlap, and with
/// springs at the bone every surface gets values by interpolation; `resultant_factor` says how well the force is kept.
std::vector<ContactFields> contact_fields(const Joint& joint, const SpringBeds& beds, const FieldMaps& maps,
                                          const Equilibrium& e);

/// How the nodes of a part have moved in its frame (nodes x 3); nullptr: no contact presses it.
const Eigen::MatrixX3d* part_motion(const Joint& joint, const Equilibrium& e, int part);
/// How its nodes have moved from where the model has them, global; empty where part_motion is none.
std::vector<Vector3d> part_displacements(const Joint& joint, const Equilibrium& e, int part);

/// Displacement of every model node: that of its part; rigid with its body; cartilage nodes moved towards their bone by
/// the layer's shortening, linearly through the thickness (squash).
std::vector<Vector3d> node_displacements(const JointModel& model, const Joint& joint, const FieldMaps& maps,
                                         const Equilibrium& e, const std::vector<ContactFields>& fields, bool squash);

}  // namespace dea
