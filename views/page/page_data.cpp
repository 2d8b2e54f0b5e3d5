#include "views/page/page_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "io/settings/settings_xml.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/rules/rules.h"
#include "views/map/map_scale.h"
#include "views/text/compare_text.h"
#include "views/text/run_text.h"

namespace dea {

namespace {

namespace fs = std::filesystem;

constexpr const char* kAsTheyAre = "contact pressure";  ///< for map_values: 0 is a value

std::string file_name(const std::string& path) { return fs::path(path).filename().string(); }

/// Equal, and undefined at the same places.
bool same_values(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) {
           return x == y || (std::isnan(x) && std::isnan(y));
         });
}

/// A scalar field of a surface in all states; none: no state has it, or it cannot be shown (a warning says why).
/// `undefined`: values that are not finite are gaps of the map, otherwise refused. `zero`: 0 is a value.
std::optional<PageField> read_field(const ResultFile& file, const std::vector<int>& surfaces, const std::string& field,
                                    bool undefined, bool zero, std::vector<std::string>& warnings) {
  PageField out;
  bool any = false;
  try {
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
      out.states.push_back(surfaces[s] < 0 ? std::vector<double>()
                                           : facet_values(file, static_cast<int>(s), surfaces[s], field, undefined));
      if (!zero) std::replace(out.states.back().begin(), out.states.back().end(), 0.0, kNaN);
      any = any || !out.states.back().empty();
    }
  } catch (const InputError& e) {
    if (!undefined) throw;
    warnings.push_back(fmt::format("warning: \"{}\" is left out of the report: {}", field, e.what()));
    return std::nullopt;
  }
  if (!any) return std::nullopt;
  const std::vector<double>& first = out.states.front();
  out.fixed =
      !first.empty() && std::all_of(out.states.begin(), out.states.end(),
                                    [&](const std::vector<double>& values) { return same_values(values, first); });
  if (out.fixed) out.states.resize(1);
  return out;
}

bool nothing_but_zeros(const PageField& field) {
  for (const std::vector<double>& values : field.states)
    for (double x : values)
      if (x != 0 && !std::isnan(x)) return false;
  return true;
}

/// The pattern of nodal pressures against the reference's, with the area-weighted least-squares line b -> a over the
/// nodes that pattern_difference takes; null: there is none.
Json pattern_json(const std::vector<double>& a, const std::vector<double>& b, const std::vector<double>& areas) {
  const PatternDifference d = pattern_difference(a, b, areas, {0.0});
  double total = 0.0, mean_a = 0.0, mean_b = 0.0, ab = 0.0, bb = 0.0;
  const auto counts = [&](std::size_t i) { return !std::isnan(a[i]) && areas[i] > 0 && (a[i] > 0 || b[i] > 0); };
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!counts(i)) continue;
    total += areas[i];
    mean_a += areas[i] * a[i];
    mean_b += areas[i] * b[i];
  }
  mean_a /= total;
  mean_b /= total;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!counts(i)) continue;
    ab += areas[i] * (a[i] - mean_a) * (b[i] - mean_b);
    bb += areas[i] * (b[i] - mean_b) * (b[i] - mean_b);
  }
  // as for the correlation: what is left of a constant is its rounding
  const double slope = bb > 1e-24 * total * mean_b * mean_b && bb > 0 ? ab / bb : kNaN;
  return {{"r", short_number(d.correlation)},
          {"rms", short_number(d.rms)},
          {"mean", short_number(d.mean)},
          {"largest", short_number(d.largest)},
          {"dice", d.dice.empty() ? Json(nullptr) : short_number(d.dice.front())},
          {"slope", short_number(slope)},
          {"intercept", short_number(mean_a - slope * mean_b)}};
}

Json distribution_json(const Distribution& d) {
  return {{"area", short_number(d.area)},     {"peak", short_number(d.peak)}, {"p99", short_number(d.p99)},
          {"mean", short_number(d.mean)},     {"p5", short_number(d.p5)},     {"p25", short_number(d.p25)},
          {"median", short_number(d.median)}, {"p75", short_number(d.p75)},   {"p95", short_number(d.p95)}};
}

Json measures_json(const ResultSurface& surface, const SurfaceValues& values, const FacetMask& mask) {
  const SurfaceMeasures m = measure(surface, values, {0.0}, mask);
  return {{"nodes", distribution_json(m.nodes.front())},
          {"facets", distribution_json(m.facets.front())},
          {"force", short_number(m.resultant.norm())},
          {"center", json_vector(m.center_of_pressure)},
          {"headline", headline_json(headline(surface, values.pressure, mask))}};
}

