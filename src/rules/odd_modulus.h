// src/rules/odd_modulus.h – a modulus that no cartilage has.
#pragma once
#include <optional>

#include "src/base/unit_names.h"

namespace dea {

/// The modulus in MPa, if these units make one of it that no cartilage has; nullopt: it may be one, or the units are
/// none of FEBio's.
std::optional<double> odd_modulus(double E, const UnitNames& units);

}  // namespace dea
