#include "views/map/map_geometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "src/base/numbers.h"

namespace dea {

namespace {

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

void find_neighbours(MapMesh& mesh) {
  std::vector<std::array<int, 4>> edges;  // its ends, the triangle, which of its edges
  for (int t = 0; t < mesh.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(mesh.triangles[at(t)][at(k)], mesh.triangles[at(t)][at((k + 1) % 3)]);
      edges.push_back({a, b, t, k});
    }
  }
  std::sort(edges.begin(), edges.end());
  mesh.neighbours.assign(mesh.triangles.size(), {-1, -1, -1});
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    while (end < edges.size() && edges[end][0] == edges[i][0] && edges[end][1] == edges[i][1]) ++end;
    if (end - i == 2) {  // three facets at an edge have no neighbours there
      const int x = edges[i][2], kx = edges[i][3], y = edges[i + 1][2], ky = edges[i + 1][3];
      if (mesh.triangles[at(x)][at(kx)] != mesh.triangles[at(y)][at(ky)]) {  // turned alike
        mesh.neighbours[at(x)][at(kx)] = y;
        mesh.neighbours[at(y)][at(ky)] = x;
      }
    }
    i = end;
  }
}

using Triangle2 = std::array<Vector2d, 3>;

/// What two triangles have in common: area and middle.
double common_area(Triangle2 a, Triangle2 b, Vector2d& middle) {
  for (Triangle2* t : {&a, &b})
    if (cross((*t)[1] - (*t)[0], (*t)[2] - (*t)[0]) < 0) std::swap((*t)[1], (*t)[2]);
  std::vector<Vector2d> polygon(a.begin(), a.end()), next;
  for (int k = 0; k < 3 && !polygon.empty(); ++k) {
    const Vector2d &p = b[at(k)], d = b[at((k + 1) % 3)] - b[at(k)];
    next.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vector2d &x = polygon[i], &y = polygon[(i + 1) % polygon.size()];
      const double sx = cross(d, x - p), sy = cross(d, y - p);
      if (sx >= 0) next.push_back(x);
      if ((sx > 0 && sy < 0) || (sx < 0 && sy > 0)) next.push_back(x + sx / (sx - sy) * (y - x));
    }
    polygon.swap(next);
  }
  double area = 0.0;
  middle.setZero();
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const double part = 0.5 * cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
    area += part;
    middle += part / 3.0 * (polygon[0] + polygon[i - 1] + polygon[i]);
  }
  if (area > 0) middle /= area;
  return area;
}

/// A triangle's height above the map at a place in it.
double depth_at(const Triangle2& t, const Vector3d& depths, const Vector2d& x) {
  const double whole = cross(t[1] - t[0], t[2] - t[0]);
  const double u = cross(t[1] - x, t[2] - x) / whole, v = cross(t[2] - x, t[0] - x) / whole;
  return u * depths[0] + v * depths[1] + (1.0 - u - v) * depths[2];
}

struct Cover {
  int behind, before;
  double area;
};

/// Triangles of the map by the cells of n x n that they may touch.
struct MapGrid {
  int n = 0;                              ///< 0: fewer than two triangles are drawn
  std::vector<std::vector<int>> cells;    ///< j * n + i
  std::vector<std::array<int, 4>> boxes;  ///< per triangle: least i, j, largest i, j
};