PageCarry make_carry(const NodeMatch& match, const ResultSurface& from) {
  PageCarry carry;
  for (const SurfacePoint& point : match.points) {
    for (std::size_t k = 0; k < 3; ++k) {
      carry.vertices.push_back(point.triangle < 0 ? -1 : from.mesh.triangles[at(point.triangle)][k]);
      carry.weights.push_back(point.triangle < 0 ? 0.0f : static_cast<float>(point.weights[k]));
    }
  }
  return carry;
}

/// Of a result in one of its states; empty: none.
std::vector<double> pressure_in(const PageSurface& s, std::size_t result, std::size_t state) {
  const std::optional<PageField>& field = s.pressure[result];
  return field ? field->states[field->fixed ? 0 : state] : std::vector<double>();
}

/// What to look at first: the whole surface, as dea plot shows the first result's.
void place_camera(PageSurface& s, const ResultSurface& first, int state, const CompareOptions& options) {
  std::vector<double> load = pressure_in(s, 0, at(state));
  load.resize(at(first.facets()), 0.0);
  for (double& p : load) p = std::max(p, 0.0);
  s.view = view_from(default_direction(first, load), options.layout.any() ? options.up : Vector3d(0, 0, 0));
}

/// States of the results that show the same time, and the compared ones.
void make_frames(const std::vector<ResultFile>& files, const std::vector<int>& compared, PageData& data) {
  std::vector<PageFrame> all, common;
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (std::size_t k = 0; k < files[i].xplt.states.size(); ++k) {
      const double time = files[i].xplt.states[k].time;
      auto frame = std::find_if(all.begin(), all.end(), [&](const PageFrame& f) {
        return same_time(f.time, time) && f.states[i] < 0;  // a file may have two states at one time
      });
      if (frame == all.end()) {
        all.push_back({time, std::vector<int>(files.size(), -1)});
        frame = all.end() - 1;
      }
      frame->states[i] = static_cast<int>(k);
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const PageFrame& a, const PageFrame& b) { return a.time < b.time; });
  for (const PageFrame& f : all)
    if (std::find(f.states.begin(), f.states.end(), -1) == f.states.end()) common.push_back(f);
  data.frames = common.size() >= 2 ? common : all;
  auto shown =
      std::find_if(data.frames.begin(), data.frames.end(), [&](const PageFrame& f) { return f.states == compared; });
  if (shown == data.frames.end()) shown = data.frames.insert(shown, PageFrame{kNaN, compared});
  data.frame = static_cast<int>(shown - data.frames.begin());
  for (PageFrame& f : data.frames)
    for (std::size_t i = 0; i < files.size(); ++i)
      if (f.states[i] >= 0 && !is_solution(files[i], f.states[i])) f.unsolved.push_back(static_cast<int>(i));
}

/// What maps hold, at nodes and facets.
struct Found {
  ValueRange nodes, facets;
  double usual = 0.0;  ///< largest of the results'
  void add(const Found& other) {
    nodes.add(other.nodes);
    facets.add(other.facets);
    usual = std::max(usual, other.usual);
  }
};

/// One quantity of a surface in all results.
struct Quantity {
  std::string name;  ///< as in PageQuantity::field
  const std::vector<std::optional<PageField>>& fields;
  const std::vector<ResultSurface>& own;
  const std::vector<NodeMatch>& matches;
  const std::vector<PageFrame>& frames;
};

/// Gaps have been taken out by read_field: what is 0 now is one.
MapValues shown_values(const Quantity& q, std::size_t result, std::size_t state) {
  return map_values(q.own[result], kAsTheyAre, q.fields[result]->states[state]);
}

/// Which list of values a frame shows; the result has a state in it.
std::size_t state_in_frame(const Quantity& q, std::size_t result, std::size_t frame) {
  return q.fields[result]->fixed ? 0 : at(q.frames[frame].states[result]);
}

PageScale page_scale(const Quantity& q, ValueRange range, double usual, ColourMap map) {
  if (q.name == "gap" && map == ColourMap::Sequential && !range.empty()) range.least = std::max(range.least, 0.0);
  ScaleKind kind;
  kind.map = map;
  kind.pressure = q.name == "pressure";
  kind.usual = usual;
  return {map_scale(kind, range), range};
}

