#include "src/facts/holders.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/facts/symmetry_planes.h"
#include "src/geometry/ray_caster.h"
#include "src/geometry/surface_mesh.h"

namespace dea {

namespace {

/// Notes that a body holds a node of a deformable part. Says whether it is the first that the body holds of that part.
bool note_holder(Holders& holders, const std::vector<int>& region, int node, int body, const std::string& how) {
  if (region[at(node)] < 0) return false;
  const bool first = holders.of_region[region[at(node)]].try_emplace(body, how).second;
  auto& bodies = holders.of_node[at(node)];
  if (std::find(bodies.begin(), bodies.end(), body) == bodies.end()) bodies.push_back(body);
  return first;
}

/// Does this body hold every deformable part the surface lies on (or has it none)?
bool held_already(const Holders& holders, const std::vector<int>& region, const Surface& s, int body) {
  for (int node : s.nodes) {
    if (region[at(node)] < 0) continue;
    const auto found = holders.of_region.find(region[at(node)]);
    if (found == holders.of_region.end() || found->second.count(body) == 0) return false;
  }
  return true;
}

/// The body of a surface as far as it is known: -1 not (yet).
int body_of_surface_nodes(const Holders& holders, const Bodies& bodies, const std::vector<int>& region,
                          const Surface& s) {
  int body = -1;
  for (int node : s.nodes) {
    int b = bodies.of_node[at(node)];
    if (region[at(node)] >= 0 && b < 0) {
      const auto found = holders.of_region.find(region[at(node)]);
      if (found != holders.of_region.end() && found->second.size() == 1) b = found->second.begin()->first;
    }
    if (b >= 0 && body >= 0 && b != body) return -1;
    if (b >= 0) body = b;
  }
  return body;
}

void note_bones(const JointModel& model, const Bodies& bodies, const std::vector<int>& region, Holders& holders) {
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    const int b = bodies.of_node[i];
    if (b >= 0)
      note_holder(holders, region, static_cast<int>(i), b,
                  fmt::format("shares nodes with rigid body \"{}\"", bodies.bodies[at(b)].name));
  }
  for (const RigidNodes& set : model.rigid_nodes) {
    const int b = bodies.of_material[at(set.material)];
    for (int node : set.nodes)
      note_holder(holders, region, node, b,
                  fmt::format("rigid node set \"{}\" on body \"{}\"", set.name, bodies.bodies[at(b)].name));
  }
}

/// Fixed in all three components, by one condition or several: the ground; in fewer it is a symmetry plane.
void note_ground(const JointModel& model, const Bodies& bodies, const std::vector<int>& region,
                 const NodeHolds& node_holds, const std::vector<int>& moved, Holders& holders) {
  holders.fixed.assign(model.nodes.size(), 0);
  holders.held_components.assign(model.nodes.size(), 0);
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    if (moved[i] >= 0) continue;  // fixed in some components or steps, moved in others
    unsigned fixed = 0;
    for (const NodeHold& hold : node_holds.of(static_cast<int>(i)))
      if (hold.fixed) fixed |= 1u << hold.component;
    if (fixed != 7u) {
      holders.held_components[i] = static_cast<unsigned char>(fixed);
      continue;
    }
    if (bodies.of_node[i] >= 0) continue;  // they hold that body, or are FEBio's to ignore
    holders.fixed[i] = 1;
    note_holder(holders, region, static_cast<int>(i), bodies.ground(), "nodes fixed in x, y and z");
  }
}

/// A surface takes the body of the one it is tied to.
struct Tie {
  const Contact* contact;
  const Surface *surface, *to;
  int body;
};

std::vector<Tie> new_ties(const JointModel& model, const Bodies& bodies, const std::vector<int>& region,
                          const Holders& holders) {
  std::vector<Tie> ties;
  for (const Contact& c : model.contacts) {
    if (c.kind != Contact::Kind::Tied || c.primary < 0 || c.secondary < 0) continue;
    const Surface *a = &model.surfaces[at(c.primary)], *b = &model.surfaces[at(c.secondary)];
    for (int side = 0; side < 2; ++side, std::swap(a, b)) {
      const int from = body_of_surface_nodes(holders, bodies, region, *b);
      if (from >= 0 && !held_already(holders, region, *a, from)) ties.push_back({&c, a, b, from});
    }
  }
  return ties;
}

std::size_t count_holders(const Holders& holders) {
  std::size_t count = 0;
  for (const auto& h : holders.of_region) count += h.second.size();
  return count;
}

/// The deformable part that a tie leads to at this place: a corner of the triangle is held by nothing but its part.
/// -1: to bone.
int soft_end(const Holders& holders, const Bodies& bodies, const std::vector<int>& region, const SurfaceMesh& to,
             int triangle) {
  for (const int v : to.triangles[at(triangle)]) {
    const int node = to.model_nodes[at(v)];
    if (region[at(node)] >= 0 && bodies.of_node[at(node)] < 0 && holders.of_node[at(node)].empty())
      return region[at(node)];
  }
  return -1;
}

