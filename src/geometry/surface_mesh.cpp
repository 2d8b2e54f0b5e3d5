#include "src/geometry/surface_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <unordered_map>

#include "src/base/decompositions.h"
#include "src/base/numbers.h"
#include "src/geometry/coincident.h"
#include "src/model/element_faces.h"

namespace dea {

namespace {

/// Axis of the plane of symmetry behind which the surface goes on at an edge of the rim, as the triangle's mirror
/// image; -1: none.
int image_axis(const SurfaceMesh& mesh, int t, int k) {
  constexpr double kAlong = 0.95;  // such a surface lies in the plane, it does not run into it
  if (mesh.planes.empty() || mesh.neighbours[at(t)][at(k)] >= 0) return -1;
  const auto& corner = mesh.triangles[at(t)];
  const unsigned planes = mesh.planes[at(corner[at(k)])] & mesh.planes[at(corner[at((k + 1) % 3)])];
  for (int axis = 0; axis < 3; ++axis)
    if ((planes >> axis & 1) != 0 && std::abs(mesh.normals[at(t)][axis]) < kAlong) return axis;
  return -1;
}

/// How much the surface turns at an edge of a triangle, in radians. Nothing: there is no neighbour.
std::optional<double> turn_at(const SurfaceMesh& mesh, int t, int k) {
  const int other = mesh.neighbours[at(t)][at(k)];
  const Vector3d& n = mesh.normals[at(t)];
  if (other < 0) {
    const int axis = image_axis(mesh, t, k);
    if (axis < 0) return std::nullopt;
    return 2 * std::asin(std::abs(n[axis]));
  }
  const Vector3d& m = mesh.normals[at(other)];
  return std::atan2(n.cross(m).norm(), n.dot(m));
}

/// How much the surface turns at the next edge alongside edge k of triangle t: of the edges of the triangle and of its
/// neighbours across its other two edges the one that is most nearly parallel. Nothing: the surface ends there.
std::optional<double> next_turn(const SurfaceMesh& mesh, int t, int k) {
  const Vector3d along = (mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k)).normalized();
  double best = 0;
  std::optional<double> turn;
  const auto consider = [&](int triangle, int edge) {
    const Vector3d way = mesh.corner(triangle, (edge + 1) % 3) - mesh.corner(triangle, edge);
    const double parallel = std::abs(way.dot(along)) / way.norm();
    if (parallel <= best) return;
    best = parallel;
    turn = turn_at(mesh, triangle, edge);
  };
  for (int own = 0; own < 3; ++own) {
    if (own == k) continue;
    consider(t, own);
    const int beside = mesh.neighbours[at(t)][at(own)];
    for (int edge = 0; beside >= 0 && edge < 3; ++edge)
      if (mesh.neighbours[at(beside)][at(edge)] != t) consider(beside, edge);
  }
  return turn;
}

/// Per triangle and edge: does the surface it stands for have an edge there, too? It turns by more than 40 degrees, or
/// by more than 15 and three times as much as alongside, on either side: coarse facets of a round surface turn alike.
std::vector<std::array<char, 3>> find_creases(const SurfaceMesh& mesh) {
  constexpr double kAlways = 40 * kPi / 180, kNever = 15 * kPi / 180, kTimes = 3;
  std::vector<std::array<char, 3>> crease(at(mesh.size()), {0, 0, 0});
  for (int t = 0; t < mesh.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int other = mesh.neighbours[at(t)][at(k)];
      const double turn = turn_at(mesh, t, k).value_or(0.0);
      if (turn <= kNever) continue;
      bool sharp = turn > kAlways;
      if (!sharp) {
        const auto here = next_turn(mesh, t, k);
        auto there = here;  // of an image
        if (other >= 0) {
          const auto back = std::find(mesh.neighbours[at(other)].begin(), mesh.neighbours[at(other)].end(), t);
          there = next_turn(mesh, other, static_cast<int>(back - mesh.neighbours[at(other)].begin()));
        }
        sharp = turn > kTimes * std::max(here.value_or(0.0), there.value_or(0.0)) && (here || there);
      }
      crease[at(t)][at(k)] = sharp;
    }
  return crease;
}

/// The smooth surface's normal at a corner of a triangle: that of the facets around the vertex up to creases.
struct CornerNormal {
  Vector3d normal = Vector3d::Zero();
  bool one_sided = false;  // the facets end at a rim or at creases
};

/// Exact where the vertices lie on a sphere, however uneven the facets: each corner's cross product of edges over the
/// squares of their lengths (N. Max, Weights for computing vertex normals from facet normals, J. Graphics Tools 4(2),
/// 1999).
std::vector<std::array<CornerNormal, 3>> corner_normals(const SurfaceMesh& mesh,
                                                        const std::vector<std::array<char, 3>>& crease) {
  std::vector<std::array<CornerNormal, 3>> normals(at(mesh.size()));
  std::vector<std::vector<std::array<int, 2>>> around(mesh.vertices.size());  // corners of each vertex
  for (int t = 0; t < mesh.size(); ++t)
    for (int k = 0; k < 3; ++k) around[at(mesh.triangles[at(t)][at(k)])].push_back({t, k});
  std::vector<int> group;
  for (const auto& corners : around) {
    group.assign(corners.size(), -1);
    const auto place = [&](int t) {
      return at(std::find_if(corners.begin(), corners.end(), [&](const auto& c) { return c[0] == t; }) -
                corners.begin());
    };
    for (std::size_t first = 0; first < corners.size(); ++first) {
      if (group[first] >= 0) continue;
      CornerNormal sum;
      std::array<bool, 3> mirrored = {false, false, false};  // images behind planes across these axes
      std::vector<std::size_t> members = {first};
      group[first] = static_cast<int>(first);
      for (std::size_t m = 0; m < members.size(); ++m) {
        const int t = corners[members[m]][0], k = corners[members[m]][1];
        const Vector3d a = mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k),
                       b = mesh.corner(t, (k + 2) % 3) - mesh.corner(t, k);
        sum.normal += a.cross(b) / (a.squaredNorm() * b.squaredNorm());
        for (const int edge : {k, (k + 2) % 3}) {
          const int next = mesh.neighbours[at(t)][at(edge)];
          const int axis = image_axis(mesh, t, edge);
          if ((next < 0 && axis < 0) || crease[at(t)][at(edge)]) {
            sum.one_sided = true;
            continue;
          }
          if (axis >= 0) {
            mirrored[at(axis)] = true;
            continue;
          }
          const std::size_t i = place(next);
          if (i == corners.size() || group[i] >= 0) continue;
          group[i] = static_cast<int>(first);
          members.push_back(i);
        }
      }
      for (int axis = 0; axis < 3; ++axis)
        if (mirrored[at(axis)]) sum.normal[axis] = 0.0;  // the image's takes it away
      sum.normal.normalize();
      for (const std::size_t m : members) normals[at(corners[m][0])][at(corners[m][1])] = sum;
    }
  }
  return normals;
}

