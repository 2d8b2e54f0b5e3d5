#include "views/study_page/study_surfaces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "src/base/error.h"
#include "src/base/numbers.h"

namespace dea {

namespace {

StudySurfaceMesh surface_mesh(const StudySurface& stored, int contact_id) {
  StudySurfaceMesh s;
  s.contact_id = contact_id;
  s.contact = stored.contact;
  s.source = stored.source;
  s.surface = stored.surface.name;
  s.stored_vertices = stored.surface.vertices.size();
  std::vector<int> begin = {0}, nodes;
  for (const std::array<int, 3>& t : stored.surface.triangles) {
    for (int v : t) {
      if (v < 0 || at(v) >= stored.surface.vertices.size())
        throw InputError(fmt::format("surface \"{}\": found vertex {} of {}", s.surface, v, s.stored_vertices));
      nodes.push_back(v);
    }
    begin.push_back(static_cast<int>(nodes.size()));
  }
  s.geometry = make_result_surface(s.surface, begin, nodes, stored.surface.vertices);
  s.map = make_map_mesh(s.geometry);
  s.areas = nodal_areas(s.geometry);
  return s;
}

bool same_geometry(const StudySurface& a, const StudySurface& b) {
  return a.contact == b.contact && a.source == b.source && a.surface.vertices == b.surface.vertices &&
         a.surface.triangles == b.surface.triangles;
}

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

/// The part of each vertex's area that belongs to a contact of `area`: all of those with the greatest pressures, and of
/// the last what is left. Averages at vertices reach beyond contact, and by how far the file says.
std::vector<double> areas_in_contact(const std::vector<double>& areas, const std::vector<double>& pressure,
                                     double area) {
  std::vector<std::size_t> order;
  for (std::size_t v = 0; v < pressure.size(); ++v)
    if (pressure[v] > 0) order.push_back(v);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return pressure[a] > pressure[b]; });
  std::vector<double> in_contact(areas.size(), 0.0);
  for (std::size_t v : order) {
    in_contact[v] = std::min(areas[v], area);
    area -= in_contact[v];
  }
  return in_contact;
}

/// In the order of headline_statistics.
std::array<double, 5> numbers_in(const RegionPlaces& r, int region, const std::vector<double>& pressure,
                                 const std::vector<double>& in_contact) {
  std::vector<double> values, areas;
  Vector3d force = Vector3d::Zero();
  for (std::size_t v = 0; v < pressure.size(); ++v) {
    if (r.regions.index[v] != region) continue;
    values.push_back(pressure[v]);
    areas.push_back(in_contact[v]);
    force += pressure[v] * r.vertex_area[v];
  }
  const Distribution d = distribution(values, areas, 0.0);
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

StudyFields study_fields(const std::string& path, const StudyNumbers& n) {
  StudyFields out;
  const std::vector<StudyFieldRow> rows = list_fields(path);
  if (rows.empty()) return out;
  std::vector<StudySurface> stored;  // each once, though several models may have it
  std::map<std::tuple<int, std::string, std::string>, std::size_t> places;  // of model, contact and source among them
  for (int m = 0; m < static_cast<int>(n.head.models.size()); ++m)
    for (StudySurface& s : read_surfaces(path, m)) {
      const auto same = std::find_if(stored.begin(), stored.end(),
                                     [&](const StudySurface& other) { return same_geometry(other, s); });
      places[{m, s.contact, s.source}] = static_cast<std::size_t>(same - stored.begin());
      if (same == stored.end()) stored.push_back(std::move(s));
    }
  std::vector<int> mesh_of(stored.size(), -1);
  for (const StudyFieldRow& r : rows) {
    const int c = n.case_of(static_cast<double>(r.key.case_id));
    if (c < 0 || !is_solution(r.outcome)) continue;
    const auto place = places.find({r.model, r.contact, r.source});
    if (place == places.end()) continue;
    int& mesh = mesh_of[place->second];
    if (mesh < 0) {
      mesh = static_cast<int>(out.surfaces.size());
      out.surfaces.push_back(surface_mesh(stored[place->second], r.key.contact_id));
    }
    out.fields.push_back({at(c), at(r.key.state - 1), mesh, r.key.contact_id, r.contact_area});
  }
  return out;
}

void each_pressure(const std::string& path, const StudyNumbers& n, const StudyFields& fields,
                   const std::function<bool(const StudyField&)>& wanted,
                   const std::function<void(const StudyField&, std::vector<double>&&)>& each) {
  std::vector<StudyFieldKey> keys;
  std::vector<const StudyField*> of_keys;
  for (const StudyField& f : fields.fields) {
    if (!wanted(f)) continue;
    keys.push_back({static_cast<std::int64_t>(n.cases[f.c].number), static_cast<int>(f.state) + 1, f.contact_id});
    of_keys.push_back(&f);
  }
  read_fields(path, keys, [&](std::size_t i, std::vector<float>&& pressure) {
    const StudySurfaceMesh& s = fields.surfaces[at(of_keys[i]->surface)];
    if (pressure.size() != s.stored_vertices)
      throw InputError(fmt::format("{}: found {} pressures in case {}, state {}, expected {}: one per vertex", path,
                                   pressure.size(), keys[i].case_id, keys[i].state, s.stored_vertices));
    std::vector<double> values;
    for (int v : s.geometry.mesh.model_nodes) values.push_back(static_cast<double>(pressure[at(v)]));
    each(*of_keys[i], std::move(values));
  });
}

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
  const StudyRows stored = read_rows(path, {"headline_area"});
  std::map<std::tuple<std::size_t, std::size_t, int, std::string>, double> area;
  for (std::size_t r = 0; r < stored.case_id.size(); ++r) {
    const StudyPlace& place = stored.places[at(stored.place[r])];
    const int c = n.case_of(static_cast<double>(stored.case_id[r]));
    if (place.part.empty() && c >= 0)
      area[{at(c), at(stored.state[r] - 1), place.contact_id, place.contact}] = stored.numbers[0][r];
  }
  const std::vector<RegionPlaces> places = make_places(fields, options, n);
  for (auto& of_statistic : n.values)  // of what is not among headline_statistics regions have none
    of_statistic.resize(n.places.size(), std::vector<double>(n.cases.size() * n.choices(), kNaN));
  each_pressure(
      path, n, fields, [](const StudyField&) { return true; },
      [&](const StudyField& f, std::vector<double>&& pressure) {
        const StudySurfaceMesh& s = fields.surfaces[at(f.surface)];
        const RegionPlaces& r = places[at(f.surface)];
        const auto found = area.find({f.c, f.state, s.contact_id, s.contact});
        const std::vector<double> in_contact =
            areas_in_contact(s.areas, pressure, found == area.end() || std::isnan(found->second) ? 0.0 : found->second);
        for (std::size_t k = 0; k < r.regions.names.size(); ++k) {
          const std::array<double, 5> numbers = numbers_in(r, static_cast<int>(k), pressure, in_contact);
          for (std::size_t i = 0; i < numbers.size(); ++i)
            n.values[i][r.first + k][f.c * n.choices() + f.state] = numbers[i];
        }
      });
  add_largest(n);
}

}  // namespace dea