/// Does a node lie over the surface that it is tied to, and not beyond its rim? Measured across the surface's normal.
bool lies_over(const SurfaceMesh& mesh, const SurfacePoint& closest, const Vector3d& x) {
  constexpr double kBeyond = 0.5;  // of the facet's size: rims of different meshes need not match
  const Vector3d away = x - position(mesh, closest), &n = mesh.normals[at(closest.triangle)];
  return (away - away.dot(n) * n).norm() <= kBeyond * std::sqrt(2 * mesh.areas[at(closest.triangle)]);
}

/// A node that a tie fastens to a body, through a deformable part or not.
struct TiedNode {
  const Tie* tie;
  int node, soft;  // soft: that part, -1: none
};

std::vector<TiedNode> tied_nodes(const JointModel& model, const Bodies& bodies, const std::vector<int>& region,
                                 Holders& holders, const std::vector<Tie>& ties) {
  std::vector<TiedNode> tied;
  for (const Tie& tie : ties) {
    const SurfaceMesh mesh = make_surface_mesh(tie.to->begin, tie.to->nodes, model.nodes);
    if (mesh.size() == 0) continue;
    const RayCaster caster(mesh);
    FarTie far;
    TieGap gap;
    gap.facet = std::sqrt(2 * surface_extent(mesh).area / mesh.size());
    for (int node : nodes_of_surface(*tie.surface)) {
      const Vector3d& x = model.nodes[at(node)];
      const SurfacePoint closest = caster.closest(x);
      if (!lies_over(mesh, closest, x)) continue;
      const double away = (position(mesh, closest) - x).norm();
      ++far.of;
      if (tie.contact->max_distance > 0 && away > tie.contact->max_distance) {
        far.nearest = far.nodes == 0 ? away : std::min(far.nearest, away);
        ++far.nodes;
        continue;
      }
      tied.push_back({&tie, node, soft_end(holders, bodies, region, mesh, closest.triangle)});
      const double between = (x - position(mesh, closest)).dot(mesh.normals[at(closest.triangle)]);
      ++gap.nodes;
      gap.mean += (between - gap.mean) / gap.nodes;
      gap.most = std::max(gap.most, std::abs(between));
    }
    if (tie.contact->closes_gap && gap.nodes > 0)
      holders.tie_gaps[static_cast<int>(tie.contact - model.contacts.data())] = gap;
    if (far.nodes > 0) holders.far_ties[static_cast<int>(tie.contact - model.contacts.data())] = far;
  }
  return tied;
}

/// Passes, for layers tied to layers: each decides from what was known before it, so that a layer tied to two bodies is
/// held by both, whatever the order. Ties to bone come first: a part that bone holds is not held by what is tied to its
/// side. Every pass but the last adds a body to a part, so there is an end.
void note_ties(const JointModel& model, const Bodies& bodies, const std::vector<int>& region, Holders& holders) {
  for (;;) {
    const std::size_t before = count_holders(holders);
    const std::vector<Tie> ties = new_ties(model, bodies, region, holders);
    const std::vector<TiedNode> tied = tied_nodes(model, bodies, region, holders, ties);
    const auto hold = [&](const TiedNode& t) {
      const bool first = note_holder(
          holders, region, t.node, t.tie->body,
          fmt::format("tied contact \"{}\" to body \"{}\"", t.tie->contact->name, bodies.bodies[at(t.tie->body)].name));
      if (first) holders.ties.insert(t.tie->contact->name);
    };
    for (const TiedNode& t : tied)
      if (t.soft < 0) hold(t);
    const std::map<int, std::map<int, std::string>> by_bone = holders.of_region;
    for (const TiedNode& t : tied) {
      if (t.soft < 0 || region[at(t.node)] < 0 || by_bone.count(region[at(t.node)]) > 0) continue;
      holders.soft_ties.try_emplace(region[at(t.node)], SoftTie{t.tie->contact->name, t.soft});
      hold(t);
    }
    if (count_holders(holders) == before) return;
  }
}

/// Where cartilage is rigid with its bone no node is held, and a contact states the planes instead. The few nodes of a
/// plane that are not held count as held: their neighbours leave them no way.
void note_planes(const JointModel& model, const std::vector<int>& region, const NodeHolds& node_holds,
                 Holders& holders) {
  holders.same_plane = same_plane(model, region);
  std::vector<SymmetryPlane> stated;
  for (const Contact& c : model.contacts)
    if (c.dea) stated.insert(stated.end(), c.dea->symmetry_planes.begin(), c.dea->symmetry_planes.end());
  const std::vector<unsigned char> in_stated = nodes_in_planes(model.nodes, stated, holders.same_plane);
  for (std::size_t i = 0; i < in_stated.size(); ++i)
    holders.held_components[i] = static_cast<unsigned char>(holders.held_components[i] | in_stated[i]);
  std::vector<char> on_bone;
  for (const auto& bodies : holders.of_node) on_bone.push_back(!bodies.empty());
  holders.ends = find_part_ends(model, region, node_holds, holders.held_components, on_bone, holders.same_plane);
  for (const PartEnd& end : holders.ends)
    for (const int node : end.forgotten)
      holders.held_components[at(node)] =
          static_cast<unsigned char>(holders.held_components[at(node)] | (1u << end.plane.axis));
}

}  // namespace

