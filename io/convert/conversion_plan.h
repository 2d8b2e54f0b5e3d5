// io/convert/conversion_plan.h – what a conversion changes, before it is written in one way or the other.
#pragma once
#include <string>
#include <vector>

#include "io/convert/linear_solver.h"
#include "src/joint/joint.h"

namespace dea {

struct ConversionPlan {
  std::vector<Remark> left_to_febio;  ///< joints between rigid bodies that DEA does not know
  Joint joint;                        ///< of the model as it is
  JointModel target;  ///< the model as it will be; its lists are the model's, entry by entry, new ones at the end
  std::vector<char> converted;         ///< per contact: becomes one of type dea
  std::vector<char> contact_gone;      ///< per contact
  std::vector<char> rigid_nodes_gone;  ///< per entry of rigid_nodes; those that lose some nodes have them in `target`
  std::vector<char> fixed_nodes_gone;  ///< per entry of fixed_nodes
  std::vector<std::string> map_of_surface;  ///< per surface: name of its thickness map; "": none
  std::vector<char> node_rigid;             ///< per node: of a rigid element in `target`
  int ground = -1;                          ///< material made for cartilage on the ground; -1: none
  bool split = false;          ///< a domain of the model was divided: `target.domains` are no longer the model's
  LinearSolver linear_solver;  ///< for all steps; without a type: each step's own, or none
  std::vector<Sentence> changes, notes;
};

ConversionPlan plan_conversion(const JointModel& model, const Settings& settings);

}  // namespace dea
