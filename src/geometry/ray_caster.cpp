#include "src/geometry/ray_caster.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "src/base/numbers.h"

namespace dea {

// ---- the tree -------------------------------------------------------------------------------------------------------

namespace {

/// Children of a node: their boxes lie side by side, for the processor to work on them together.
constexpr int kWidth = 4;
using Four = Eigen::Array<double, kWidth, 1>;

/// Boxes are too large by this part of the surface's extent: far more than rounding, far less than a triangle.
constexpr double kPadding = 1e-6;

using Box = Eigen::AlignedBox3d;

}  // namespace

struct RayCaster::Tree {
  struct Node {
    Four bounds[2][3];  // low, high; axis; child
    int child[kWidth];  // a node's number, or ~ a triangle's
    int children;
  };
  std::vector<Node> nodes;  // the root first; none: the surface has no triangles
  Vector3d center;          // of all vertices
  double extent;            // no two points of the surface are farther apart than this
};

namespace {

using Node = RayCaster::Tree::Node;

/// A node takes at least two triangles or nodes, and its range of triangles is halved twice: with 2^31 triangles no
/// branch has more than 16 nodes, of which each leaves at most three children waiting.
constexpr int kMostWaiting = 64;

/// A triangle while the tree is built. What is sorted is small: single precision does, it only says where to split.
struct Item {
  float centroid[3];
  int triangle;
};

class Builder {
 public:
  explicit Builder(const SurfaceMesh& mesh) : mesh_(mesh) {
    items_.reserve(mesh.triangles.size());
    for (int t = 0; t < mesh.size(); ++t) {
      const Vector3d sum = mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2);
      Item item{{}, t};
      for (int axis = 0; axis < 3; ++axis)  // numbers that can be sorted, whatever the vertices are
        item.centroid[axis] = std::isfinite(sum[axis]) ? static_cast<float>(sum[axis]) : 0.0f;
      items_.push_back(item);
    }
    nodes_.reserve(items_.size() / 2 + 1);
    if (!items_.empty()) add(0, items_.size());
  }

  std::vector<Node> take() { return std::move(nodes_); }

 private:
  Box add(std::size_t begin, std::size_t end) {
    const std::size_t own = nodes_.size();
    nodes_.emplace_back();
    std::size_t cuts[kWidth + 1] = {begin, 0, 0, 0, end};
    if (end - begin <= kWidth) {
      for (std::size_t k = 1; k < kWidth; ++k) cuts[k] = std::min(begin + k, end);
    } else {
      cuts[2] = halve(begin, end);
      cuts[1] = halve(begin, cuts[2]);
      cuts[3] = halve(cuts[2], end);
    }
    Box all;
    int children = 0;
    for (std::size_t k = 0; k < kWidth; ++k) {
      if (cuts[k] == cuts[k + 1]) continue;
      Box box;
      int child;
      if (cuts[k + 1] - cuts[k] == 1) {
        const int t = items_[cuts[k]].triangle;
        child = ~t;
        for (int corner = 0; corner < 3; ++corner) box.extend(mesh_.corner(t, corner));
      } else {
        child = static_cast<int>(nodes_.size());
        box = add(cuts[k], cuts[k + 1]);
      }
      all.extend(box);
      Node& node = nodes_[own];
      for (int axis = 0; axis < 3; ++axis) {
        node.bounds[0][axis][children] = box.min()[axis];
        node.bounds[1][axis][children] = box.max()[axis];
      }
      node.child[children++] = child;
    }
    Node& node = nodes_[own];
    node.children = children;
    for (int k = children; k < kWidth; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        node.bounds[0][axis][k] = kInfinity;
        node.bounds[1][axis][k] = -kInfinity;
      }
      node.child[k] = 0;
    }
    return all;
  }

  /// Sorts a range into two halves along its longest side. Where they meet: after a multiple of kWidth triangles, so
  /// that most nodes are full.
  std::size_t halve(std::size_t begin, std::size_t end) {
    const std::size_t count = end - begin;
    if (count <= 1) return end;
    float low[3], high[3];
    std::copy_n(items_[begin].centroid, 3, low);
    std::copy_n(items_[begin].centroid, 3, high);
    for (std::size_t i = begin + 1; i < end; ++i)
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], items_[i].centroid[k]);
        high[k] = std::max(high[k], items_[i].centroid[k]);
      }
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    const std::size_t half = count > kWidth ? (count / 2 + kWidth - 1) / kWidth * kWidth : (count + 1) / 2;
    const auto first = items_.begin() + static_cast<std::ptrdiff_t>(begin);
    std::nth_element(first, first + static_cast<std::ptrdiff_t>(half), first + static_cast<std::ptrdiff_t>(count),
                     [axis](const Item& a, const Item& b) { return a.centroid[axis] < b.centroid[axis]; });
    return begin + half;
  }

  const SurfaceMesh& mesh_;
  std::vector<Item> items_;
  std::vector<Node> nodes_;
};

}  // namespace