void find_bulges(SurfaceMesh& mesh) {
  const auto crease = find_creases(mesh);
  const auto normals = corner_normals(mesh, crease);
  constexpr double kCos40 = 0.76604444311897801;
  mesh.bulge.assign(mesh.triangles.size(), {0, 0, 0});
  for (int t = 0; t < mesh.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (crease[at(t)][k]) continue;
      const CornerNormal &i = normals[at(t)][k], &j = normals[at(t)][(k + 1) % 3];
      const int other = mesh.neighbours[at(t)][k];
      // sharp, too, where a corner's normal is more than 40 degrees from the facets at the edge
      const Vector3d& n = mesh.normals[at(t)];
      double least = std::min(n.dot(i.normal), n.dot(j.normal));
      if (other >= 0) {
        const Vector3d& m = mesh.normals[at(other)];
        least = std::min({least, m.dot(i.normal), m.dot(j.normal)});
      }
      if (least < kCos40) continue;
      const Vector3d edge = mesh.corner(t, static_cast<int>(k)) - mesh.corner(t, static_cast<int>((k + 1) % 3));
      double& b = mesh.bulge[at(t)][k];
      // A vertex at a rim or a crease has facets on one side only and no normal of its own worth the name: the
      // curvature at the inner end serves for the whole edge (the normal mirrored in the edge's bisecting plane).
      if (i.one_sided == j.one_sided)
        b = 0.5 * edge.dot(i.normal - j.normal);
      else
        b = j.one_sided ? edge.dot(i.normal) : -edge.dot(j.normal);
    }
  }
}

