#include "views/compare/compare_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"
#include "src/base/time_text.h"
#include "src/base/unit_names.h"
#include "src/version.h"

namespace dea {

namespace {

constexpr const char* kPressure = "contact pressure";

/// One surface of one file at its compared state.
struct Side {
  int surface = -1;
  ResultSurface geometry;
  SurfaceValues values;
  std::vector<double> nodal;  ///< pressure
  SurfaceFrame frame;         ///< of the reference configuration, whatever the areas
  SurfaceFacts facts;
};

std::string quoted(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& n : names) text += fmt::format("{}\"{}\"", text.empty() ? "" : ", ", n);
  return text.empty() ? "none" : text;
}

std::vector<std::string> surfaces_with_pressure(const ResultFile& file, int state) {
  std::vector<std::string> names;
  const std::vector<XpltFacets>& surfaces = mesh_of(file, state).surfaces;
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    if (surfaces[s].size() > 0 && !facet_values(file, state, static_cast<int>(s), kPressure).empty() &&
        std::find(names.begin(), names.end(), surfaces[s].name) == names.end())
      names.push_back(surfaces[s].name);
  return names;
}

double largest_pressure(const ResultFile& file, int state, const std::string& name) {
  const std::vector<double> p = facet_values(file, state, find_surface(file, state, name), kPressure);
  return p.empty() ? 0.0 : *std::max_element(p.begin(), p.end());
}

/// "A=B" is one name per file, unless a file has a surface of that name.
std::vector<std::string> split_names(const std::string& text, const std::vector<ResultFile>& files,
                                     const std::vector<int>& states) {
  for (std::size_t i = 0; i < files.size(); ++i)
    if (find_surface(files[i], states[i], text) >= 0) return std::vector<std::string>(files.size(), text);
  std::vector<std::string> names = split(text, '=');
  if (names.size() == 1) names.assign(files.size(), text);
  if (names.size() != files.size())
    throw UsageError(fmt::format("--surface {}: found {} names, expected one or one per file ({})", text, names.size(),
                                 files.size()));
  return names;
}

/// Of --surface. `with_pressure`: per file.
std::vector<std::vector<std::string>> asked_surfaces(const std::vector<ResultFile>& files,
                                                     const std::vector<int>& states, const CompareOptions& options,
                                                     const std::vector<std::vector<std::string>>& with_pressure) {
  std::vector<std::vector<std::string>> chosen;
  for (const std::string& text : options.surfaces) {
    chosen.push_back(split_names(text, files, states));
    for (std::size_t i = 0; i < files.size(); ++i)
      if (std::find(with_pressure[i].begin(), with_pressure[i].end(), chosen.back()[i]) == with_pressure[i].end())
        throw InputError(fmt::format("{}: found no surface \"{}\" with \"{}\"{}, expected one of {}", files[i].path,
                                     chosen.back()[i], kPressure, did_you_mean(chosen.back()[i], with_pressure[i]),
                                     quoted(with_pressure[i])));
    for (std::size_t k = 0; k + 1 < chosen.size(); ++k)
      if (chosen[k].front() == chosen.back().front())
        throw UsageError(fmt::format("--surface {}: surface \"{}\" given twice", text, chosen[k].front()));
  }
  return chosen;
}

/// Surfaces of the same name in all files, pressed in one of them at least; first those that are pressed in all, and
/// of these first those with springs, whose facets carry the springs' own force.
std::vector<std::vector<std::string>> common_surfaces(const std::vector<ResultFile>& files,
                                                      const std::vector<int>& states,
                                                      const std::vector<std::vector<std::string>>& with_pressure,
                                                      std::vector<std::string>& warnings) {
  bool common = false;
  std::vector<std::vector<std::string>> chosen, one_sided;
  for (const std::string& name : with_pressure.front()) {
    const bool everywhere = std::all_of(with_pressure.begin(), with_pressure.end(), [&](const auto& names) {
      return std::find(names.begin(), names.end(), name) != names.end();
    });
    if (!everywhere) continue;
    common = true;
    int pressed = 0;
    std::string unpressed;
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (largest_pressure(files[i], states[i], name) > 0)
        ++pressed;
      else
        unpressed += fmt::format("{}{}", unpressed.empty() ? "" : ", ", files[i].label);
    }
    if (pressed == 0) continue;
    (unpressed.empty() ? chosen : one_sided).push_back(std::vector<std::string>(files.size(), name));
    if (!unpressed.empty())
      warnings.push_back(
          fmt::format("note: surface \"{}\" has no pressure anywhere in {}; FEBio computes a contact's pressure on its "
                      "primary surface only, unless "
                      "told otherwise",
                      name, unpressed));
  }
  if (!common) {
    std::string have;
    for (std::size_t i = 0; i < files.size(); ++i)
      have += fmt::format("{}{} has {}", i > 0 ? "; " : "", files[i].path, quoted(with_pressure[i]));
    throw InputError(
        fmt::format("found no surface with \"{}\" that all files have, expected --surface A=B: {}", kPressure, have));
  }
  const auto springs_stand_on = [&](const std::vector<std::string>& names) {
    for (std::size_t i = 0; i < files.size(); ++i)
      if (has_springs(files[i], states[i], find_surface(files[i], states[i], names[i]))) return true;
    return false;
  };
  std::stable_partition(chosen.begin(), chosen.end(), springs_stand_on);
  chosen.insert(chosen.end(), one_sided.begin(), one_sided.end());
  return chosen;
}

