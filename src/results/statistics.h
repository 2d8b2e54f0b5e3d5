// src/results/statistics.h – the numbers that sum up a contact's results.
#pragma once
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "src/base/numbers.h"
#include "src/equilibrium/equilibrium.h"
#include "src/results/fields.h"
#include "src/results/headline.h"
#include "src/results/inside_fields.h"

namespace dea {

/// Of the peak: less does not count as pressed.
inline constexpr double kFelt = 0.2;

/// Where a bare surface ends under pressure though the cartilage it presses goes on: there its edge presses like a
/// punch's. Pressed: the nearest spring inwards, within its own size, carries more than kFelt of the peak.
struct PressedRim {
  double selection = 0.0;  ///< length where the body's own mesh goes on, unselected
  double mesh = 0.0;       ///< length where the mesh ends
  double whole = 0.0;      ///< length of the whole rim, pressed or not; 0: nothing is pressed there
};

/// Of one compartment. NaN: undefined, it carries nothing.
struct CompartmentLoad {
  Headline headline;                  ///< of its share of the surface with springs, above the threshold of the whole
  Vector3d force = Vector3d::Zero();  ///< on the target, global axes; over all compartments it adds up to the contact's
  Vector3d center_of_pressure = Vector3d::Constant(kNaN);  ///< of its springs, current
  std::optional<InsideEnds> inside;                        ///< of its layer's share; none: not asked for, or no layer
};

/// Numbers per contact and state. NaN: undefined (no active spring).
struct ContactStatistics {
  Headline headline;       ///< of the source's surface
  int springs = 0;         ///< cast
  int springs_hit = 0;     ///< of these, those that stand over the target
  int springs_active = 0;  ///< of these, those that carry pressure
  int springs_most = 0;    ///< of these, the fewest that together carry nine tenths of the force
  // over active springs, weighted by area
  double peak = 0.0, p99 = 0.0, mean = 0.0, median = 0.0, p5 = 0.0, p25 = 0.0, p75 = 0.0, p95 = 0.0;
  double contact_area = 0.0;  ///< of the active springs
  // as Abraham et al. 2013 define them: over articular nodes of the source with p > 0, unweighted
  double nodal_peak = 0.0, nodal_mean = 0.0, nodal_median = 0.0;
  double facet_peak = 0.0;          ///< largest facet value of the source
  double facet_contact_area = 0.0;  ///< whole facets of the source in contact
  Vector3d center_of_pressure = Vector3d::Zero();
  Vector3d force = Vector3d::Zero();   ///< of the contact on the target
  Vector3d moment = Vector3d::Zero();  ///< the same, about the target's current centre of mass
  double largest_strain = 0.0;
  PressedRim pressed_rim[2];                  ///< of bare surfaces: primary, secondary
  double complementarity = kNaN;              ///< Law::Layer: residual of (L4) over the largest pressure
  std::vector<CompartmentLoad> compartments;  ///< one per compartment_names of the contact
  std::optional<InsideEnds> inside[2];        ///< of the layers of source, target; none: not asked for, or no layer
};

/// Of a layer that several contacts press. Where it is pressed twice: PressedTwice of the equilibrium.
struct LayerStatistics {
  std::vector<double> pressure;  ///< per facet of FieldMaps::SharedMap::plotted: that of all contacts added up, >= 0
  Headline headline;             ///< of this map
  double force = 0.0;            ///< sum of p A over it
};
/// One per shared layer of the joint. `fields`: one per contact.
std::vector<LayerStatistics> layer_statistics(const Joint& joint, const FieldMaps& maps,
                                              const std::vector<ContactFields>& fields);

/// The side of a contact whose compartments its results are told by: the one with springs if it has some, else the
/// other; -1: both are one piece.
int compartment_side(const ContactPair& pair);
/// Of that side; empty: none.
const std::vector<std::string>& compartment_names(const ContactPair& pair);

/// One per contact. `fields`: of the same equilibrium.
std::vector<ContactStatistics> contact_statistics(const Joint& joint, const SpringBeds& beds, const FieldMaps& maps,
                                                  const Equilibrium& e, const std::vector<ContactFields>& fields);

/// Puts what is known of the inside of both layers (primary, secondary) into the fields and statistics of their
/// contact. Compartments have that of compartment_side's layer.
void add_inside(const ContactPair& pair, std::array<std::optional<InsideSide>, 2> inside, ContactFields& fields,
                ContactStatistics& statistics);

/// Pressures by the nodes of an edge, the lesser first.
using EdgePressures = std::map<std::array<int, 2>, double>;
/// What other contacts press beside the edges of side `side` of a contact, on facets of the same layer.
EdgePressures pressed_beside(const Joint& joint, const std::vector<ContactFields>& fields, int contact, int side);

/// Where the selection of a layer's facets ends under pressure though the cartilage goes on: length of its rim beside
/// facets that carry more than `above`. `pressure`: per facet, SideFields::pressure. There the pressure is that of an
/// edge of the selection, as under a punch; not where another contact presses the facet beyond with half as much or
/// more (`beside`).
double pressed_end_of_selection(const Layer& layer, const std::vector<double>& pressure, double above,
                                const EdgePressures& beside = {});

/// How many facets wide contact is at its widest: twice the greatest distance of a pressed facet's edges from where
/// contact ends, over the mean size of the pressed facets, sqrt(2 area) of their triangles. A strip has its width,
/// whatever its length. Contact does not end at a plane of symmetry. Pressed is a facet with more than `above`;
/// `pressure`: per facet, SideFields::pressure. 0: none is. Infinity: it ends nowhere, on a closed surface. Where it is
/// more than `enough`: some number that is.
double facets_across(const Layer& layer, const std::vector<double>& pressure, double above, double enough = kInfinity);

/// Have the two bodies passed each other, so that no spring meets the other surface from its front any more? True if of
/// the springs whose line meets it at all three quarters meet it behind, deeper than springs look (four thicknesses).
bool passed_through(const Joint& joint, const ContactPair& pair, const std::vector<Pose>& poses);

}  // namespace dea