void finish_surface_mesh(SurfaceMesh& mesh) {
  const std::size_t n = mesh.triangles.size();
  mesh.normals.resize(n);
  mesh.areas.resize(n);
  mesh.vertex_normals.assign(mesh.vertices.size(), Vector3d::Zero());
  mesh.vertex_areas.assign(mesh.vertices.size(), 0.0);
  for (int t = 0; t < mesh.size(); ++t) {
    const auto i = at(t);
    const Vector3d twice = (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
    mesh.areas[i] = 0.5 * twice.norm();
    mesh.normals[i] = twice.normalized();
    for (int v : mesh.triangles[i]) {
      mesh.vertex_normals[at(v)] += 0.5 * twice;
      mesh.vertex_areas[at(v)] += mesh.areas[i] / 3.0;
    }
  }
  mesh.neighbours = edge_neighbours(mesh.triangles, true);
  for (int t = 0; t < mesh.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int axis = image_axis(mesh, t, k);
      if (axis < 0) continue;
      for (const int end : {k, (k + 1) % 3})  // the image's normals take it away
        mesh.vertex_normals[at(mesh.triangles[at(t)][at(end)])][axis] = 0.0;
    }
  for (Vector3d& normal : mesh.vertex_normals) {
    const double length = normal.norm();
    normal = length > 0 ? Vector3d(normal / length) : Vector3d::UnitZ();
  }
  find_bulges(mesh);
}

}  // namespace

SurfaceMesh make_surface_mesh(const std::vector<int>& begin, const std::vector<int>& nodes,
                              const std::vector<Vector3d>& positions, std::vector<int>* zero_area,
                              const std::vector<unsigned char>& node_planes) {
  SurfaceMesh mesh;
  mesh.facets = static_cast<int>(begin.size()) - 1;
  std::unordered_map<int, int> vertex_of;
  const auto vertex = [&](int node) {
    const auto found = vertex_of.try_emplace(node, static_cast<int>(mesh.vertices.size()));
    if (found.second) {
      mesh.model_nodes.push_back(node);
      mesh.vertices.push_back(positions[at(node)]);
      if (!node_planes.empty()) mesh.planes.push_back(node_planes[at(node)]);
    }
    return found.first->second;
  };
  for (int f = 0; f < mesh.facets; ++f) {
    const int first = begin[at(f)];
    const int count = begin[at(f) + 1] - first;
    if (count == 0) continue;
    int kept = 0;
    for (const auto& t : split_facet(nodes.data() + first, count, positions)) {
      const Vector3d &a = positions[at(t[0])], &b = positions[at(t[1])], &c = positions[at(t[2])];
      const double longest2 = std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
      if ((b - a).cross(c - a).norm() <= 1e-10 * longest2) continue;  // a collapsed quad keeps its other triangle
      mesh.triangles.push_back({vertex(t[0]), vertex(t[1]), vertex(t[2])});
      mesh.facet.push_back(f);
      ++kept;
    }
    if (kept == 0 && zero_area) zero_area->push_back(f);
  }
  finish_surface_mesh(mesh);
  return mesh;
}