/// Names of the surfaces to compare, one per file each.
std::vector<std::vector<std::string>> choose_surfaces(const std::vector<ResultFile>& files,
                                                      const std::vector<int>& states, const CompareOptions& options,
                                                      std::vector<std::string>& warnings) {
  std::vector<std::vector<std::string>> with_pressure;
  for (std::size_t i = 0; i < files.size(); ++i) {
    with_pressure.push_back(surfaces_with_pressure(files[i], states[i]));
    if (with_pressure.back().empty())
      throw InputError(fmt::format("{}: found no surface with \"{}\" at time {}, expected one", files[i].path,
                                   kPressure, time_text(files[i].xplt.states[at(states[i])].time)));
  }
  std::vector<std::vector<std::string>> chosen = asked_surfaces(files, states, options, with_pressure);
  if (!chosen.empty()) return chosen;
  chosen = common_surfaces(files, states, with_pressure, warnings);
  if (chosen.empty())
    throw InputError(
        fmt::format("{}: found no \"{}\" above 0 on any common surface in any file", files.front().path, kPressure));
  return chosen;
}

double resultant(const ResultSurface& surface, const std::vector<double>& pressure) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t f = 0; f < pressure.size(); ++f)
    if (pressure[f] > 0) sum += pressure[f] * surface.area_vectors[f];
  return sum.norm();
}