/// `each`: per frame.
void set_scales(const Quantity& q, const Found& all, const std::vector<Found>& each, ColourMap map, PageQuantity& out) {
  out.nodes.all = page_scale(q, all.nodes, all.usual, map);
  out.facets.all = page_scale(q, all.facets, all.usual, map);
  for (const Found& found : each) {
    out.nodes.frames.push_back(page_scale(q, found.nodes, found.usual, map));
    out.facets.frames.push_back(page_scale(q, found.facets, found.usual, map));
  }
}

/// Per list of values of a result.
std::vector<Found> find_in_states(const Quantity& q, std::size_t result) {
  const PageField& field = *q.fields[result];
  std::vector<Found> found(field.states.size());
  parallel_for(found.size(), [&](std::size_t k) {
    if (field.states[k].empty()) return;
    const MapValues v = shown_values(q, result, k);
    found[k].nodes.add(v.vertices);
    found[k].facets.add(v.facets);
    if (q.name != "space") return;
    std::vector<std::pair<double, double>> areas;
    add_areas(q.own[result], v.facets, areas);
    found[k].usual = most_of_area_below(std::move(areas));
  });
  return found;
}

/// In all states of a result together.
Found find_in_result(const Quantity& q, std::size_t result, const std::vector<Found>& in_states) {
  Found together;
  for (const Found& found : in_states) together.add(found);
  if (q.name != "space") return together;
  std::vector<std::pair<double, double>> areas;
  for (const std::vector<double>& values : q.fields[result]->states) add_areas(q.own[result], values, areas);
  together.usual = most_of_area_below(std::move(areas));
  return together;
}

/// Two results of which the page can show the difference.
struct ResultPair {
  std::size_t a, b;
  bool same_mesh;
  std::vector<Found> frames;
};

std::vector<ResultPair> result_pairs(const Quantity& q, const PageSurface& s) {
  const std::size_t n = q.fields.size();
  std::vector<ResultPair> pairs;
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b) {
      const bool same = s.same_mesh[a] && s.same_mesh[b];
      if (q.fields[a] && q.fields[b] && (b + 1 == n || same))
        pairs.push_back({a, b, same, std::vector<Found>(q.frames.size())});
    }
  }
  return pairs;
}

/// The difference of a pair in one frame.
Found find_difference(const Quantity& q, const ResultPair& pair, const MapValues& x, const MapValues& y) {
  Found found;
  const std::vector<double> carried =
      pair.same_mesh ? std::vector<double>() : carry_values(q.matches[pair.a], q.own[pair.a], x.vertices);
  const std::vector<double>& from = pair.same_mesh ? x.vertices : carried;
  for (std::size_t i = 0; i < y.vertices.size(); ++i) found.nodes.add(from[i] - y.vertices[i]);
  if (pair.same_mesh)
    for (std::size_t i = 0; i < y.facets.size(); ++i) found.facets.add(x.facets[i] - y.facets[i]);
  else
    found.facets = found.nodes;  // facets of other meshes have no difference: nodes are shown
  return found;
}

void find_differences(const Quantity& q, std::vector<ResultPair>& pairs) {
  parallel_for(pairs.empty() ? 0 : q.frames.size(), [&](std::size_t f) {
    std::vector<std::optional<MapValues>> values(q.fields.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!q.fields[i] || q.frames[f].states[i] < 0) continue;
      const std::size_t k = state_in_frame(q, i, f);
      if (!q.fields[i]->states[k].empty()) values[i] = shown_values(q, i, k);
    }
    for (ResultPair& pair : pairs)
      if (values[pair.a] && values[pair.b]) pair.frames[f] = find_difference(q, pair, *values[pair.a], *values[pair.b]);
  });
}

/// Ends and lines of one quantity's maps, and of its differences.
void add_scales(const Quantity& q, PageSurface& s) {
  if (std::none_of(q.fields.begin(), q.fields.end(), [](const auto& f) { return f.has_value(); })) return;
  Found all;
  std::vector<Found> of_frames(q.frames.size());
  for (std::size_t i = 0; i < q.fields.size(); ++i) {
    if (!q.fields[i]) continue;
    const std::vector<Found> in_states = find_in_states(q, i);
    all.add(find_in_result(q, i, in_states));
    for (std::size_t f = 0; f < q.frames.size(); ++f)
      if (q.frames[f].states[i] >= 0) of_frames[f].add(in_states[state_in_frame(q, i, f)]);
  }
  s.scales.push_back({q.name, -1, -1, {}, {}});
  set_scales(q, all, of_frames, ColourMap::Sequential, s.scales.back());

  std::vector<ResultPair> pairs = result_pairs(q, s);
  find_differences(q, pairs);
  for (const ResultPair& pair : pairs) {
    Found together;
    for (const Found& found : pair.frames) together.add(found);
    s.differences.push_back({q.name, static_cast<int>(pair.a), static_cast<int>(pair.b), {}, {}});
    set_scales(q, together, pair.frames, ColourMap::Diverging, s.differences.back());
  }
}

