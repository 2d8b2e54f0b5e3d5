// src/results/inside_fields.h – stress and strain inside the cartilage of a whole joint: of the model's elements,
// on its surfaces, as numbers. docs/layer_law.md, section 8.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "src/base/finding.h"
#include "src/base/fault.h"
#include "src/equilibrium/equilibrium.h"
#include "src/results/inside.h"
#include "src/results/inside_numbers.h"

namespace dea {

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
  std::vector<InsideMap> contacts;  ///< one per contact of the joint
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

/// Per facet of a surface its mean at one height: max shear stress [MPa], first and third principal strain.
struct InsideFacets {
  std::vector<double> max_shear, first_strain, third_strain;
};
/// Of one side of a contact.
struct InsideSide {
  InsideEnds numbers;
  std::vector<InsideEnds> compartments;  ///< one per compartment of the layer
  InsideFacets bone, surface;
};

struct InsideResults {
  std::vector<InsideDomain> domains;  ///< one per InsideMaps::domains; 0 where no contact's layer is
  std::vector<std::array<std::optional<InsideSide>, 2>> contacts;  ///< primary, secondary; none: no layer
};
/// At an equilibrium that still has its springs. An element under several contacts shows the one that presses hardest
/// there. Values are finite.
InsideResults inside_results(const InsideMaps& maps, const Joint& joint, const SpringBeds& beds, const Equilibrium& e);

}  // namespace dea
