// src/joint/placing.h – where bodies are put before anything moves or loads them.
#pragma once
#include <string>
#include <vector>

#include "src/base/finding.h"
#include "src/geometry/pose.h"
#include "src/geometry/surface_mesh.h"
#include "src/joint/joint.h"

namespace dea {

/// Poses of all bodies in the reference configuration.
std::vector<Pose> reference_poses(const Joint& joint);

/// Starting pose of each body: its reference pose, then settings.placements in their order. What is attached to a body
/// goes along; nothing is recognised again. Throws UsageError for a body that is not there or never moves, and where
/// the sphere about whose centre a body is to be turned says little: settings.rotate_about has to name the point then.
std::vector<Pose> starting_poses(const JointModel& model, const Joint& joint, const Settings& settings);

/// The sphere through a body's articular surface, if it has one, no other one, and that is round enough to have a
/// centre. Else UsageError: `given` asks for the centre, `expected` is what to give in its place.
SphereFit articular_sphere(const Joint& joint, int body, const NamedSetting& given, const Sentence& expected);

/// Reference coordinates of the point about which settings turn a body. `name`: of the body, for faults. Throws as
/// starting_poses does.
Vector3d turn_point(const Joint& joint, int body, const TurnPoint& about, const std::string& name);

/// The same model with its bodies where the settings place them: nodes, centres of mass, and all points of bodies. A
/// rigid spring that has its length from its reference keeps it. InputError: springs between nodes whose free length is
/// that of their reference, which would be another one.
JointModel placed_model(const JointModel& model, const Joint& joint, const Settings& settings);

/// The placements, a sentence each: how a body is turned, about what point, and how that was found.
Findings placement_findings(const JointModel& model, const Joint& joint, const Settings& settings);

}  // namespace dea
