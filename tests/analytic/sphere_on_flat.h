// tests/analytic/sphere_on_flat.h – a rigid sphere on a flat layer, and the same tied by ligaments: answers on paper.
// docs/theory.md, section 7, derives them.  mm, N, MPa, linear law.
#pragma once
#include <cmath>

#include "tests/analytic/concentric_spheres.h"

namespace dea::analytic {

/// Sphere pressed `depth` deep into a layer bonded to a flat rigid base (samples/sphere_on_flat).
struct SphereOnFlat {
  double radius = 25;
  double thickness = 2;
  double modulus = confined_modulus(11.85, 0.45);

  /// Springs stand on the flat layer: its overlap with the sphere is a spherical cap.
  double force_from_layer(double depth) const {
    return modulus / thickness * kPi * depth * depth * (3 * radius - depth) / 3;
  }
  /// Springs stand on the sphere.
  double force_from_sphere(double depth) const { return modulus / thickness * kPi * radius * depth * depth; }
  /// Area in contact, on the surface that carries the springs.
  double area_on_layer(double depth) const { return kPi * depth * (2 * radius - depth); }
  double area_on_sphere(double depth) const { return 2 * kPi * radius * depth; }
  double peak_pressure(double depth) const { return modulus * depth / thickness; }
};

/// A condyle on a plateau (samples/ligament): by symmetry it only sinks, and the contact carries the load and what the
/// ligaments add to it.
struct CondyleWithLigaments {
  SphereOnFlat contact;
  double half_width = 6;    ///< horizontal distance between the insertions of one ligament
  double height = 45;       ///< vertical distance between them before loading
  double free_length = 44;  ///< of a ligament
  double stiffness = 50;    ///< of each of the two ligaments [N/mm]
  double tether = 40;       ///< of each tether [N/mm]; only the upper one gets taut

  double ligament_length(double depth) const { return std::hypot(half_width, height - depth); }
  double ligament_tension(double depth) const { return stiffness * (ligament_length(depth) - free_length); }
  /// What the contact must carry at this depth.
  double demand(double load, double depth) const {
    return load + 2 * ligament_tension(depth) * (height - depth) / ligament_length(depth) - tether * depth;
  }
  double depth_from_layer(double load) const {
    return bisect([&](double d) { return contact.force_from_layer(d) - demand(load, d); }, 0, 0, 1);
  }
  double depth_from_sphere(double load) const {
    return bisect([&](double d) { return contact.force_from_sphere(d) - demand(load, d); }, 0, 0, 1);
  }
};

}  // namespace dea::analytic
