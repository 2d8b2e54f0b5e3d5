#include "src/joint/layer.h"

#include <algorithm>
#include <cmath>

#include "src/base/numbers.h"

namespace dea {

double Layer::facet_size() const {
  double sum = 0.0, area = 0.0;
  if (rigid || springs_at == SpringsAt::Bone) return 0.0;
  for (int t = 0; t < articular.size(); ++t) {
    double mean = 0.0;
    for (int v : articular.triangles[at(t)]) mean += thickness[at(v)] / 3;
    const double size = std::sqrt(2 * articular.areas[at(t)]);
    if (!(mean > kNoThickness * size)) continue;
    sum += articular.areas[at(t)] * size / mean;
    area += articular.areas[at(t)];
  }
  return area > 0 ? sum / area : 0.0;
}

int Layer::without_thickness(double part) const {
  int count = 0;
  for (std::size_t v = 0; v < thickness.size(); ++v)
    count += !(thickness[v] > part * std::sqrt(spring_surface().vertex_areas[v]));
  return rigid ? 0 : count;
}

double Layer::min_thickness() const {
  return thickness.empty() ? 0.0 : *std::min_element(thickness.begin(), thickness.end());
}
double Layer::max_thickness() const {
  return thickness.empty() ? 0.0 : *std::max_element(thickness.begin(), thickness.end());
}
double Layer::mean_thickness() const {
  double sum = 0.0, area = 0.0;
  for (std::size_t v = 0; v < thickness.size(); ++v) {
    sum += thickness[v] * spring_surface().vertex_areas[v];
    area += spring_surface().vertex_areas[v];
  }
  return area > 0 ? sum / area : 0.0;
}
int Layer::missed_count() const { return static_cast<int>(std::count(missed.begin(), missed.end(), 1)); }

std::unordered_map<int, int> articular_vertices(const Layer& layer) {
  std::unordered_map<int, int> vertex;
  const SurfaceMesh& mesh = layer.articular;
  for (std::size_t v = 0; v < mesh.model_nodes.size(); ++v) vertex[mesh.model_nodes[v]] = static_cast<int>(v);
  for (const auto& [node, other] : layer.stands_for)
    if (const auto found = vertex.find(other); found != vertex.end()) vertex.try_emplace(node, found->second);
  return vertex;
}

}  // namespace dea
