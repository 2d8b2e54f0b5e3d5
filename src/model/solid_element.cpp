#include "src/model/solid_element.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "src/base/numbers.h"

namespace dea {

namespace {

using Shape = ElementShape;

/// A polynomial in the element's own coordinates: coefficients and exponents.
struct Term {
  double factor;
  std::array<int, 3> power;
};
using Polynomial = std::vector<Term>;

double power(double x, int n) {
  double product = 1.0;
  while (n-- > 0) product *= x;
  return product;
}

double value_of(const Polynomial& p, const Vector3d& x) {
  double sum = 0.0;
  for (const Term& t : p) sum += t.factor * power(x[0], t.power[0]) * power(x[1], t.power[1]) * power(x[2], t.power[2]);
  return sum;
}

double slope_of(const Polynomial& p, const Vector3d& x, int axis) {
  double sum = 0.0;
  for (const Term& t : p) {
    if (t.power[at(axis)] == 0) continue;
    double product = t.factor * t.power[at(axis)];
    for (int k = 0; k < 3; ++k) product *= power(x[k], t.power[at(k)] - (k == axis ? 1 : 0));
    sum += product;
  }
  return sum;
}

struct GaussPoint {
  Vector3d place;
  double weight;
};

/// A shape in its own coordinates: hexahedra in [-1, 1]^3, prisms a triangle of (0, 0), (1, 0), (0, 1) times [-1, 1],
/// tetrahedra with corners at the origin and the unit points. Nodes' functions: one row of `weights` each, over
/// `basis`.
struct Reference {
  std::vector<Polynomial> basis;
  Eigen::MatrixXd weights;
  std::vector<GaussPoint> points;
  std::vector<Eigen::MatrixXd> slopes;  // of the nodes' functions at each point: nodes x 3
  bool mean_dilatation = false;
};

// ---- where the nodes are --------------------------------------------------------------------------------------------

std::vector<Vector3d> corners_of(Shape shape) {
  switch (shape) {
    case Shape::Hex8:
    case Shape::Hex20:
    case Shape::Hex27:
      return {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}};
    case Shape::Penta6:
    case Shape::Penta15:
      return {{0, 0, -1}, {1, 0, -1}, {0, 1, -1}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    default:
      return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  }
}

/// Corners; nodes on edges half-way, as the faces tell; then centres of faces and of the element, FEBio's order.
std::vector<Vector3d> places_of(Shape shape) {
  std::vector<Vector3d> places = corners_of(shape);
  places.resize(at(nodes_per_element(shape)), Vector3d::Constant(kNaN));
  const auto middle = [&](std::initializer_list<int> of) {
    Vector3d sum = Vector3d::Zero();
    for (int k : of) sum += places[at(k)] / static_cast<double>(of.size());
    return sum;
  };
  for (const std::vector<int>& face : element_faces(shape)) {
    const std::size_t n = face.size() < 6 ? face.size() : face.size() / 2;
    for (std::size_t k = n; k < 2 * n && k < face.size(); ++k)
      places[at(face[k])] = middle({face[k - n], face[(k - n + 1) % n]});
  }
  if (shape == Shape::Hex27) {
    places[20] = middle({0, 1, 5, 4});
    places[21] = middle({1, 2, 6, 5});
    places[22] = middle({2, 3, 7, 6});
    places[23] = middle({3, 0, 4, 7});
    places[24] = middle({0, 1, 2, 3});
    places[25] = middle({4, 5, 6, 7});
    places[26] = Vector3d::Zero();
  } else if (shape == Shape::Tet15) {
    places[10] = middle({0, 1, 2});
    places[11] = middle({0, 1, 3});
    places[12] = middle({1, 2, 3});
    places[13] = middle({0, 2, 3});
    places[14] = middle({0, 1, 2, 3});
  }
  return places;
}

// ---- what the displacements are made of -----------------------------------------------------------------------------

std::vector<Polynomial> basis_of(Shape shape) {
  std::vector<Polynomial> basis;
  const auto add = [&](int i, int j, int k) { basis.push_back({{1.0, {i, j, k}}}); };
  const auto add_up_to = [&](int degree) {
    for (int i = 0; i <= degree; ++i)
      for (int j = 0; i + j <= degree; ++j)
        for (int k = 0; i + j + k <= degree; ++k) add(i, j, k);
  };
  const Polynomial all_four = {{1, {1, 1, 1}}, {-1, {2, 1, 1}}, {-1, {1, 2, 1}}, {-1, {1, 1, 2}}};
  switch (shape) {
    case Shape::Hex8:
    case Shape::Hex20:
    case Shape::Hex27: {
      const int most = shape == Shape::Hex8 ? 1 : 2;
      for (int i = 0; i <= most; ++i)
        for (int j = 0; j <= most; ++j)
          for (int k = 0; k <= most; ++k)
            if (shape != Shape::Hex20 || (i == 2) + (j == 2) + (k == 2) <= 1) add(i, j, k);
      break;
    }
    case Shape::Penta6:
    case Shape::Penta15: {
      const int most = shape == Shape::Penta6 ? 1 : 2;
      for (int i = 0; i <= most; ++i)
        for (int j = 0; i + j <= most; ++j)
          for (int k = 0; k <= most; ++k)
            if (k < 2 || i + j <= 1) add(i, j, k);
      break;
    }
    case Shape::Tet10:
    case Shape::Tet15:
      add_up_to(2);
      if (shape == Shape::Tet10) break;
      basis.push_back({{1, {1, 1, 0}}, {-1, {2, 1, 0}}, {-1, {1, 2, 0}}, {-1, {1, 1, 1}}});
      basis.push_back({{1, {1, 0, 1}}, {-1, {2, 0, 1}}, {-1, {1, 1, 1}}, {-1, {1, 0, 2}}});
      basis.push_back({{1, {0, 1, 1}}, {-1, {1, 1, 1}}, {-1, {0, 2, 1}}, {-1, {0, 1, 2}}});
      add(1, 1, 1);
      basis.push_back(all_four);
      break;
    default:
      add_up_to(1);
  }
  return basis;
}

// ---- points of integration ------------------------------------------------------------------------------------------

std::vector<std::array<double, 2>> gauss(int points) {
  if (points == 2) return {{-1 / std::sqrt(3.0), 1.0}, {1 / std::sqrt(3.0), 1.0}};
  if (points == 3) return {{-std::sqrt(0.6), 5.0 / 9}, {0.0, 8.0 / 9}, {std::sqrt(0.6), 5.0 / 9}};
  const double a = std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(1.2)), b = std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(1.2));
  const double wa = (18 + std::sqrt(30.0)) / 36, wb = (18 - std::sqrt(30.0)) / 36;
  return {{-b, wb}, {-a, wa}, {a, wa}, {b, wb}};
}

