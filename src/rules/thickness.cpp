#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "src/base/numbers.h"
#include "src/rules/look.h"

namespace dea {

namespace {

/// Vertices whose thickness is the closest point's for want of a better one.
std::vector<std::size_t> doubtful_vertices(const Layer& layer) {
  std::vector<std::size_t> doubtful;
  for (std::size_t v = 0; v < layer.missed.size(); ++v)
    if (layer.missed[v]) doubtful.push_back(v);
  return doubtful;
}

/// Those of them that are farther than two thicknesses from any rim of the surface.
std::size_t far_from_rim(const Layer& layer, const std::vector<std::size_t>& vertices) {
  const SurfaceMesh& mesh = layer.spring_surface();
  if (mesh.vertices.size() != layer.missed.size()) return 0;
  const auto rim = rim_segments(mesh);
  const double near_by = 2 * layer.mean_thickness();
  std::size_t count = 0;
  for (const std::size_t v : vertices)
    count += std::none_of(rim.begin(), rim.end(), [&](const std::array<Vector3d, 2>& edge) {
      return distance_to_segment(mesh.vertices[v], edge[0], edge[1]) <= near_by;
    });
  return count;
}

/// "; `dea info hip.feb -o hip_check.xplt` shows where"; of a model without a file: nothing.
std::string shows_where(const JointModel& model) {
  if (model.files.empty()) return "";
  const std::string& file = model.files.front();
  const std::string out = std::filesystem::path(file).stem().string() + "_check.xplt";
  const auto pasted = [](const std::string& name) {
    return name.find_first_of(" \t'\"$&;()<>|*?") == std::string::npos ? name : "\"" + name + "\"";
  };
  return fmt::format("; `dea info {} -o {}` shows where", pasted(file), pasted(out));
}

}  // namespace

/// Vertices without cartilage.
Findings no_thickness(const JointModel& model, const Joint& joint) {
  Findings found;
  for (const ContactPair& pair : joint.contacts)
    for (const Layer& layer : pair.layers) {
      const int without = layer.without_thickness(), all = static_cast<int>(layer.thickness.size());
      if (without == 0) continue;
      const std::string& surface = model.surfaces[at(layer.surface)].name;
      found.push_back({"no-thickness",
                       {.surface = surface},
                       {{"without", without},
                        {"vertices", all},
                        {"percent", 100 * kNoThickness},
                        {"give", NamedSetting{"thickness", surface, "VALUE"}}},
                       2 * without > all ? 0 : 1});
    }
  return found;
}

Findings nearest_thickness(const JointModel& model, const Joint& joint) {
  Findings found;
  for (const ContactPair& pair : joint.contacts)
    for (const Layer& layer : pair.layers) {
      const std::vector<std::size_t> doubtful = doubtful_vertices(layer);
      if (doubtful.empty()) continue;
      const std::size_t far = far_from_rim(layer, doubtful);
      found.push_back({far == 0 ? "nearest-thickness-at-rim" : "nearest-thickness",
                       {.surface = model.surfaces[at(layer.surface)].name},
                       {{"count", doubtful.size()},
                        {"vertices", layer.missed.size()},
                        {"far", far},
                        {"shows_where", shows_where(model)}}});
    }
  return found;
}

/// Vertices under pressure whose thickness is doubtful.
Findings pressed_nearest_thickness(const JointModel& model, const Joint& joint, const SolvedStates& result) {
  Findings found;
  for (const JudgedSide& s : judged_sides(model, joint, result)) {
    const std::vector<double>& pressure = s.fields.vertex_pressure;
    if (s.layer.springs_at == SpringsAt::Bone || pressure.size() != s.layer.missed.size()) continue;
    int count = 0;
    double most = 0.0;
    for (const std::size_t v : doubtful_vertices(s.layer)) {
      if (!(pressure[v] > kFelt * s.statistics.peak)) continue;
      ++count;
      most = std::max(most, pressure[v]);
    }
    const NamedSetting give{"thickness", s.subject.surface, "VALUE"};
    if (count > 0)
      found.push_back({"nearest-thickness-pressed", s.subject, {{"count", count}, {"pressure", most}, {"give", give}}});
  }
  return found;
}

}  // namespace dea