/// Per state of a file the surface of its mesh that has the same facets as the compared one; -1: none.
std::vector<int> surfaces_in_states(const ResultFile& file, int compared, int compared_surface,
                                    const std::string& name) {
  std::vector<int> surfaces;
  const XpltMesh& mesh = mesh_of(file, compared);
  for (int k = 0; k < static_cast<int>(file.xplt.states.size()); ++k) {
    const int surface = find_surface(file, k, name);
    const XpltMesh& other = mesh_of(file, k);
    const bool same =
        surface >= 0 && (&other == &mesh ? surface == compared_surface
                                         : other.surfaces[at(surface)] == mesh.surfaces[at(compared_surface)] &&
                                               other.coordinates == mesh.coordinates);
    surfaces.push_back(same ? surface : -1);
  }
  return surfaces;
}

void read_fields(const ResultFile& file, const std::vector<int>& surfaces, PageSurface& s,
                 std::vector<std::string>& warnings) {
  s.pressure.push_back(read_field(file, surfaces, "contact pressure", false, true, warnings));
  s.thickness.push_back(read_field(file, surfaces, "cartilage thickness", true, false, warnings));
  s.space.push_back(read_field(file, surfaces, "joint space", true, false, warnings));
  s.gap.push_back(read_field(file, surfaces, "contact gap", true, true, warnings));
  if (s.gap.back() && nothing_but_zeros(*s.gap.back())) s.gap.back().reset();
}

/// The mesh each result is shown on: the last one's, or its own where that is another.
void add_geometry(const std::vector<ResultFile>& files, const std::vector<int>& compared,
                  const std::vector<ResultSurface>& own, const std::vector<NodeMatch>& matches, PageSurface& s) {
  const std::size_t n = files.size();
  for (std::size_t i = 0; i < n; ++i) {
    const bool same = i + 1 == n || matches[i].same_mesh;
    const std::size_t shown = same ? n - 1 : i;
    s.same_mesh.push_back(same);
    s.geometry.push_back(own[shown]);
    s.node_ids.emplace_back();
    const XpltMesh& mesh = mesh_of(files[shown], compared[shown]);
    for (int node : own[shown].mesh.model_nodes) s.node_ids.back().push_back(mesh.node_ids[at(node)]);
    s.carry.push_back(same ? std::nullopt : std::optional<PageCarry>(make_carry(matches[i], own[i])));
  }
}

void add_edges(const ResultSurface& own, PageField& field) {
  const MapMesh mesh = make_map_mesh(own);
  field.edges.resize(field.states.size());
  parallel_for(field.states.size(), [&](std::size_t k) {
    const std::vector<double>& p = field.states[k];
    field.edges[k] = p.empty() ? kInfinity : edge_level(mesh, p, point_values(mesh, nodal_average(own, p)));
  });
}

/// The numbers of every state.
void add_measures(const std::vector<ResultFile>& files, const std::vector<ResultSurface>& own,
                  const std::vector<Region>& regions, PageSurface& s) {
  s.measures.resize(files.size());
  for (std::size_t i = 0; i < files.size(); ++i) {
    s.measures[i].resize(files[i].xplt.states.size(), std::vector<Json>(regions.size()));
    parallel_for(s.measures[i].size(), [&](std::size_t k) {
      SurfaceValues v;
      v.pressure = pressure_in(s, i, k);
      if (v.pressure.empty()) return;
      for (std::size_t r = 0; r < regions.size(); ++r)
        s.measures[i][k][r] = measures_json(own[i], v, regions[r].masks[i]);
    });
  }
}