double total(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// dea's springs push on the areas of the mesh. Its files move the nodes of the layers, too, but that is a picture of
/// how far they are squeezed and no solution.
bool pressure_is_per_mesh_area(const ResultFile& file) { return written_by_dea(file.xplt); }

SurfaceFacts surface_facts(const ResultFile& file, int state, const Side& side, const ResultSurface& mesh) {
  SurfaceFacts facts;
  facts.area = total(mesh.facet_areas);
  facts.resultant = resultant(mesh, side.values.pressure);
  facts.deformed_area = facts.deformed_resultant = kNaN;
  if (pressure_is_per_mesh_area(file)) {
    facts.deformed_area = facts.area;
    facts.deformed_resultant = facts.resultant;
  } else if (const std::optional<ResultSurface> moved = deformed_surface(file, state, side.surface)) {
    facts.deformed_area = total(moved->facet_areas);
    facts.deformed_resultant = resultant(*moved, side.values.pressure);
    double change = 0.0;
    for (std::size_t f = 0; f < mesh.facet_areas.size(); ++f)
      change += std::abs(moved->facet_areas[f] - mesh.facet_areas[f]);
    // single precision: 7 digits of a place, which may be 1000 facets away from the origin
    facts.deforms = change > 1e-3 * facts.area;
  }
  facts.contact_force = surface_vector(file, state, side.surface, "contact force");
  facts.interface = interface_compliance(side.values.pressure, side.values.gap, side.geometry.facet_areas);
  return facts;
}

/// What does not fit together: pressure, areas and contact force of one file.
void note_areas_and_force(const Side& side, const ResultFile& file, CompareAreas areas,
                          std::vector<std::string>& warnings) {
  const SurfaceFacts& facts = side.facts;
  const bool deformed = areas == CompareAreas::Deformed;
  if (deformed && pressure_is_per_mesh_area(file))
    warnings.push_back(
        fmt::format("note: {}: dea's pressure is per area of the mesh: areas of \"{}\" are those of the mesh",
                    file.label, side.geometry.name));
  else if (deformed && !facts.deforms)
    warnings.push_back(
        fmt::format("note: {}: surface \"{}\" does not deform in its file: its areas are those of the mesh", file.label,
                    side.geometry.name));
  const double share = share_of_contact_force(facts, areas);
  const double other = share_of_contact_force(facts, deformed ? CompareAreas::Reference : CompareAreas::Deformed);
  if (!(facts.resultant > 0) || !(std::abs(share - 1) > 0.01)) return;
  if (std::abs(other - 1) < 0.5 * std::abs(share - 1))
    warnings.push_back(
        fmt::format("note: {}: pressure on \"{}\" times {} areas is {:.1f}% of its contact force, times {} areas "
                    "{:.1f}%: --areas {}",
                    file.label, side.geometry.name, deformed ? "deformed" : "the reference mesh's", 100 * share,
                    deformed ? "the reference mesh's" : "deformed", 100 * other, deformed ? "reference" : "deformed"));
  else
    warnings.push_back(fmt::format("note: {}: the pressure map of \"{}\" carries {:.1f}% of its contact force",
                                   file.label, side.geometry.name, 100 * share));
}

Side make_side(const ResultFile& file, int state, const std::string& name, CompareAreas areas) {
  Side side;
  side.surface = find_surface(file, state, name);
  const ResultSurface mesh = result_surface(file, state, side.surface);
  side.frame = surface_frame(mesh);
  side.geometry = compared_surface(file, state, side.surface, areas);
  if (side.geometry.mesh.size() == 0) throw InputError(fmt::format("{}: surface \"{}\" has no area", file.path, name));
  side.values.pressure = facet_values(file, state, side.surface, kPressure);
  side.values.gap = facet_values(file, state, side.surface, "contact gap");
  side.nodal = nodal_average(side.geometry, side.values.pressure);
  side.facts = surface_facts(file, state, side, mesh);
  return side;
}

/// Values of a surface per facet in every state up to `last` that has the same facets; states without values count as
/// 0.
struct History {
  std::vector<double> times;
  std::vector<std::vector<double>> pressure;
  int left_out = 0;
};
History history(const ResultFile& file, int last, const std::string& name) {
  History h;
  const XpltMesh& mesh = mesh_of(file, last);
  const XpltFacets& facets = mesh.surfaces[at(find_surface(file, last, name))];
  for (int s = 0; s <= last; ++s) {
    const int surface = find_surface(file, s, name);
    if (surface < 0 || !(mesh_of(file, s).surfaces[at(surface)] == facets)) {
      ++h.left_out;
      continue;
    }
    h.times.push_back(file.xplt.states[at(s)].time);
    h.pressure.push_back(facet_values(file, s, surface, kPressure));
    if (h.pressure.back().empty()) h.pressure.back().assign(at(facets.size()), 0.0);
  }
  return h;
}

std::optional<TimeSums> nodal_sums(const History& h, const ResultSurface& geometry, std::optional<double> dose_above) {
  if (h.times.size() < 2) return std::nullopt;
  std::vector<std::vector<double>> nodal;
  for (const auto& p : h.pressure) nodal.push_back(nodal_average(geometry, p));
  return over_time(h.times, nodal, dose_above);
}

TimeMeasures time_measures(const std::optional<TimeSums>& of, const std::vector<double>& areas) {
  if (!of) return {kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};
  const TimeSums& sums = *of;
  TimeMeasures m;
  double area = 0.0;
  m.max_dose = m.mean_dose = sums.dose.empty() ? kNaN : 0.0;
  for (std::size_t v = 0; v < areas.size(); ++v) {
    if (!(areas[v] > 0 && sums.peak[v] > 0)) continue;
    area += areas[v];
    m.max_peak = std::max(m.max_peak, sums.peak[v]);
    m.mean_peak += areas[v] * sums.peak[v];
    m.max_exposure = std::max(m.max_exposure, sums.exposure[v]);
    m.mean_exposure += areas[v] * sums.exposure[v];
    if (sums.dose.empty()) continue;
    m.max_dose = std::max(m.max_dose, sums.dose[v]);
    m.mean_dose += areas[v] * sums.dose[v];
  }
  if (area > 0) {
    m.mean_peak /= area;
    m.mean_exposure /= area;
    m.mean_dose /= area;
  }
  return m;
}

/// Axis and centre of regions and profile.
SurfaceFrame chosen_frame(const SurfaceFrame& own, const CompareOptions& options, const std::string& surface) {
  SurfaceFrame frame = own;
  if (options.axis) frame.axis = options.axis->normalized();
  if (options.center) frame.center = *options.center;
  if ((options.layout.any() || options.profile) && !(frame.axis.norm() > 0))
    throw UsageError(fmt::format("surface \"{}\" is closed and has no axis of its own: --axis x,y,z", surface));
  return frame;
}

std::vector<double> facet_correlations(const std::vector<Side>& sides, const std::vector<NodeMatch>& matches,
                                       const FacetMask& mask) {
  std::vector<double> out;
  const Side& reference = sides.back();
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    if (!matches[i].same_mesh) {
      out.push_back(kNaN);
      continue;
    }
    std::vector<double> weights(reference.values.pressure.size(), 1.0);
    for (std::size_t f = 0; f < mask.size(); ++f) weights[f] = mask[f] ? 1.0 : 0.0;
    out.push_back(correlation(sides[i].values.pressure, reference.values.pressure, weights));
  }
  return out;
}

