#include "views/study_page/study_regions.h"

#include <algorithm>
#include <cmath>

#include "src/base/error.h"
#include "src/base/numbers.h"

namespace dea {

namespace {

/// A surface's regions, and what each vertex counts for.
struct RegionPlaces {
  Regions regions;
  std::size_t first = 0;              ///< place of the first region
  std::vector<Vector3d> vertex_area;  ///< per vertex: a third of the area vectors around it
};

std::vector<Vector3d> vertex_area_vectors(const ResultSurface& s) {
  std::vector<Vector3d> sum(s.mesh.vertices.size(), Vector3d::Zero());
  for (int t = 0; t < s.mesh.size(); ++t)
    for (int v : s.mesh.triangles[at(t)]) sum[at(v)] += s.mesh.areas[at(t)] / 3.0 * s.mesh.normals[at(t)];
  return sum;
}

/// In the order of headline_statistics.
std::array<double, 5> numbers_in(const StudySurfaceMesh& s, const RegionPlaces& r, int region,
                                 const std::vector<double>& pressure, double above) {
  std::vector<double> values, areas;
  Vector3d force = Vector3d::Zero();
  for (std::size_t v = 0; v < pressure.size(); ++v) {
    if (r.regions.index[v] != region) continue;
    values.push_back(pressure[v]);
    areas.push_back(s.areas[v]);
    force += pressure[v] * r.vertex_area[v];
  }
  const Distribution d = distribution(values, areas, above);
  return {d.p99, d.mean, d.area, d.peak, force.norm()};
}

std::vector<RegionPlaces> make_places(const StudyFields& fields, const StudyRegionOptions& options, StudyNumbers& n) {
  std::vector<RegionPlaces> places;
  for (const StudySurfaceMesh& s : fields.surfaces) {
    RegionPlaces r{regions_of(s, options), 0, vertex_area_vectors(s.geometry)};
    r.first = n.places.size();
    for (std::size_t i = 0; i < places.size(); ++i)  // models with other meshes share places of one contact
      if (fields.surfaces[i].contact == s.contact && fields.surfaces[i].contact_id == s.contact_id)
        r.first = places[i].first;
    if (r.first == n.places.size())
      for (const std::string& name : r.regions.names) n.places.push_back({s.contact_id, s.contact, name});
    places.push_back(std::move(r));
  }
  return places;
}

}  // namespace

Regions regions_of(const StudySurfaceMesh& s, const StudyRegionOptions& o) {
  SurfaceFrame frame = surface_frame(s.geometry);
  if (o.axis) frame.axis = o.axis->normalized();
  if (o.center) frame.center = *o.center;
  if (!(frame.axis.norm() > 0))
    throw UsageError("surface \"" + s.surface + "\" is closed and has no axis of its own, expected one to be given");
  return laid_out(s.geometry.mesh.vertices, frame, o, *o.up, o.anterior.value_or(Vector3d::Zero()));
}

void add_regions(const std::string& path, const StudyFields& fields, const StudyRegionOptions& options,
                 StudyNumbers& n) {
  const StudyRows thresholds = read_rows(path, {"headline_above"});
  std::map<std::tuple<std::size_t, std::size_t, int, std::string>, double> above;
  for (std::size_t r = 0; r < thresholds.case_id.size(); ++r) {
    const StudyPlace& place = thresholds.places[at(thresholds.place[r])];
    const int c = n.case_of(static_cast<double>(thresholds.case_id[r]));
    if (place.part.empty() && c >= 0)
      above[{at(c), at(thresholds.state[r] - 1), place.contact_id, place.contact}] = thresholds.numbers[0][r];
  }
  const std::vector<RegionPlaces> places = make_places(fields, options, n);
  for (auto& of_statistic : n.values)  // of what is not among headline_statistics regions have none
    of_statistic.resize(n.places.size(), std::vector<double>(n.cases.size() * n.choices(), kNaN));
  each_pressure(
      path, n, fields, [](const StudyField&) { return true; },
      [&](const StudyField& f, std::vector<double>&& pressure) {
        const StudySurfaceMesh& s = fields.surfaces[at(f.surface)];
        const RegionPlaces& r = places[at(f.surface)];
        const auto found = above.find({f.c, f.state, s.contact_id, s.contact});
        const double threshold = found == above.end() || std::isnan(found->second) ? 0.0 : found->second;
        for (std::size_t k = 0; k < r.regions.names.size(); ++k) {
          const std::array<double, 5> numbers = numbers_in(s, r, static_cast<int>(k), pressure, threshold);
          for (std::size_t i = 0; i < numbers.size(); ++i)
            n.values[i][r.first + k][f.c * n.choices() + f.state] = numbers[i];
        }
      });
  add_largest(n);
}

}  // namespace dea
