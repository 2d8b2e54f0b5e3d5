#include "src/model/element_faces.h"

#include <algorithm>
#include <cassert>
#include <cmath>

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
  for (int k = 0; k < corners; ++k) key[static_cast<std::size_t>(k)] = nodes[k];
  std::sort(key.begin(), key.end());
  for (std::size_t k = 1; k < 4; ++k)
    if (key[k] == key[k - 1]) key[k - 1] = -1;
  std::sort(key.begin(), key.end());
  return key;
}

std::size_t FaceKeyHash::operator()(const FaceKey& k) const {
  std::size_t h = 1469598103934665603ull;
  for (int v : k) h = (h ^ static_cast<std::size_t>(v)) * 1099511628211ull;
  return h ^ (h >> 29);
}

namespace {

void split_quad(std::array<int, 4> q, const std::vector<Vector3d>& x, std::vector<std::array<int, 3>>& out) {
  const auto at = [&](int i) -> const Vector3d& { return x[static_cast<std::size_t>(q[static_cast<std::size_t>(i)])]; };
  const double d02 = (at(0) - at(2)).norm(), d13 = (at(1) - at(3)).norm();
  bool along_02;
  if (std::abs(d02 - d13) <= 1e-5 * std::max(d02, d13)) {
    along_02 = std::min(q[0], q[2]) < std::min(q[1], q[3]);  // a tie: the diagonal at the lowest node
  } else {
    along_02 = d02 < d13;
  }
  if (along_02) {
    out.push_back({q[0], q[1], q[2]});
    out.push_back({q[0], q[2], q[3]});
  } else {
    out.push_back({q[0], q[1], q[3]});
    out.push_back({q[1], q[2], q[3]});
  }
}

}  // namespace

std::vector<std::array<int, 3>> split_facet(const int* f, int facet_nodes, const std::vector<Vector3d>& x) {
  std::vector<std::array<int, 3>> out;
  switch (facet_nodes) {
    case 3:
    case 10:  // cubic: flat through its corners
      out.push_back({f[0], f[1], f[2]});
      break;
    case 4:
      split_quad({f[0], f[1], f[2], f[3]}, x, out);
      break;
    case 6:
      out = {{f[0], f[3], f[5]}, {f[3], f[1], f[4]}, {f[5], f[4], f[2]}, {f[3], f[4], f[5]}};
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

}  // namespace dea
