#include <febiodea/joint/symmetry_planes.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include <febiodea/base/numbers.h>

namespace dea {

namespace {

void add(std::vector<SymmetryPlane>& planes, const SymmetryPlane& plane, double tolerance) {
  const bool known = std::any_of(planes.begin(), planes.end(), [&](const SymmetryPlane& p) {
    return p.axis == plane.axis && std::abs(p.at - plane.at) <= tolerance;
  });
  if (!known) planes.push_back({plane.axis, std::abs(plane.at) <= tolerance ? 0.0 : plane.at});
}

/// Nodes of a deformable part: where they end, and how many are held in each component elsewhere than there.
struct PartNodes {
  Vector3d low, high;
  std::array<int, 3> held_inside = {};
};

std::map<int, PartNodes> part_nodes(const JointModel& model, const std::vector<int>& region,
                                    const std::vector<unsigned char>& held, const std::vector<char>& on_bone,
                                    double tolerance) {
  std::map<int, PartNodes> parts;
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region[i] < 0) continue;
    const Vector3d& x = model.nodes[i];
    PartNodes& part = parts.try_emplace(region[i], PartNodes{x, x, {}}).first->second;
    part.low = part.low.cwiseMin(x);
    part.high = part.high.cwiseMax(x);
  }
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region[i] < 0 || on_bone[i] || held[i] == 0) continue;
    PartNodes& part = parts.at(region[i]);
    for (int k = 0; k < 3; ++k) {
      const double x = model.nodes[i][k];
      part.held_inside[at(k)] += (held[i] >> k & 1) != 0 && x - part.low[k] > tolerance && part.high[k] - x > tolerance;
    }
  }
  return parts;
}

/// The first step in which nodes of an end are held across it.
int first_step(const JointModel& model, const std::vector<int>& nodes, int axis) {
  std::vector<char> there(model.nodes.size(), 0);
  for (const int node : nodes) there[at(node)] = 1;
  int first = -1;
  for (const FixedNodes& f : model.fixed_nodes) {
    const int step = std::max(0, f.step);
    if (!f.xyz[at(axis)] || (first >= 0 && step >= first)) continue;
    if (std::any_of(f.nodes.begin(), f.nodes.end(), [&](int node) { return there[at(node)] != 0; })) first = step;
  }
  return std::max(0, first);
}

constexpr int kLeastNodes = 3;  // fewer make no plane

/// The component in which the nodes of an end are held, where not the whole part is: a plane held in the wrong one. -1:
/// none. Where the part ends across that component, too, nodes are of that other plane.
int held_instead(const JointModel& model, const PartNodes& part, const std::vector<int>& nodes,
                 const std::vector<unsigned char>& held, int axis, double tolerance) {
  for (int k = 0; k < 3; ++k) {
    if (k == axis) continue;
    int inside = 0, count = 0;
    for (const int node : nodes) {
      const double x = model.nodes[at(node)][k];
      if (x - part.low[k] <= tolerance || part.high[k] - x <= tolerance) continue;
      ++inside;
      count += held[at(node)] >> k & 1;
    }
    if (count >= kLeastNodes && 10 * count >= 9 * inside && 2 * count > part.held_inside[at(k)]) return k;
  }
  return -1;
}

}  // namespace

double same_plane(const JointModel& model) {
  constexpr double kSamePlane = 1e-3;
  double size = 0.0;
  for (const Contact& c : model.contacts)
    for (const int s : {c.primary, c.secondary}) {
      if (s < 0 || model.surfaces[at(s)].size() == 0) continue;
      const Surface& surface = model.surfaces[at(s)];
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
      const double mean = sum / surface.size();
      if (mean > 0 && (size == 0.0 || mean < size)) size = mean;
    }
  return kSamePlane * size;
}

bool is_plane(const PartEnd& end) { return end.held >= kLeastNodes && 2 * end.held >= end.nodes; }

