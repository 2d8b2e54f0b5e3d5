// layer_bench – what the contact of two bonded layers costs: one line per size. How to read it: README.md.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "src/base/parallel.h"
#include "src/springs/layer_contact.h"
#include "tests/src/layer_meshes.h"

namespace {

using namespace dea;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Least time of some repeats [ms].
template <class Work>
double least_ms(int repeats, const Work& work) {
  double least = 1e300;
  for (int i = 0; i < repeats; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    least = std::min(least, 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return least;
}

/// Two layers of about 2 and 1.5 mm on 20 x 20 mm, n x n facets, pressed by a paraboloid of 80 mm over about 40% of it.
void rung(int n, double nu, LayerFit fit) {
  const SurfaceMesh surface =
      test::grid(n, n, [](double u, double v) { return Vector3d(20 * u - 10, 20 * v - 10, 0.0); });
  const Elasticity cartilage{11.85, nu};
  const auto source_mesh = test::layer_mesh(
                 surface, [](const Vector3d&x) { return 2 + 0.5 * std::sin(0.4 * x.x()); }, test::all(Rim::Free)),
             target_mesh = test::layer_mesh(
                 surface, [](const Vector3d&x) { return 1.5 + 0.4 * std::cos(0.3 * x.y()); },
                 test::all(Rim::Continues));
  const VectorXd overlap =
      test::at_feet(surface, [](const Vector3d& x) { return 0.3 - (x.x() * x.x() + x.y() * x.y()) / (2 * 80.0); });
  test::FootedLayer source(source_mesh, cartilage, fit), target(target_mesh, cartilage, fit);
  const int repeats = std::clamp(60000 / surface.size(), 1, 10);
  const double meshing = least_ms(repeats, [&] {
    test::layer_mesh(
        surface, [](const Vector3d& x) { return 2 + 0.01 * x.x(); }, test::all(Rim::Free));
  });
  const double factorisation = least_ms(repeats, [&] { make_layer_operator(target_mesh, cartilage, fit); });
  LayerContact contact;
  contact.layers = {{&source.layer, &source.feet, {}}, {&target.layer, &target.feet, {}}};
  contact.area = source.areas();
  LayerPressure cold, warm;
  const double solution = least_ms(repeats, [&] { cold = solve_contact(contact, overlap); });
  const double again =
      least_ms(repeats, [&] { warm = solve_contact(contact, overlap.array() + 0.005, cold.pressure); });
  MatrixXd motions(overlap.size(), 6);
  for (int i = 0; i < surface.size(); ++i) {
    const Vector3d x = surface.centroid(i);
    motions.row(i) << 1, x.x(), x.y(), x.x() / 80, x.y() / 80, x.x() * x.y() / 80;
  }
  ActiveRates rates;
  const double derivative = least_ms(repeats, [&] { rates = solve_active(contact, cold.active, motions); });
  fmt::print("{:8} {:6.4f} {:>9} {:9.2f} {:9.2f} {:9.2f} {:5} {:9.2f} {:5} {:9.2f} {:5}  {:8.1e} {}\n", surface.size(),
             nu, name(fit), meshing, factorisation, solution, cold.applications, again, warm.applications, derivative,
             rates.applications, cold.residual, cold.converged ? "" : "not converged");
}

}  // namespace

int main(int argc, char** argv) {
  const auto limit = limit_threads(1);
  const bool smoke = argc > 1 && std::string(argv[1]) == "smoke";
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);  // a line is seen when it is measured
  fmt::print("Contact of two layers, one thread, ms (least of some repeats); app.: applications of the compliance.\n");
  fmt::print("{:>8} {:>6} {:>9} {:>9} {:>9} {:>9} {:>5} {:>9} {:>5} {:>9} {:>5}  {:>8}\n", "feet", "nu", "law", "mesh",
             "factor", "contact", "app.", "warm", "app.", "6 rates", "app.", "residual");
  for (const int n : smoke ? std::vector<int>{10} : std::vector<int>{22, 45, 100, 224, 316})
    for (const double nu : smoke ? std::vector<double>{0.45} : std::vector<double>{0.3, 0.45, 0.49, 0.4999})
      for (const LayerFit fit : {LayerFit::OneTerm, LayerFit::TwoTerms}) rung(n, nu, fit);
  return 0;
}