RayCaster::RayCaster(SurfaceMesh of) : mesh_(std::make_shared<const SurfaceMesh>(std::move(of))) {
  Box box;
  if (mesh_->vertices.empty()) box.extend(Vector3d(Vector3d::Zero()));
  for (const Vector3d& x : mesh_->vertices) box.extend(x);
  tree_ =
      std::make_shared<const Tree>(Tree{Builder(*mesh_).take(), 0.5 * (box.min() + box.max()), box.diagonal().norm()});
}

namespace {

/// Children that a query has yet to look into, the nearest on top.
class Waiting {
 public:
  void push(double distance, int node) {
    int i = size_++;
    for (; i > floor_ && entries_[i - 1].distance < distance; --i) entries_[i] = entries_[i - 1];
    entries_[i] = {distance, node};
  }
  /// What is pushed from here on lies on top of all that is there.
  void start() { floor_ = size_; }
  bool pop(double* distance, int* node) {
    if (size_ == 0) return false;
    *distance = entries_[--size_].distance;
    *node = entries_[size_].node;
    return true;
  }

 private:
  struct Entry {
    double distance;
    int node;
  };
  Entry entries_[kMostWaiting];
  int size_ = 0, floor_ = 0;
};

// ---- lines ----------------------------------------------------------------------------------------------------------

// A barycentric tolerance: a line that meets the shared edge of two triangles belongs to both.
constexpr double kEdgeTolerance = 1e-9;

struct Candidate {
  double distance;
  SurfacePoint point;
};

/// Möller-Trumbore in double precision. Weights may be down to -kEdgeTolerance.
bool intersect(const SurfaceMesh& mesh, int t, const Vector3d& origin, const Vector3d& direction, double* distance,
               std::array<double, 3>* weights) {
  const Vector3d& a = mesh.corner(t, 0);
  const Vector3d e1 = mesh.corner(t, 1) - a, e2 = mesh.corner(t, 2) - a;
  const Vector3d p = direction.cross(e2);
  const double det = e1.dot(p);
  if (det == 0.0) return false;
  const Vector3d s = origin - a;
  const double u = s.dot(p) / det;
  if (!(u >= -kEdgeTolerance && u <= 1.0 + kEdgeTolerance)) return false;
  const Vector3d q = s.cross(e1);
  const double v = direction.dot(q) / det;
  if (!(v >= -kEdgeTolerance && u + v <= 1.0 + kEdgeTolerance)) return false;
  *distance = e2.dot(q) / det;
  *weights = {1.0 - u - v, u, v};
  return true;
}

}  // namespace

LineHit RayCaster::nearest_facing(const Vector3d& origin, const Vector3d& direction, double from, double limit,
                                  double to, double min_facing) const {
  const Tree& tree = *tree_;
  const SurfaceMesh& mesh = *mesh_;
  thread_local std::vector<Candidate> found;
  LineHit result;
  if (!(from < to) || tree.nodes.empty()) return result;
  found.clear();
  double best = kInfinity, low = from, high = to;  // of what counts: beyond the limit, or, so far, all
  bool beyond = false;                             // the limit something was found
  const double tolerance = 1e-9 * tree.extent;
  const auto look_at = [&](int t) {
    if (!(mesh.normals[at(t)].dot(direction) < -min_facing)) return;
    Candidate c;
    c.point.triangle = t;
    if (!intersect(mesh, t, origin, direction, &c.distance, &c.point.weights)) return;
    if (!(c.distance > from && c.distance < to)) return;
    const bool counts = c.distance > limit;
    if (beyond && !counts) return;
    if (counts && !beyond) {
      beyond = true;
      best = kInfinity;
      low = std::max(from, limit);
    }
    found.push_back(c);
    if (!(std::abs(c.distance) < best)) return;
    best = std::abs(c.distance);
    low = std::max(low, -(best + tolerance));
    if (beyond) high = std::min(high, best + tolerance);
  };

  // Planes of a box that the line meets first and last, per axis; all moved out by the padding.
  const double padding = kPadding * tree.extent + 1e-14 * origin.lpNorm<Eigen::Infinity>();
  double inverse[3], first_origin[3], last_origin[3];
  int first[3];
  for (int k = 0; k < 3; ++k) {
    constexpr double kParallel = 1e-300;  // keeps 0 times infinity out
    inverse[k] = 1.0 / (std::abs(direction[k]) > kParallel ? direction[k] : kParallel);
    first[k] = inverse[k] < 0;
    const double out = first[k] ? -padding : padding;
    first_origin[k] = origin[k] + out;
    last_origin[k] = origin[k] - out;
  }
  Waiting waiting;
  int number = 0;
  double distance = 0;
  do {
    if (distance > std::max(-low, high)) continue;
    const Node& node = tree.nodes[at(number)];
    Four enter = Four::Constant(low), leave = Four::Constant(high);
    for (int axis = 0; axis < 3; ++axis) {
      enter = enter.max((node.bounds[first[axis]][axis] - first_origin[axis]) * inverse[axis]);
      leave = leave.min((node.bounds[1 - first[axis]][axis] - last_origin[axis]) * inverse[axis]);
    }
    waiting.start();
    for (int k = 0; k < node.children; ++k) {
      if (!(enter[k] <= leave[k])) continue;
      if (node.child[k] < 0)
        look_at(~node.child[k]);
      else
        waiting.push(std::max(enter[k], -leave[k]), node.child[k]);
    }
  } while (waiting.pop(&distance, &number));

  for (const Candidate& c : found) {
    if (std::abs(c.distance) > best + tolerance || (beyond && !(c.distance > limit))) continue;
    if (result.point.triangle >= 0 && c.point.triangle > result.point.triangle) continue;
    result.point = c.point;
    result.distance = c.distance;
  }
  return result;
}

