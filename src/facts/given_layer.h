// src/facts/given_layer.h – what is said of a contact and its layers: by the user, or by the contact itself.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "src/model/joint_model.h"
#include "src/model/settings.h"

namespace dea {

/// What is said of a layer, the user before the contact.
struct GivenLayer {
  std::optional<double> E, nu, thickness;
  bool map = false;                      ///< the contact has a map of its thickness, and no number takes its place
  const NodeThickness* nodes = nullptr;  ///< thickness per node, before number and map; the settings'
  std::optional<double> thickness_scale;
  bool has_thickness() const { return thickness || map || nodes != nullptr; }
};
GivenLayer given_layer(const JointModel& model, const Settings& settings, const Contact& contact, int side);

/// Layers know nothing of springs that stand on the bone: there the law is linear, unless another one is said.
Law law_of(const Settings& settings, const Contact& contact);
Facets facets_of(const Settings& settings, const Contact& contact);

/// Thickness per node that the settings have for a surface; nullptr: none.
const NodeThickness* node_thickness(const Settings& settings, const std::string& surface);
/// At the node of this number; nullptr: it is not there.
const double* thickness_at(const NodeThickness& thickness, int node_id);

/// What a setting says of a surface; empty: nothing.
std::string said_of(const std::map<std::string, std::string>& values, const std::string& surface);

}  // namespace dea
