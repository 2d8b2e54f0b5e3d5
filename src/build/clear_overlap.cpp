#include "src/build/clear_overlap.h"

#include <algorithm>

#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/build/region.h"

namespace dea {

namespace {

constexpr int kRounds = 12;
constexpr double kLeastPart = 0.2;

/// By how much each vertex of a layer overlaps others.
std::vector<double> overlaps(const std::vector<BuiltLayer>& layers, const std::vector<char>& made, std::size_t l,
                             double reach) {
  std::vector<double> overlap(layers[l].articular.size(), 0.0);
  for (std::size_t other = 0; other < layers.size(); ++other) {
    if (layers[other].body == layers[l].body) continue;
    const std::vector<double> gaps = joint_gaps(layers[l], RayCaster(mesh_of(layers[other].face())), reach);
    const double share = made[other] ? 0.5 : 1.0;
    for (std::size_t v = 0; v < gaps.size(); ++v) overlap[v] = std::max(overlap[v], -share * gaps[v]);
  }
  return overlap;
}

}  // namespace

std::vector<double> joint_gaps(const BuiltLayer& layer, const RayCaster& other, double reach) {
  const std::vector<Eigen::Vector3d> normals = point_normals(layer.face());
  std::vector<double> gaps(layer.articular.size(), kInfinity);
  constexpr double kCos60 = 0.5;
  parallel_for(gaps.size(), [&](std::size_t v) {
    const LineHit hit = other.nearest_facing(layer.articular[v], normals[v], -reach, -reach, reach, kCos60);
    if (hit.point.triangle >= 0) gaps[v] = hit.distance;
  });
  return gaps;
}

std::vector<double> layer_gaps(const BuiltJoint& joint, int layer, double reach) {
  std::vector<double> gaps(joint.layers[at(layer)].articular.size(), kInfinity);
  for (const BuiltContact& c : joint.contacts) {
    if (c.primary != layer && c.secondary != layer) continue;
    const BuiltLayer& other = joint.layers[at(c.primary == layer ? c.secondary : c.primary)];
    const std::vector<double> to = joint_gaps(joint.layers[at(layer)], RayCaster(mesh_of(other.face())), reach);
    for (std::size_t v = 0; v < gaps.size(); ++v) gaps[v] = std::min(gaps[v], to[v]);
  }
  return gaps;
}

std::vector<Thinned> clear_overlaps(std::vector<BuiltLayer>& layers, const std::vector<char>& made, double reach) {
  const std::vector<BuiltLayer> wanted = layers;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<std::vector<double>> overlap(layers.size());
    bool any = false;
    for (std::size_t l = 0; l < layers.size(); ++l)
      if (made[l]) {
        overlap[l] = overlaps(layers, made, l, reach);
        // a triangle may overlap between its corners' rays: neighbours go along by half
        const std::vector<double> own = overlap[l];
        const auto neighbours = vertex_neighbours(own.size(), layers[l].triangles);
        for (std::size_t v = 0; v < own.size(); ++v)
          for (const int n : neighbours[v]) overlap[l][v] = std::max(overlap[l][v], 0.5 * own[at(n)]);
      }
    for (std::size_t l = 0; l < layers.size(); ++l)
      for (std::size_t v = 0; v < overlap[l].size(); ++v) {
        const Eigen::Vector3d through = layers[l].articular[v] - layers[l].bone[v];
        const double thickness = through.norm(),
                     least = kLeastPart * (wanted[l].articular[v] - wanted[l].bone[v]).norm();
        const double now = std::max(least, thickness - overlap[l][v]);
        if (overlap[l][v] < 1e-6 * thickness || now >= thickness) continue;
        layers[l].articular[v] = layers[l].bone[v] + now / thickness * through;
        any = true;
      }
    if (!any) break;
  }
  std::vector<Thinned> thinned(layers.size());
  for (std::size_t l = 0; l < layers.size(); ++l)
    for (std::size_t v = 0; v < layers[l].articular.size(); ++v) {
      const double change = (layers[l].articular[v] - wanted[l].articular[v]).norm();
      if (change == 0) continue;
      ++thinned[l].vertices;
      thinned[l].most = std::max(thinned[l].most, change);
    }
  return thinned;
}

}  // namespace dea