// ---- closest points -------------------------------------------------------------------------------------------------

namespace {

/// Closest point of triangle t to x: barycentric weights and squared distance.
double closest_on_triangle(const SurfaceMesh& mesh, int t, const Vector3d& x, std::array<double, 3>* weights) {
  const Vector3d &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
  const Vector3d normal = (b - a).cross(c - a);
  const double twice2 = normal.squaredNorm();
  const double wa = (b - x).cross(c - x).dot(normal) / twice2;
  const double wb = (c - x).cross(a - x).dot(normal) / twice2;
  const double wc = 1.0 - wa - wb;
  if (wa >= 0 && wb >= 0 && wc >= 0) {
    *weights = {wa, wb, wc};
    const double d = (x - a).dot(normal);
    return d * d / twice2;
  }
  double best = kInfinity;
  *weights = {1, 0, 0};
  for (int k = 0; k < 3; ++k) {
    const Vector3d &p = mesh.corner(t, k), &q = mesh.corner(t, (k + 1) % 3);
    const Vector3d pq = q - p;
    const double s = std::clamp((x - p).dot(pq) / pq.squaredNorm(), 0.0, 1.0);
    const double d2 = (x - (p + s * pq)).squaredNorm();
    if (d2 < best) {
      best = d2;
      *weights = {0, 0, 0};
      (*weights)[static_cast<std::size_t>(k)] = 1.0 - s;
      (*weights)[static_cast<std::size_t>((k + 1) % 3)] = s;
    }
  }
  return best;
}

/// Calls `look_at(t)` for all triangles that have a point within `radius` of x, and some others, the near ones early.
/// `radius` may shrink on the way.
template <class LookAt>
void near_to(const RayCaster::Tree& tree, const Vector3d& x, const double& radius, const LookAt& look_at) {
  if (tree.nodes.empty()) return;
  const auto within2 = [&] {
    const double r = radius * (1 + 1e-14) + kPadding * tree.extent;
    return r * r;
  };
  Waiting waiting;
  int number = 0;
  double distance2 = 0;
  do {
    if (distance2 > within2()) continue;
    const Node& node = tree.nodes[at(number)];
    Four child2 = Four::Zero();
    for (int axis = 0; axis < 3; ++axis)
      child2 += (node.bounds[0][axis] - x[axis]).max(x[axis] - node.bounds[1][axis]).max(0.0).square();
    waiting.start();
    for (int k = 0; k < node.children; ++k) {
      if (child2[k] > within2()) continue;
      if (node.child[k] < 0)
        look_at(~node.child[k]);
      else
        waiting.push(child2[k], node.child[k]);
    }
  } while (waiting.pop(&distance2, &number));
}

}  // namespace

SurfacePoint RayCaster::closest(const Vector3d& x) const {
  // Farther away rounding tells no triangles apart, and each would be asked: a point on the way there has the same
  // answer to the digits that are left.
  const Vector3d away = x - tree_->center;
  const double far = 1e9 * tree_->extent, distance = std::min(away.norm(), far);
  const Vector3d from = away.norm() > far ? Vector3d(tree_->center + far * away.normalized()) : x;
  thread_local std::vector<Candidate> found;
  found.clear();
  double best = kInfinity;
  double radius = kInfinity;
  const double tolerance = 1e-12 * tree_->extent + 1e-15 * distance;  // what rounding leaves
  near_to(*tree_, from, radius, [&](int t) {
    Candidate c;
    c.point.triangle = t;
    c.distance = std::sqrt(closest_on_triangle(*mesh_, t, from, &c.point.weights));
    if (c.distance > radius) return;
    found.push_back(c);
    best = std::min(best, c.distance);
    radius = best + tolerance;
  });
  SurfacePoint point;
  for (const Candidate& c : found)
    if (!(c.distance > radius) && (point.triangle < 0 || c.point.triangle < point.triangle)) point = c.point;
  return point;
}

std::vector<int> RayCaster::within(const Vector3d& x, double radius) const {
  std::vector<int> found;
  near_to(*tree_, x, radius, [&](int t) {
    std::array<double, 3> weights;
    if (closest_on_triangle(*mesh_, t, x, &weights) <= radius * radius) found.push_back(t);
  });
  std::sort(found.begin(), found.end());
  return found;
}

Vector3d position(const SurfaceMesh& mesh, const SurfacePoint& p) {
  return p.weights[0] * mesh.corner(p.triangle, 0) + p.weights[1] * mesh.corner(p.triangle, 1) +
         p.weights[2] * mesh.corner(p.triangle, 2);
}

}  // namespace dea