double bulge_height(const SurfaceMesh& mesh, int t, const std::array<double, 3>& w) {
  const auto& b = mesh.bulge[at(t)];
  return w[0] * w[1] * b[0] + w[1] * w[2] * b[1] + w[2] * w[0] * b[2];
}

SurfaceMesh turned_round(const SurfaceMesh& mesh, const std::vector<Vector3d>& positions,
                         const std::vector<unsigned char>& node_planes) {
  std::vector<int> begin = {0}, nodes;
  for (const auto& tri : mesh.triangles) {
    for (int v : {tri[0], tri[2], tri[1]}) nodes.push_back(mesh.model_nodes[at(v)]);
    begin.push_back(static_cast<int>(nodes.size()));
  }
  return make_surface_mesh(begin, nodes, positions, nullptr, node_planes);
}

SurfaceMesh with_turned(SurfaceMesh mesh, const std::vector<char>& which) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (which[t]) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  finish_surface_mesh(mesh);
  return mesh;
}

void flatten(SurfaceMesh& mesh) { mesh.bulge.assign(mesh.bulge.size(), {0, 0, 0}); }

Vector3d linear_gradient(const SurfaceMesh& mesh, int t, const std::array<double, 3>& v) {
  const Vector3d e1 = mesh.corner(t, 1) - mesh.corner(t, 0), e2 = mesh.corner(t, 2) - mesh.corner(t, 0);
  const Vector3d normal = e1.cross(e2);
  return ((v[1] - v[0]) * e2.cross(normal) + (v[2] - v[0]) * normal.cross(e1)) / normal.squaredNorm();
}

SurfaceMesh with_vertices_at(SurfaceMesh mesh, const std::vector<Vector3d>& vertices, bool flat) {
  mesh.vertices = vertices;
  finish_surface_mesh(mesh);
  if (flat) flatten(mesh);
  return mesh;
}

Vector3d bulge_gradient(const SurfaceMesh& mesh, int t, const std::array<double, 3>& w) {
  const auto& b = mesh.bulge[at(t)];
  // dH/dw_k at the corners' unit weights: the gradient of a function of the weights is linear_gradient of its partials
  return linear_gradient(mesh, t, {w[1] * b[0] + w[2] * b[2], w[0] * b[0] + w[2] * b[1], w[1] * b[1] + w[0] * b[2]});
}

namespace {

Barycentric grid_point(int n, int i, int j) {
  return {static_cast<double>(n - i - j) / n, static_cast<double>(i) / n, static_cast<double>(j) / n};
}

/// Grid points of the corners of the parts, in the order of triangle_parts.
std::vector<std::array<std::array<int, 2>, 3>> part_corners(int n) {
  std::vector<std::array<std::array<int, 2>, 3>> parts;
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      parts.push_back({{{i, j}, {i + 1, j}, {i, j + 1}}});
      if (i + j + 2 <= n) parts.push_back({{{i + 1, j}, {i + 1, j + 1}, {i, j + 1}}});
    }
  return parts;
}

}  // namespace

Barycentric weights_in(const std::array<Vector3d, 3>& c, const Vector3d& x) {
  const Vector3d normal = (c[1] - c[0]).cross(c[2] - c[0]);
  const double twice2 = normal.squaredNorm();
  const double w0 = (c[1] - x).cross(c[2] - x).dot(normal) / twice2,
               w1 = (c[2] - x).cross(c[0] - x).dot(normal) / twice2;
  return {w0, w1, 1 - w0 - w1};
}

std::vector<std::array<Barycentric, 3>> triangle_parts(int n) {
  std::vector<std::array<Barycentric, 3>> parts;
  for (const auto& corners : part_corners(n)) {
    std::array<Barycentric, 3> part;
    for (std::size_t c = 0; c < 3; ++c) part[c] = grid_point(n, corners[c][0], corners[c][1]);
    parts.push_back(part);
  }
  return parts;
}

