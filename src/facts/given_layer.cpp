#include "src/facts/given_layer.h"

#include "src/base/numbers.h"

namespace dea {

namespace {

std::optional<double> number_for(const std::map<std::string, double>& values, const std::string& surface) {
  auto found = values.find(surface);
  if (found == values.end()) found = values.find("");
  return found == values.end() ? std::nullopt : std::optional<double>(found->second);
}

}  // namespace

std::string said_of(const std::map<std::string, std::string>& values, const std::string& surface) {
  const auto found = values.find(surface);
  return found == values.end() ? std::string() : found->second;
}

const NodeThickness* node_thickness(const Settings& settings, const std::string& surface) {
  const auto found = settings.thickness_from.find(surface);
  return found == settings.thickness_from.end() ? nullptr : &found->second;
}

const double* thickness_at(const NodeThickness& thickness, int node_id) {
  const auto found = thickness.at_node.find(node_id);
  return found == thickness.at_node.end() ? nullptr : &found->second;
}

Law law_of(const Settings& settings, const Contact& contact) {
  const Law usual = settings.springs_at == SpringsAt::Articular ? Law::Layer : Law::Linear;
  return settings.law.value_or(contact.dea ? contact.dea->law.value_or(usual) : usual);
}

Facets facets_of(const Settings& settings, const Contact& contact) {
  return settings.facets.value_or(contact.dea ? contact.dea->facets.value_or(Facets::Curved) : Facets::Curved);
}

GivenLayer given_layer(const JointModel& model, const Settings& settings, const Contact& contact, int side) {
  const std::string& name = model.surfaces[at(side == 0 ? contact.primary : contact.secondary)].name;
  GivenLayer given;
  given.E = number_for(settings.E, name);
  given.nu = number_for(settings.nu, name);
  given.nodes = node_thickness(settings, name);
  if (given.nodes == nullptr) given.thickness = number_for(settings.thickness, name);
  given.thickness_scale = number_for(settings.thickness_scale, name);
  if (!contact.dea) return given;
  const DeaLayer& stated = contact.dea->layers[side];
  if (!given.E) given.E = stated.E;
  if (!given.nu) given.nu = stated.nu;
  given.map = !given.thickness && !stated.thickness_map.empty();
  if (!given.thickness && given.nodes == nullptr) given.thickness = stated.thickness;
  return given;
}

}  // namespace dea