Findings far_ties(const JointModel& model, const Holders& holders) {
  Findings found;
  for (const auto& [contact, far] : holders.far_ties) {
    const Contact& c = model.contacts[at(contact)];
    found.push_back(
        {"tie-out-of-reach",
         {.contact = c.name},
         {{"type", c.type}, {"reach", c.max_distance}, {"nodes", far.nodes}, {"of", far.of}, {"nearest", far.nearest}},
         ties_by_search_radius(c.type) ? 0 : 1});
  }
  return found;
}

Findings closing_ties(const JointModel& model, const Holders& holders) {
  constexpr double kSome = 0.01;  // of the facets' size
  Findings closing;
  for (const auto& [contact, gap] : holders.tie_gaps)
    if (std::abs(gap.mean) > kSome * gap.facet)
      closing.push_back({"tie-closes-gap",
                         {.contact = model.contacts[at(contact)].name},
                         {{"type", model.contacts[at(contact)].type},
                          {"nodes", gap.nodes},
                          {"mean", std::abs(gap.mean)},
                          {"most", gap.most}}});
  return closing;
}

Findings holds_of_some_steps(const JointModel& model, const Holders& holders, const std::vector<int>& region,
                             const NodeHolds& node_holds, const std::vector<int>& moved) {
  Findings found;
  const auto steps = static_cast<int>(model.steps.size());
  const auto tell = [&](int form, std::vector<NamedValue> what, const std::set<int>& in) {
    if (in.count(-1) > 0 || static_cast<int>(in.size()) == steps) return;
    std::vector<int> numbers;
    for (const int step : in) numbers.push_back(step + 1);
    what.push_back({"steps", std::move(numbers)});
    found.push_back({"held-in-some-steps", {}, std::move(what), in.empty() ? form + 3 : form});
  };

  using Steps = std::set<int>;
  std::map<int, std::array<Steps, 3>> per_node;  // of those held in x, y and z: by component
  std::array<std::map<int, Steps>, 3> in_plane;  // of the others: by component, and node
  for (int node = 0; node < static_cast<int>(model.nodes.size()); ++node)
    for (const NodeHold& hold : node_holds.of(node)) {
      const std::size_t k = at(hold.component);
      if (hold.fixed && region[at(node)] >= 0 && moved[at(node)] < 0)
        (holders.fixed[at(node)] ? per_node[node][k] : in_plane[k][node]).insert(hold.step);
    }
  std::map<std::set<int>, int> fixed;  // steps in which nodes are held -> how many
  for (const auto& entry : per_node) {
    std::set<int> in;
    for (int step = 0; step < steps; ++step)
      if (std::all_of(entry.second.begin(), entry.second.end(), [&](const std::set<int>& component) {
            return component.count(-1) > 0 || component.count(step) > 0;
          }))
        in.insert(step);
    ++fixed[in];
  }
  for (const auto& [in, count] : fixed) tell(0, {{"nodes", count}}, in);
  for (std::size_t k = 0; k < 3; ++k) {
    std::map<Steps, int> held;  // steps -> how many nodes
    for (const auto& entry : in_plane[k]) ++held[entry.second];
    for (const auto& [in, count] : held) tell(1, {{"nodes", count}, {"component", "xyz"[k]}}, in);
  }

  std::map<std::string, Steps> ties;  // those that hold a part, by their name
  for (const Contact& c : model.contacts)
    if (c.kind == Contact::Kind::Tied && holders.ties.count(c.name) > 0) ties[c.name].insert(c.step);
  for (const auto& [name, in] : ties) tell(2, {{"tie", name}}, in);
  return found;
}

Holders find_holders(const JointModel& model, const Bodies& bodies, const std::vector<int>& region,
                     const NodeHolds& node_holds, const std::vector<int>& moved) {
  Holders holders;
  holders.of_node.resize(model.nodes.size());
  note_bones(model, bodies, region, holders);
  note_ground(model, bodies, region, node_holds, moved, holders);
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    if (moved[i] >= 0)
      note_holder(holders, region, static_cast<int>(i), moved[i],
                  fmt::format("nodes moved together by \"{}\"", bodies.bodies[at(moved[i])].name));
  note_ties(model, bodies, region, holders);
  note_planes(model, region, node_holds, holders);
  return holders;
}

}  // namespace dea