/// Of facets, by values carried to the vertices; what is not covered counts as 0.
std::vector<double> carried_facets(const ResultSurface& onto, std::vector<double> carried) {
  for (double& p : carried)
    if (std::isnan(p)) p = 0.0;
  return facet_average(onto, carried);
}

/// 1: it is all there.
double carried_share(const Side& from, const Side& onto, const NodeMatch& match, const std::vector<double>& carried) {
  const double own = resultant(from.geometry, from.values.pressure);
  if (match.same_mesh || !(own > 0)) return 1.0;
  return resultant(onto.geometry, carried_facets(onto.geometry, carried)) / own;
}

/// One surface in all files, before anything is compared.
struct SurfaceInFiles {
  std::vector<Side> sides;                    ///< per file; the last is the reference
  std::vector<std::optional<TimeSums>> sums;  ///< per file; none: one state is no history
  std::vector<NodeMatch> matches;             ///< per file but the reference
  std::vector<std::vector<double>> carried;   ///< nodal pressure of each of them on the reference's nodes
};

SurfaceInFiles read_sides(const std::vector<ResultFile>& files, const std::vector<int>& states,
                          const std::vector<std::string>& names, const CompareOptions& options,
                          std::vector<std::string>& warnings) {
  SurfaceInFiles in;
  for (std::size_t i = 0; i < files.size(); ++i) {
    in.sides.push_back(make_side(files[i], states[i], names[i], options.areas));
    note_areas_and_force(in.sides.back(), files[i], options.areas, warnings);
    const History h = history(files[i], states[i], names[i]);
    if (h.left_out > 0)
      warnings.push_back(
          fmt::format("warning: {}: {} states with another mesh of \"{}\" are left out of sums over time",
                      files[i].path, h.left_out, names[i]));
    in.sums.push_back(nodal_sums(h, in.sides.back().geometry, options.dose_above));
  }
  return in;
}

/// Finds the reference's nodes on the other files' surfaces, and says how well they fit.
void match_sides(const std::vector<ResultFile>& files, SurfaceInFiles& in, ComparedSurface& compared,
                 std::vector<std::string>& warnings) {
  const std::vector<std::string>& names = compared.names;
  const Side& reference = in.sides.back();
  const ResultFile& last = files.back();
  for (std::size_t i = 0; i + 1 < files.size(); ++i) {
    Side& side = in.sides[i];
    const NodeMatch match = match_nodes(reference.geometry, side.geometry);
    in.carried.push_back(carry_values(match, side.geometry, side.nodal));
    side.facts.carried = carried_share(side, reference, match, in.carried.back());
    if (!(match.covered > 0))
      throw InputError(fmt::format("{}: surface \"{}\" lies nowhere on \"{}\" of {}", files[i].path, names[i],
                                   names.back(), last.path));
    if (match.covered < 0.99)
      warnings.push_back(
          fmt::format("warning: surface \"{}\" of {} covers only {:.1f}% of \"{}\" of {}; the rest is left out of "
                      "correlation, rms and Dice",
                      names[i], files[i].label, 100 * match.covered, names.back(), last.label));
    const double by_reference = match.same_mesh ? 1.0 : match_nodes(side.geometry, reference.geometry).covered;
    if (by_reference < 0.99)
      warnings.push_back(fmt::format(
          "warning: surface \"{}\" of {} reaches beyond: only {:.1f}% of it is covered by \"{}\" of {}; the rest "
          "counts in its own numbers, and is left out of correlation, rms and Dice",
          names[i], files[i].label, 100 * by_reference, names.back(), last.label));
    if (std::abs(side.facts.carried - 1) > 0.01)
      warnings.push_back(fmt::format(
          "note: {}: its map of \"{}\", projected onto the mesh of {}, carries {:.1f}% of its own resultant there; "
          "correlation, rms and Dice are of that",
          files[i].label, names[i], last.label, 100 * side.facts.carried));
    in.matches.push_back(match);
    compared.same_mesh.push_back(match.same_mesh);
    compared.covered.push_back(match.covered);
    compared.covered_by_reference.push_back(by_reference);
  }
}

