#include "src/model/sound_mesh.h"

#include <algorithm>
#include <cmath>

#include "src/base/say.h"

namespace dea {

namespace {

// Graded meshes change size by two or three from node to node, a cone's tip by a thousand if its foot has 6000 nodes.
constexpr double kFlung = 1e3;
// Seven digits leave a tenth of an element's size at 1e6 times that size.
constexpr double kFarthest = 1e6;
constexpr std::size_t kMostNamed = 20;

std::string text_of(const Vector3d& x) { return fmt::format("({:.7g}, {:.7g}, {:.7g})", x[0], x[1], x[2]); }

/// `i`: an entry of its nodes.
std::string node_of_element(const JointModel& model, const Domain& d, std::size_t i) {
  return fmt::format("node {} of element {} of \"{}\"", model.node_ids[at(d.nodes[i])],
                     d.element_ids[i / at(nodes_per_element(d.shape))], d.name);
}

/// How far apart the nodes of some elements are.
double median_spacing(const std::vector<int>& nodes, const NodeSpacing& spacing) {
  std::vector<double> all;
  for (const int node : nodes)
    if (std::isfinite(spacing.nearest2[at(node)])) all.push_back(spacing.nearest2[at(node)]);
  if (all.empty()) return kInfinity;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return std::sqrt(*middle);
}

bool beyond(const Vector3d& x, double reach) { return !(x.cwiseAbs().maxCoeff() <= reach); }

std::vector<Fault> flung_nodes(const JointModel& model, const NodeSpacing& spacing) {
  std::vector<Fault> faults;
  std::vector<char> told(model.nodes.size(), 0);
  for (const Domain& d : model.domains)
    for (std::size_t i = 0; i < d.nodes.size(); ++i) {
      const int node = d.nodes[i];
      if (told[at(node)] || faults.size() >= kMostNamed || !is_flung(spacing, node)) continue;
      told[at(node)] = 1;
      faults.push_back(make_fault(model, d.origin,
                                  say("{} {}", node_of_element(model, d, i), flung_words(spacing, node)),
                                  say("check its coordinates {}", text_of(model.nodes[at(node)]))));
    }
  return faults;
}

/// Surfaces of contacts whose facets a plot file could not tell apart.
std::vector<Fault> far_surfaces(const JointModel& model, const NodeSpacing& spacing) {
  std::vector<Fault> faults;
  for (const Contact& contact : model.contacts)
    for (const int surface : {contact.primary, contact.secondary}) {
      if (contact.kind != Contact::Kind::Sliding || surface < 0) continue;
      const Surface& s = model.surfaces[at(surface)];
      const double size = median_spacing(s.nodes, spacing);
      const auto far = std::find_if(s.nodes.begin(), s.nodes.end(),
                                    [&](int node) { return beyond(model.nodes[at(node)], kFarthest * size); });
      if (far == s.nodes.end()) continue;
      faults.push_back(make_fault(
          model, s.origin,
          say("surface \"{}\" is too far from the origin (node {} at {}): a plot file's numbers, of seven digits, "
              "cannot tell nodes {:.2g} apart there;",
              s.name, model.node_ids[at(*far)], text_of(model.nodes[at(*far)]), size),
          "move the model to the origin"));
    }
  return faults;
}

/// Nodes, and points that the model's conditions name. `reach`: by the largest elements.
std::vector<Fault> far_points(const JointModel& model, double reach) {
  std::vector<Fault> faults;
  const auto check_place = [&](const std::string& what, Origin origin, const Vector3d& x) {
    if (!beyond(x, reach) || faults.size() >= kMostNamed) return;
    faults.push_back(make_fault(model, origin,
                                say("{} is at {}, too far from the origin for this mesh;", what, text_of(x)),
                                "check its coordinates"));
  };
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    if (beyond(model.nodes[i], reach)) check_place(fmt::format("node {}", model.node_ids[i]), {0, 0}, model.nodes[i]);
  for (const Material& m : model.materials)
    if (m.center_of_mass) check_place(fmt::format("the centre of mass of \"{}\"", m.name), m.origin, *m.center_of_mass);
  for (const RigidFollower& f : model.rigid_followers)
    check_place(fmt::format("the insertion of \"{}\"", f.name), f.origin, f.insertion);
  for (const RigidAxialForce& f : model.rigid_axial_forces)
    for (const Vector3d& x : {f.point_a, f.point_b}) check_place(fmt::format("a point of \"{}\"", f.name), f.origin, x);
  for (const RigidCable& c : model.rigid_cables)
    for (const RigidCable::Point& p : c.points)
      check_place(fmt::format("a point of \"{}\"", c.name), c.origin, p.position);
  for (const RigidJoint& j : model.rigid_joints)
    check_place(fmt::format("the joint_origin of \"{}\"", j.name), j.origin, j.joint_origin);
  for (const RigidSpring& s : model.rigid_springs)
    for (const Vector3d& x : {s.insertion_a, s.insertion_b})
      check_place(fmt::format("an insertion of \"{}\"", s.name), s.origin, x);
  return faults;
}

}  // namespace

NodeSpacing node_spacing(const std::vector<Vector3d>& positions, const std::vector<int>& begin,
                         const std::vector<int>& nodes) {
  NodeSpacing found{std::vector<double>(positions.size(), kInfinity), std::vector<double>(positions.size(), 0.0)};
  for (std::size_t e = 0; e + 1 < begin.size(); ++e)
    for (int i = begin[e]; i < begin[e + 1]; ++i)
      for (int j = begin[e]; j < i; ++j) {
        const std::size_t a = at(nodes[at(i)]), b = at(nodes[at(j)]);
        const double d2 = (positions[a] - positions[b]).squaredNorm();
        if (!(d2 > 0)) continue;
        found.nearest2[a] = std::min(found.nearest2[a], d2);
        found.nearest2[b] = std::min(found.nearest2[b], d2);
      }
  for (std::size_t e = 0; e + 1 < begin.size(); ++e) {
    double first = 0.0, second = 0.0;  // the two largest
    for (int i = begin[e]; i < begin[e + 1]; ++i) {
      const double d2 = found.nearest2[at(nodes[at(i)])];
      second = std::max(second, std::min(first, d2));
      first = std::max(first, d2);
    }
    for (int i = begin[e]; i < begin[e + 1]; ++i) {
      const std::size_t a = at(nodes[at(i)]);
      found.around2[a] = std::max(found.around2[a], found.nearest2[a] < first ? first : second);
    }
  }
  return found;
}

bool is_flung(const NodeSpacing& spacing, int node) {
  const double nearest2 = spacing.nearest2[at(node)], around2 = spacing.around2[at(node)];
  return std::isfinite(nearest2) && around2 > 0 && nearest2 > kFlung * kFlung * around2;
}

std::string flung_words(const NodeSpacing& spacing, int node) {
  return fmt::format("is {:.3g} away from its other nodes, which are {:.2g} apart;",
                     std::sqrt(spacing.nearest2[at(node)]), std::sqrt(spacing.around2[at(node)]));
}

std::vector<Fault> mesh_faults(const JointModel& model) {
  std::vector<int> begin = {0}, nodes;
  for (const Domain& d : model.domains) {
    nodes.insert(nodes.end(), d.nodes.begin(), d.nodes.end());
    for (std::size_t e = 0; e < d.element_ids.size(); ++e) begin.push_back(begin.back() + nodes_per_element(d.shape));
  }
  const NodeSpacing spacing = node_spacing(model.nodes, begin, nodes);
  std::vector<Fault> faults = flung_nodes(model, spacing);
  if (!faults.empty()) return faults;
  faults = far_surfaces(model, spacing);
  if (!faults.empty()) return faults;
  double reach = 0.0;
  for (const Domain& d : model.domains) reach = std::max(reach, kFarthest * median_spacing(d.nodes, spacing));
  return reach > 0 ? far_points(model, reach) : faults;
}

}  // namespace dea