/// Per frame what needs the pressure at nodes: patterns against the last result, profiles (`of_surface` has any).
void add_patterns(const std::vector<PageFrame>& frames, const std::vector<ResultSurface>& own,
                  const std::vector<NodeMatch>& matches, const std::vector<Region>& regions,
                  const ComparedSurface* of_surface, double bin, PageSurface& s) {
  const std::size_t n = own.size();
  s.patterns.resize(frames.size(), std::vector<std::vector<Json>>(regions.size(), std::vector<Json>(n)));
  const bool profile = of_surface != nullptr && !of_surface->profiles.empty();
  if (profile) s.profiles.resize(frames.size(), std::vector<std::vector<double>>(n));
  std::vector<std::vector<double>> areas;
  for (const Region& region : regions) areas.push_back(nodal_areas(own.back(), region.masks.back()));
  parallel_for(frames.size(), [&](std::size_t f) {
    const std::vector<int>& states = frames[f].states;
    std::vector<std::vector<double>> nodal(n);
    for (std::size_t i = n; i-- > 0;) {
      if (states[i] < 0) continue;
      const std::vector<double> p = pressure_in(s, i, at(states[i]));
      if (p.empty()) continue;
      nodal[i] = nodal_average(own[i], p);
      if (profile)
        for (const ProfileBin& b : pressure_profile(own[i], p, of_surface->axis, of_surface->center, bin))
          s.profiles[f][i].push_back(b.mean);
      if (i + 1 == n || nodal[n - 1].empty()) continue;
      const std::vector<double> carried = carry_values(matches[i], own[i], nodal[i]);
      for (std::size_t r = 0; r < regions.size(); ++r)
        s.patterns[f][r][i] = pattern_json(carried, nodal[n - 1], areas[r]);
    }
  });
  if (!profile) return;
  std::size_t bins = 0;
  for (const auto& frame : s.profiles)
    for (const auto& p : frame) bins = std::max(bins, p.size());
  for (std::size_t b = 0; b <= bins; ++b) s.bins.push_back(bin * static_cast<double>(b));
}

/// `compared`: the state of each file whose mesh is shown.
PageSurface make_surface(const std::vector<ResultFile>& files, const std::vector<int>& compared,
                         const std::vector<std::string>& names, const CompareOptions& options,
                         const ComparedSurface* of_surface, const PageData& data, std::vector<std::string>& warnings) {
  PageSurface s;
  s.names = names;
  const std::size_t n = files.size();
  std::vector<ResultSurface> own;
  for (std::size_t i = 0; i < n; ++i) {
    const int surface = find_surface(files[i], compared[i], names[i]);
    own.push_back(compared_surface(files[i], compared[i], surface, options.areas));
    read_fields(files[i], surfaces_in_states(files[i], compared[i], surface, names[i]), s, warnings);
  }
  std::vector<NodeMatch> matches;
  for (std::size_t i = 0; i + 1 < n; ++i) matches.push_back(match_nodes(own.back(), own[i]));
  add_geometry(files, compared, own, matches, s);
  s.title = names.front();
  for (std::size_t i = 1; i < n; ++i)
    if (names[i] != names.front()) s.title += " = " + names[i];
  place_camera(s, own.front(), compared.front(), options);
  for (std::size_t i = 0; i < n; ++i)
    if (s.pressure[i]) add_edges(own[i], *s.pressure[i]);

  add_scales({"pressure", s.pressure, own, matches, data.frames}, s);
  add_scales({"thickness", s.thickness, own, matches, data.frames}, s);
  add_scales({"space", s.space, own, matches, data.frames}, s);
  add_scales({"gap", s.gap, own, matches, data.frames}, s);

  std::vector<SurfaceIn> on;
  for (std::size_t i = 0; i < n; ++i) on.push_back({find_surface(files[i], compared[i], names[i]), &own[i]});
  const std::vector<Region> regions = make_regions(files, compared, on, options, surface_frame(own.back()));
  for (const Region& region : regions) s.regions.push_back(region.name);
  add_measures(files, own, regions, s);
  add_patterns(data.frames, own, matches, regions, of_surface, options.bin, s);
  return s;
}

Json results_json(const std::vector<ResultFile>& files) {
  return list_json(files, [](const ResultFile& file) -> Json {
    return {{"label", file.label},
            {"file", file_name(file.path)},
            {"software", file.xplt.software},
            {"times", list_json(file.xplt.states, [](const XpltState& s) { return time_json(s.time); })}};
  });
}

/// Cells may name files.
void drop_folders(PageData& data, const std::vector<std::string>& paths) {
  for (std::string& line : data.warnings) line = without_folders(line, paths);
  data.recognised = without_folders(data.recognised, paths);
  for (TitledTable& t : data.tables) t.title = without_folders(t.title, paths);
}

