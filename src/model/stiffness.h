// src/model/stiffness.h – stress per strain of materials at small strain: isotropic, with axes, with fibres.
#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>

namespace dea {

using Eigen::Vector3d;

/// Strains xx, yy, zz, xy, yz, xz with shears as angles (engineering); stresses in the same order.
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

Matrix6d isotropic_stiffness(double E, double nu);

/// A direction in an element, as a material gives it.
struct Direction {
  enum class By {
    Vector,   ///< along `vector`, in the material's axes
    Nodes,    ///< from one node of the element to another
    Element,  ///< each element has its own, or the first of its axes
    Unknown   ///< in a way that is not read
  };
  By by = By::Vector;
  Vector3d vector = Vector3d::UnitX();
  std::array<int, 2> nodes = {0, 1};  ///< places among the element's
};

/// The axes of a material: the first along a, the third across a and d.
struct Axes {
  enum class By { None, Vectors, Nodes, Unknown };
  By by = By::None;
  Vector3d a = Vector3d::UnitX(), d = Vector3d::UnitY();
  std::array<int, 3> nodes = {0, 1, 3};  ///< a: from the first to the second, d: to the third
};

/// Columns: unit axes from a and d; nothing: these lie along each other.
std::optional<Eigen::Matrix3d> axes_from(const Vector3d& a, const Vector3d& d);

/// Fibres, which pull and do not push. Tension per area at a stretch L of theirs:
///     ExpLinear  c0 (exp(c1 (L - 1)) - 1) up to L = c3, from there on with the slope c2
///     ExpPow     2 c2 L^2 (L^2 - 1)^(c1 - 1) exp(c0 (L^2 - 1)^c1), of W = c2/(c0 c1) (exp(c0 (L^2 - 1)^c1) - 1)
struct Fibres {
  enum class Law { ExpLinear, ExpPow, Unknown };
  Law law = Law::Unknown;
  std::array<double, 4> c = {0, 0, 0, 0};
  bool deviatoric = false;  ///< stretch and stress without change of volume: of uncoupled materials
  Direction direction;
};

/// Slope of the tension per strain at a strain >= 0 [MPa].
double fibre_modulus(const Fibres& fibres, double strain);

/// What fibres of this modulus along a unit vector add to a stiffness (stress per strain, as isotropic_stiffness). They
/// resist being shortened, too: linear, as small strain is.
Matrix6d fibre_stiffness(double modulus, bool deviatoric, const Vector3d& along);

/// Three planes of symmetry. Young's moduli, shear moduli 12, 23, 31, Poisson's ratios 12, 23, 31, as FEBio's: v12 =
/// -strain 2 / strain 1 under stress along 1. Nothing: not positive definite. In its own axes.
std::optional<Matrix6d> orthotropic_stiffness(const std::array<double, 3>& E, const std::array<double, 3>& G,
                                              const std::array<double, 3>& nu);

/// A stiffness told in axes (columns of Q) as global axes tell it.
Matrix6d turned_stiffness(const Matrix6d& D, const Eigen::Matrix3d& Q);

}  // namespace dea