MapGrid make_grid(const MapMesh& mesh, const Projection& p) {
  MapGrid grid;
  const auto around = [&](int t) {
    Eigen::AlignedBox2d box;
    for (int v : mesh.triangles[at(t)]) box.extend(p.points[at(v)]);
    return box;
  };
  Eigen::AlignedBox2d all;
  int drawn = 0;
  for (int t = 0; t < mesh.size(); ++t) {
    if (p.layer[at(t)] < 0) continue;
    ++drawn;
    all.extend(around(t));
  }
  if (drawn < 2) return grid;
  const int n = grid.n = std::clamp(static_cast<int>(std::sqrt(drawn / 2.0)), 1, 1000);
  const Vector2d cell = (all.sizes() / n).cwiseMax(1e-300);
  grid.cells.resize(at(n) * at(n));
  grid.boxes.resize(mesh.triangles.size());
  for (int t = 0; t < mesh.size(); ++t) {
    if (p.layer[at(t)] < 0) continue;
    const Eigen::AlignedBox2d of = around(t);
    auto& box = grid.boxes[at(t)];
    for (int i = 0; i < 2; ++i) {
      box[at(i)] = std::clamp(static_cast<int>((of.min()[i] - all.min()[i]) / cell[i]), 0, n - 1);
      box[at(i + 2)] = std::clamp(static_cast<int>((of.max()[i] - all.min()[i]) / cell[i]), 0, n - 1);
    }
    for (int j = box[1]; j <= box[3]; ++j)
      for (int i = box[0]; i <= box[2]; ++i) grid.cells[at(j) * at(n) + at(i)].push_back(t);
  }
  return grid;
}

/// Which of two triangles covers the other, if they overlap on the map.
std::optional<Cover> cover_of(const MapMesh& mesh, const Projection& p, const std::vector<double>& depth,
                              const std::vector<double>& signed_areas, int s, int t) {
  const double area_s = signed_areas[at(s)], area_t = signed_areas[at(t)];
  const auto &vs = mesh.triangles[at(s)], &vt = mesh.triangles[at(t)];
  if ((area_s > 0) == (area_t > 0) &&
      std::any_of(vs.begin(), vs.end(), [&](int v) { return std::find(vt.begin(), vt.end(), v) != vt.end(); }))
    return std::nullopt;  // neighbours that face the same way lie side by side
  const auto corners = [&](const std::array<int, 3>& v) {
    return Triangle2{p.points[at(v[0])], p.points[at(v[1])], p.points[at(v[2])]};
  };
  const auto depths = [&](const std::array<int, 3>& v) {
    return Vector3d(depth[at(v[0])], depth[at(v[1])], depth[at(v[2])]);
  };
  Vector2d middle;
  const Triangle2 cs = corners(vs), ct = corners(vt);
  const double common = common_area(cs, ct, middle);
  if (!(common > 1e-4 * std::min(std::abs(area_s), std::abs(area_t)))) return std::nullopt;
  const bool s_behind = depth_at(cs, depths(vs), middle) < depth_at(ct, depths(vt), middle);
  return s_behind ? Cover{s, t, common} : Cover{t, s, common};
}

/// All pairs of triangles of which one covers the other, by way of a grid.
std::vector<Cover> find_covers(const MapMesh& mesh, const Projection& p, const std::vector<double>& depth,
                               const std::vector<double>& signed_areas) {
  std::vector<Cover> covers;
  const MapGrid grid = make_grid(mesh, p);
  for (int j = 0; j < grid.n; ++j) {
    for (int i = 0; i < grid.n; ++i) {
      const std::vector<int>& here = grid.cells[at(j) * at(grid.n) + at(i)];
      for (std::size_t x = 0; x < here.size(); ++x) {
        for (std::size_t y = x + 1; y < here.size(); ++y) {
          const auto &a = grid.boxes[at(here[x])], &b = grid.boxes[at(here[y])];
          if (i != std::max(a[0], b[0]) || j != std::max(a[1], b[1])) continue;  // each pair in one cell only
          if (const auto cover = cover_of(mesh, p, depth, signed_areas, here[x], here[y])) covers.push_back(*cover);
        }
      }
    }
  }
  return covers;
}

