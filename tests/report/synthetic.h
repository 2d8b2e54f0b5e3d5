// tests/report/synthetic.h – results made up for reports: a dome of n x n quads, pressures that wander over it.
#pragma once
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "io/results/result_file.h"

namespace dea::test {

struct Dome {
  std::string surface = "dome", material = "bone";
  int n = 8;             ///< facets along each side
  double size = 20.0;    ///< of its square, centred at 0
  double radius = 25.0;  ///< of its sphere
};

/// Facets of a field at (x, y) of their centre and time t.
using Field = std::function<double(double x, double y, double t)>;

inline ResultFile make_dome_result(const std::string& path, const std::string& label, const Dome& dome,
                                   const std::vector<double>& times,
                                   const std::vector<std::pair<std::string, Field>>& fields) {
  ResultFile result;
  result.path = path;
  result.label = label;
  result.xplt.software = "made up";
  result.xplt.units = "mm-N-s";
  const int n = dome.n;
  XpltMesh mesh;
  const auto x_of = [&](double i) { return dome.size * (i / n - 0.5); };
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const double x = x_of(i), y = x_of(j);
      mesh.node_ids.push_back(static_cast<int>(mesh.node_ids.size()) + 1);
      for (double c : {x, y, std::sqrt(dome.radius * dome.radius - x * x - y * y) - dome.radius})
        mesh.coordinates.push_back(static_cast<float>(c));
    }
  }
  mesh.parts = {dome.material};
  XpltDomain shells;
  shells.element_type = 3;
  shells.name = "shells";
  XpltFacets facets;
  facets.name = dome.surface;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = i + (n + 1) * j;
      for (int node : {a, a + 1, a + n + 2, a + n + 1}) {
        facets.nodes.push_back(node);
        shells.nodes.push_back(node);
      }
      facets.begin.push_back(static_cast<int>(facets.nodes.size()));
      shells.element_ids.push_back(static_cast<int>(shells.element_ids.size()) + 1);
    }
  }
  mesh.surfaces = {facets};
  mesh.domains = {shells};
  result.xplt.meshes = {mesh};
  for (const auto& field : fields)
    result.xplt.variables.push_back(XpltVariable{XpltGroup::Surface, XpltType::Float, XpltFormat::Item, field.first});
  for (double t : times) {
    XpltState state;
    state.time = static_cast<float>(t);
    state.variables.resize(fields.size());
    for (std::size_t f = 0; f < fields.size(); ++f) {
      XpltRegion region;
      region.region = 1;
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
          region.values.push_back(static_cast<float>(fields[f].second(x_of(i + 0.5), x_of(j + 0.5), t)));
      state.variables[f].push_back(std::move(region));
    }
    result.xplt.states.push_back(std::move(state));
  }
  return result;
}

/// A round contact that wanders and grows. `noise`: like the checkerboards of finite elements, 0 none.
inline Field wandering(double peak, double width, double noise) {
  return [=](double x, double y, double t) {
    const double cx = 4.0 * std::cos(3.0 * t), cy = 4.0 * std::sin(3.0 * t), r = std::hypot(x - cx, y - cy) / width;
    const double p = t * peak * (1.0 - r * r);
    if (p <= 0) return 0.0;
    // a hash of the place: the same in every run
    std::uint32_t h = static_cast<std::uint32_t>(std::lround(1e3 * x)) * 73856093u ^
                      static_cast<std::uint32_t>(std::lround(1e3 * y)) * 19349663u ^
                      static_cast<std::uint32_t>(std::lround(1e3 * t)) * 83492791u;
    h = (h ^ (h >> 13)) * 1274126177u;
    h ^= h >> 16;
    return p * (1.0 + noise * (h / 4294967295.0 - 0.5));
  };
}

inline Field gap_field() {
  return [](double x, double y, double t) {
    return 0.02 * std::hypot(x - 4.0 * std::cos(3.0 * t), y - 4.0 * std::sin(3.0 * t)) - 0.1 * t +
           0.01 * std::sin(x) * std::cos(y);
  };
}

inline Field thickness_field() {
  return [](double x, double y, double) { return 2.0 + 0.02 * x - 0.001 * y * y; };
}

inline std::vector<double> steps(int count) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) times.push_back(static_cast<double>(i) / (count > 1 ? count - 1 : 1));
  return times;
}

/// Three results of n x n facets. `hard`: pressure everywhere and noise in all of it, the hardest to pack.
inline std::vector<ResultFile> large_results(int n, int states, bool hard = false) {
  const double wider = hard ? 10.0 : 1.0, noise = hard ? 0.3 : 0.0;
  Dome dome;
  dome.n = n;
  const std::vector<double> times = steps(states);
  return {make_dome_result("layer.xplt", "layer", dome, times,
                           {{"contact pressure", wandering(6.0, 6.0 * wider, noise)},
                            {"joint space", gap_field()},
                            {"cartilage thickness", thickness_field()}}),
          make_dome_result("linear.xplt", "linear", dome, times,
                           {{"contact pressure", wandering(7.0, 5.5 * wider, noise)},
                            {"joint space", gap_field()},
                            {"cartilage thickness", thickness_field()}}),
          make_dome_result("fea.xplt", "FEA", dome, times, {{"contact pressure", wandering(5.5, 6.2 * wider, 0.3)}})};
}

/// Names that would be markup, fields that are undefined somewhere, meshes that differ, a state that one lacks.
inline std::vector<ResultFile> awkward_results() {
  const std::string bad = "</script><b>&\"'\xc3\xa9\xff";
  Dome fine, coarse;
  fine.n = 24;
  fine.surface = coarse.surface = bad;
  fine.material = coarse.material = "<img src=x onerror=alert(1)>";
  coarse.n = 15;
  const Field holed = [](double x, double y, double t) { return x > 6 ? std::nan("") : gap_field()(x, y, t); };
  return {make_dome_result("/some/where/first.xplt", bad, fine, {0, 0.25, 0.5, 0.75, 1},
                           {{"contact pressure", wandering(6.0, 6.0, 0.0)}, {"joint space", holed}}),
          make_dome_result("/some/where/second.xplt", "other <i>mesh</i>", coarse, {0, 0.25, 0.5, 1},
                           {{"contact pressure", wandering(7.0, 5.5, 0.1)}}),
          make_dome_result("/some/where/third.xplt", "reference", fine, {0, 0.25, 0.5, 0.75, 1},
                           {{"contact pressure", wandering(5.5, 6.2, 0.3)}})};
}

}  // namespace dea::test
