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

/// Coordinates that differ by less are one: the coordinates of a file have less noise.
double same_plane(const std::vector<Vector3d>& nodes) {
  constexpr double kSamePlane = 1e-6;  // of the model's size
  if (nodes.empty()) return 0.0;
  Vector3d low = nodes.front(), high = low;
  for (const Vector3d& x : nodes) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  return kSamePlane * (high - low).norm();
}

void add(std::vector<SymmetryPlane>& planes, const SymmetryPlane& plane, double tolerance) {
  const bool known = std::any_of(planes.begin(), planes.end(), [&](const SymmetryPlane& p) {
    return p.axis == plane.axis && std::abs(p.at - plane.at) <= tolerance;
  });
  if (!known) planes.push_back({plane.axis, std::abs(plane.at) <= tolerance ? 0.0 : plane.at});
}

/// The ends of a deformable part along an axis, and how many of its nodes there are held along it.
struct End {
  double at = 0.0;
  int nodes = 0, held = 0;
};

}  // namespace

std::map<int, std::vector<SymmetryPlane>> find_symmetry_planes(const JointModel& model, const std::vector<int>& region,
                                                               const std::vector<unsigned char>& held,
                                                               const std::vector<char>& on_bone) {
  if (std::all_of(held.begin(), held.end(), [](unsigned char bits) { return bits == 0; })) return {};
  const double tolerance = same_plane(model.nodes);
  std::map<int, std::vector<SymmetryPlane>> planes;
  std::map<int, std::array<Vector3d, 2>> box;  // of each part
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region[i] < 0) continue;
    const Vector3d& x = model.nodes[i];
    auto& ends = box.try_emplace(region[i], std::array<Vector3d, 2>{x, x}).first->second;
    ends = {ends[0].cwiseMin(x), ends[1].cwiseMax(x)};
  }
  std::map<std::tuple<int, int, int>, End> found;  // part, axis, lower or upper
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region[i] < 0 || on_bone[i]) continue;
    for (int axis = 0; axis < 3; ++axis)
      for (int upper = 0; upper < 2; ++upper) {
        const double at_end = box.at(region[i])[static_cast<std::size_t>(upper)][axis];
        if (!(std::abs(model.nodes[i][axis] - at_end) <= tolerance)) continue;
        End& end = found[{region[i], axis, upper}];
        end.at = at_end;
        ++end.nodes;
        end.held += held[i] >> axis & 1;
      }
  }
  constexpr int kLeastNodes = 3;  // fewer make no plane
  for (const auto& [key, end] : found)
    if (end.held >= kLeastNodes && 2 * end.held >= end.nodes)
      add(planes[std::get<0>(key)], {std::get<1>(key), end.at}, tolerance);
  return planes;
}

void add_planes(const JointModel& model, const std::vector<SymmetryPlane>& more, std::vector<SymmetryPlane>& planes) {
  const double tolerance = same_plane(model.nodes);
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

std::vector<unsigned char> nodes_in_planes(const std::vector<Vector3d>& nodes,
                                           const std::vector<SymmetryPlane>& planes) {
  if (planes.empty()) return {};
  const double tolerance = same_plane(nodes);
  std::vector<unsigned char> in_plane(nodes.size(), 0);
  for (const SymmetryPlane& plane : planes)
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (std::abs(nodes[i][plane.axis] - plane.at) <= tolerance)
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
