#include "src/joint/left_out.h"

#include <algorithm>
#include <array>

#include "src/base/numbers.h"
#include "src/base/say.h"

namespace dea {

FacetList kept_facets(const FacetList& facets, const std::vector<FaceKind>& kinds) {
  FacetList kept;
  for (int f = 0; f < facets.size(); ++f) {
    const bool keep = kinds.empty() || kinds[at(f)] == FaceKind::Open;
    kept.add(keep ? facets.facet(f) : std::vector<int>());
  }
  return kept;
}

std::string mostly_left_out(const JointModel& model, const FacetList& facets, const std::vector<FaceKind>& kinds) {
  const SurfaceMesh all = make_surface_mesh(facets.begin, facets.nodes, model.nodes);
  std::array<double, 3> area = {0, 0, 0};
  std::array<long, 3> count = {0, 0, 0};
  for (int t = 0; t < all.size(); ++t) area[static_cast<std::size_t>(kinds[at(all.facet[at(t)])])] += all.areas[at(t)];
  for (FaceKind kind : kinds) ++count[static_cast<std::size_t>(kind)];
  const auto open = static_cast<std::size_t>(FaceKind::Open), bonded = static_cast<std::size_t>(FaceKind::Bonded),
             wall = static_cast<std::size_t>(FaceKind::SideWall);
  // a selection closed all round has as much bone side as articular side
  if (count[open] > 0 && area[wall] <= area[open]) return "";
  const std::string rest = count[open] == 0
                               ? "none:"
                               : fmt::format(
                                     "{} facets, of less area ({:.3g}) than the side wall ({:.3g}): too little to tell "
                                     "the articular face by;",
                                     count[open], area[open], area[wall]);
  return fmt::format(
      "{} of its {} facets turn away from the articular face (side wall) and {} are bonded to bone, which leaves {}",
      count[wall], facets.size(), count[bonded], rest);
}

Findings left_out_findings(const std::string& surface, const std::vector<FaceKind>& kinds) {
  const auto turned = std::count(kinds.begin(), kinds.end(), FaceKind::SideWall),
             bonded = std::count(kinds.begin(), kinds.end(), FaceKind::Bonded);
  if (turned + bonded == 0) return {};
  return {{"facets-left-out",
           {.surface = surface},
           {{"walls", turned}, {"bonded", bonded}, {"facets", kinds.size()}, {"keep", NamedSetting{"keep-facets"}}},
           bonded == 0   ? 0
           : turned == 0 ? 1
                         : 2}};
}

Findings rim_findings(const std::string& surface, const LayerFace& face) {
  double rim = 0.0, stepped = 0.0, highest = 0.0;
  for (const LayerFace::Edge& e : face.edges) {
    const double length =
        (face.mesh.corner(e.triangle, e.edge) - face.mesh.corner(e.triangle, (e.edge + 1) % 3)).norm();
    rim += length;
    if (e.step > 0.0) stepped += length;
    highest = std::max(highest, e.step);
  }
  constexpr double kWorthSaying = 0.02;
  Findings findings;
  if (face.bevelled > kWorthSaying * rim)
    findings.push_back({"rim-bevelled", {.surface = surface}, {{"length", face.bevelled}}});
  if (stepped > kWorthSaying * rim)
    findings.push_back({"face-stepped", {.surface = surface}, {{"height", highest}, {"length", stepped}}});
  return findings;
}

}  // namespace dea
