// tests/io/plot_files.h – surfaces and plot files made by hand, for tests of maps.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "io/results/result_file.h"
#include "src/base/numbers.h"

namespace dea::test {

/// Facets by their nodes, and a field of one value per facet.
struct PlotPatch {
  std::vector<Vector3d> nodes;
  std::vector<std::vector<int>> facets;
};

/// n x m quads of the rectangle a x b, normals up, put into space by `place`.
inline PlotPatch sheet(
    int n, int m, double a, double b,
    const std::function<Vector3d(double, double)>& place = [](double x, double y) { return Vector3d(x, y, 0); }) {
  PlotPatch p;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) p.nodes.push_back(place(a * i / n, b * j / m));
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const int k = i + (n + 1) * j;
      p.facets.push_back({k, k + 1, k + n + 2, k + n + 1});
    }
  return p;
}

/// Cap of a sphere about the z axis as quads, triangles at the pole; outward normals unless a socket.
inline PlotPatch cap(double radius, double degrees, int rings, int spokes, bool socket) {
  PlotPatch p;
  p.nodes.push_back({0, 0, radius});
  for (int i = 1; i <= rings; ++i)
    for (int k = 0; k < spokes; ++k) {
      const double t = degrees * kPi / 180 * i / rings, f = 2 * kPi * k / spokes;
      p.nodes.push_back(radius * Vector3d(std::sin(t) * std::cos(f), std::sin(t) * std::sin(f), std::cos(t)));
    }
  const auto node = [&](int i, int k) { return 1 + (i - 1) * spokes + k % spokes; };
  for (int k = 0; k < spokes; ++k) p.facets.push_back({0, node(1, k), node(1, k + 1)});
  for (int i = 1; i < rings; ++i)
    for (int k = 0; k < spokes; ++k)
      p.facets.push_back({node(i, k), node(i + 1, k), node(i + 1, k + 1), node(i, k + 1)});
  if (socket)
    for (auto& f : p.facets) std::reverse(f.begin(), f.end());
  return p;
}

/// A file with one surface, "contact pressure" per facet and state, and the same field under another name.
inline ResultFile result_of(const std::string& label, const PlotPatch& p,
                            const std::vector<std::vector<double>>& pressures, const std::string& units = "") {
  XpltFile file;
  file.software = "test";
  file.units = units;
  XpltMesh mesh;
  for (const Vector3d& x : p.nodes) {
    mesh.node_ids.push_back(static_cast<int>(mesh.node_ids.size()) + 1);
    for (int k = 0; k < 3; ++k) mesh.coordinates.push_back(static_cast<float>(x[k]));
  }
  mesh.parts = {"shell"};
  XpltDomain domain;
  domain.element_type = 3;
  domain.name = "shell";
  XpltFacets facets;
  facets.name = "surface";
  for (const auto& f : p.facets) {
    facets.nodes.insert(facets.nodes.end(), f.begin(), f.end());
    facets.begin.push_back(static_cast<int>(facets.nodes.size()));
    facets.max_nodes = std::max(facets.max_nodes, static_cast<int>(f.size()));
    domain.element_ids.push_back(static_cast<int>(domain.element_ids.size()) + 1);
    for (std::size_t k = 0; k < 4; ++k) domain.nodes.push_back(f[std::min(k, f.size() - 1)]);
  }
  mesh.domains = {domain};
  XpltFacets bare = facets;
  bare.name = "bare";
  mesh.surfaces = {facets, bare};
  file.meshes = {mesh};
  for (const char* name : {"contact pressure", "joint space"})
    file.variables.push_back(XpltVariable{XpltGroup::Surface, XpltType::Float, XpltFormat::Item, name});
  file.variables.push_back(XpltVariable{XpltGroup::Surface, XpltType::Vec3, XpltFormat::Item, "contact traction"});
  for (std::size_t s = 0; s < pressures.size(); ++s) {
    XpltState state;
    state.time = static_cast<float>(s);
    std::vector<float> values(pressures[s].begin(), pressures[s].end());
    state.variables = {{{1, values}}, {{1, values}}, {{1, std::vector<float>(3 * values.size(), 1.0f)}}};
    file.states.push_back(state);
  }
  return {label + ".xplt", label, file};
}

}  // namespace dea::test
