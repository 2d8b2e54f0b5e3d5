#include "src/facts/bodies.h"

#include <algorithm>
#include <cmath>

#include "src/base/disjoint_sets.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/model/element_faces.h"

namespace dea {

namespace {

/// Area, centroid of a shell element's middle surface, and its mean thickness. Beside solids FEBio counts the mass of
/// shells twice (FERigidShellDomain::detJ0 has the whole thickness, and the weights across it add up to 2).
void add_shell_mass(const JointModel& model, const Domain& domain, int element, double density, double* mass,
                    Vector3d* moment) {
  const int n = nodes_per_element(domain.shape);
  const int* nodes = domain.nodes.data() + static_cast<std::ptrdiff_t>(element) * n;
  double thickness = 0.0;
  if (!domain.shell_thickness.empty()) {
    for (int k = 0; k < n; ++k) thickness += domain.shell_thickness[at(element * n + k)];
    thickness /= n;
  }
  for (const auto& t : split_facet(nodes, n, model.nodes)) {
    const Vector3d &a = model.nodes[at(t[0])], &b = model.nodes[at(t[1])], &c = model.nodes[at(t[2])];
    const double dm = density * 2.0 * thickness * 0.5 * (b - a).cross(c - a).norm();
    *mass += dm;
    *moment += dm * (a + b + c) / 3.0;
  }
}

/// Per rigid material, the first one of its body: bodies share nodes, and a bone that the user takes as rigid and whose
/// nodes the model gives to a rigid body is part of that body.
std::vector<int> first_materials(const JointModel& model, const std::vector<char>& rigid) {
  DisjointSets sets(model.materials.size());
  std::vector<int> node_material(model.nodes.size(), -1);
  for (const Domain& domain : model.domains) {
    if (domain.material < 0 || !rigid[at(domain.material)] || is_line(domain.shape)) continue;
    for (int node : domain.nodes) {
      int& first = node_material[at(node)];
      if (first < 0)
        first = domain.material;
      else
        sets.join(first, domain.material);
    }
  }
  for (const RigidNodes& set : model.rigid_nodes)
    for (int node : set.nodes)
      if (const int m = node_material[at(node)]; m >= 0 && !model.materials[at(m)].rigid) sets.join(m, set.material);
  std::vector<int> first(model.materials.size());
  for (std::size_t m = 0; m < first.size(); ++m) first[m] = sets.root(static_cast<int>(m));
  return first;
}

/// Masses and centres of mass. Densities of a body of which one is no number count as 1, all of them. Of a body that
/// the model has rigid, what the user takes as rigid is no part of either: FEBio turns it about the centre of what is
/// rigid there.
void find_masses(const JointModel& model, const std::vector<char>& rigid, Bodies& result) {
  std::vector<Vector3d> moments(result.bodies.size(), Vector3d::Zero());
  const auto is_nan = [&](int m) {
    return !model.materials[at(m)].rigid && std::isnan(model.materials[at(m)].density);
  };
  std::vector<char> even;  // per body: one density everywhere
  for (const Body& body : result.bodies)
    even.push_back(std::any_of(body.materials.begin(), body.materials.end(), is_nan) ? 1 : 0);
  for (const Domain& domain : model.domains) {
    if (domain.material < 0 || !rigid[at(domain.material)]) continue;
    const Material& material = model.materials[at(domain.material)];
    const int b = result.of_material[at(domain.material)];
    const bool in_model = rigid_in_model(model, result.bodies[at(b)]) >= 0;
    if (!material.rigid && in_model) continue;
    const double density = even[at(b)] && !in_model ? 1.0 : material.density;
    const int elements = static_cast<int>(domain.element_ids.size());
    for (int e = 0; e < elements; ++e) {
      if (is_shell(domain.shape)) {
        add_shell_mass(model, domain, e, density, &result.bodies[at(b)].mass, &moments[at(b)]);
      } else if (!is_line(domain.shape)) {
        const ElementVolume v = element_volume(model, domain, e);
        result.bodies[at(b)].mass += density * v.volume;
        moments[at(b)] += density * v.volume * v.centroid;
      }
    }
  }
  for (std::size_t b = 0; b < result.bodies.size(); ++b) {
    Body& body = result.bodies[b];
    const int of = rigid_in_model(model, body);
    if (const auto& given = model.materials[at(of >= 0 ? of : body.materials.front())].center_of_mass) {
      body.center_of_mass = *given;
      body.center_given = true;
    } else if (body.mass > 0) {
      body.center_of_mass = moments[b] / body.mass;
    }
  }
}

}  // namespace

int rigid_in_model(const JointModel& model, const Body& body) {
  const auto found =
      std::find_if(body.materials.begin(), body.materials.end(), [&](int m) { return model.materials[at(m)].rigid; });
  return found == body.materials.end() ? -1 : *found;
}

bool taken_as_rigid(const JointModel& model, const Body& body) {
  return std::any_of(body.materials.begin(), body.materials.end(),
                     [&](int m) { return !model.materials[at(m)].rigid; });
}

ElementVolume element_volume(const JointModel& model, const Domain& domain, int element) {
  const int n = nodes_per_element(domain.shape);
  const int* nodes = domain.nodes.data() + static_cast<std::ptrdiff_t>(element) * n;
  ElementVolume v;
  const Vector3d origin = model.nodes[at(nodes[0])];
  int face_nodes[8];
  for (const auto& face : element_faces(domain.shape)) {
    for (std::size_t k = 0; k < face.size(); ++k) face_nodes[k] = nodes[face[k]];
    for (const auto& t : split_facet(face_nodes, static_cast<int>(face.size()), model.nodes)) {
      const Vector3d a = model.nodes[at(t[0])] - origin, b = model.nodes[at(t[1])] - origin,
                     c = model.nodes[at(t[2])] - origin;
      const double dv = a.dot(b.cross(c)) / 6.0;
      v.volume += dv;
      v.centroid += dv * (a + b + c) / 4.0;
    }
  }
  v.centroid = v.volume != 0 ? Vector3d(origin + v.centroid / v.volume) : origin;
  return v;
}

std::vector<char> rigid_materials(const JointModel& model, const Settings& settings) {
  std::vector<char> rigid;
  for (const Material& m : model.materials) rigid.push_back(m.rigid ? 1 : 0);
  for (const std::string& name : settings.rigid) {
    bool found = false;
    for (std::size_t i = 0; i < model.materials.size(); ++i) {
      if (model.materials[i].name != name) continue;
      rigid[i] = 1;
      found = true;
    }
    if (!found)
      throw UsageError(Fault{.given = NamedSetting{"rigid", "", name},
                             .found = no_such_name("material", name, every_name(model.materials))});
  }
  return rigid;
}

int add_body(Bodies& bodies, Body body) {
  const std::string name = body.name;
  const auto taken = [&] {
    return std::any_of(bodies.bodies.begin(), bodies.bodies.end(),
                       [&](const Body& other) { return other.name == body.name; });
  };
  for (int i = 2; taken(); ++i) body.name = fmt::format("{} ({})", name, i);
  const int index = bodies.ground();
  bodies.bodies.insert(bodies.bodies.end() - 1, std::move(body));
  return index;
}

Bodies find_bodies(const JointModel& model, const std::vector<char>& rigid, const std::vector<char>& layer_domains) {
  const std::vector<int> first = first_materials(model, rigid);
  Bodies result;
  result.of_material.assign(model.materials.size(), -1);
  for (std::size_t m = 0; m < first.size(); ++m) {
    if (!rigid[m]) continue;
    if (at(first[m]) == m) {
      Body body;
      body.name = model.materials[m].name;
      result.of_material[m] = static_cast<int>(result.bodies.size());
      result.bodies.push_back(body);
    }
    result.of_material[m] = result.of_material[at(first[m])];
    result.bodies[at(result.of_material[m])].materials.push_back(static_cast<int>(m));
  }
  find_masses(model, rigid, result);
  Body ground;
  ground.name = "ground";
  ground.ground = true;
  result.bodies.push_back(ground);
  result.of_node.assign(model.nodes.size(), -1);
  for (std::size_t d = 0; d < model.domains.size(); ++d) {
    const Domain& domain = model.domains[d];
    if (domain.material < 0 || !rigid[at(domain.material)] || is_line(domain.shape)) continue;
    if (!layer_domains.empty() && layer_domains[d]) continue;
    for (int node : domain.nodes) result.of_node[at(node)] = result.of_material[at(domain.material)];
  }
  return result;
}

}  // namespace dea
