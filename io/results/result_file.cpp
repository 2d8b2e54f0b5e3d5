#include "io/results/result_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/time_text.h"
#include "src/model/sound_mesh.h"

namespace dea {

namespace {

std::vector<int> sorted(std::vector<int> nodes) {
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

/// Node lists of the things a named set is made of; empty: there is no such set.
std::vector<std::vector<int>> set_members(const XpltMesh& mesh, const std::string& name) {
  std::vector<std::vector<int>> members;
  for (const auto* list : {&mesh.facet_sets, &mesh.surfaces}) {
    for (const XpltFacets& set : *list) {
      if (set.name != name || !members.empty()) continue;
      for (int f = 0; f < set.size(); ++f)
        members.push_back(sorted({set.nodes.begin() + set.begin[at(f)], set.nodes.begin() + set.begin[at(f) + 1]}));
    }
  }
  if (!members.empty()) return members;
  for (const XpltSet& set : mesh.element_sets) {
    if (set.name != name) continue;
    const std::unordered_set<int> in_set(set.items.begin(), set.items.end());
    for (const XpltDomain& domain : mesh.domains) {
      const int n = xplt_nodes_per_element(domain.element_type);
      for (int e = 0; e < xplt_elements(domain); ++e)
        if (in_set.count(domain.element_ids[at(e)]))
          members.push_back(sorted({domain.nodes.begin() + e * n, domain.nodes.begin() + (e + 1) * n}));
    }
    break;
  }
  return members;
}

}  // namespace

ResultFile read_result(const std::string& path, const std::string& label) {
  ResultFile result{path, label, read_xplt(path)};
  if (result.xplt.states.empty()) throw InputError(path + ": found no complete state, expected at least one");
  return result;
}

const XpltMesh& mesh_of(const ResultFile& result, int state) {
  return result.xplt.meshes[at(result.xplt.states[at(state)].mesh)];
}

bool is_solution(const ResultFile& result, int state) {
  // FEBio gives others than those that end a time step this status, too, converged or not
  return !written_by_dea(result.xplt) || result.xplt.states[at(state)].status != kStatusNotConverged;
}

constexpr const char* kNoSolution = "is no solution; do not use its numbers";

std::string newer_note(const ResultFile& result) {
  return fmt::format(
      "note: {}: a plot file of version {:#x}; dea knows up to {:#x} and passes over what is new: {} part{}",
      result.path, result.xplt.version, XpltFile().version, result.xplt.passed_over,
      result.xplt.passed_over == 1 ? "" : "s");
}

std::string no_solution_warning(const ResultFile& result, int state) {
  return fmt::format("warning: {}: the state at time {} {}", result.path, time_text(result.xplt.states[at(state)].time),
                     kNoSolution);
}

std::vector<std::string> no_solution_warnings(const std::vector<std::string>& remarks) {
  std::vector<std::string> warnings;
  for (const std::string& remark : remarks)
    if (remark.ends_with(kNoSolution)) warnings.push_back(remark);
  return warnings;
}

bool same_time(double a, double b) { return std::abs(a - b) <= 1e-6 * std::max({std::abs(a), std::abs(b), 1e-30}); }

int find_state(const ResultFile& result, double time) {
  for (std::size_t s = 0; s < result.xplt.states.size(); ++s)
    if (same_time(result.xplt.states[s].time, time)) return static_cast<int>(s);
  std::string times;
  for (const XpltState& state : result.xplt.states) times += (times.empty() ? "" : ", ") + time_text(state.time);
  throw InputError(
      fmt::format("{}: found no state at time {}, expected one of {}", result.path, time_text(time), times));
}

int find_surface(const ResultFile& result, int state, const std::string& name) {
  const std::vector<XpltFacets>& surfaces = mesh_of(result, state).surfaces;
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    if (surfaces[s].name == name) return static_cast<int>(s);
  return -1;
}

namespace {

/// Values of a variable on a region in a state; null: none.
const XpltRegion* find_region(const ResultFile& result, int state, XpltGroup group, const std::string& field,
                              int region) {
  const int index = find_variable(result.xplt, group, field);
  if (index < 0) return nullptr;
  for (const XpltRegion& candidate : result.xplt.states[at(state)].variables[at(index)])
    if (candidate.region == region) return &candidate;
  return nullptr;
}

/// `displacement`: three numbers per node of the mesh; null: none.
ResultSurface make_surface(const ResultFile& result, int state, int surface, const std::vector<float>* displacement) {
  const XpltMesh& mesh = mesh_of(result, state);
  const XpltFacets& facets = mesh.surfaces[at(surface)];
  std::vector<Vector3d> positions(mesh.node_ids.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    positions[i] = Vector3d(mesh.coordinates[3 * i], mesh.coordinates[3 * i + 1], mesh.coordinates[3 * i + 2]);
  for (std::size_t i = 0; displacement && i < positions.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) positions[i][static_cast<int>(k)] += (*displacement)[3 * i + k];
  for (int f = 0; f < facets.size(); ++f) {
    const int n = facets.begin[at(f) + 1] - facets.begin[at(f)];
    if (n != 3 && n != 4 && n != 6 && n != 7 && n != 8 && n != 9 && n != 10)
      throw InputError(fmt::format("{}: surface \"{}\": found a facet of {} nodes, expected triangles and quads",
                                   result.path, facets.name, n));
  }
  for (int node : facets.nodes)
    if (!positions[at(node)].allFinite())
      throw InputError(
          fmt::format("{}: surface \"{}\": found a node whose position is not a number", result.path, facets.name));
  const NodeSpacing spacing = node_spacing(positions, facets.begin, facets.nodes);
  for (int node : facets.nodes)
    if (is_flung(spacing, node))
      throw InputError(fmt::format("{}: surface \"{}\": node {} {} the file is damaged, or its model is", result.path,
                                   facets.name, mesh.node_ids[at(node)], flung_words(spacing, node)));
  return make_result_surface(facets.name, facets.begin, facets.nodes, positions);
}

}  // namespace

ResultSurface result_surface(const ResultFile& result, int state, int surface) {
  return make_surface(result, state, surface, nullptr);
}

const std::vector<float>* displacement_of(const ResultFile& result, int state) {
  const XpltRegion* u = find_region(result, state, XpltGroup::Nodal, "displacement", 0);
  return u != nullptr && u->values.size() == mesh_of(result, state).coordinates.size() ? &u->values : nullptr;
}

std::optional<ResultSurface> deformed_surface(const ResultFile& result, int state, int surface) {
  const std::vector<float>* u = displacement_of(result, state);
  return u == nullptr ? std::nullopt : std::optional(make_surface(result, state, surface, u));
}

std::vector<double> facet_values(const ResultFile& result, int state, int surface, const std::string& field,
                                 bool undefined) {
  const XpltRegion* region = find_region(result, state, XpltGroup::Surface, field, surface + 1);
  if (region == nullptr) return {};
  const XpltVariable& variable = result.xplt.variables[at(find_variable(result.xplt, XpltGroup::Surface, field))];
  const XpltFacets& facets = mesh_of(result, state).surfaces[at(surface)];
  if (variable.type != XpltType::Float || variable.format == XpltFormat::Region)
    throw InputError(fmt::format("{}: \"{}\" is not one number per facet or node", result.path, field));
  for (float x : region->values)
    if (!std::isfinite(x) && !undefined)
      throw InputError(fmt::format("{}: surface \"{}\", time {}: \"{}\" is not a number somewhere", result.path,
                                   facets.name, time_text(result.xplt.states[at(state)].time), field));
  std::vector<double> values;
  if (variable.format == XpltFormat::Item) {
    values.assign(region->values.begin(), region->values.end());
    for (double& x : values)
      if (!std::isfinite(x)) x = kNaN;
    return values;
  }
  std::unordered_map<int, int> place;  // per node: values per node come in order of first appearance
  for (int node : facets.nodes) place.try_emplace(node, static_cast<int>(place.size()));
  for (int f = 0; f < facets.size(); ++f) {
    const int n = facets.begin[at(f) + 1] - facets.begin[at(f)];
    double sum = 0.0;
    for (int k = 0; k < n; ++k) {
      const int slot = variable.format == XpltFormat::Mult ? f * facets.max_nodes + k
                                                           : place[facets.nodes[at(facets.begin[at(f)] + k)]];
      sum += region->values[at(slot)];
    }
    values.push_back(std::isfinite(sum) ? sum / n : kNaN);
  }
  return values;
}

std::optional<Vector3d> surface_vector(const ResultFile& result, int state, int surface, const std::string& field) {
  const XpltRegion* region = find_region(result, state, XpltGroup::Surface, field, surface + 1);
  if (region == nullptr || region->values.size() != 3) return std::nullopt;
  return Vector3d(region->values[0], region->values[1], region->values[2]);
}

bool has_springs(const ResultFile& result, int state, int surface) {
  const XpltRegion* region = find_region(result, state, XpltGroup::Surface, "springs", surface + 1);
  return region != nullptr && region->values.size() == 1 && region->values[0] > 0;
}

std::vector<BodyPose> body_poses(const ResultFile& result, int state) {
  const XpltMesh& mesh = mesh_of(result, state);
  const XpltState& values = result.xplt.states[at(state)];
  std::vector<BodyPose> bodies;
  const auto body = [&](const std::string& name) {
    for (BodyPose& b : bodies)
      if (b.name == name) return &b;
    return static_cast<BodyPose*>(nullptr);
  };
  const int index = find_variable(result.xplt, XpltGroup::Domain, "rigid position");
  if (index >= 0) {
    for (const XpltRegion& region : values.variables[at(index)]) {
      const std::string& name = mesh.parts[at(mesh.domains[at(region.region - 1)].part - 1)];
      if (body(name) || region.values.size() != 3) continue;
      bodies.push_back({name, Vector3d(region.values[0], region.values[1], region.values[2]), {}});
    }
  }
  const std::vector<XpltObject>& objects = result.xplt.meshes.front().objects;
  for (std::size_t o = 0; o < objects.size() && o < values.objects.size(); ++o) {
    if (objects[o].line || objects[o].tag != 1) continue;
    const XpltObjectState& s = values.objects[o];
    BodyPose* known = body(objects[o].name);
    if (!known) {
      bodies.push_back({objects[o].name, Vector3d(s.position[0], s.position[1], s.position[2]), {}});
      known = &bodies.back();
    }
    const Eigen::Quaterniond q(s.rotation[3], s.rotation[0], s.rotation[1], s.rotation[2]);
    if (q.norm() > 0) known->rotation = q;
  }
  return bodies;
}

std::vector<std::string> region_names(const XpltMesh& mesh) {
  std::vector<std::string> names;
  for (const auto* list : {&mesh.facet_sets, &mesh.surfaces})
    for (const XpltFacets& set : *list)
      if (std::find(names.begin(), names.end(), set.name) == names.end()) names.push_back(set.name);
  for (const XpltSet& set : mesh.element_sets)
    if (std::find(names.begin(), names.end(), set.name) == names.end()) names.push_back(set.name);
  return names;
}

FacetMask facets_in(const ResultFile& result, int state, int surface, const std::string& name) {
  const XpltMesh& mesh = mesh_of(result, state);
  const XpltFacets& facets = mesh.surfaces[at(surface)];
  const std::vector<std::vector<int>> members = set_members(mesh, name);
  if (members.empty()) {
    const std::vector<std::string> known = region_names(mesh);
    throw InputError(fmt::format("{}: found no facet set, surface or element set \"{}\"{}, expected one of {}",
                                 result.path, name, did_you_mean(name, known), name_list(known, name, 20)));
  }
  std::unordered_map<int, std::vector<int>> members_at;  // node -> members
  for (std::size_t m = 0; m < members.size(); ++m)
    for (int node : members[m]) members_at[node].push_back(static_cast<int>(m));
  FacetMask mask(at(facets.size()), 0);
  for (int f = 0; f < facets.size(); ++f) {
    const std::vector<int> nodes =
        sorted({facets.nodes.begin() + facets.begin[at(f)], facets.nodes.begin() + facets.begin[at(f) + 1]});
    for (int m : members_at[nodes.front()])
      if (std::includes(members[at(m)].begin(), members[at(m)].end(), nodes.begin(), nodes.end())) mask[at(f)] = 1;
  }
  if (std::find(mask.begin(), mask.end(), 1) == mask.end())
    throw InputError(fmt::format("{}: no facet of surface \"{}\" lies in \"{}\"", result.path, facets.name, name));
  return mask;
}

}  // namespace dea