/// The contacts' surfaces, each once: springs' surfaces first, whose facets carry the springs' own force.
std::vector<std::string> contact_surfaces(const JointModel& model, const Joint& joint) {
  std::vector<std::string> names;
  for (const bool source : {true, false}) {
    for (const ContactPair& pair : joint.contacts) {
      const Layer& layer = source ? pair.source_layer() : pair.target_layer();
      const std::string& name = model.surfaces[at(layer.surface)].name;
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

}  // namespace

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t i = text.find(from); i != std::string::npos; i = text.find(from, i + to.size()))
    text.replace(i, from.size(), to);
}

std::string without_folders(std::string text, const std::vector<std::string>& files) {
  for (const std::string& path : files)
    if (fs::path(path).has_parent_path()) replace_all(text, path, file_name(path));
  return text;
}

std::string command_text(const std::vector<std::string>& words, const std::vector<std::string>& files) {
  std::string text;
  for (std::string word : words) {
    if (text.empty()) {
      word = file_name(word);
    } else if (fs::path(word).is_absolute() && word.size() > 1) {
      word = fs::path(word).has_filename() ? file_name(word) : file_name(word.substr(0, word.size() - 1));
    } else {
      word = without_folders(word, files);
      for (std::size_t i = word.find('='); word.rfind("--", 0) == 0 && i != word.npos; i = word.find('=', i + 1))
        if (fs::path(word.substr(i + 1)).is_absolute()) word = word.substr(0, i + 1) + file_name(word.substr(i + 1));
    }
    const bool plain = !word.empty() && word.find_first_of(" \t\n\"'\\$`<>|&;()*?[]#~!{}") == std::string::npos;
    if (!plain) {
      replace_all(word, "'", "'\\''");
      word = "'" + word + "'";
    }
    text += (text.empty() ? "" : " ") + word;
  }
  return text;
}

PageData compare_page(const std::vector<ResultFile>& files, const CompareOptions& options, const Comparison& comparison,
                      const std::vector<std::string>& words) {
  PageData data;
  data.kind = "compare";
  for (std::size_t i = 0; i + 1 < files.size(); ++i)
    data.title += fmt::format("{}{}", i == 0 ? "" : i + 2 == files.size() ? " and " : ", ", files[i].label);
  data.title += " against " + files.back().label;
  data.command = command_text(words, comparison.paths);
  data.units = unit_names(comparison.units);
  data.results = results_json(files);
  make_frames(files, comparison.states, data);
  data.warnings = comparison.warnings;
  for (const ComparedSurface& surface : comparison.surfaces) {
    data.surfaces.push_back(
        make_surface(files, comparison.states, surface.names, options, &surface, data, data.warnings));
    if (!surface.asked_for) data.surfaces.back().note = "not every result has pressure here";
  }
  const int state = comparison.states.front();
  std::vector<int> surfaces;
  for (const ComparedSurface& surface : comparison.surfaces)
    surfaces.push_back(find_surface(files.front(), state, surface.names.front()));
  data.context = make_context(mesh_of(files.front(), state));
  add_motion(files.front(), state, surfaces, data.context);
  data.tables = compare_tables(comparison, true);
  drop_folders(data, comparison.paths);
  return data;
}

PageData run_page(const JointModel& model, const Analysis& analysis, const ResultFile& file,
                  const std::string& recognised, const std::vector<std::string>& words,
                  const std::vector<std::string>& paths) {
  PageData data;
  data.kind = "run";
  data.title = file.label;
  data.command = command_text(words, paths);
  data.units = unit_names(file.xplt.units);
  const std::vector<ResultFile> files = {file};
  data.results = results_json(files);
  data.warnings = lines(analysis.findings, command_line_wording());
  if (!file.xplt.states.empty()) {
    const int last = static_cast<int>(file.xplt.states.size()) - 1;
    make_frames(files, {last}, data);
    std::vector<int> surfaces;
    for (const std::string& name : contact_surfaces(model, analysis.joint)) {
      const int surface = find_surface(file, last, name);
      if (surface < 0 || !(result_surface(file, last, surface).mesh.size() > 0)) continue;
      surfaces.push_back(surface);
      data.surfaces.push_back(make_surface(files, {last}, {name}, {}, nullptr, data, data.warnings));
    }
    data.context = make_context(mesh_of(file, last));
    add_motion(file, last, surfaces, data.context);
  }
  data.charts = run_charts(analysis);
  data.tables = run_tables(analysis, false, data.units);
  data.recognised = recognised;
  std::vector<std::string> all = paths;
  all.insert(all.end(), model.files.begin(), model.files.end());
  drop_folders(data, all);
  return data;
}

}  // namespace dea