std::vector<GaussPoint> points_of(Shape shape) {
  std::vector<GaussPoint> points;
  const auto in_hex = [&](int n) {
    for (const auto& x : gauss(n))
      for (const auto& y : gauss(n))
        for (const auto& z : gauss(n)) points.push_back({{x[0], y[0], z[0]}, x[1] * y[1] * z[1]});
  };
  const auto half = [](double x) { return 0.5 * (1 + x); };  // [-1, 1] to [0, 1]
  switch (shape) {
    case Shape::Hex8:
    case Shape::Hex20:
      in_hex(2);
      break;
    case Shape::Hex27:
      in_hex(3);
      break;
    case Shape::Penta6:
      for (const auto& t : gauss(2))
        for (const auto& r : {std::array<double, 2>{1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6}, {1.0 / 6, 2.0 / 3}})
          points.push_back({{r[0], r[1], t[0]}, t[1] / 6});
      break;
    case Shape::Penta15:  // a triangle as a square with one side drawn together
      for (const auto& t : gauss(3))
        for (const auto& u : gauss(3))
          for (const auto& v : gauss(3))
            points.push_back(
                {{half(u[0]), half(v[0]) * (1 - half(u[0])), t[0]}, t[1] * u[1] * v[1] / 4 * (1 - half(u[0]))});
      break;
    case Shape::Tet4:
      points.push_back({Vector3d::Constant(0.25), 1.0 / 6});
      break;
    case Shape::Tet10: {
      const double a = (5 + 3 * std::sqrt(5.0)) / 20, b = (5 - std::sqrt(5.0)) / 20;
      for (const Vector3d& x : {Vector3d(b, b, b), Vector3d(a, b, b), Vector3d(b, a, b), Vector3d(b, b, a)})
        points.push_back({x, 1.0 / 24});
      break;
    }
    default:
      for (const auto& u : gauss(4))
        for (const auto& v : gauss(4))
          for (const auto& w : gauss(4)) {
            const double x = half(u[0]), y = half(v[0]) * (1 - x), z = half(w[0]) * (1 - x - y);
            points.push_back({{x, y, z}, u[1] * v[1] * w[1] / 8 * (1 - x) * (1 - x - y)});
          }
  }
  return points;
}

