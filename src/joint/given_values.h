// src/joint/given_values.h – numbers of springs, ligaments, cables, muscles and rigid forces that the user puts in
// the place of the model's (Settings::set_values), each under the name the model gives.
//
//   stiffness     of a linear spring: force per elongation, >= 0; 0: it is cut
//   slack-length  of a linear spring, or of one by a curve: the length from which elongation, strain and stretch count,
//                 > 0; of all springs of a set alike
//   force         of an axial force, cable or spring of constant force: its pull; of a rigid force: its component
//
// A number takes the place of the one in the file: a load controller that scales the model's scales it too.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "src/base/finding.h"
#include "src/base/sentence.h"
#include "src/facts/parts.h"

namespace dea {

inline constexpr const char* kStiffness = "stiffness";
inline constexpr const char* kSlackLength = "slack-length";
inline constexpr const char* kForce = "force";

/// The user's number; nullopt: the model's holds.
std::optional<double> given_value(const Settings& settings, const std::string& name, const char* parameter);
/// Of springs between nodes: by their own name or that of their discrete set.
std::optional<double> given_value(const JointModel& model, const Settings& settings, const DiscreteSprings& springs,
                                  const char* parameter);

/// The force of a spring between nodes that is the same at any length, without its controller; nullopt: it is not.
std::optional<double> constant_force(const DiscreteSprings& springs);

/// Throws UsageError for a name that the model does not give, a parameter that the thing of this name does not have, a
/// value of the wrong sign, and a rigid force in whose place the settings put another.
void check_given_values(const ModelParts& parts);

/// What was changed, a sentence per number: "set: ACL.stiffness 80 (model: 60)".
Findings given_value_findings(const ModelParts& parts);

}  // namespace dea