ComparedRegion compare_region(const SurfaceInFiles& in, const Region& region, const std::vector<double>& thresholds) {
  ComparedRegion r;
  r.name = region.name;
  for (std::size_t i = 0; i < in.sides.size(); ++i) {
    const Side& side = in.sides[i];
    r.headlines.push_back(headline(side.geometry, side.values.pressure, region.masks[i]));
    r.results.push_back(measure(side.geometry, side.values, thresholds, region.masks[i]));
    r.over_time.push_back(time_measures(in.sums[i], nodal_areas(side.geometry, region.masks[i])));
  }
  const Side& reference = in.sides.back();
  const std::vector<double> areas = nodal_areas(reference.geometry, region.masks.back());
  for (const std::vector<double>& carried : in.carried)
    r.differences.push_back(pattern_difference(carried, reference.nodal, areas, thresholds));
  r.facet_correlation = facet_correlations(in.sides, in.matches, region.masks.back());
  return r;
}

ComparedSurface compare_surface(const std::vector<ResultFile>& files, const std::vector<int>& states,
                                const std::vector<std::string>& names, const CompareOptions& options,
                                const std::vector<double>& thresholds, std::vector<std::string>& warnings) {
  ComparedSurface compared;
  compared.names = names;
  SurfaceInFiles in = read_sides(files, states, names, options, warnings);
  match_sides(files, in, compared, warnings);
  for (const Side& side : in.sides) {
    compared.facets.push_back(side.geometry.facets());
    compared.facts.push_back(side.facts);
  }
  const Side& reference = in.sides.back();
  std::vector<RowsOfFile> rows;
  for (std::size_t i = 0; i < files.size(); ++i)
    rows.push_back({&files[i], states[i], in.sides[i].surface, &in.sides[i].values.pressure,
                    headline(in.sides[i].geometry, in.sides[i].values.pressure).above});
  if (std::all_of(compared.same_mesh.begin(), compared.same_mesh.end(), [](char same) { return same != 0; }))
    compared.inside = compare_inside(rows);
  SurfaceFrame frame = chosen_frame(reference.frame, options, names.back());
  std::vector<SurfaceIn> on;
  for (const Side& side : in.sides) on.push_back({side.surface, &side.geometry});
  for (const Region& region : make_regions(files, states, on, options, reference.frame))
    compared.regions.push_back(compare_region(in, region, thresholds));
  if (options.profile) {
    // by itself the axis points at the surface, whichever side its normals are on
    if (!options.axis && frame.axis.dot(surface_extent(reference.geometry.mesh).centroid - frame.center) < 0)
      frame.axis = -frame.axis;
    for (const Side& side : in.sides)
      compared.profiles.push_back(
          pressure_profile(side.geometry, side.values.pressure, frame.axis, frame.center, options.bin));
  }
  compared.axis = frame.axis;
  compared.center = frame.center;
  return compared;
}

std::vector<ComparedBody> compare_bodies(const std::vector<ResultFile>& files, const std::vector<int>& states) {
  std::vector<std::vector<BodyPose>> poses;
  std::vector<ComparedBody> bodies;
  for (std::size_t i = 0; i < files.size(); ++i) poses.push_back(body_poses(files[i], states[i]));
  for (const auto& list : poses) {
    for (const BodyPose& b : list) {
      if (std::any_of(bodies.begin(), bodies.end(), [&](const ComparedBody& c) { return c.name == b.name; })) continue;
      ComparedBody body;
      body.name = b.name;
      int found = 0;
      for (const auto& other : poses) {
        const auto same = std::find_if(other.begin(), other.end(), [&](const BodyPose& o) { return o.name == b.name; });
        body.results.push_back(same == other.end() ? std::nullopt : std::optional<BodyPose>(*same));
        found += same != other.end();
      }
      if (found < 2) continue;
      for (std::size_t i = 0; i + 1 < files.size(); ++i)
        body.differences.push_back(
            body.results[i] && body.results.back()
                ? std::optional<PoseDifference>(pose_difference(*body.results[i], *body.results.back()))
                : std::nullopt);
      bodies.push_back(std::move(body));
    }
  }
  return bodies;
}

