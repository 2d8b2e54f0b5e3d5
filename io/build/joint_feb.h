// io/build/joint_feb.h – a joint made of surfaces, as a model file that FEBio and dea solve.
#pragma once
#include <string>

#include "src/build/built_joint.h"

namespace dea {

/// FEBio 4.0: prisms of neo-Hookean cartilage, rigid bones as triangle shells that share the cartilage's nodes,
/// sliding-elastic contacts, a step that moves the loaded bodies by settings.seat and one that loads them (times 0 to 1
/// and 1 to 2; with several loads on until 1 + their number, load i, counted from 0, at time 2 + i). Fixed bodies are
/// held, loaded ones do not turn. Numbers round-trip.
std::string joint_feb(const BuiltJoint& joint, const BuiltModelSettings& settings);

}  // namespace dea
