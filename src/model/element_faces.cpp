#include "src/model/element_faces.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <initializer_list>
#include <tuple>

namespace dea {

int facet_corners(int facet_nodes) {
  switch (facet_nodes) {
    case 3:
    case 6:
    case 7:
    case 10:
      return 3;
    case 4:
    case 8:
    case 9:
      return 4;
    default:
      return 0;
  }
}

FaceKey face_key(const int* nodes, int corners) {
  FaceKey key = {-1, -1, -1, -1};
  for (int k = 0; k < corners; ++k) key[at(k)] = nodes[k];
  std::sort(key.begin(), key.end());
  for (std::size_t k = 1; k < 4; ++k)
    if (key[k] == key[k - 1]) key[k - 1] = -1;
  std::sort(key.begin(), key.end());
  return key;
}

FaceKey face_key(const std::vector<int>& facet) {
  return face_key(facet.data(), facet_corners(static_cast<int>(facet.size())));
}

std::size_t FaceKeyHash::operator()(const FaceKey& k) const {
  std::size_t h = 1469598103934665603ull;
  for (int v : k) h = (h ^ static_cast<std::size_t>(v)) * 1099511628211ull;
  return h ^ (h >> 29);
}

std::vector<int> turned_round(std::vector<int> facet) {
  const int count = static_cast<int>(facet.size()), corners = facet_corners(count);
  std::reverse(facet.begin() + 1, facet.begin() + corners);
  if (count >= 2 * corners) std::reverse(facet.begin() + corners, facet.begin() + 2 * corners);
  return facet;
}

std::vector<FacetEdge> facet_edges(const std::vector<std::vector<int>>& facets) {
  std::vector<FacetEdge> edges;
  for (int f = 0; f < static_cast<int>(facets.size()); ++f) {
    const auto& facet = facets[at(f)];
    const int corners = facet_corners(static_cast<int>(facet.size()));
    for (int k = 0; k < corners; ++k) {
      const int a = facet[at(k)], b = facet[at((k + 1) % corners)];
      if (a != b) edges.push_back({std::min(a, b), std::max(a, b), f, k});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const FacetEdge& a, const FacetEdge& b) {
    return std::tie(a.low, a.high, a.facet, a.edge) < std::tie(b.low, b.high, b.facet, b.edge);
  });
  return edges;
}

namespace {

void split_quad(std::array<int, 4> q, const std::vector<Vector3d>& x, FacetTriangles& out) {
  const double d02 = (x[at(q[0])] - x[at(q[2])]).norm(), d13 = (x[at(q[1])] - x[at(q[3])]).norm();
  const bool tie = std::abs(d02 - d13) <= 1e-5 * std::max(d02, d13);
  if (tie ? std::min(q[0], q[2]) < std::min(q[1], q[3]) : d02 < d13) {
    out.push_back({q[0], q[1], q[2]});
    out.push_back({q[0], q[2], q[3]});
  } else {
    out.push_back({q[0], q[1], q[3]});
    out.push_back({q[1], q[2], q[3]});
  }
}

}  // namespace

FacetTriangles split_facet(const int* f, int facet_nodes, const std::vector<Vector3d>& x) {
  FacetTriangles out;
  switch (facet_nodes) {
    case 3:
    case 10:  // cubic: flat through its corners
      out.push_back({f[0], f[1], f[2]});
      break;
    case 4:
      split_quad({f[0], f[1], f[2], f[3]}, x, out);
      break;
    case 6:
      for (const auto& t : {std::array{f[0], f[3], f[5]}, {f[3], f[1], f[4]}, {f[5], f[4], f[2]}, {f[3], f[4], f[5]}})
        out.push_back(t);
      break;
    case 7:
      for (int k = 0; k < 3; ++k) {
        out.push_back({f[k], f[3 + k], f[6]});
        out.push_back({f[3 + k], f[(k + 1) % 3], f[6]});
      }
      break;
    case 8:
      for (int k = 0; k < 4; ++k) out.push_back({f[k], f[4 + k], f[4 + (k + 3) % 4]});
      split_quad({f[4], f[5], f[6], f[7]}, x, out);
      break;
    case 9:
      for (int k = 0; k < 4; ++k) split_quad({f[k], f[4 + k], f[8], f[4 + (k + 3) % 4]}, x, out);
      break;
    default:
      assert(false);
  }
  return out;
}

FacetTriangles split_facet(const std::vector<int>& facet, const std::vector<Vector3d>& x) {
  return split_facet(facet.data(), static_cast<int>(facet.size()), x);
}

Vector3d area_vector(const std::array<int, 3>& t, const std::vector<Vector3d>& x) {
  return (x[at(t[1])] - x[at(t[0])]).cross(x[at(t[2])] - x[at(t[0])]);
}

Vector3d area_vector(const std::vector<int>& facet, const std::vector<Vector3d>& x) {
  Vector3d sum = Vector3d::Zero();
  for (const auto& t : split_facet(facet, x)) sum += area_vector(t, x);
  return sum;
}

}  // namespace dea