XpltVariable surface_variable(const std::string& name, const std::string& units) {
  return {XpltGroup::Surface, XpltType::Float, XpltFormat::Item, name, units};
}

/// Per written state the state of each file.
std::vector<std::vector<int>> paired_states(const std::vector<ResultFile>& files, const CompareOptions& options,
                                            const Comparison& comparison) {
  std::vector<std::vector<int>> pairs;
  if (!options.at) {
    for (std::size_t s = 0; s < files.front().xplt.states.size(); ++s) {
      std::vector<int> pair = {static_cast<int>(s)};
      for (std::size_t i = 1; i < files.size(); ++i) {
        for (std::size_t k = 0; k < files[i].xplt.states.size(); ++k) {
          if (!same_time(files[i].xplt.states[k].time, files.front().xplt.states[s].time)) continue;
          pair.push_back(static_cast<int>(k));
          break;
        }
      }
      bool same_meshes = pair.size() == files.size();
      for (std::size_t i = 0; i < files.size() && same_meshes; ++i)
        same_meshes = files[i].xplt.states[at(pair[i])].mesh == files[i].xplt.states[at(comparison.states[i])].mesh;
      if (same_meshes) pairs.push_back(std::move(pair));
    }
  }
  if (pairs.empty()) pairs.push_back(comparison.states);
  return pairs;
}

/// After the displacement: pressures, differences, and with `time_fields` peaks, exposures and doses, file by file.
std::vector<XpltVariable> compare_variables(const CompareOptions& options, const std::vector<std::string>& labels,
                                            bool time_fields) {
  std::vector<XpltVariable> variables;
  for (const std::string& label : labels)
    variables.push_back(surface_variable(fmt::format("{} {}", kPressure, label), "P"));
  for (std::size_t i = 0; i + 1 < labels.size(); ++i)
    variables.push_back(surface_variable(
        labels.size() == 2 ? "pressure difference" : fmt::format("pressure difference {}", labels[i]), "P"));
  if (!time_fields) return variables;
  for (const std::string& label : labels) {
    variables.push_back(surface_variable(fmt::format("peak pressure {}", label), "P"));
    variables.push_back(surface_variable(fmt::format("exposure {}", label), "P.t"));
    if (options.dose_above) variables.push_back(surface_variable(fmt::format("overpressure dose {}", label), "P.t"));
  }
  return variables;
}

/// One surface of all files, on the first file's facets.
struct SurfaceOnFirst {
  std::vector<std::string> names;
  std::vector<Side> sides;
  std::vector<NodeMatch> matches;
  int region() const { return sides.front().surface + 1; }
  std::vector<double> carried(std::size_t file, const std::vector<double>& facets) const {
    if (matches[file].same_mesh) return facets;
    const ResultSurface& own = sides[file].geometry;
    return carried_facets(sides.front().geometry, carry_values(matches[file], own, nodal_average(own, facets)));
  }
};

/// Values of compare_variables in one state: `pair` has the state of each file, `v` is the place of the first variable.
void add_compared_values(const std::vector<ResultFile>& files, const SurfaceOnFirst& surface,
                         const std::vector<int>& pair, const CompareOptions& options, bool time_fields, std::size_t v,
                         XpltState& state) {
  const auto add = [&](const std::vector<double>& values) {
    state.variables[v++].push_back({surface.region(), {values.begin(), values.end()}});
  };
  std::vector<std::vector<double>> pressure;
  for (std::size_t i = 0; i < files.size(); ++i) {
    std::vector<double> p = facet_values(files[i], pair[i], surface.sides[i].surface, kPressure);
    if (p.empty()) p.assign(at(surface.sides[i].geometry.facets()), 0.0);
    pressure.push_back(surface.carried(i, p));
    add(pressure.back());
  }
  for (std::size_t i = 0; i + 1 < files.size(); ++i) {
    std::vector<double> difference;
    for (std::size_t f = 0; f < pressure[i].size(); ++f) difference.push_back(pressure[i][f] - pressure.back()[f]);
    add(difference);
  }
  if (!time_fields) return;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const History h = history(files[i], pair[i], surface.names[i]);
    const TimeSums sums = over_time(h.times, h.pressure, options.dose_above);
    for (const std::vector<double>* values : {&sums.peak, &sums.exposure, &sums.dose})
      if (!values->empty()) add(surface.carried(i, *values));
  }
}

