// src/results/inside_fields.h – stress and strain inside the cartilage of a whole joint: of the model's elements,
// on its surfaces, as numbers. docs/layer_law.md, section 8.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "src/base/fault.h"
#include "src/base/finding.h"
#include "src/equilibrium/equilibrium.h"
#include "src/joint/layer.h"
#include "src/results/inside_numbers.h"
#include "src/springs/layer_bed.h"
#include "src/springs/layer_inside.h"

namespace dea {

/// Places in a layer of points of its reference configuration, such as its elements' centroids: below the closest point
/// of its face, at the height that the distances from bone and face tell; where the bone is not known, the depth below
/// the face over the thickness. Points that lie far beside the face have triangle -1. `face`: that `mesh` was made of.
std::vector<InsidePlace> inside_places(const Layer& layer, const LayerFace& face, const LayerMesh& mesh,
                                       const std::vector<Vector3d>& points);

/// As FEBio's plot files have it: stress, normal and shear in current global axes; Lagrange strain stays in the axes of
/// the reference.
InsideState turned(InsideState state, const Eigen::Matrix3d& rotation);

/// `measured`: of all vertices, at one height (states_at_height). `among`: per vertex, whether it counts; empty: all.
InsideStatistics inside_statistics(const InsideLayer& inside, const std::vector<InsideMeasures>& measured,
                                   const std::vector<char>& among = {});

/// What of a layer does not depend on pressures: made once, used for all states.
struct InsideMap {
  std::shared_ptr<const LayerOperator> layer;
  InsideShape shape;
  DepthLaws laws;
  std::vector<std::array<int, 2>> uses;  ///< contacts and sides (0 primary, 1 secondary) that press it
};

/// The elements of one layer.
struct InsideElements {
  std::vector<int> element;  ///< counted through InsideMaps::domains
  std::vector<InsidePlace> places;
  std::string parts;                   ///< names of their materials
  int all = 0;                         ///< in the layer
  double lowest = 0, highest = 0;      ///< of the heights of `places`
  int fewest_rows = 0, most_rows = 0;  ///< under a facet of the articular surface; 0: not counted (tetrahedra)
};

/// What does not depend on poses and loads: made once for a joint.
struct InsideMaps {
  std::vector<InsideMap> layers;  ///< each once; only of Law::Layer with LayerFit::TwoTerms, which has the fractions
  std::vector<std::array<int, 2>> layer_of;  ///< per contact, primary and secondary: index into `layers`, -1: none
  std::vector<int> domains;  ///< indices into JointModel::domains: solid elements of materials that are not rigid
  std::vector<int> first;    ///< per domain: number of its first element
  int elements = 0;
  std::vector<std::array<InsideElements, 2>> placed;  ///< per contact: primary, secondary
};
InsideMaps make_inside_maps(const JointModel& model, const Settings& settings, const Joint& joint,
                            const SpringBeds& beds);

/// What was found and could not be, a sentence each.
Findings inside_findings(const JointModel& model, const Joint& joint, const InsideMaps& maps);

/// UsageError where settings.inside asks for what no contact's law has.
void check_inside(const Joint& joint, const Settings& settings);

/// xx yy zz xy yz xz.
using SymmetricTensor = std::array<double, 6>;

/// One per element of a domain of the model.
struct InsideDomain {
  int domain = -1;                      ///< index into JointModel::domains
  std::vector<SymmetricTensor> stress;  ///< Cauchy [MPa], current global axes, at the centroid
  std::vector<SymmetricTensor> strain;  ///< Lagrange, global axes of the reference
};

/// Of one side of a contact.
struct InsideSide {
  InsideEnds numbers;
  std::vector<InsideEnds> compartments;     ///< one per compartment of the layer
  std::vector<std::vector<double>> facets;  ///< per row of inside_facet_fields, per facet of the surface: its mean
};

struct InsideResults {
  std::vector<InsideDomain> domains;  ///< one per InsideMaps::domains; 0 where no contact's layer is
  std::vector<std::array<std::optional<InsideSide>, 2>> contacts;  ///< primary, secondary; none: no layer
};
/// At an equilibrium that still has its springs. An element under several layers shows the one that presses hardest
/// there. Values are finite.
InsideResults inside_results(const InsideMaps& maps, const Joint& joint, const SpringBeds& beds, const Equilibrium& e);

}  // namespace dea
