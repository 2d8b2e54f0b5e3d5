#include "src/joint/left_out.h"

#include <algorithm>
#include <array>

#include "src/base/numbers.h"
#include "src/base/say.h"

namespace dea {

FacetList kept_facets(const FacetList& facets, const std::vector<FaceKind>& kinds) {
  FacetList kept;
  for (int f = 0; f < facets.size(); ++f) {
    if (kinds.empty() || kinds[at(f)] == FaceKind::Open)
      kept.add({facets.nodes.begin() + facets.begin[at(f)], facets.nodes.begin() + facets.begin[at(f) + 1]});
    else
      kept.add({});
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

Sentence left_out_note(const std::string& surface, const std::vector<FaceKind>& kinds) {
  const auto turned = std::count(kinds.begin(), kinds.end(), FaceKind::SideWall),
             bonded = std::count(kinds.begin(), kinds.end(), FaceKind::Bonded);
  if (turned + bonded == 0) return {};
  const std::string away = fmt::format("{} away from its articular face (side wall)", turned == 1 ? "turns" : "turn"),
                    held = fmt::format("{} bonded to bone", bonded == 1 ? "is" : "are");
  return say("surface \"{}\": {} of {} facets {}{}: left out ({} keeps them)", surface, turned > 0 ? turned : bonded,
             kinds.size(), turned > 0 ? away : held,
             turned > 0 && bonded > 0 ? fmt::format(" and {} {}", bonded, held) : std::string(),
             NamedSetting{"keep-facets"});
}

std::string rim_note(const std::string& surface, const LayerFace& face) {
  double rim = 0.0, stepped = 0.0, highest = 0.0;
  for (const LayerFace::Edge& e : face.edges) {
    const double length =
        (face.mesh.corner(e.triangle, e.edge) - face.mesh.corner(e.triangle, (e.edge + 1) % 3)).norm();
    rim += length;
    if (e.step > 0.0) stepped += length;
    highest = std::max(highest, e.step);
  }
  constexpr double kWorthSaying = 0.02;
  std::string text;
  if (face.bevelled > kWorthSaying * rim)
    text = fmt::format(
        "the layer ends in a bevel along {:.3g} of its rim (the next face turns by 20 to 65 degrees), which is taken "
        "as "
        "going on below 40 degrees and as a free edge above: pressures within a thickness of it may be a third off",
        face.bevelled);
  if (stepped > kWorthSaying * rim)
    text += fmt::format(
        "{}steps or notches of up to {:.3g} cross its face along {:.3g} of edges; they are taken as free edges, though "
        "the layer goes on below them: pressures beside them come out too low; smooth the mesh, or merge its nodes",
        text.empty() ? "" : "; ", highest, stepped);
  return text.empty() ? text : fmt::format("surface \"{}\": {}", surface, text);
}

}  // namespace dea
