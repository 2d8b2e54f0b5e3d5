#include <febiodea/model/element_faces.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace dea {

namespace {

using Faces = std::vector<std::vector<int>>;

const Faces kHex8 = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {0, 3, 2, 1}, {4, 5, 6, 7}};
const Faces kHex20 = {{0, 1, 5, 4, 8, 17, 12, 16},  {1, 2, 6, 5, 9, 18, 13, 17}, {2, 3, 7, 6, 10, 19, 14, 18},
                      {3, 0, 4, 7, 11, 16, 15, 19}, {0, 3, 2, 1, 11, 10, 9, 8},  {4, 5, 6, 7, 12, 13, 14, 15}};
const Faces kPenta6 = {{0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}, {0, 2, 1}, {3, 4, 5}};
const Faces kPenta15 = {{0, 1, 4, 3, 6, 13, 9, 12},
                        {1, 2, 5, 4, 7, 14, 10, 13},
                        {2, 0, 3, 5, 8, 12, 11, 14},
                        {0, 2, 1, 8, 7, 6},
                        {3, 4, 5, 9, 10, 11}};
const Faces kTet4 = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 2, 1}};
const Faces kTet10 = {{0, 1, 3, 4, 8, 7}, {1, 2, 3, 5, 9, 8}, {2, 0, 3, 6, 7, 9}, {0, 2, 1, 6, 5, 4}};
const Faces kPyra5 = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {0, 3, 2, 1}};
const Faces kPyra13 = {
    {0, 1, 4, 5, 10, 9}, {1, 2, 4, 6, 11, 10}, {2, 3, 4, 7, 12, 11}, {3, 0, 4, 8, 9, 12}, {0, 3, 2, 1, 8, 7, 6, 5}};
const Faces kTri3 = {{0, 1, 2}};
const Faces kTri6 = {{0, 1, 2, 3, 4, 5}};
const Faces kQuad4 = {{0, 1, 2, 3}};
const Faces kQuad8 = {{0, 1, 2, 3, 4, 5, 6, 7}};
const Faces kQuad9 = {{0, 1, 2, 3, 4, 5, 6, 7, 8}};
const Faces kNone = {};

}  // namespace

const Faces& element_faces(ElementShape shape) {
  switch (shape) {
    case ElementShape::Hex8:
      return kHex8;
    case ElementShape::Hex20:
    case ElementShape::Hex27:
      return kHex20;  // the face-centre nodes of a hex27 are left out: they may be in any order
    case ElementShape::Penta6:
      return kPenta6;
    case ElementShape::Penta15:
      return kPenta15;
    case ElementShape::Tet4:
    case ElementShape::Tet5:
      return kTet4;
    case ElementShape::Tet10:
    case ElementShape::Tet15:
      return kTet10;
    case ElementShape::Tet20:
      return kTet4;  // corners only: a cubic face is taken as its flat triangle
    case ElementShape::Pyra5:
      return kPyra5;
    case ElementShape::Pyra13:
      return kPyra13;
    case ElementShape::Tri3:
      return kTri3;
    case ElementShape::Tri6:
      return kTri6;
    case ElementShape::Quad4:
      return kQuad4;
    case ElementShape::Quad8:
      return kQuad8;
    case ElementShape::Quad9:
      return kQuad9;
    case ElementShape::Line2:
    case ElementShape::Line3:
      return kNone;
  }
  assert(false);
  return kNone;
}

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
  if (std::abs(d02 - d13) <= 1e-9 * std::max(d02, d13)) {
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