Reference make_reference(Shape shape) {
  Reference r;
  r.basis = basis_of(shape);
  const std::vector<Vector3d> places = places_of(shape);
  const auto n = static_cast<Eigen::Index>(places.size());
  Eigen::MatrixXd at_nodes(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) at_nodes(i, j) = value_of(r.basis[at(i)], places[at(j)]);
  r.weights = at_nodes.inverse();
  r.points = points_of(shape);
  for (const GaussPoint& g : r.points) {
    Eigen::MatrixXd slopes(n, 3);
    for (Eigen::Index i = 0; i < n; ++i)
      for (int k = 0; k < 3; ++k) slopes(i, k) = slope_of(r.basis[at(i)], g.place, k);
    r.slopes.push_back(r.weights * slopes);
  }
  r.mean_dilatation = shape == Shape::Hex8 || shape == Shape::Penta6;
  return r;
}

const Reference& reference_of(Shape shape) {
  static const std::vector<Reference> all = [] {
    std::vector<Reference> made(element_types().size());
    for (const ElementType& type : element_types())
      if (type.kind == ElementKind::Solid && has_stiffness(type.shape) && type.shape != Shape::Pyra5)
        made[static_cast<std::size_t>(type.shape)] = make_reference(type.shape);
    return made;
  }();
  return all[static_cast<std::size_t>(shape)];
}

/// Strains per displacement from the functions' gradients (nodes x 3).
Eigen::Matrix<double, 6, Eigen::Dynamic> strains(const Eigen::MatrixXd& gradient) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> B = Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, 3 * gradient.rows());
  for (Eigen::Index i = 0; i < gradient.rows(); ++i) {
    const double x = gradient(i, 0), y = gradient(i, 1), z = gradient(i, 2);
    B.middleCols<3>(3 * i) << x, 0, 0, 0, y, 0, 0, 0, z, y, x, 0, 0, z, y, z, 0, x;
  }
  return B;
}

}  // namespace

bool has_stiffness(ElementShape shape) {
  return element_type(shape).kind == ElementKind::Solid && shape != Shape::Tet5 && shape != Shape::Tet20 &&
         shape != Shape::Pyra13;
}

std::vector<ElementPoint> element_points(ElementShape shape, const std::vector<Vector3d>& nodes) {
  if (shape == Shape::Pyra5) {  // FEBio's: a hexahedron whose upper face is drawn together
    std::vector<ElementPoint> points =
        element_points(Shape::Hex8, {nodes[0], nodes[1], nodes[2], nodes[3], nodes[4], nodes[4], nodes[4], nodes[4]});
    for (ElementPoint& p : points) {
      for (int k = 5; k < 8; ++k) p.strain.middleCols<3>(12) += p.strain.middleCols<3>(3 * k);
      p.strain.conservativeResize(Eigen::NoChange, 15);
    }
    return points;
  }
  const Reference& reference = reference_of(shape);
  const auto n = static_cast<Eigen::Index>(nodes.size());
  Eigen::Matrix<double, 3, Eigen::Dynamic> x(3, n);
  for (Eigen::Index i = 0; i < n; ++i) x.col(i) = nodes[at(i)];
  std::vector<ElementPoint> points;
  double volume = 0.0;
  Eigen::RowVectorXd dilatation = Eigen::RowVectorXd::Zero(3 * n);
  for (std::size_t i = 0; i < reference.points.size(); ++i) {
    const Eigen::MatrixXd& local = reference.slopes[i];
    const Eigen::Matrix3d jacobian = x * local;  // dx / d xi
    ElementPoint point;
    point.volume = jacobian.determinant() * reference.points[i].weight;
    point.strain = strains(local * jacobian.inverse());
    volume += point.volume;
    dilatation += point.volume * point.strain.topRows<3>().colwise().sum();
    points.push_back(std::move(point));
  }
  if (reference.mean_dilatation)
    for (ElementPoint& point : points) {
      const Eigen::RowVectorXd more = (dilatation / volume - point.strain.topRows<3>().colwise().sum()) / 3;
      point.strain.topRows<3>().rowwise() += more;
    }
  return points;
}

Eigen::MatrixXd element_stiffness(const std::vector<ElementPoint>& points, const Matrix6d& D, double of_volume) {
  Matrix6d rest = D;
  rest.topLeftCorner<3, 3>().array() -= of_volume;
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(points.front().strain.cols(), points.front().strain.cols());
  for (const ElementPoint& p : points) K += p.volume * p.strain.transpose() * rest * p.strain;
  return K;
}

}  // namespace dea