std::vector<PartEnd> find_part_ends(const JointModel& model, const std::vector<int>& region,
                                    const std::vector<unsigned char>& held, const std::vector<char>& on_bone) {
  if (std::all_of(held.begin(), held.end(), [](unsigned char bits) { return bits == 0; })) return {};
  const double tolerance = same_plane(model);
  const std::map<int, PartNodes> parts = part_nodes(model, region, held, on_bone, tolerance);
  std::map<std::tuple<int, int, int>, std::vector<int>> at_end;  // part, axis, lower or upper
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region[i] < 0 || on_bone[i]) continue;
    const PartNodes& part = parts.at(region[i]);
    for (int axis = 0; axis < 3; ++axis)
      for (int upper = 0; upper < 2; ++upper)
        if (std::abs(model.nodes[i][axis] - (upper ? part.high : part.low)[axis]) <= tolerance)
          at_end[{region[i], axis, upper}].push_back(static_cast<int>(i));
  }
  std::vector<PartEnd> ends;
  for (const auto& [key, nodes] : at_end) {
    PartEnd end;
    end.region = std::get<0>(key);
    end.plane.axis = std::get<1>(key);
    end.nodes = static_cast<int>(nodes.size());
    std::vector<double> where;
    for (const int node : nodes) {
      if ((held[at(node)] >> end.plane.axis & 1) != 0)
        where.push_back(model.nodes[at(node)][end.plane.axis]);
      else
        end.forgotten.push_back(node);
    }
    end.held = static_cast<int>(where.size());
    if (end.nodes < kLeastNodes) continue;
    if (10 * end.held < end.nodes)
      end.instead = held_instead(model, parts.at(end.region), nodes, held, end.plane.axis, tolerance);
    if (end.held == 0 && end.instead < 0) continue;
    if (!(is_plane(end) && 10 * end.held >= 9 * end.nodes)) end.forgotten.clear();
    if (where.empty()) where.push_back(model.nodes[at(nodes.front())][end.plane.axis]);
    std::nth_element(where.begin(), where.begin() + static_cast<std::ptrdiff_t>(where.size() / 2), where.end());
    const double middle = where[where.size() / 2];
    end.plane.at = std::abs(middle) <= tolerance ? 0.0 : middle;
    end.step = first_step(model, nodes, end.plane.axis);
    ends.push_back(std::move(end));
  }
  return ends;
}

void add_planes(const JointModel& model, const std::vector<SymmetryPlane>& more, std::vector<SymmetryPlane>& planes) {
  const double tolerance = same_plane(model);
  for (const SymmetryPlane& plane : more) add(planes, plane, tolerance);
  std::sort(planes.begin(), planes.end(), [](const SymmetryPlane& a, const SymmetryPlane& b) {
    return std::tie(a.axis, a.at) < std::tie(b.axis, b.at);
  });
}

std::vector<SymmetryPlane> planes_of_contact(const JointModel& model, const Contact& contact,
                                             const std::vector<int>& region,
                                             const std::map<int, std::vector<SymmetryPlane>>& of_region) {
  std::vector<SymmetryPlane> planes;
  if (contact.dea) add_planes(model, contact.dea->symmetry_planes, planes);
  if (of_region.empty()) return planes;
  std::set<int> regions;
  for (const int s : {contact.primary, contact.secondary})
    if (s >= 0)
      for (const int node : model.surfaces[at(s)].nodes) regions.insert(region[at(node)]);
  for (const int r : regions) {
    const auto found = of_region.find(r);
    if (found != of_region.end()) add_planes(model, found->second, planes);
  }
  return planes;
}

std::vector<unsigned char> nodes_in_planes(const JointModel& model, const std::vector<SymmetryPlane>& planes) {
  if (planes.empty()) return {};
  const double tolerance = same_plane(model);
  std::vector<unsigned char> in_plane(model.nodes.size(), 0);
  for (const SymmetryPlane& plane : planes)
    for (std::size_t i = 0; i < model.nodes.size(); ++i)
      if (std::abs(model.nodes[i][plane.axis] - plane.at) <= tolerance)
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
