// src/facts/holders.h – what holds the deformable parts of a model: bones, node sets, ties, the ground.
#pragma once
#include <map>
#include <set>
#include <string>
#include <vector>

#include "src/base/finding.h"
#include "src/facts/bodies.h"
#include "src/facts/node_holds.h"
#include "src/facts/symmetry_planes.h"
#include "src/model/joint_model.h"

namespace dea {

/// A part that is tied to another deformable part, not to what holds that one.
struct SoftTie {
  std::string contact;
  int part = -1;  ///< the other part's region
};

/// A tie of which nodes lie over the surface they would be tied to, but out of its reach.
struct FarTie {
  int nodes = 0, of = 0;
  double nearest = 0.0;  ///< of those
};

/// What lies between tied nodes and the surface they are tied to.
struct TieGap {
  int nodes = 0;
  double mean = 0.0, most = 0.0;  ///< along that surface's normals; most: the largest size
  double facet = 0.0;             ///< of the surface that they are tied to: mean size
};

struct Holders {
  std::map<int, std::map<int, std::string>> of_region;  ///< region -> body -> how
  std::map<int, SoftTie> soft_ties;                     ///< region -> what it is tied to, if that is deformable
  std::map<int, FarTie> far_ties;                       ///< by the contact
  std::map<int, TieGap> tie_gaps;                       ///< by the contact: of those that close them in FEBio
  std::set<std::string> ties;                           ///< names of the contacts that are how a body holds a part
  std::vector<std::vector<int>> of_node;                ///< per node: all bodies that hold it
  std::vector<char> fixed;                              ///< per node: held by the ground in x, y and z
  std::vector<unsigned char> held_components;  ///< per node: bit k set, held by the ground in component k, not in all
  double same_plane = 0.0;                     ///< nodes nearer to a plane of symmetry lie in it
  std::vector<PartEnd> ends;                   ///< of deformable parts, at which nodes are held
};

/// Ties that reach no node of some that lie over their surface.
Findings far_ties(const JointModel& model, const Holders& holders);

/// `region`: per node, -1: in no deformable part, else its part. `moved`: per node, body of nodes that are moved
/// together, -1: none.
Holders find_holders(const JointModel& model, const Bodies& bodies, const std::vector<int>& region,
                     const NodeHolds& node_holds, const std::vector<int>& moved);

/// Ties over gaps or overlaps that FEBio closes and dea does not.
Findings closing_ties(const JointModel& model, const Holders& holders);

/// Fixed nodes and ties that hold deformable parts in some steps only: they count in all.
Findings holds_of_some_steps(const JointModel& model, const Holders& holders, const std::vector<int>& region,
                             const NodeHolds& node_holds, const std::vector<int>& moved);

}  // namespace dea