/// Layer of a triangle: the longest chain of triangles behind it.
void assign_layers(const MapMesh& mesh, Projection& p, const std::vector<double>& depth,
                   const std::vector<Cover>& covers) {
  std::vector<std::vector<int>> before(mesh.triangles.size());
  std::vector<int> waiting(mesh.triangles.size(), 0);
  for (const Cover& c : covers) {
    before[at(c.behind)].push_back(c.before);
    ++waiting[at(c.before)];
  }
  std::vector<int> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  const auto middle_depth = [&](int t) {
    const auto& v = mesh.triangles[at(t)];
    return depth[at(v[0])] + depth[at(v[1])] + depth[at(v[2])];
  };
  std::sort(order.begin(), order.end(), [&](int s, int t) {
    const double ds = middle_depth(s), dt = middle_depth(t);
    return ds != dt ? ds < dt : s < t;
  });
  std::vector<char> done(mesh.triangles.size(), 0);
  std::vector<int> ready;
  const auto settle_layer = [&](int t) {
    done[at(t)] = 1;
    for (int next : before[at(t)]) {
      if (done[at(next)]) continue;
      p.layer[at(next)] = std::max(p.layer[at(next)], p.layer[at(t)] + 1);
      if (--waiting[at(next)] == 0) ready.push_back(next);
    }
  };
  for (const bool cut_open : {false, true})  // three that cover each other in turn are cut open
    for (int start : order) {                // at the farthest
      if (done[at(start)] || p.layer[at(start)] < 0 || (!cut_open && waiting[at(start)] > 0)) continue;
      ready.push_back(start);
      while (!ready.empty()) {
        const int t = ready.back();
        ready.pop_back();
        if (!done[at(t)]) settle_layer(t);
      }
    }
  for (int l : p.layer) p.layers = std::max(p.layers, l + 1);
}

/// A point of a map: a vertex and -1, or the ends a < b of the edge that a contour crosses there.
using Place = std::pair<int, int>;
struct Piece {
  Place from, to;
  Vector2d x, y;
};

/// Pieces joined end to end.
std::vector<Polyline> chain(std::vector<Piece> pieces) {
  std::sort(pieces.begin(), pieces.end(),
            [](const Piece& p, const Piece& q) { return std::tie(p.from, p.to) < std::tie(q.from, q.to); });
  std::vector<Place> ends;
  for (const Piece& p : pieces) ends.push_back(p.to);
  std::sort(ends.begin(), ends.end());
  std::vector<char> used(pieces.size(), 0);
  const auto next = [&](const Place& from) {
    const auto first = std::lower_bound(pieces.begin(), pieces.end(), from,
                                        [](const Piece& p, const Place& place) { return p.from < place; });
    for (auto i = static_cast<std::size_t>(first - pieces.begin()); i < pieces.size() && pieces[i].from == from; ++i)
      if (!used[i]) return i;
    return pieces.size();
  };
  std::vector<Polyline> lines;
  const auto walk = [&](std::size_t start) {
    Polyline line;
    const Place first = pieces[start].from;
    for (std::size_t i = start; i < pieces.size();) {
      const Piece& piece = pieces[i];
      used[i] = 1;
      line.points.push_back(piece.x);
      if (piece.to == first) {
        line.closed = true;
        break;
      }
      i = next(piece.to);
      if (i == pieces.size()) line.points.push_back(piece.y);
    }
    lines.push_back(std::move(line));
  };
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (!used[i] && !std::binary_search(ends.begin(), ends.end(), pieces[i].from)) walk(i);
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (!used[i]) walk(i);
  return lines;
}

/// Pieces of the region's outline (`rims`) and of the contour itself, in one triangle.
void cut_triangle(const MapMesh& mesh, const Projection& p, const TriangleMask& in, const std::vector<double>& values,
                  double level, bool rims, int t, std::vector<Piece>& pieces) {
  const auto& v = mesh.triangles[at(t)];
  const auto above = [&](int k) { return values[at(v[at(k % 3)])] >= level; };
  const auto corner = [&](int k) { return std::pair{Place{v[at(k % 3)], -1}, p.points[at(v[at(k % 3)])]}; };
  const auto crossing = [&](int k) {
    const auto [a, b] = std::minmax(v[at(k % 3)], v[at((k + 1) % 3)]);
    const double s = (level - values[at(a)]) / (values[at(b)] - values[at(a)]);
    return std::pair{Place{a, b}, Vector2d(p.points[at(a)] + s * (p.points[at(b)] - p.points[at(a)]))};
  };
  const auto add = [&](const std::pair<Place, Vector2d>& from, const std::pair<Place, Vector2d>& to) {
    pieces.push_back({from.first, to.first, from.second, to.second});
  };
  int leaves = -1, enters = -1;
  for (int k = 0; k < 3; ++k) {
    if (above(k) && !above(k + 1)) leaves = k;
    if (!above(k) && above(k + 1)) enters = k;
    const int other = mesh.neighbours[at(t)][at(k)];
    if (!rims || (other >= 0 && in[at(other)]) || (!above(k) && !above(k + 1))) continue;
    add(above(k) ? corner(k) : crossing(k), above(k + 1) ? corner(k + 1) : crossing(k));
  }
  if (leaves >= 0 && enters >= 0) add(crossing(leaves), crossing(enters));
}

