#include "src/facts/symmetry_planes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "src/base/numbers.h"
#include "src/base/value_above.h"

namespace dea {

namespace {

constexpr int kLeastNodes = 3;  // fewer make no plane

/// Zero, if it is but for rounding.
double rounded(double at, double same_plane) { return std::abs(at) <= same_plane ? 0.0 : at; }

/// Mean size of a surface's facets.
double facet_size(const JointModel& model, const Surface& surface) {
  double sum = 0.0;
  for (int f = 0; f < surface.size(); ++f) {
    const int first = surface.begin[at(f)];
    Vector3d low = model.nodes[at(surface.nodes[at(first)])], high = low;
    for (int i = first; i < surface.begin[at(f + 1)]; ++i) {
      low = low.cwiseMin(model.nodes[at(surface.nodes[at(i)])]);
      high = high.cwiseMax(model.nodes[at(surface.nodes[at(i)])]);
    }
    sum += (high - low).norm();
  }
  return surface.size() > 0 ? sum / surface.size() : 0.0;
}

/// What the search for ends looks up. References: must not outlive what it was made of.
struct PlaneSearch {
  const JointModel& model;
  const std::vector<int>& region;
  const NodeHolds& node_holds;
  const std::vector<unsigned char>& held;
  const std::vector<char>& on_bone;
  double same_plane;
};

/// A deformable part: the box it lies in, and its nodes that no bone holds.
struct Part {
  Vector3d low, high;
  std::vector<int> nodes;
};

std::map<int, Part> find_all_parts(const PlaneSearch& in) {
  std::map<int, Part> parts;
  for (std::size_t i = 0; i < in.region.size(); ++i) {
    if (in.region[i] < 0) continue;
    const Vector3d& x = in.model.nodes[i];
    Part& part = parts.try_emplace(in.region[i], Part{x, x, {}}).first->second;
    part.low = part.low.cwiseMin(x);
    part.high = part.high.cwiseMax(x);
    if (!in.on_bone[i]) part.nodes.push_back(static_cast<int>(i));
  }
  return parts;
}

bool is_held(const PlaneSearch& in, int node, int component) { return (in.held[at(node)] >> component & 1) != 0; }

/// Steps in which more than half of an end's nodes are held across it.
std::vector<int> held_steps(const PlaneSearch& in, const std::vector<int>& nodes, int axis) {
  std::vector<int> steps;
  for (int step = 0; step < static_cast<int>(in.model.steps.size()); ++step) {
    const auto held = std::count_if(nodes.begin(), nodes.end(), [&](int node) {
      const auto holds = in.node_holds.of(node);
      return std::any_of(holds.begin(), holds.end(),
                         [&](const NodeHold& h) { return h.fixed && h.component == axis && h.acts(step); });
    });
    if (2 * held > static_cast<std::ptrdiff_t>(nodes.size())) steps.push_back(step);
  }
  return steps;
}

/// Where nodes are held that lie at an end, or no farther from it than a tenth of a facet.
struct Near {
  std::vector<int> nodes;     // at the end
  std::vector<double> where;  // of those held across it
  int held_near = 0;
};

Near near_end(const PlaneSearch& in, const Part& part, int axis, double end) {
  Near found;
  for (const int node : part.nodes) {
    const double x = in.model.nodes[at(node)][axis], away = std::abs(x - end);
    if (away > 100 * in.same_plane) continue;
    found.held_near += is_held(in, node, axis);
    if (away > in.same_plane) continue;
    found.nodes.push_back(node);
    if (is_held(in, node, axis)) found.where.push_back(x);
  }
  return found;
}

/// Ends that are planes of symmetry, or may have been meant so.
std::vector<PartEnd> ends_of_part(const PlaneSearch& in, int region, const Part& part) {
  std::vector<PartEnd> ends;
  for (int axis = 0; axis < 3; ++axis)
    for (const double limit : {part.low[axis], part.high[axis]}) {
      const Near found = near_end(in, part, axis, limit);
      if (static_cast<int>(found.nodes.size()) < kLeastNodes) continue;
      PartEnd end;
      end.region = region;
      end.nodes = static_cast<int>(found.nodes.size());
      end.held = static_cast<int>(found.where.size());
      // Three nodes of a plane that noise spreads farther are no plane.
      end.is_plane = end.held >= kLeastNodes && 2 * end.held > end.nodes && 2 * end.held > found.held_near;
      end.plane = {axis, rounded(found.where.empty() ? limit : value_above(found.where, 0.5), in.same_plane)};
      if (end.is_plane) {
        end.steps = held_steps(in, found.nodes, axis);
        if (10 * end.held >= 9 * end.nodes)
          for (const int node : found.nodes)
            if (!is_held(in, node, axis)) end.forgotten.push_back(node);
      }
      ends.push_back(std::move(end));
    }
  return ends;
}

/// Does a contact press the part there? Then it is its face that is held, and no plane of symmetry.
bool is_pressed(const PlaneSearch& in, int region, const SymmetryPlane& plane) {
  const auto there = [&](int node) {
    return in.region[at(node)] == region &&
           std::abs(in.model.nodes[at(node)][plane.axis] - plane.at) <= 2 * in.same_plane;
  };
  for (const Contact& c : in.model.contacts) {
    if (c.kind != Contact::Kind::Sliding) continue;
    for (const int s : {c.primary, c.secondary}) {
      if (s < 0) continue;
      const Surface& surface = in.model.surfaces[at(s)];
      int facets = 0;
      for (int f = 0; f < surface.size(); ++f)
        facets += std::all_of(surface.nodes.begin() + surface.begin[at(f)],
                              surface.nodes.begin() + surface.begin[at(f + 1)], there);
      if (2 * facets > surface.size()) return true;
    }
  }
  return false;
}

/// The component in which an end is held that is no plane of symmetry: a fifth of its nodes or more, and the part
/// hardly anywhere else but at the end across from it. Nodes in planes of symmetry across that component are theirs.
int held_instead(const PlaneSearch& in, const Part& part, const std::vector<PartEnd>& ends,
                 const SymmetryPlane& plane) {
  const auto at_end = [&](const Vector3d& x) { return std::abs(x[plane.axis] - plane.at) <= 2 * in.same_plane; };
  const auto across = [&](const Vector3d& x) {
    return x[plane.axis] - part.low[plane.axis] <= in.same_plane ||
           part.high[plane.axis] - x[plane.axis] <= in.same_plane;
  };
  for (int k = 0; k < 3; ++k) {
    if (k == plane.axis) continue;
    int nodes = 0, held = 0, meant = 0, elsewhere = 0;
    for (const int node : part.nodes) {
      const Vector3d& x = in.model.nodes[at(node)];
      const bool of_plane = std::any_of(ends.begin(), ends.end(), [&](const PartEnd& e) {
        return e.is_plane && e.plane.axis == k && std::abs(x[k] - e.plane.at) <= 2 * in.same_plane;
      });
      if (of_plane) continue;
      if (at_end(x)) {
        ++nodes;
        held += is_held(in, node, k);
        meant += is_held(in, node, plane.axis);
      } else if (!across(x)) {
        elsewhere += is_held(in, node, k);
      }
    }
    if (held >= kLeastNodes && 5 * held >= nodes && 5 * meant < nodes && elsewhere < held) return k;
  }
  return -1;
}

}  // namespace

double same_plane(const JointModel& model, const std::vector<int>& region) {
  constexpr double kSamePlane = 1e-3;
  double of_parts = 0.0, of_all = 0.0;
  const auto take = [](double size, double& least) {
    if (size > 0 && (least == 0.0 || size < least)) least = size;
  };
  for (const Contact& c : model.contacts)
    for (const int s : {c.primary, c.secondary}) {
      if (s < 0) continue;
      const Surface& surface = model.surfaces[at(s)];
      const double size = facet_size(model, surface);
      take(size, of_all);
      if (std::any_of(surface.nodes.begin(), surface.nodes.end(), [&](int node) { return region[at(node)] >= 0; }))
        take(size, of_parts);
    }
  return kSamePlane * (of_parts > 0 ? of_parts : of_all);
}

std::vector<PartEnd> find_part_ends(const JointModel& model, const std::vector<int>& region,
                                    const NodeHolds& node_holds, const std::vector<unsigned char>& held,
                                    const std::vector<char>& on_bone, double same_plane) {
  if (std::all_of(held.begin(), held.end(), [](unsigned char bits) { return bits == 0; })) return {};
  const PlaneSearch in = {model, region, node_holds, held, on_bone, same_plane};
  std::vector<PartEnd> found;
  for (const auto& [number, part] : find_all_parts(in)) {
    std::vector<PartEnd> ends = ends_of_part(in, number, part);
    for (PartEnd& end : ends)
      if (end.is_plane && is_pressed(in, number, end.plane)) {
        end.is_plane = false;
        end.forgotten.clear();
      }
    for (PartEnd& end : ends)
      if (!end.is_plane) end.instead = held_instead(in, part, ends, end.plane);
    for (PartEnd& end : ends)
      if (end.is_plane || end.instead >= 0) found.push_back(std::move(end));
  }
  return found;
}

void add_planes(const std::vector<SymmetryPlane>& more, double same_plane, std::vector<SymmetryPlane>& planes) {
  for (const SymmetryPlane& plane : more) {
    const bool known = std::any_of(planes.begin(), planes.end(), [&](const SymmetryPlane& p) {
      return p.axis == plane.axis && std::abs(p.at - plane.at) <= same_plane;
    });
    if (!known) planes.push_back({plane.axis, rounded(plane.at, same_plane)});
  }
  std::sort(planes.begin(), planes.end(), [](const SymmetryPlane& a, const SymmetryPlane& b) {
    return std::tie(a.axis, a.at) < std::tie(b.axis, b.at);
  });
}

std::vector<SymmetryPlane> planes_of_contact(const JointModel& model, const Contact& contact,
                                             const std::vector<int>& region, const std::vector<PartEnd>& ends,
                                             double same_plane) {
  std::vector<SymmetryPlane> planes;
  if (contact.dea) add_planes(contact.dea->symmetry_planes, same_plane, planes);
  std::set<int> regions;
  for (const int s : {contact.primary, contact.secondary})
    if (s >= 0)
      for (const int node : model.surfaces[at(s)].nodes) regions.insert(region[at(node)]);
  for (const PartEnd& end : ends)
    if (end.is_plane && regions.count(end.region) > 0) add_planes({end.plane}, same_plane, planes);
  return planes;
}

std::vector<unsigned char> nodes_in_planes(const std::vector<Vector3d>& nodes, const std::vector<SymmetryPlane>& planes,
                                           double same_plane) {
  if (planes.empty()) return {};
  std::vector<unsigned char> in_plane(nodes.size(), 0);
  for (const SymmetryPlane& plane : planes)
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (std::abs(nodes[i][plane.axis] - plane.at) <= same_plane)
        in_plane[i] = static_cast<unsigned char>(in_plane[i] | (1u << plane.axis));
  return in_plane;
}

std::string in_words(const std::vector<SymmetryPlane>& planes) {
  std::string text;
  for (const SymmetryPlane& plane : planes)
    text += fmt::format("{}{} = {:.6g}", text.empty() ? "" : ", ", "xyz"[plane.axis], plane.at);
  return text;
}

}  // namespace dea