int part_at(int n, const Barycentric& w) {
  const double u = std::clamp(w[1], 0.0, 1.0) * n, v = std::clamp(w[2], 0.0, 1.0) * n;
  const int i = std::min(static_cast<int>(u), n - 1), j = std::min(static_cast<int>(v), n - 1 - i);
  const bool turned = i + j + 2 <= n && (u - i) + (v - j) > 1;
  return i * (2 * n - i) + 2 * j + turned;
}

SurfaceMesh divided(const SurfaceMesh& mesh, int n) {
  SurfaceMesh out;
  out.model_nodes = mesh.model_nodes;
  out.vertices = mesh.vertices;
  out.facets = mesh.facets;
  out.planes = mesh.planes;
  std::map<std::array<int, 2>, int> first_on_edge;  // the n - 1 points from the lower to the higher vertex
  const auto add = [&](const Vector3d& x, unsigned char planes) {
    out.vertices.push_back(x);
    if (!mesh.planes.empty()) out.planes.push_back(planes);
    out.model_nodes.push_back(-1);
    return static_cast<int>(out.vertices.size()) - 1;
  };
  const auto parts = part_corners(n);
  std::vector<int> id(at((n + 1) * (n + 1)));
  for (int t = 0; t < mesh.size(); ++t) {
    const auto& corner = mesh.triangles[at(t)];
    const auto on_edge = [&](std::size_t from, std::size_t to, int step) {  // `step` of n along the edge
      const int a = corner[from], b = corner[to], low = std::min(a, b), high = std::max(a, b);
      const auto found = first_on_edge.try_emplace({low, high}, static_cast<int>(out.vertices.size()));
      if (found.second) {
        const Vector3d x = mesh.vertices[at(low)], along = mesh.vertices[at(high)] - x;
        const unsigned char planes =
            mesh.planes.empty() ? 0 : static_cast<unsigned char>(mesh.planes[at(a)] & mesh.planes[at(b)]);
        for (int k = 1; k < n; ++k) add(x + static_cast<double>(k) / n * along, planes);
      }
      return found.first->second + (a < b ? step : n - step) - 1;
    };
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        int& v = id[at(i * (n + 1) + j)];
        if (i == 0 && j == 0)
          v = corner[0];
        else if (i == n)
          v = corner[1];
        else if (j == n)
          v = corner[2];
        else if (j == 0)
          v = on_edge(0, 1, i);
        else if (i == 0)
          v = on_edge(0, 2, j);
        else if (i + j == n)
          v = on_edge(1, 2, j);
        else {
          const Barycentric w = grid_point(n, i, j);
          v = add(w[0] * mesh.corner(t, 0) + w[1] * mesh.corner(t, 1) + w[2] * mesh.corner(t, 2), 0);
        }
      }
    for (const auto& part : parts) {
      std::array<int, 3> triangle;
      for (std::size_t c = 0; c < 3; ++c) triangle[c] = id[at(part[c][0] * (n + 1) + part[c][1])];
      out.triangles.push_back(triangle);
      out.facet.push_back(mesh.facet[at(t)]);
    }
  }
  finish_surface_mesh(out);
  out.bulge.assign(out.triangles.size(), {0, 0, 0});
  return out;
}