/// The edges of triangles of `in` beyond which no triangle goes on: `goes_on(t, other)`.
template <class GoesOn>
std::vector<Polyline> open_edges(const MapMesh& mesh, const Projection& p, const TriangleMask& in, GoesOn goes_on) {
  std::vector<Piece> pieces;
  for (int t = 0; t < mesh.size(); ++t) {
    if (!in[at(t)]) continue;
    for (int k = 0; k < 3; ++k) {
      const int other = mesh.neighbours[at(t)][at(k)];
      if (other >= 0 && goes_on(t, other)) continue;
      const int a = mesh.triangles[at(t)][at(k)], b = mesh.triangles[at(t)][at((k + 1) % 3)];
      pieces.push_back({{a, -1}, {b, -1}, p.points[at(a)], p.points[at(b)]});
    }
  }
  return chain(std::move(pieces));
}

std::vector<Polyline> cut_triangles(const MapMesh& mesh, const Projection& p, const TriangleMask& in,
                                    const std::vector<double>& values, double level, bool region) {
  std::vector<Piece> pieces;
  for (int t = 0; t < mesh.size(); ++t)
    if (in[at(t)]) cut_triangle(mesh, p, in, values, level, region, t, pieces);
  return chain(std::move(pieces));
}

/// The part of a triangle's area where the linear interpolation of its corners' values is `level` or more.
double share_above(const MapMesh& mesh, const std::vector<double>& values, int t, double level) {
  const auto& v = mesh.triangles[at(t)];
  std::array<double, 3> x = {values[at(v[0])] - level, values[at(v[1])] - level, values[at(v[2])] - level};
  std::sort(x.begin(), x.end());
  if (!std::isfinite(x[0]) || !std::isfinite(x[2]) || x[2] < 0) return 0.0;
  if (x[1] < 0) return x[2] / (x[2] - x[1]) * x[2] / (x[2] - x[0]);
  if (x[0] < 0) return 1.0 - x[0] / (x[0] - x[1]) * x[0] / (x[0] - x[2]);
  return 1.0;
}

}  // namespace

MapMesh make_map_mesh(const ResultSurface& surface) {
  MapMesh mesh;
  mesh.points = surface.mesh.vertices;
  std::vector<char> quad(at(surface.facets()), 0);
  for (int f = 0; f < surface.facets(); ++f) {
    const int begin = surface.begin[at(f)];
    if (surface.begin[at(f) + 1] - begin != 4) continue;
    std::array<int, 4> v;
    for (int k = 0; k < 4; ++k) v[at(k)] = surface.slot_vertex[at(begin + k)];
    std::array<int, 4> sorted = v;
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] < 0 || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) continue;  // collapsed
    quad[at(f)] = 1;
    const int middle = static_cast<int>(mesh.points.size());
    mesh.middles.push_back(v);
    mesh.points.push_back(
        (mesh.points[at(v[0])] + mesh.points[at(v[1])] + mesh.points[at(v[2])] + mesh.points[at(v[3])]) / 4.0);
    for (int k = 0; k < 4; ++k) {
      mesh.triangles.push_back({v[at(k)], v[at((k + 1) % 4)], middle});
      mesh.facet.push_back(f);
    }
  }
  for (int t = 0; t < surface.mesh.size(); ++t) {
    if (quad[at(surface.mesh.facet[at(t)])]) continue;
    mesh.triangles.push_back(surface.mesh.triangles[at(t)]);
    mesh.facet.push_back(surface.mesh.facet[at(t)]);
  }
  for (const auto& v : mesh.triangles)
    mesh.areas.push_back(
        0.5 *
        (mesh.points[at(v[1])] - mesh.points[at(v[0])]).cross(mesh.points[at(v[2])] - mesh.points[at(v[0])]).norm());
  find_neighbours(mesh);
  return mesh;
}

