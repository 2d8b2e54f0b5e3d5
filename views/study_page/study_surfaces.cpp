#include "views/study_page/study_surfaces.h"

#include <fmt/format.h>

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

/// Surfaces by model, contact and source.
class Surfaces {
 public:
  Surfaces(const std::string& path, std::size_t models) {
    for (std::size_t m = 0; m < models; ++m)
      for (StudySurface& s : read_surfaces(path, static_cast<int>(m))) add(static_cast<int>(m), std::move(s));
  }
  /// -1: none.
  int of(int model, int contact_id, const std::string& contact, const std::string& source,
         std::vector<StudySurfaceMesh>& meshes) {
    const auto found = known_.find({model, contact, source});
    if (found == known_.end()) return -1;
    int& mesh = mesh_of_[found->second];
    if (mesh < 0) {
      mesh = static_cast<int>(meshes.size());
      meshes.push_back(surface_mesh(stored_[found->second], contact_id));
    }
    return mesh;
  }

 private:
  void add(int model, StudySurface&& s) {
    const std::tuple<int, std::string, std::string> key{model, s.contact, s.source};
    for (std::size_t i = 0; i < stored_.size(); ++i)
      if (same_geometry(stored_[i], s)) {
        known_[key] = i;
        return;
      }
    known_[key] = stored_.size();
    stored_.push_back(std::move(s));
    mesh_of_.push_back(-1);
  }

  std::vector<StudySurface> stored_;
  std::vector<int> mesh_of_;
  std::map<std::tuple<int, std::string, std::string>, std::size_t> known_;
};

}  // namespace

StudyFields study_fields(const std::string& path, const StudyNumbers& n) {
  StudyFields out;
  const std::vector<StudyFieldRow> rows = list_fields(path);
  if (rows.empty()) return out;
  Surfaces surfaces(path, n.head.models.size());
  for (const StudyFieldRow& r : rows) {
    const int c = n.case_of(static_cast<double>(r.key.case_id));
    if (c < 0 || !is_solution(r.outcome)) continue;
    const int surface = surfaces.of(r.model, r.key.contact_id, r.contact, r.source, out.surfaces);
    if (surface >= 0) out.fields.push_back({at(c), at(r.key.state - 1), surface, r.key.contact_id, r.contact_area});
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

}  // namespace dea
