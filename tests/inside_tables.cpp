// The tables of docs/layer_law.md, section 8, that compare the inside of layers with finite elements:
//   inside_tables          prints them
#include <cstdio>
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

}  // namespace
}  // namespace dea::test

int main() {
  dea::test::round_bones();
  dea::test::slopes();
  dea::test::free_end();
}