std::vector<double> point_values(const MapMesh& mesh, const std::vector<double>& vertex_values) {
  std::vector<double> values = vertex_values;
  for (const auto& v : mesh.middles)
    values.push_back((values[at(v[0])] + values[at(v[1])] + values[at(v[2])] + values[at(v[3])]) / 4.0);
  return values;
}

Vector3d default_direction(const ResultSurface& surface, const std::vector<double>& load) {
  Vector3d all = Vector3d::Zero(), loaded = Vector3d::Zero();
  double area = 0.0;
  for (int f = 0; f < surface.facets(); ++f) {
    all += surface.area_vectors[at(f)];
    loaded += load[at(f)] * surface.area_vectors[at(f)];
    area += surface.facet_areas[at(f)];
  }
  const SurfaceExtent extent = surface_extent(surface.mesh);
  double carried = 0.0, seen = 0.0, bulge = 0.0;
  for (int f = 0; f < surface.facets(); ++f) {
    const double weight = load[at(f)] * surface.facet_areas[at(f)];
    carried += weight;
    if (surface.area_vectors[at(f)].dot(all) > 0.2 * surface.facet_areas[at(f)] * all.norm()) seen += weight;
    bulge += surface.area_vectors[at(f)].dot(surface.facet_centers[at(f)] - extent.centroid);
  }
  const bool ball = bulge > 0.05 * area * extent.radius_of_gyration;
  if (!ball && all.norm() > 0.1 * area && seen >= 0.95 * carried) return all;
  if (loaded.norm() > 1e-6 * carried && loaded.norm() > 0) return loaded;
  return all.norm() > 1e-6 * area ? all : Vector3d(Vector3d::UnitZ());
}

MapView view_from(const Vector3d& toward, const Vector3d& up) {
  MapView view;
  view.toward = toward.normalized();
  Vector3d across = up.norm() > 0 ? Vector3d(up.normalized().cross(view.toward)) : Vector3d(0, 0, 0);
  if (!(across.norm() > 1e-6)) {
    for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1)})
      if (axis.cross(view.toward).norm() > 0.3) across = axis.cross(view.toward);  // the last one stays
  }
  view.right = across.normalized();
  view.up = view.toward.cross(view.right);
  return view;
}

bool unroll(const ResultSurface& surface, const Vector3d& up, MapView& view) {
  const SphereFit sphere = fit_sphere(surface.mesh);
  if (roundness(surface.mesh, sphere) != Roundness::Round) return false;
  Vector3d outward = surface_extent(surface.mesh).centroid - sphere.center;
  if (outward.norm() < 1e-3 * sphere.radius) outward = Vector3d::UnitZ();  // a whole ball has no middle
  double facing = 0.0;
  for (int t = 0; t < surface.mesh.size(); ++t)
    facing += surface.mesh.areas[at(t)] * surface.mesh.normals[at(t)].dot(surface.mesh.centroid(t) - sphere.center);
  view = view_from(facing >= 0 ? outward : Vector3d(-outward), up);  // a socket is seen from within
  view.unrolled = true;
  view.center = sphere.center;
  view.radius = sphere.radius;
  view.pole = outward.normalized();
  return true;
}