double distance_to_segment(const Vector3d& x, const Vector3d& a, const Vector3d& b) {
  const Vector3d ab = b - a;
  const double length2 = ab.squaredNorm();
  const double s = length2 > 0 ? std::clamp((x - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  return (x - (a + s * ab)).norm();
}

std::vector<std::array<int, 3>> edge_neighbours(const std::vector<std::array<int, 3>>& triangles, bool in_pairs,
                                                std::size_t* crowded) {
  struct Side {
    std::uint64_t edge;
    int triangle, k;
  };
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::uint64_t>(triangles[t][at(k)]),
                 b = static_cast<std::uint64_t>(triangles[t][at((k + 1) % 3)]);
      sides.push_back({std::min(a, b) << 32 | std::max(a, b), static_cast<int>(t), k});
    }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle; });
  std::vector<std::array<int, 3>> neighbours(triangles.size(), {-1, -1, -1});
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    while (end < sides.size() && sides[end].edge == sides[i].edge) ++end;
    if (end - i > 2 && crowded != nullptr) ++*crowded;
    if (end - i > 2 && !in_pairs) continue;
    for (; i + 1 < end; i += 2) {
      neighbours[at(sides[i].triangle)][at(sides[i].k)] = sides[i + 1].triangle;
      neighbours[at(sides[i + 1].triangle)][at(sides[i + 1].k)] = sides[i].triangle;
    }
  }
  return neighbours;
}

std::vector<std::vector<int>> vertex_neighbours(std::size_t vertices,
                                                const std::vector<std::array<int, 3>>& triangles) {
  std::vector<std::vector<int>> neighbours(vertices);
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      neighbours[at(t[k])].push_back(t[(k + 1) % 3]);
      neighbours[at(t[(k + 1) % 3])].push_back(t[k]);
    }
  for (std::vector<int>& n : neighbours) {
    std::sort(n.begin(), n.end());
    n.erase(std::unique(n.begin(), n.end()), n.end());
  }
  return neighbours;
}

std::vector<std::array<int, 2>> rim_edges(const std::vector<std::array<int, 3>>& triangles,
                                          const std::vector<std::array<int, 3>>& neighbours) {
  std::vector<std::array<int, 2>> rim;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      if (neighbours[t][k] < 0) rim.push_back({triangles[t][k], triangles[t][(k + 1) % 3]});
  return rim;
}

std::vector<std::array<Vector3d, 2>> rim_segments(const SurfaceMesh& mesh) {
  std::vector<std::array<Vector3d, 2>> rim;
  for (const auto& edge : rim_edges(mesh.triangles, mesh.neighbours))
    rim.push_back({mesh.vertices[at(edge[0])], mesh.vertices[at(edge[1])]});
  return rim;
}

std::vector<char> rim_vertices(std::size_t vertices, const std::vector<std::array<int, 3>>& triangles,
                               const std::vector<std::array<int, 3>>& neighbours) {
  std::vector<char> on_rim(vertices, 0);
  for (const auto& edge : rim_edges(triangles, neighbours)) on_rim[at(edge[0])] = on_rim[at(edge[1])] = 1;
  return on_rim;
}

std::vector<double> rim_distances(const SurfaceMesh& mesh, double reach) {
  const std::vector<std::array<Vector3d, 2>> rim = rim_segments(mesh);
  std::vector<double> distance(mesh.triangles.size(), kInfinity);
  if (rim.empty()) return distance;

  // Rim edges are binned by their midpoints; an edge nearer than cell - longest / 2 lies in a neighbouring cell.
  double longest = 0.0;
  for (int t = 0; t < mesh.size(); ++t)
    for (int k = 0; k < 3; ++k) longest = std::max(longest, (mesh.corner(t, k) - mesh.corner(t, (k + 1) % 3)).norm());
  const double cell = std::max(reach, longest) + 1.5 * longest;
  std::map<GridCell, std::vector<int>> grid;
  for (int i = 0; i < static_cast<int>(rim.size()); ++i)
    grid[grid_cell(0.5 * (rim[at(i)][0] + rim[at(i)][1]), cell)].push_back(i);
  std::vector<double> vertex_distance(mesh.vertices.size(), cell - 0.5 * longest);  // no rim edge within this distance
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const GridCell home = grid_cell(mesh.vertices[v], cell);
    for (long dx = -1; dx <= 1; ++dx)
      for (long dy = -1; dy <= 1; ++dy)
        for (long dz = -1; dz <= 1; ++dz) {
          const auto found = grid.find({home[0] + dx, home[1] + dy, home[2] + dz});
          if (found == grid.end()) continue;
          for (int i : found->second) {
            vertex_distance[v] =
                std::min(vertex_distance[v], distance_to_segment(mesh.vertices[v], rim[at(i)][0], rim[at(i)][1]));
          }
        }
  }
  for (int t = 0; t < mesh.size(); ++t) {
    // distance is 1-Lipschitz: any point of the triangle lies within `size` of the vertex where it is measured
    double bound = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double size = std::max((mesh.corner(t, k) - mesh.corner(t, (k + 1) % 3)).norm(),
                                   (mesh.corner(t, k) - mesh.corner(t, (k + 2) % 3)).norm());
      bound = std::max(bound, vertex_distance[at(mesh.triangles[at(t)][at(k)])] - size);
    }
    distance[at(t)] = bound;
  }
  return distance;
}

