// The tables of docs/layer_law.md, section 8, that compare the inside of layers with finite elements:
//   inside_tables          prints them
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <string>
#include <vector>

#include "tests/src/inside_cases.h"

namespace dea::test {
namespace {

/// "4, 9": greatest errors of the greatest shear and the first principal strain, in per cent.
std::string cell(const std::array<double, 5>& worst) {
  return std::to_string(std::lround(100 * worst[2])) + ", " + std::to_string(std::lround(100 * worst[3]));
}

/// A row per place of the layer, a column per case.
void print_rows(const std::string& head, const std::vector<ElementCase>& cases) {
  std::vector<analytic::SolvedElements> solved;
  for (const ElementCase& in : cases) solved.emplace_back(in.elements);
  const char* places[] = {"bone", "middle", "surface"};
  for (int h = 0; h < 3; ++h) {
    std::printf("| %s | %s |", h == 0 ? head.c_str() : "", places[h]);
    for (std::size_t i = 0; i < cases.size(); ++i)
      std::printf(" %s |", cell(element_errors(cases[i], solved[i], h * cases[i].elements.through / 2)).c_str());
    std::printf("\n");
  }
}

void round_bones() {
  std::printf("| nu, bone | | t/R = 0 | 0.1 | -0.1 | 0.3 | -0.3 |\n|---|---|---|---|---|---|---|\n");
  for (const double nu : {0.3, 0.45})
    for (const bool sphere : {false, true}) {
      std::vector<ElementCase> cases;
      for (const double k : {0.0, 0.1, -0.1, 0.3, -0.3}) cases.push_back(round_case(nu, k, sphere, 2));
      print_rows(std::to_string(nu).substr(0, 4) + (sphere ? ", sphere" : ", cylinder"), cases);
    }
}

void slopes() {
  constexpr double kBend = 4;
  std::printf("\n| nu | | slope 0.2 | -0.2 | 0.5 | -0.5 |\n|---|---|---|---|---|---|\n");
  for (const double nu : {0.3, 0.45, 0.49}) {
    std::vector<ElementCase> cases;
    for (const double slope : {0.2, -0.2, 0.5, -0.5}) {
      const auto thickness = [=](const Vector3d& x) {
        return x.x() < kBend ? 1.0 : std::max(0.3, 1 + slope * (x.x() - kBend));
      };
      const auto pressure = [](double s) { return bump((s - kBend) / 3); };
      cases.push_back(strip_case(nu, 10, thickness, pressure, false, 150));
      cases.back().from = 1;
      cases.back().to = 7;
    }
    print_rows(std::to_string(nu).substr(0, 4), cases);
  }
}

void free_end() {
  struct Load {
    const char* name;
    double (*pressure)(double s);
  };
  const Load loads[] = {{"fading out", [](double s) { return bump((s - 4) / 4); }},
                        {"a bump", [](double s) { return bump((s - 6.5) / 1.5); }},
                        {"even", [](double) { return 1.0; }}};
  std::printf("\n| nu | load | further than t: bone | middle | within t: bone | middle |\n|---|---|---|---|---|---|\n");
  for (const double nu : {0.3, 0.45})
    for (const Load& load : loads) {
      ElementCase in = strip_case(nu, 8, even(1), load.pressure, true, 120);
      const analytic::SolvedElements solved(in.elements);
      std::printf("| %.2f | %s |", nu, load.name);
      for (const bool near : {false, true}) {
        in.from = near ? 7 : 0;
        in.to = near ? 8 : 7;
        for (const int h : {0, 1})
          std::printf(" %s |", cell(element_errors(in, solved, h * in.elements.through / 2)).c_str());
      }
      std::printf("\n");
    }
}

/// Law less elements, in per cent of the greatest patch: the worst between places of a rim, of some loads.
struct RimErrors {
  static constexpr int kTo[] = {1, 2, 3, 4, 6, 8, 12, 16};  ///< patches
  std::array<double, std::size(kTo)> worst = {};
  void add(const std::array<double, kRimPatches>& law, const std::array<double, kRimPatches>& elements) {
    const double most = *std::max_element(elements.begin(), elements.end());
    std::size_t patch = 0;
    for (std::size_t place = 0; place < worst.size(); ++place)
      for (; patch < static_cast<std::size_t>(kTo[place]); ++patch) {
        const double error = (law[patch] - elements[patch]) / most;
        if (std::abs(error) > std::abs(worst[place])) worst[place] = error;
      }
  }
};

void rims(bool pressure, int row) {
  std::printf(
      "\n| %s, nu | wall | 0 to 0.25 t | to 0.5 | to 0.75 | to 1 | to 1.5 | to 2 | to 3 | to 4 |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n",
      row > 0    ? "shear at 0.26 t"
      : pressure ? "normal stress"
                 : "shear");
  for (const double nu : {0.3, 0.45, 0.49})
    for (const double degrees : {45.0, 70.0, 90.0, 110.0}) {
      RimErrors errors[2];
      for (const RimLoad& load : kRimLoads) {
        const RimCase in{nu, degrees, load.pressure, row};
        const RimPatches law = rim_by_law(in), elements = rim_by_elements(in);
        RimErrors& of = errors[load.up_to_edge ? 0 : 1];
        pressure ? of.add(law.pressure, elements.pressure) : of.add(law.shear, elements.shear);
      }
      std::printf("| %.2f | %.0f |", nu, degrees);
      for (std::size_t k = 0; k < errors[0].worst.size(); ++k)
        std::printf(" %+.0f, %+.0f |", 100 * errors[0].worst[k], 100 * errors[1].worst[k]);
      std::printf("\n");
    }
}

}  // namespace
}  // namespace dea::test

int main() {
  dea::test::round_bones();
  dea::test::slopes();
  dea::test::free_end();
  dea::test::rims(false, 0);
  dea::test::rims(true, 0);
  dea::test::rims(false, 6);
}