/// The thresholds that are taken by themselves are of pressures in MPa. Empty: so are the files, or nobody knows.
std::string low_thresholds(const CompareOptions& options, const std::string& system) {
  const UnitNames units = unit_names(system);
  const double megapascal = units.newtons > 0 ? 1e6 * units.metres * units.metres / units.newtons : 1.0;  // in units
  if (options.thresholds != CompareOptions().thresholds || megapascal < 10) return "";
  return fmt::format(
      "note: thresholds 0.1 and 0.5 are in the files' unit, {}, where 1 MPa is {:g}: all contact is above "
      "them; give others with --threshold",
      units.pressure, megapascal);
}

}  // namespace

double share_of_contact_force(const SurfaceFacts& facts, CompareAreas areas) {
  if (!facts.contact_force || !(facts.contact_force->norm() > 0) || !(facts.resultant > 0)) return kNaN;
  return (areas == CompareAreas::Deformed ? facts.deformed_resultant : facts.resultant) / facts.contact_force->norm();
}

ResultSurface compared_surface(const ResultFile& file, int state, int surface, CompareAreas areas) {
  ResultSurface mesh = result_surface(file, state, surface);
  if (areas == CompareAreas::Reference || pressure_is_per_mesh_area(file)) return mesh;
  const std::optional<ResultSurface> moved = deformed_surface(file, state, surface);
  if (!moved)
    throw InputError(
        fmt::format("{}: found no \"displacement\" of the nodes at time {}, expected one for --areas "
                    "deformed; --areas reference needs none",
                    file.path, time_text(file.xplt.states[at(state)].time)));
  return with_areas_of(std::move(mesh), *moved);
}

std::vector<Region> make_regions(const std::vector<ResultFile>& files, const std::vector<int>& states,
                                 const std::vector<SurfaceIn>& on, const CompareOptions& options,
                                 const SurfaceFrame& own) {
  std::vector<Region> regions = {{"", std::vector<FacetMask>(files.size())}};
  for (const std::string& name : options.regions) {
    Region region{name, {}};
    for (std::size_t i = 0; i < files.size(); ++i)
      region.masks.push_back(facets_in(files[i], states[i], on[i].number, name));
    regions.push_back(std::move(region));
  }
  if (!options.layout.any()) return regions;
  const SurfaceFrame frame = chosen_frame(own, options, on.back().geometry->name);
  const std::size_t first = regions.size();
  for (const SurfaceIn& surface : on) {
    const Regions lying =
        laid_out(surface.geometry->facet_centers, frame, options.layout, options.up, options.anterior);
    regions.resize(first + lying.names.size());
    for (std::size_t k = 0; k < lying.names.size(); ++k) {
      regions[first + k].name = lying.names[k];
      regions[first + k].masks.push_back(region_mask(lying, static_cast<int>(k)));
    }
  }
  return regions;
}

