#include "views/build_page/build_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "src/base/numbers.h"
#include "src/base/unit_names.h"
#include "src/build/clear_overlap.h"
#include "src/results/comparison.h"
#include "views/map/hip_picture.h"
#include "views/map/map_geometry.h"
#include "views/map/map_scale.h"
#include "views/page/page.h"
#include "views/page/page_data.h"
#include "views/page/page_parts.h"
#include "views/text/build_text.h"

namespace dea {

namespace {

constexpr int kBins = 40;  // of the histogram of Jacobians, from 0 to 1

ResultSurface result_surface(const std::string& name, const TriangleSurface& s) {
  std::vector<int> begin = {0}, nodes;
  for (const auto& t : s.triangles) {
    nodes.insert(nodes.end(), t.begin(), t.end());
    begin.push_back(static_cast<int>(nodes.size()));
  }
  return make_result_surface(name, begin, nodes, s.points);
}

/// Points of the layer in the order of the drawn mesh's vertices, counted from 1.
std::vector<std::int32_t> point_numbers(const ResultSurface& surface, const TriangleSurface& s) {
  std::vector<std::int32_t> numbers(surface.mesh.vertices.size(), 0);
  for (std::size_t slot = 0; slot < surface.slot_vertex.size(); ++slot)
    if (surface.slot_vertex[slot] >= 0) numbers[at(surface.slot_vertex[slot])] = s.triangles[slot / 3][slot % 3] + 1;
  return numbers;
}

std::vector<double> at_points(const std::vector<double>& values, const std::vector<std::int32_t>& numbers) {
  std::vector<double> out;
  for (const std::int32_t n : numbers) out.push_back(n > 0 ? values[at(n - 1)] : kNaN);
  return out;
}

std::vector<float> floats(const std::vector<double>& values) {
  std::vector<float> out;
  for (const double x : values) out.push_back(std::isfinite(x) ? static_cast<float>(x) : static_cast<float>(kNaN));
  return out;
}

/// Of maps of all layers. From 0 where nothing lies below. `usual`: the end where the largest value means little; 0:
/// there is none.
Json scale_of_layers(const ValueRange& range, std::optional<double> high, double usual) {
  ScaleKind kind = {ColourMap::Sequential, false, usual, std::nullopt, high};
  if (range.least >= 0) kind.low = 0;
  return scale_json({map_scale(kind, range), range});
}

/// How many prisms lie in each of kBins bins of [0, 1]; what is outside counts in the first or the last.
std::vector<int> histogram(const std::vector<double>& jacobians) {
  std::vector<int> counts(kBins, 0);
  for (const double j : jacobians) ++counts[at(std::clamp(static_cast<int>(std::floor(j * kBins)), 0, kBins - 1))];
  return counts;
}

/// The least of each column, where it stands.
std::vector<double> least_of_columns(const std::vector<double>& prisms, std::size_t columns) {
  std::vector<double> least(columns, kInfinity);
  for (std::size_t i = 0; i < prisms.size(); ++i) {
    double& of = least[i / (prisms.size() / columns)];
    of = std::min(of, prisms[i]);
  }
  return least;
}

struct LayerRanges {
  ValueRange thickness, gap, jacobian, change;
  std::vector<std::pair<double, double>> gap_areas;  ///< for an end of the scale that a few far places do not set
};

/// What was taken for every option that has a number or a word.
TitledTable option_table(const BuildPageInput& input) {
  const BuildRequest& r = input.request;
  const BuiltModelSettings& m = input.summary.model;
  TitledTable t{"Options", {{"option", "taken", ""}, "lll", {}}};
  const auto add = [&](const char* name, const std::string& value, bool given, const char* otherwise) {
    t.table.rows.push_back({name, value, given ? "as given" : otherwise});
  };
  const auto length = [](double x) { return four_digits(x) + " mm"; };
  const bool any_made = std::any_of(r.cartilages.begin(), r.cartilages.end(), [](const CartilageRequest& c) {
    return c.way != CartilageRequest::Way::Segmented;
  });
  if (any_made) {
    double thickest = 0;
    for (const CartilageRequest& c : r.cartilages) thickest = std::max(thickest, asked_thickness(c));
    add("reach", length(r.reach.value_or(3 * thickest)), r.reach.has_value(), "3 times the thickest layer");
    add("rim", length(r.rim_length), r.rim_length != BuildRequest{}.rim_length, "default");
    add("holes in regions", r.fill_holes ? "filled" : "kept", !r.fill_holes, "default");
  }
  add("fade", r.fade ? length(*r.fade) : "-", r.fade.has_value(), "half the gap: as rim; others: 0");
  add("edge", r.edge ? length(*r.edge) : "-", r.edge.has_value(), "triangles stay");
  add("layers", std::to_string(r.elements_through), r.elements_through != BuildRequest{}.elements_through, "default");
  add("least", r.least_thickness ? length(*r.least_thickness) : "-", r.least_thickness.has_value(),
      "of segmented cartilage: a tenth of its mean");
  add("bones",
      !r.whole_bones               ? "none"
      : r.most_bone_triangles == 0 ? "shell"
                                   : fmt::format("{} triangles", r.most_bone_triangles),
      !r.whole_bones || r.most_bone_triangles > 0, "default");
  add("primary", r.primary.empty() ? "-" : r.primary, !r.primary.empty(), "the smaller surface of each contact");
  const BuiltModelSettings usual;
  add("E", fmt::format("{} MPa", m.E), m.E != usual.E, "default");
  add("nu", fmt::format("{}", m.nu), m.nu != usual.nu, "default");
  add("penalty", fmt::format("{}", m.penalty), m.penalty != usual.penalty, "default");
  return t;
}

/// By how much the thickness changed at each point; empty: nowhere.
std::vector<double> thickness_changes(const LayerReport& report) {
  std::vector<double> changes;
  if (report.changes.thinned == 0) return changes;
  for (const double change : report.changes.change) changes.push_back(std::abs(change));
  return changes;
}

Json layer_json(const BuildSummary& s, std::size_t l, LayerRanges& ranges, Json& meshes, PageArrays& arrays) {
  const BuiltLayer& layer = s.joint.layers[l];
  const TriangleSurface face = layer.face();
  const ResultSurface surface = result_surface(layer.name, face);
  const std::vector<std::int32_t> numbers = point_numbers(surface, face);
  Json j;
  j["name"] = layer.name;
  j["body"] = layer.body;
  j["bare"] = layer.bare;
  j["mesh"] = meshes.size();
  meshes.push_back(mesh_json(surface, numbers, arrays));
  j["view"] = view_json(
      view_from(default_direction(surface, std::vector<double>(face.triangles.size(), 0.0)), Vector3d::Zero()),
      face.points);

  std::vector<double> gaps = layer_gaps(s.joint, static_cast<int>(l), s.report.reach);
  for (double& gap : gaps)
    if (!std::isfinite(gap)) gap = kNaN;
  ranges.gap.add(gaps);
  add_areas(surface, facet_average(surface, at_points(gaps, numbers)), ranges.gap_areas);
  j["gap"] = arrays.add(pack_floats(floats(at_points(gaps, numbers))));
  j["thickness"] = j["jacobian"] = j["change"] = nullptr;
  j["jacobians"] = nullptr;
  if (layer.bare) return j;
  const std::vector<double>& thickness = s.report.layers[l].quality.thickness;
  ranges.thickness.add(thickness);
  j["thickness"] = arrays.add(pack_floats(floats(at_points(thickness, numbers))));

  if (const std::vector<double> changes = thickness_changes(s.report.layers[l]); !changes.empty()) {
    ranges.change.add(changes);
    j["change"] = arrays.add(pack_floats(floats(at_points(changes, numbers))));
  }

  const std::vector<double> prisms = prism_jacobians(layer, s.model.elements_through);
  const std::vector<double> columns = least_of_columns(prisms, layer.triangles.size());
  ranges.jacobian.add(columns);
  j["jacobian"] = arrays.add(pack_floats(floats(columns)));
  const auto least = static_cast<std::size_t>(std::min_element(columns.begin(), columns.end()) - columns.begin());
  const Vector3d where = surface.facet_centers[least];
  j["jacobians"] = {{"counts", histogram(prisms)},
                    {"least", short_number(columns[least])},
                    {"triangle", least + 1},
                    {"where", json_vector(where)}};
  return j;
}

Json bone_json(const TriangleSurface& bone, Json& meshes, PageArrays& arrays) {
  if (bone.triangles.empty()) return nullptr;
  const ResultSurface surface = result_surface("", bone);
  meshes.push_back(mesh_json(surface, point_numbers(surface, bone), arrays));
  return meshes.size() - 1;
}

/// Across the way from bone to bone, a little from above, so that both are seen; scans have z upwards as a rule.
Json joint_view(const BuildPageInput& input) {
  const BuiltJoint& joint = input.summary.joint;
  std::vector<Vector3d> points;
  for (const BuiltLayer& layer : joint.layers)
    if (!layer.bare) points.insert(points.end(), layer.articular.begin(), layer.articular.end());
  Vector3d center = Vector3d::Zero();
  for (const Vector3d& x : points) center += x / static_cast<double>(points.size());
  Vector3d along = Vector3d::UnitZ();
  if (joint.bodies.size() > 1 && !joint.layers.empty()) {
    Vector3d sum = Vector3d::Zero();
    const BuiltLayer& layer = joint.layers.front();
    for (const auto& t : layer.triangles)
      sum += (layer.articular[at(t[1])] - layer.articular[at(t[0])])
                 .cross(layer.articular[at(t[2])] - layer.articular[at(t[0])]);
    if (sum.norm() > 0) along = sum.normalized();
  }
  if (along.z() < 0) along = -along;
  const Vector3d across = along.cross(std::abs(along.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY()).normalized();
  Json view = view_json(view_from((across + 0.3 * along).normalized(), along), points);
  view["radius"] = 1.25 * view["radius"].get<double>();  // some of the bones around it
  return view;
}

Json text_list(const std::vector<std::string>& lines, const std::vector<std::string>& files) {
  return list_json(lines, [&](const std::string& line) { return without_folders(line, files); });
}

}  // namespace

std::string build_page_html(const BuildPageInput& input) {
  const BuildSummary& s = input.summary;
  PageArrays arrays;
  Json page, meshes = Json::array();
  page["schema"] = "dea.report/1";
  page["kind"] = "build";
  page["title"] = std::filesystem::path(s.output).stem().string();
  page["file"] = std::filesystem::path(s.output).filename().string();
  page["command"] = command_text(input.words, input.files);
  add_page_head(unit_names(s.model.units), page);
  page["elements_through"] = s.model.elements_through;
  page["bodies"] = Json::array();
  for (std::size_t b = 0; b < s.joint.bodies.size(); ++b) {
    const BuiltBody& body = s.joint.bodies[b];
    page["bodies"].push_back(
        {{"name", body.name},
         {"loaded", !body.fixed},
         {"center", json_vector(body.center)},
         {"mesh", b < input.bones.size() ? bone_json(input.bones[b], meshes, arrays) : Json(nullptr)}});
  }
  LayerRanges ranges;
  page["layers"] = Json::array();
  for (std::size_t l = 0; l < s.joint.layers.size(); ++l)
    page["layers"].push_back(layer_json(s, l, ranges, meshes, arrays));
  page["meshes"] = std::move(meshes);
  page["view"] = joint_view(input);
  page["scales"] = {{"thickness", scale_of_layers(ranges.thickness, std::nullopt, 0)},
                    {"gap", scale_of_layers(ranges.gap, std::nullopt, most_of_area_below(ranges.gap_areas))},
                    {"jacobian", scale_of_layers(ranges.jacobian, 1.0, 0)},
                    {"change", scale_of_layers(ranges.change, std::nullopt, 0)}};
  page["reach"] = json_number(s.report.reach);
  std::vector<TitledTable> tables = build_tables(s);
  tables.push_back(option_table(input));
  page["tables"] = list_json(tables, table_json);
  page["warnings"] = text_list(build_warnings(s), input.files);
  page["changes"] = text_list(layer_changes(s), input.files);
  page["findings"] = text_list(s.report.findings, input.files);
  page["hip_figure"] = nullptr;
  if (s.anatomy.hip) {
    page["hip_figure"] = hip_picture(*s.anatomy.hip, PictureFormat::Svg);
    page["hip_panels"] = hip_panels();
    page["hip_words"] = hip_words(*s.anatomy.hip);
  }
  page["headline"] = headline_words();
  return page_text(page["title"].get<std::string>(), page, arrays, page::build_style(), page::build_main());
}

}  // namespace dea