EdgeNames edge_names(const MapView& view, const BodyDirections& body) {
  EdgeNames names;
  if (!(body.anterior.norm() > 0)) return names;
  const Vector3d up = body.superior.normalized(), front = (body.anterior - body.anterior.dot(up) * up).normalized();
  const bool left = body.side == "left", sided = !body.side.empty();
  const struct {
    Vector3d to;
    const char *there, *opposite;
  } axes[] = {{up, "superior", "inferior"},
              {front, "anterior", "posterior"},
              {front.cross(up),
               !sided ? "right"
               : left ? "medial"
                      : "lateral",
               !sided ? "left"
               : left ? "lateral"
                      : "medial"}};
  constexpr double kNear = 0.5;  // an axis names edges within 45 degrees of it, unless it is nearly along the view
  double nearest[2] = {kNear, kNear};
  for (const auto& axis : axes) {
    const double across[2] = {axis.to.dot(view.right), axis.to.dot(view.up)};
    const std::size_t edge = std::abs(across[1]) > std::abs(across[0]) ? 1 : 0;
    if (std::abs(across[edge]) <= nearest[edge]) continue;
    nearest[edge] = std::abs(across[edge]);
    names[edge] = across[edge] > 0 ? axis.there : axis.opposite;
    names[edge + 2] = across[edge] > 0 ? axis.opposite : axis.there;
  }
  return names;
}

Vector2d on_map(const MapView& view, const Vector3d& x) {
  if (!view.unrolled) return {view.right.dot(x), view.up.dot(x)};
  const Vector3d d = x - view.center;
  const double height = d.dot(view.pole);
  const Vector2d across(view.right.dot(d), view.up.dot(d));
  const double r = across.norm();
  const double angle = std::atan2(r, height);
  return r > 0 ? Vector2d(2.0 * view.radius * std::sin(0.5 * angle) / r * across) : Vector2d(0, 0);
}

Projection project(const MapMesh& mesh, const MapView& view, const std::vector<double>& weights) {
  Projection p;
  std::vector<double> depth;
  for (const Vector3d& x : mesh.points) {
    p.points.push_back(on_map(view, x));
    depth.push_back(view.unrolled ? 0.0 : view.toward.dot(x));
  }
  std::vector<double> signed_areas;
  double balance = 0.0, plain = 0.0;
  for (int t = 0; t < mesh.size(); ++t) {
    const auto& v = mesh.triangles[at(t)];
    signed_areas.push_back(0.5 *
                           cross(p.points[at(v[1])] - p.points[at(v[0])], p.points[at(v[2])] - p.points[at(v[0])]));
    const double tilt = mesh.areas[at(t)] > 0 ? signed_areas.back() / mesh.areas[at(t)] : 0.0;
    balance += tilt * weights[at(t)];
    plain += signed_areas.back();
  }
  p.from_behind = (balance != 0 ? balance : plain) < 0;
  p.layer.assign(mesh.triangles.size(), 0);
  p.back.assign(mesh.triangles.size(), 0);
  p.hidden.assign(mesh.triangles.size(), 0.0);
  for (int t = 0; t < mesh.size(); ++t) {
    const double a = signed_areas[at(t)];
    if (!(std::abs(a) > 1e-6 * mesh.areas[at(t)])) p.layer[at(t)] = -1;
    p.back[at(t)] = (a < 0) != p.from_behind;
    if (!view.unrolled) continue;
    // Round the antipode a triangle comes to lie across the whole map.
    if (p.back[at(t)] || std::abs(a) > 4.0 * mesh.areas[at(t)]) p.layer[at(t)] = -1;
  }
  if (view.unrolled) {
    p.layers = 1;
    return p;
  }
  const std::vector<Cover> covers = find_covers(mesh, p, depth, signed_areas);
  for (const Cover& c : covers)
    p.hidden[at(c.behind)] = std::min(1.0, p.hidden[at(c.behind)] + c.area / std::abs(signed_areas[at(c.behind)]));
  assign_layers(mesh, p, depth, covers);
  return p;
}

TriangleMask layer_triangles(const MapMesh& mesh, const Projection& p, int layer) {
  TriangleMask in(mesh.triangles.size(), 0);
  for (int t = 0; t < mesh.size(); ++t) {
    if (p.layer[at(t)] == layer) in[at(t)] = 1;
    // Neighbours of later layers, too, which are drawn over in the same place: no light shines through the seam.
    if (p.layer[at(t)] > layer)
      for (int n : mesh.neighbours[at(t)])
        if (n >= 0 && p.layer[at(n)] == layer && p.back[at(n)] == p.back[at(t)]) in[at(t)] = 1;
  }
  return in;
}

