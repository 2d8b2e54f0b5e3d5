// large_strain – answers for layers under large strain, as CSV on standard output: a rigid cylinder (plane strain) or
// sphere on a flat layer, a layer on a ball under a rigid flat, one in a socket around a rigid ball, two unlike layers.
// Finite elements of tests/analytic/neo_hookean_layer.h. mm, N (cylinders N/mm), MPa.
//
//     large_strain [cylinder|sphere|curved|two]... [elements through a layer, 8 by default]
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "tests/analytic/neo_hookean_layer.h"

using namespace dea::analytic;

namespace {

constexpr double kThickness = 2;
int through = 8;

/// Elements as wide as high within the undeformed surfaces' intersection, growing ones for 8 layers' thicknesses more.
LayerGrid grid_for(double relative_radius, double depth, double thickness) {
  LayerGrid grid;
  grid.fine_length = std::sqrt(2 * relative_radius * depth) * 1.05 + 0.25 * thickness;
  grid.length = grid.fine_length + 8 * thickness;
  // at least 12 across: the force scatters with where the edge of contact falls between nodes
  grid.fine = std::max(3 * through / 2, static_cast<int>(std::ceil(grid.fine_length / thickness * through)));
  grid.coarse = 2 * through;
  grid.through = through;
  return grid;
}

void print(const char* name, const NeoHookeanLayer& a, double base_radius, double punch_radius,
           const NeoHookeanLayer* b, const std::vector<PressedLayer>& results) {
  for (const PressedLayer& r : results) {
    std::printf("%s,%g,%g,%g,%g,", name, a.nu, a.E, a.thickness, base_radius);
    if (b)
      std::printf("%g,%g,%g,", b->nu, b->E, b->thickness);
    else
      std::printf(",,,");
    std::printf("%g,%.6g,%.5g,%.5g,%.5g,%.4g\n", punch_radius, r.depth, r.force, r.peak_nominal, r.peak_cauchy,
                r.radius);
  }
  std::fflush(stdout);
}

/// One layer; radii 0: flat.
void one(const char* name, bool axisymmetric, double nu, double layer_radius, double punch_radius) {
  NeoHookeanLayer layer;
  layer.nu = nu;
  layer.thickness = kThickness;
  layer.curvature = layer_radius == 0 ? 0 : 1 / layer_radius;
  const double punch = punch_radius == 0 ? 0 : 1 / punch_radius;
  const LayerGrid grid = grid_for(1 / (layer.curvature + punch), 0.2 * kThickness, kThickness);
  print(name, layer, layer_radius, punch_radius, nullptr,
        press_rigid(axisymmetric, layer, punch,
                    {0.05 * kThickness, 0.1 * kThickness, 0.15 * kThickness, 0.2 * kThickness}, grid));
}

}  // namespace

int main(int count, char** arguments) {
  std::string what;
  for (int i = 1; i < count; ++i) {
    if (std::atoi(arguments[i]) > 0)
      through = std::atoi(arguments[i]);
    else
      what += std::string(arguments[i]) + ' ';
  }
  const auto wanted = [&](const char* name) { return what.empty() || what.find(name) != std::string::npos; };
  std::puts("case,nu,E,t,layer_radius,nu_2,E_2,t_2,punch_radius,depth,force,peak_nominal,peak_cauchy,contact_radius");
  try {
    // half widths of about 1, 2 and 4 t at depth 0.2 t by small-strain theory
    const double cylinders[3][4] = {{0.3, 6.5, 22.8, 84.6}, {0.45, 5.3, 18.2, 69.3}, {0.49, 4.6, 14.6, 51.0}};
    if (wanted("cylinder"))
      for (const auto& row : cylinders)
        for (int i = 1; i < 4; ++i) one("cylinder", false, row[0], 0, row[i]);
    const double spheres[4][4] = {
        {0.3, 6.48, 22.9, 85.5}, {0.45, 5.95, 20.4, 75.0}, {0.49, 5.68, 18.8, 64.9}, {0.499, 0, 18.3, 61.1}};
    if (wanted("sphere"))
      for (const auto& row : spheres)
        for (int i = 1; i < 4; ++i)
          if (row[i] > 0) one("sphere", true, row[0], 0, row[i]);
    if (wanted("curved"))
      for (const double nu : {0.3, 0.45, 0.49}) {
        one("ball_on_flat", true, nu, 20, 0);
        one("ball_on_flat", true, nu, 60, 0);
        one("ball_in_socket", true, nu, -20, 15);
        one("ball_in_socket", true, nu, -60, 30);
      }
    if (wanted("two"))
      for (const double radius : {12.0, 25.0, 80.0}) {
        NeoHookeanLayer soft, stiff;  // flat, and on a ball
        soft.E = 5;
        soft.nu = 0.45;
        soft.thickness = 2;
        stiff.E = 20;
        stiff.nu = 0.4;
        stiff.thickness = 1.5;
        stiff.curvature = 1 / radius;
        const double h = soft.thickness + stiff.thickness;
        print("two", stiff, radius, 0, &soft,
              press_layers(true, stiff, soft, {0.05 * h, 0.1 * h}, grid_for(radius, 0.15 * h, stiff.thickness)));
      }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "large_strain: %s\n", e.what());
    return 1;
  }
}