Comparison compare_files(const std::vector<ResultFile>& files, const CompareOptions& options) {
  Comparison c;
  c.areas = options.areas;
  c.thresholds = {0.0};
  c.thresholds.insert(c.thresholds.end(), options.thresholds.begin(), options.thresholds.end());
  c.dose_above = options.dose_above;
  for (const ResultFile& file : files) {
    c.labels.push_back(file.label);
    c.paths.push_back(file.path);
    c.states.push_back(options.at ? find_state(file, *options.at) : static_cast<int>(file.xplt.states.size()) - 1);
    c.times.push_back(file.xplt.states[at(c.states.back())].time);
    c.solved.push_back(is_solution(file, c.states.back()));
    if (!c.solved.back()) c.warnings.push_back(no_solution_warning(file, c.states.back()));
    int unsolved = 0;
    for (int s = 0; s < c.states.back(); ++s) unsolved += !is_solution(file, s);
    if (unsolved > 0)
      c.warnings.push_back(fmt::format(
          "warning: {}: {} of the {} states before the compared one {} no solution; peaks and integrals over "
          "time count them too",
          file.path, unsolved, c.states.back(), unsolved == 1 ? "is" : "are"));
    if (c.units.empty()) c.units = file.xplt.units;
    if (!file.xplt.units.empty() && file.xplt.units != c.units)
      c.warnings.push_back(fmt::format("warning: {} is in {}, others are in {}: numbers are compared as they are",
                                       file.path, file.xplt.units, c.units));
    if (is_newer(file.xplt)) c.warnings.push_back(newer_note(file));
    if (file.xplt.truncated)
      c.warnings.push_back(
          fmt::format("warning: {}: the last state is cut off and left out; the one before is at time {}", file.path,
                      time_text(file.xplt.states.back().time)));
    if (!same_time(c.times.back(), c.times.front()))
      c.warnings.push_back(
          fmt::format("warning: the last state of {} is at time {}, that of {} at {}; --at T compares at one time",
                      files.front().label, time_text(c.times.front()), file.label, time_text(c.times.back())));
  }
  const std::string low = low_thresholds(options, c.units);
  if (!low.empty()) c.warnings.push_back(low);
  for (std::size_t i = 0; i + 1 < files.size(); ++i) {
    const int n = c.states[i] + 1, reference = c.states.back() + 1;
    if (n == 1 || reference == 1) continue;  // no sums over time
    bool same = n == reference;
    for (int s = 0; same && s < n; ++s)
      same = same_time(files[i].xplt.states[at(s)].time, files.back().xplt.states[at(s)].time);
    if (!same)
      c.warnings.push_back(fmt::format(
          "warning: up to the compared state {} has {} states and {} has {}, at other times: peaks and "
          "integrals over time are not of the same moments; `dea run --times-from` solves at a file's times",
          c.labels[i], n, c.labels.back(), reference));
  }
  for (const std::vector<std::string>& names : choose_surfaces(files, c.states, options, c.warnings))
    c.surfaces.push_back(compare_surface(files, c.states, names, options, c.thresholds, c.warnings));
  for (ComparedSurface& surface : c.surfaces)
    for (const SurfaceMeasures& m : surface.regions.front().results)
      surface.asked_for = surface.asked_for && (!options.surfaces.empty() || m.facets.front().area > 0);
  c.bodies = compare_bodies(files, c.states);
  return c;
}

XpltFile make_compare_file(const std::vector<ResultFile>& files, const CompareOptions& options,
                           const Comparison& comparison, bool time_fields, bool compressed) {
  const ResultFile& first = files.front();
  XpltFile out;
  out.compressed = compressed;
  out.software = fmt::format("FEBioDEA {}", kVersion);
  out.units = comparison.units;
  out.meshes = {mesh_of(first, comparison.states.front())};
  out.meshes.front().objects = first.xplt.meshes.front().objects;

  const int displacement = find_variable(first.xplt, XpltGroup::Nodal, "displacement");
  if (displacement >= 0) out.variables.push_back(first.xplt.variables[at(displacement)]);
  const std::size_t fields = out.variables.size();
  for (XpltVariable& v : compare_variables(options, comparison.labels, time_fields))
    out.variables.push_back(std::move(v));

  const std::vector<std::vector<int>> pairs = paired_states(files, options, comparison);
  for (const std::vector<int>& pair : pairs) {
    const XpltState& own = first.xplt.states[at(pair.front())];
    XpltState state;
    state.time = own.time;
    for (std::size_t i = 0; i < files.size(); ++i)
      if (pair[i] >= 0 && !is_solution(files[i], pair[i])) state.status = kStatusNotConverged;
    state.element_flags = own.element_flags;
    state.objects = own.objects;
    state.variables.resize(out.variables.size());
    if (displacement >= 0) state.variables[0] = own.variables[at(displacement)];
    out.states.push_back(std::move(state));
  }
  for (const ComparedSurface& compared : comparison.surfaces) {
    SurfaceOnFirst surface;
    surface.names = compared.names;
    for (std::size_t i = 0; i < files.size(); ++i) {
      surface.sides.push_back(make_side(files[i], comparison.states[i], compared.names[i], options.areas));
      surface.matches.push_back(match_nodes(surface.sides.front().geometry, surface.sides.back().geometry));
    }
    for (std::size_t s = 0; s < pairs.size(); ++s)
      add_compared_values(files, surface, pairs[s], options, time_fields, fields, out.states[s]);
  }
  for (XpltState& state : out.states)
    for (auto& regions : state.variables)
      std::sort(regions.begin(), regions.end(),
                [](const XpltRegion& a, const XpltRegion& b) { return a.region < b.region; });
  return out;
}

}  // namespace dea
