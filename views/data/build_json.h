// views/data/build_json.h – what dea build made, as JSON.
#pragma once
#include <string>
#include <vector>

#include "src/base/finding.h"
#include "src/build/anatomy.h"
#include "src/build/build_joint.h"
#include "src/results/headline.h"
#include "views/data/json.h"

namespace dea {

/// How the joint stands under one load.
struct BuildBalance {
  struct Contact {
    std::string name;
    Headline headline;  ///< of its primary surface
  };
  bool found = false;
  double time = 0.0;                          ///< of the model
  std::string words;                          ///< how the search ended
  std::vector<Eigen::Vector3d> displacement;  ///< per body
  std::vector<Eigen::Vector3d> turn;          ///< per body: rotation vector [rad]
  std::vector<Contact> contacts;              ///< empty: nothing was solved
};

/// What `dea build` has to tell. Views of what the command holds.
struct BuildSummary {
  const std::string& output;
  const BuiltJoint& joint;
  const BuildReport& report;
  const BuiltModelSettings& model;
  const std::vector<BuildBalance>& balances;  ///< one per load
  const std::vector<double>& load_times;      ///< of the table, per load; empty: there is none
  const Anatomy& anatomy;
  const Findings& of_run;  ///< of tables, and what dea run warns of the model and dea build not in words of its own
};

bool all_balanced(const BuildSummary& summary);

/// Loads that no joint bears, or that none would feel, a line each: their units are mixed up, or a body weight is in
/// kg.
std::vector<std::string> load_questions(const BuiltJoint& joint, const BuildReport& report);
/// A modulus that no cartilage has; empty: it is none.
std::string modulus_question(const BuiltModelSettings& model);
/// Layers whose thickness had to change by much, or is less than it was to be, over a part of their area that matters;
/// a line each.
std::vector<std::string> change_warnings(const BuiltJoint& joint, const BuildReport& report);
/// What was measured against the axes or the side, layers that changed, a modulus that no cartilage has, loads that no
/// joint bears, loads without a balance; a line each.
std::vector<std::string> own_warnings(const BuildSummary& summary);
/// The same, and what dea run warns of, with the codes.
std::vector<std::string> build_warnings(const BuildSummary& summary);

/// docs/results.md says what its keys are.
Json build_json(const BuildSummary& summary);

}  // namespace dea
