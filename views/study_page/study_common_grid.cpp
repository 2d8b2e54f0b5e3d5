#include "views/study_page/study_common_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/base/numbers.h"

namespace dea {

namespace {

/// A surface on the map of a sphere of radius 1.
struct Unrolled {
  std::vector<Vector2d> points;
  std::vector<std::array<int, 3>> triangles;
};

Unrolled unrolled(const StudySurfaceMesh& s, const MapView& view) {
  const Projection p = project(s.map, view, std::vector<double>(s.map.triangles.size(), 0.0));
  Unrolled u;
  for (const Vector2d& x : p.points) u.points.push_back(x / view.radius);
  for (int t = 0; t < s.map.size(); ++t)
    if (p.layer[at(t)] == 0) u.triangles.push_back(s.map.triangles[at(t)]);
  return u;
}

double cross(const Vector2d& a, const Vector2d& b) { return a[0] * b[1] - a[1] * b[0]; }

/// Where each point of the lattice lies on one surface. Of triangles that share a point on their edge the first has it.
std::vector<CommonGrid::Source> lattice_sources(const Unrolled& u, double half, double step) {
  std::vector<CommonGrid::Source> sources(static_cast<std::size_t>(kGridSide) * kGridSide);
  const auto first = [&](double x) { return std::max(0, static_cast<int>(std::ceil((x + half) / step - 1e-9))); };
  const auto last = [&](double x) {
    return std::min(kGridSide - 1, static_cast<int>(std::floor((x + half) / step + 1e-9)));
  };
  for (const std::array<int, 3>& t : u.triangles) {
    const Vector2d a = u.points[at(t[0])], b = u.points[at(t[1])], c = u.points[at(t[2])];
    const double area = cross(b - a, c - a);
    if (area == 0) continue;
    const auto [x0, x1] = std::minmax({a[0], b[0], c[0]});
    const auto [y0, y1] = std::minmax({a[1], b[1], c[1]});
    for (int i = first(x0); i <= last(x1); ++i)
      for (int j = first(y0); j <= last(y1); ++j) {
        CommonGrid::Source& source = sources[at(i) * kGridSide + at(j)];
        if (source.vertices[0] >= 0) continue;
        const Vector2d x(step * i - half, step * j - half);
        const std::array<double, 3> w = {cross(b - x, c - x) / area, cross(c - x, a - x) / area,
                                         cross(a - x, b - x) / area};
        if (std::min({w[0], w[1], w[2]}) >= -1e-9) source = {t, w};
      }
  }
  return sources;
}

/// The points that some surface covers, in squares of four.
ResultSurface lattice_geometry(const std::vector<std::vector<CommonGrid::Source>>& sources, double half, double step,
                               double radius) {
  std::vector<Vector3d> positions;
  std::vector<char> covered;
  for (int i = 0; i < kGridSide; ++i)
    for (int j = 0; j < kGridSide; ++j) {
      positions.emplace_back(radius * (step * i - half), radius * (step * j - half), 0.0);
      covered.push_back(std::any_of(sources.begin(), sources.end(), [&](const auto& of_surface) {
        return of_surface[at(i) * kGridSide + at(j)].vertices[0] >= 0;
      }));
    }
  std::vector<int> begin = {0}, nodes;
  for (int i = 0; i + 1 < kGridSide; ++i)
    for (int j = 0; j + 1 < kGridSide; ++j) {
      const int a = i * kGridSide + j, b = a + kGridSide;
      for (const std::array<int, 3>& t : {std::array<int, 3>{a, b, b + 1}, std::array<int, 3>{a, b + 1, a + 1}}) {
        if (covered[at(t[0])] == 0 || covered[at(t[1])] == 0 || covered[at(t[2])] == 0) continue;
        nodes.insert(nodes.end(), t.begin(), t.end());
        begin.push_back(static_cast<int>(nodes.size()));
      }
    }
  return make_result_surface("common grid", begin, nodes, positions);
}

/// The global axis that is on top of a view, as view_from chose it.
Vector3d top_axis(const MapView& view) {
  int best = 2;
  for (int k : {1, 0})
    if (view.up[k] > view.up[best]) best = k;
  return Vector3d::Unit(best);
}

}  // namespace

std::vector<double> CommonGrid::sampled(std::size_t surface, const std::vector<double>& values) const {
  std::vector<double> out;
  for (const Source& s : sources[surface]) {
    double sum = s.vertices[0] < 0 ? kNaN : 0.0;
    for (std::size_t k = 0; k < 3 && s.vertices[0] >= 0; ++k) sum += s.weights[k] * values[at(s.vertices[k])];
    out.push_back(sum);
  }
  return out;
}

std::optional<CommonGrid> common_grid(const std::vector<const StudySurfaceMesh*>& surfaces, const Vector3d& up,
                                      std::string& fault) {
  CommonGrid grid;
  grid.up = up;
  std::vector<Unrolled> maps;
  double half = 0.0;
  for (const StudySurfaceMesh* s : surfaces) {
    MapView view;
    if (!unroll(s->geometry, grid.up, view)) {
      fault = fmt::format("surface \"{}\" is no part of a sphere", s->surface);
      return std::nullopt;
    }
    if (grid.up.isZero()) grid.up = top_axis(view);
    grid.radius += view.radius / static_cast<double>(surfaces.size());
    maps.push_back(unrolled(*s, view));
    for (const Vector2d& x : maps.back().points) half = std::max({half, std::abs(x[0]), std::abs(x[1])});
  }
  const double step = 2 * half / (kGridSide - 1);
  std::vector<std::vector<CommonGrid::Source>> lattice;
  for (const Unrolled& u : maps) lattice.push_back(lattice_sources(u, half, step));
  grid.step = grid.radius * step;
  grid.geometry = lattice_geometry(lattice, half, step, grid.radius);
  for (const std::vector<CommonGrid::Source>& of_lattice : lattice) {
    grid.sources.emplace_back();
    for (int point : grid.geometry.mesh.model_nodes) grid.sources.back().push_back(of_lattice[at(point)]);
  }
  return grid;
}

}  // namespace dea