std::vector<Polyline> outline(const MapMesh& mesh, const Projection& p, const TriangleMask& in) {
  return open_edges(mesh, p, in, [&](int, int other) { return in[at(other)] != 0; });
}

std::vector<Polyline> region_above(const MapMesh& mesh, const Projection& p, const TriangleMask& in,
                                   const std::vector<double>& values, double level) {
  return cut_triangles(mesh, p, in, values, level, true);
}

std::vector<Polyline> contour(const MapMesh& mesh, const Projection& p, const TriangleMask& in,
                              const std::vector<double>& values, double level) {
  return cut_triangles(mesh, p, in, values, level, false);
}

std::vector<Polyline> rim(const MapMesh& mesh, const Projection& p, const TriangleMask& in) {
  return open_edges(mesh, p, in,
                    [&](int t, int other) { return p.layer[at(other)] >= 0 && p.back[at(other)] == p.back[at(t)]; });
}

Polyline smoothed(const Polyline& line) {
  Polyline now = line;
  for (int pass = 0; pass < 2 && now.points.size() > 2; ++pass) {
    Polyline next;
    next.closed = now.closed;
    const std::size_t n = now.points.size();
    if (!now.closed) next.points.push_back(now.points.front());
    for (std::size_t i = 0; i + (now.closed ? 0 : 1) < n; ++i) {
      const Vector2d &a = now.points[i], &b = now.points[(i + 1) % n];
      if (now.closed || i > 0) next.points.push_back(0.75 * a + 0.25 * b);
      if (now.closed || i + 2 < n) next.points.push_back(0.25 * a + 0.75 * b);
    }
    if (!now.closed) next.points.push_back(now.points.back());
    now = std::move(next);
  }
  return now;
}

double area_above(const MapMesh& mesh, const std::vector<double>& values, double level) {
  double area = 0.0;
  for (int t = 0; t < mesh.size(); ++t) area += share_above(mesh, values, t, level) * mesh.areas[at(t)];
  return area;
}

double edge_level(const MapMesh& mesh, const std::vector<double>& facets, const std::vector<double>& points) {
  double wanted = 0.0;
  for (int t = 0; t < mesh.size(); ++t)
    if (facets[at(mesh.facet[at(t)])] > 0) wanted += mesh.areas[at(t)];
  return level_enclosing(mesh, wanted, points);
}

double level_enclosing(const MapMesh& mesh, double wanted, const std::vector<double>& points) {
  constexpr double kLeast = 1e-12;
  double low = 0.0, high = 0.0, whole_area = 0.0;
  for (double area : mesh.areas) whole_area += area;
  for (double x : points) high = std::max(high, x);
  if (!(high > 0)) return kInfinity;
  if (wanted > whole_area * (1 - 1e-9)) return kLeast;
  // Only triangles with values to both sides of the level are looked at again.
  struct Cut {
    int triangle;
    double least, most;
  };
  std::vector<Cut> cut;
  for (int t = 0; t < mesh.size(); ++t) {
    const auto& v = mesh.triangles[at(t)];
    const double a = points[at(v[0])], b = points[at(v[1])], c = points[at(v[2])];
    const Cut x = {t, std::min({a, b, c}), std::max({a, b, c})};
    if (std::isfinite(a + b + c) && x.most > 0) cut.push_back(x);
  }
  double whole = 0.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    double area = whole;
    for (const Cut& x : cut) area += share_above(mesh, points, x.triangle, middle) * mesh.areas[at(x.triangle)];
    (area > wanted ? low : high) = middle;
    std::erase_if(cut, [&](const Cut& x) {
      if (x.least >= high) whole += mesh.areas[at(x.triangle)];
      return x.least >= high || x.most < low;
    });
  }
  return std::max(high, kLeast);
}

}  // namespace dea
