// febiodea/joint/given_layer.h – what is said of a contact and its layers: by the user, or by the contact itself.
#pragma once
#include <map>
#include <optional>
#include <string>

#include <febiodea/model/joint_model.h>
#include <febiodea/model/settings.h>

namespace dea {

/// What is said of a layer, the user before the contact.
struct GivenLayer {
  std::optional<double> E, nu, thickness;
  bool map = false;  ///< thickness by the contact's map
};
GivenLayer given_layer(const JointModel& model, const Settings& settings, const Contact& contact, int side);

/// Layers know nothing of springs that stand on the bone: there the law is linear, unless another one is said.
Law law_of(const Settings& settings, const Contact& contact);
Facets facets_of(const Settings& settings, const Contact& contact);

/// What a setting says of a surface; empty: nothing.
std::string said_of(const std::map<std::string, std::string>& values, const std::string& surface);

}  // namespace dea
