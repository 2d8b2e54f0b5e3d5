// plugin/contact_statement.h – what a contact of this plugin says of itself to the reader of FEBio's model.
#pragma once
#include "src/model/joint_model.h"

namespace dea {

inline constexpr const char* kSides[2] = {"primary", "secondary"};

struct StatesContact {
  virtual ~StatesContact() = default;
  /// What the model says of this contact. `model`: must hold both surfaces by name. Throws InputError naming the
  /// contact and the parameter.
  virtual Contact statement(const JointModel& model) const = 0;
};

}  // namespace dea
