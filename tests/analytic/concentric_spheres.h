// tests/analytic/concentric_spheres.h – a rigid ball in a concentric hemispherical socket: the answer on paper.
//
// The ball's centre has moved by u towards the pole. Springs stand on a sphere of radius `foot_radius` of the source
// body; their rays end on a sphere of radius `end_radius` of the other one. When both bodies are concentric every
// spring is at its rest length h, so the overlap at the polar angle theta (seen from the centre of the source) is
//   socket as source:  u cos(theta) + sqrt(R^2 - u^2 sin^2(theta)) - R
//   ball as source:    u cos(theta) - sqrt(R^2 - u^2 sin^2(theta)) + R        with R = end_radius
// docs/theory.md, section 7, derives this and the closed form of the force.  mm, N, MPa.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>

namespace dea::analytic {

inline constexpr double kPi = 3.14159265358979323846;

/// Confined (aggregate) modulus (S3).
inline double confined_modulus(double E, double nu) { return E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)); }

/// Integral of f over [a, b] by Simpson's rule with 2n intervals.
inline double simpson(const std::function<double(double)>& f, double a, double b, int n = 1000) {
  const double width = (b - a) / (2 * n);
  double sum = f(a) + f(b);
  for (int i = 1; i < 2 * n; ++i) sum += (i % 2 == 1 ? 4 : 2) * f(a + i * width);
  return sum * width / 3;
}

/// Where the rising function f takes the value `target`, between a and b, by bisection.
inline double bisect(const std::function<double(double)>& f, double target, double a, double b) {
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (a + b);
    (f(middle) < target ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

struct ConcentricSpheres {
  enum class Source { Socket, Ball };
  Source source = Source::Socket;
  double foot_radius = 20;  ///< sphere on which the springs stand: its area carries the pressure
  double end_radius = 20;   ///< sphere of the other body on which the rays end
  double rest_length = 4;   ///< thickness of both layers together
  double modulus = confined_modulus(11.85, 0.45);

  double overlap(double theta, double u) const {
    const double across = u * std::sin(theta), rest = std::sqrt(end_radius * end_radius - across * across) - end_radius;
    return u * std::cos(theta) + (source == Source::Socket ? rest : -rest);
  }
  /// Polar angle up to which the surfaces overlap; in space this is the plane half-way between the two centres.
  double contact_angle(double u) const { return std::acos((source == Source::Socket ? 1 : -1) * u / (2 * end_radius)); }
  /// Linear law; zero where the surfaces are apart.
  double pressure(double theta, double u) const { return std::max(0.0, modulus * overlap(theta, u) / rest_length); }
  /// Force along the axis for any law p(e), by quadrature. e: overlap / rest length.
  double force(double u, const std::function<double(double)>& law) const {
    const double area = 2 * kPi * foot_radius * foot_radius;
    return simpson(
               [&](double theta) { return law(overlap(theta, u) / rest_length) * std::cos(theta) * std::sin(theta); },
               0, contact_angle(u)) *
           area;
  }
  /// Force along the axis for the linear law: 2 pi A^2 M u / (3 h) (1 -+ 3 u / (8 R)), exact.
  double force(double u) const {
    const double sign = source == Source::Socket ? -1 : 1;
    return 2 * kPi * foot_radius * foot_radius * modulus * u / (3 * rest_length) *
           (1 + sign * 3 * u / (8 * end_radius));
  }
  /// Motion u under a force, linear law.
  double motion(double applied) const {
    return bisect([this](double u) { return force(u); }, applied, 0, end_radius);
  }
  /// Pressure at the pole under a force, linear law.
  double peak_pressure(double applied) const { return modulus * motion(applied) / rest_length; }
  /// The same for a force so small that the motion does not matter: 3 F / (2 pi A^2).
  double small_load_peak_pressure(double applied) const { return 3 * applied / (2 * kPi * foot_radius * foot_radius); }
};

/// The two models of samples/spheres with articular springs on either side.
inline ConcentricSpheres one_layer_socket() { return {ConcentricSpheres::Source::Socket, 20, 20}; }
inline ConcentricSpheres one_layer_ball() { return {ConcentricSpheres::Source::Ball, 20, 20}; }
inline ConcentricSpheres two_layers_socket() { return {ConcentricSpheres::Source::Socket, 22, 22}; }
inline ConcentricSpheres two_layers_ball() { return {ConcentricSpheres::Source::Ball, 22, 22}; }
/// Bone variant: the same for one and for two layers.
inline ConcentricSpheres bone_socket() { return {ConcentricSpheres::Source::Socket, 24, 20}; }
inline ConcentricSpheres bone_ball() { return {ConcentricSpheres::Source::Ball, 20, 24}; }

}  // namespace dea::analytic