SphereFit fit_sphere(const SurfaceMesh& surface) {
  // |x|^2 = 2 c.x + (R^2 - |c|^2) is linear in c and the constant; centred for accuracy.
  const Vector3d shift = surface_extent(surface).centroid;
  Eigen::Matrix4d normal_matrix = Eigen::Matrix4d::Zero();
  Eigen::Vector4d rhs = Eigen::Vector4d::Zero();
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    const Vector3d x = surface.vertices[v] - shift;
    const Eigen::Vector4d row(2 * x.x(), 2 * x.y(), 2 * x.z(), 1.0);
    normal_matrix += surface.vertex_areas[v] * row * row.transpose();
    rhs += surface.vertex_areas[v] * x.squaredNorm() * row;
  }
  const Eigen::Vector4d solution = solve_least_norm(normal_matrix, rhs);
  SphereFit fit;
  fit.center = solution.head<3>() + shift;
  fit.radius = std::sqrt(std::max(0.0, solution[3] + solution.head<3>().squaredNorm()));
  double sum = 0.0, area = 0.0;
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    const double d = (surface.vertices[v] - fit.center).norm() - fit.radius;
    sum += surface.vertex_areas[v] * d * d;
    area += surface.vertex_areas[v];
  }
  fit.rms = area > 0 ? std::sqrt(sum / area) : 0.0;
  return fit;
}

Roundness roundness(const SurfaceMesh& surface, const SphereFit& sphere) {
  constexpr double kMostRms = 0.1;      // of the radius
  constexpr double kFlatRadius = 10.0;  // of the radius of gyration
  constexpr double kLeastAlong = 0.8;   // mean cosine between normals and radii
  if (!(sphere.rms <= kMostRms * sphere.radius)) return Roundness::Uneven;
  if (!(sphere.radius <= kFlatRadius * surface_extent(surface).radius_of_gyration)) return Roundness::Flat;
  double along = 0.0, area = 0.0;
  for (int t = 0; t < surface.size(); ++t) {
    const double a = surface.areas[at(t)];
    along += a * std::abs(surface.normals[at(t)].dot((surface.centroid(t) - sphere.center).normalized()));
    area += a;
  }
  return along >= kLeastAlong * area ? Roundness::Round : Roundness::Flat;
}

double mean_area(const SurfaceMesh& surface) {
  return std::accumulate(surface.areas.begin(), surface.areas.end(), 0.0) / std::max(1, surface.size());
}

SurfaceExtent surface_extent(const SurfaceMesh& surface) {
  SurfaceExtent extent;
  for (int t = 0; t < surface.size(); ++t) {
    extent.centroid += surface.areas[at(t)] * surface.centroid(t);
    extent.area += surface.areas[at(t)];
  }
  if (extent.area <= 0) return extent;
  extent.centroid /= extent.area;
  double sum = 0.0;
  for (int t = 0; t < surface.size(); ++t)
    sum += surface.areas[at(t)] * (surface.centroid(t) - extent.centroid).squaredNorm();
  extent.radius_of_gyration = std::sqrt(sum / extent.area);
  return extent;
}

}  // namespace dea
