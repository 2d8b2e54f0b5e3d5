#include "src/joint/shared_ends.h"

#include <algorithm>
#include <cmath>

#include "src/base/numbers.h"

namespace dea {

namespace {

constexpr double kSamePlane = 1e-3;    // of a facet's size
constexpr double kLeft = 0.01;         // of the thickness: what a solved balance is off by is far less
constexpr int kLeastVertices = 3;      // the top of a dome is no end in a plane
constexpr double kLeastEnd = 1.0 / 3;  // of the square root of a surface's area: how wide it is where it ends

/// Where the surface ends along an axis, and whether it does so in a plane: three vertices or more lie there, and its
/// edges there are long together.
struct End {
  double at = 0.0;
  bool plane = false;
};

End end_of(const SurfaceMesh& mesh, int axis, bool low, double tolerance) {
  End end;
  end.at = low ? kInfinity : -kInfinity;
  for (const auto& triangle : mesh.triangles)
    for (int v : triangle)
      end.at = low ? std::min(end.at, mesh.vertices[at(v)][axis]) : std::max(end.at, mesh.vertices[at(v)][axis]);
  const auto there = [&](int v) { return std::abs(mesh.vertices[at(v)][axis] - end.at) <= tolerance; };
  std::vector<char> seen(mesh.vertices.size(), 0);
  int count = 0;
  double length = 0.0, area = 0.0;
  for (int t = 0; t < mesh.size(); ++t) {
    const auto& corners = mesh.triangles[at(t)];
    area += mesh.areas[at(t)];
    int in_plane = 0;
    for (int k = 0; k < 3; ++k) {
      const int a = corners[at(k)], b = corners[at((k + 1) % 3)];
      in_plane += there(a) ? 1 : 0;
      if (there(a) && !seen[at(a)]) seen[at(a)] = 1, ++count;
      if (mesh.neighbours[at(t)][at(k)] < 0 && there(a) && there(b))
        length += (mesh.vertices[at(a)] - mesh.vertices[at(b)]).norm();
    }
    if (in_plane == 3) return end;  // the surface lies in the plane, as a flat one does across its own normal
  }
  end.plane = count >= kLeastVertices && length > kLeastEnd * std::sqrt(area);
  return end;
}

}  // namespace

std::vector<SharedEnd> shared_ends(const ContactPair& pair) {
  const double tolerance =
      kSamePlane * std::sqrt(2 * std::min(mean_area(pair.layers[0].articular), mean_area(pair.layers[1].articular)));
  std::vector<SharedEnd> ends;
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool low : {true, false}) {
      End found[2];
      for (int side = 0; side < 2; ++side) found[side] = end_of(pair.layers[side].articular, axis, low, tolerance);
      if (!found[0].plane || !found[1].plane || std::abs(found[0].at - found[1].at) > tolerance) continue;
      SharedEnd end;
      end.plane = {axis, found[0].at};
      end.tolerance = tolerance;
      for (const Layer& layer : pair.layers)
        for (const SymmetryPlane& plane : layer.planes)
          if (plane.axis == axis && std::abs(plane.at - found[0].at) <= tolerance) {
            end.symmetry = true;
            end.plane = plane;
          }
      ends.push_back(end);
    }
  }
  return ends;
}

std::optional<LeftPlane> left_plane(const ContactPair& pair, const std::vector<Body>& bodies,
                                    const std::vector<Pose>& poses) {
  if (pair.layers[0].planes.empty() && pair.layers[1].planes.empty()) return std::nullopt;
  const int a = pair.layers[0].body, b = pair.layers[1].body;
  const RelativePose relative =
      relative_pose(poses[at(a)], bodies[at(a)].center_of_mass, poses[at(b)], bodies[at(b)].center_of_mass);
  const auto moved = [&](int body, const Layer& layer, int axis) {
    const Pose& pose = poses[at(body)];
    double most = 0.0;
    for (const Vector3d& x : layer.articular.vertices) {
      const Vector3d now = pose.center + pose.rotation * (x - bodies[at(body)].center_of_mass);
      most = std::max(most, std::abs((now - x)[axis]));
    }
    return most;
  };
  LeftPlane worst;
  for (const SharedEnd& end : shared_ends(pair)) {
    if (!end.symmetry) continue;
    double shift = 0.0;
    for (const Vector3d& x : pair.layers[0].articular.vertices)
      shift = std::max(shift, std::abs((relative.rotation * x + relative.shift - x)[end.plane.axis]));
    if (shift > worst.shift) {
      const int axis = end.plane.axis;
      worst = {end.plane, shift, moved(a, pair.layers[0], axis) > moved(b, pair.layers[1], axis) ? a : b};
    }
  }
  if (!(worst.shift > kLeft * (pair.layers[0].mean_thickness() + pair.layers[1].mean_thickness()))) return std::nullopt;
  return worst;
}

}  // namespace dea
