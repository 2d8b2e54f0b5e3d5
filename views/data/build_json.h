// febiodea/views/data/build_json.h – what dea build made, as JSON.
#pragma once
#include <string>

#include <febiodea/build/anatomy.h>
#include <febiodea/build/build_joint.h>
#include <febiodea/results/headline.h>
#include <febiodea/views/data/json.h>

namespace dea {

/// What `dea build` has to tell. Views of what the command holds.
struct BuildSummary {
  const std::string& output;
  const BuiltJoint& joint;
  const BuildReport& report;
  const BuiltModelSettings& model;
  bool balanced = false;
  const std::string& balance;                ///< in words
  const std::vector<Eigen::Vector3d>& seat;  ///< per body
  Headline headline;                         ///< of the first contact's primary surface, in balance
  const Anatomy& anatomy;
};

/// docs/results.md says what its keys are.
Json build_json(const BuildSummary& summary);

}  // namespace dea
