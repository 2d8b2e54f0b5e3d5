// src/model/stiffness.h – stress per strain of materials at small strain: isotropic, with axes, with fibres.
#pragma once
#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dea {

using Eigen::Vector3d;

/// Strains xx, yy, zz, xy, yz, xz with shears as angles (engineering); stresses in the same order.
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

Matrix6d isotropic_stiffness(double E, double nu);
Matrix6d lame_stiffness(double G, double lambda);

/// A direction in an element, as a material gives it.
struct Direction {
  enum class By {
    Vector,       ///< along `vector`, in the material's axes
    Nodes,        ///< from one node of the element to another
    Cylindrical,  ///< `vector`, turned as x is turned to the line from the axis through `center` to the place
    Spherical,    ///< `vector`, turned as x is turned to the line from `center` to the place
    Element,      ///< each element has its own, or the first of its axes
    Unknown       ///< in a way that is not read
  };
  By by = By::Vector;
  Vector3d vector = Vector3d::UnitX();
  std::array<int, 2> nodes = {0, 1};  ///< places among the element's
  Vector3d center = Vector3d::Zero(), axis = Vector3d::UnitZ();
  std::string map = {};  ///< of Element: the name of its data, if they have one
};

/// The axes of a material: the first along a, the third across a and d.
struct Axes {
  enum class By { Vectors, Nodes, Cylindrical, Spherical, Element, Unknown };
  By by = By::Vectors;
  Vector3d a = Vector3d::UnitX(), d = Vector3d::UnitY();  ///< Cylindrical, Spherical: a alone, turned as a Direction
  std::array<int, 3> nodes = {0, 1, 3};  ///< a: from the first to the second, d: to the third; two alike: FEBio's d
  Vector3d center = Vector3d::Zero(), axis = Vector3d::UnitZ();
};

/// Along a direction at a place: Vector, Cylindrical and Spherical as FEBio has them; nothing: another way, or no
/// direction there.
std::optional<Vector3d> direction_at(const Direction& direction, const Vector3d& place);

/// The axes at a place, as columns: Vectors, Cylindrical and Spherical; nothing: as above.
std::optional<Eigen::Matrix3d> axes_at(const Axes& axes, const Vector3d& place);

/// Columns: unit axes from a and d; nothing: these lie along each other.
std::optional<Eigen::Matrix3d> axes_from(const Vector3d& a, const Vector3d& d);

/// Fibres, which pull and do not push. Tension per area at a stretch L of theirs:
///     ExpLinear     c0 (exp(c1 (L - 1)) - 1) up to L = c3, from there on with the slope c2
///     ExpPow        2 c2 L^2 x^(c1 - 1) exp(c0 x^c1) with x = L^2 - c3^2, from L = c3 on
///     ExpPowLinear  ExpPow from L = 1 up to L = c3, from there on 2 b L^2 - c2 L; its ksi and b such that tension and
///                   slope have no step there
///     Logarithmic   c0 ln(L/c3), from L = c3 on
struct Fibres {
  enum class Law { ExpLinear, ExpPow, ExpPowLinear, Logarithmic, Unknown };
  Law law = Law::Unknown;
  std::array<double, 4> c = {0, 0, 0, 1};
  bool deviatoric = false;  ///< stretch and stress without change of volume: of uncoupled materials
  Direction direction;
  std::vector<Axes> axes = {};  ///< in which the direction is told: each in those before it; none: global
  double share = 1.0;           ///< of what the law gives: of viscoelastic materials in the long term
  std::string path = {};        ///< which of a mixture's they are, as data of elements name them: "solid[1]"
  /// Of fibres that lie in many directions: what they add per modulus, in their axes.
  std::optional<Matrix6d> spread = {};
};

/// Slope of the tension per strain at a strain >= 0 [MPa].
double fibre_modulus(const Fibres& fibres, double strain);

/// What fibres of this modulus along a unit vector add to a stiffness (stress per strain, as isotropic_stiffness). They
/// resist being shortened, too: linear, as small strain is. `even`: they are stretched by this times the change of
/// volume, too, and pull as much in all directions.
Matrix6d fibre_stiffness(double modulus, bool deviatoric, const Vector3d& along, double even = 0.0);

/// Three planes of symmetry. Young's moduli, shear moduli 12, 23, 31, Poisson's ratios 12, 23, 31, as FEBio's: v12 =
/// -strain 2 / strain 1 under stress along 1. Nothing: not positive definite. In its own axes.
std::optional<Matrix6d> orthotropic_stiffness(const std::array<double, 3>& E, const std::array<double, 3>& G,
                                              const std::array<double, 3>& nu);

/// What is left of a stiffness without change of volume and pressure.
Matrix6d deviatoric_stiffness(const Matrix6d& D);

/// What a fluid that cannot get away adds to a drained stiffness: the pressure that makes its isotropic mean (Voigt's)
/// one of Poisson's ratio `nu`.
Matrix6d trapped_fluid_stiffness(const Matrix6d& drained, double nu);

/// Mean over directions of what fibres of modulus 1 along them add, weighted by their density: over the sphere, or
/// over directions in the plane of the first two axes.
Matrix6d spread_of(const std::function<double(const Vector3d&)>& density, bool in_plane, bool deviatoric);

/// A stiffness told in axes (columns of Q) as global axes tell it.
Matrix6d turned_stiffness(const Matrix6d& D, const Eigen::Matrix3d& Q);

/// A stiffness in axes: each in those before it; none: global.
struct StiffnessInAxes {
  Matrix6d D = Matrix6d::Zero();
  std::vector<Axes> axes = {};
};

}  // namespace dea
