#include <febiodea/views/page/report_data.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <tuple>
#include <unordered_map>

#include <febiodea/base/error.h>
#include <febiodea/base/numbers.h>
#include <febiodea/model/element_faces.h>
#include <febiodea/views/map/map_geometry.h>
#include <febiodea/views/text/report_compare.h>

namespace dea {

namespace {

namespace fs = std::filesystem;

constexpr double kDegrees = 57.29577951308232;
constexpr const char* kAsTheyAre = "contact pressure";  ///< for map_values: 0 is a value
constexpr std::size_t kMostContextTriangles = 150000;

std::string file_name(const std::string& path) { return fs::path(path).filename().string(); }

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t i = text.find(from); i != std::string::npos; i = text.find(from, i + to.size()))
    text.replace(i, from.size(), to);
}

/// The same facets as in the state that the surface's mesh is of?
bool same_surface(const ResultFile& file, int state, const std::string& name, int compared, int compared_surface) {
  const int surface = find_surface(file, state, name);
  if (surface < 0) return false;
  if (file.plot.states[at(state)].mesh == file.plot.states[at(compared)].mesh) return surface == compared_surface;
  return mesh_of(file, state).surfaces[at(surface)] == mesh_of(file, compared).surfaces[at(compared_surface)] &&
         mesh_of(file, state).coordinates == mesh_of(file, compared).coordinates;
}

/// Equal, and undefined at the same places.
bool same_values(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) {
           return x == y || (std::isnan(x) && std::isnan(y));
         });
}

/// A scalar field of a surface in all states; none: no state has it, or it cannot be shown (a warning says why).
/// `undefined`: values that are not finite are gaps of the map, otherwise refused. `zero`: 0 is a value.
std::optional<ReportField> read_field(const ResultFile& file, const std::vector<int>& surfaces,
                                      const std::string& field, bool undefined, bool zero,
                                      std::vector<std::string>& warnings) {
  ReportField out;
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

bool nothing_but_zeros(const ReportField& field) {
  for (const std::vector<double>& values : field.states)
    for (double x : values)
      if (x != 0 && !std::isnan(x)) return false;
  return true;
}

/// The area-weighted least-squares line b -> a over the nodes that pattern_difference takes.
ReportPattern pattern(const std::vector<double>& a, const std::vector<double>& b, const std::vector<double>& areas) {
  ReportPattern out;
  out.difference = pattern_difference(a, b, areas, {0.0});
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
  out.slope = bb > 1e-24 * total * mean_b * mean_b && bb > 0 ? ab / bb : kNaN;
  out.intercept = mean_a - out.slope * mean_b;
  return out;
}

ReportCarry make_carry(const NodeMatch& match, const ResultSurface& from) {
  ReportCarry carry;
  for (const SurfacePoint& point : match.points) {
    for (std::size_t k = 0; k < 3; ++k) {
      carry.vertices.push_back(point.triangle < 0 ? -1 : from.mesh.triangles[at(point.triangle)][k]);
      carry.weights.push_back(point.triangle < 0 ? 0.0f : static_cast<float>(point.weights[k]));
    }
  }
  return carry;
}

/// What to look at first: the whole surface, as dea plot shows the first result's.
void place_camera(ReportSurface& s, const ResultSurface& first, int state, const CompareOptions& options) {
  const ResultSurface& g = s.geometry.back();
  std::vector<double> load(at(first.facets()), 0.0);
  if (s.pressure.front()) {
    const ReportField& field = *s.pressure.front();
    const std::vector<double>& pressure = field.states[field.fixed ? 0 : at(state)];
    for (std::size_t f = 0; f < pressure.size(); ++f) load[f] = std::max(pressure[f], 0.0);
  }
  const MapView view = view_from(default_direction(first, load), options.thirds ? options.up : Vector3d(0, 0, 0));
  s.axis = view.toward;
  s.up = view.up;
  Vector3d least = Vector3d::Constant(std::numeric_limits<double>::infinity()), most = -least;
  for (const Vector3d& x : g.mesh.vertices) {
    least = least.cwiseMin(x);
    most = most.cwiseMax(x);
  }
  s.center = 0.5 * (least + most);
  s.radius = 0.0;
  for (const Vector3d& x : g.mesh.vertices) s.radius = std::max(s.radius, (x - s.center).norm());
}

std::vector<std::vector<FacetMask>> region_masks(const std::vector<ResultFile>& files, const std::vector<int>& states,
                                                 const ReportSurface& s, const std::vector<ResultSurface>& own,
                                                 const CompareOptions& options) {
  std::vector<std::vector<FacetMask>> masks(1, std::vector<FacetMask>(files.size()));  // region, result
  for (const std::string& name : options.regions) {
    masks.emplace_back();
    for (std::size_t i = 0; i < files.size(); ++i)
      masks.back().push_back(facets_in(files[i], states[i], find_surface(files[i], states[i], s.names[i]), name));
  }
  if (!options.thirds) return masks;
  SurfaceFrame frame = surface_frame(own.back());
  if (options.axis) frame.axis = options.axis->normalized();
  if (options.center) frame.center = *options.center;
  masks.resize(masks.size() + 3);
  for (const ResultSurface& surface : own) {
    const std::array<FacetMask, 3> third = thirds(surface, frame, options.up, options.anterior);
    for (std::size_t k = 0; k < 3; ++k) masks[masks.size() - 3 + k].push_back(third[k]);
  }
  return masks;
}

/// States of the results that show the same time, and the compared ones.
void make_frames(const std::vector<ResultFile>& files, const std::vector<int>& compared, ReportData& data) {
  std::vector<ReportFrame> all, common;
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (std::size_t k = 0; k < files[i].plot.states.size(); ++k) {
      const double time = files[i].plot.states[k].time;
      auto frame = std::find_if(all.begin(), all.end(), [&](const ReportFrame& f) {
        return same_time(f.time, time) && f.states[i] < 0;  // a file may have two states at one time
      });
      if (frame == all.end()) {
        all.push_back({time, std::vector<int>(files.size(), -1)});
        frame = all.end() - 1;
      }
      frame->states[i] = static_cast<int>(k);
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const ReportFrame& a, const ReportFrame& b) { return a.time < b.time; });
  for (const ReportFrame& f : all)
    if (std::find(f.states.begin(), f.states.end(), -1) == f.states.end()) common.push_back(f);
  data.frames = common.size() >= 2 ? common : all;
  for (std::size_t f = 0; f < data.frames.size(); ++f) {
    if (data.frames[f].states != compared) continue;
    data.frame = static_cast<int>(f);
    return;
  }
  data.frames.push_back({kNaN, compared});
  data.frame = static_cast<int>(data.frames.size()) - 1;
}

/// Ends and lines of one quantity's maps, and of its differences.
void add_scales(const std::string& field, const std::vector<std::optional<ReportField>>& fields,
                const std::vector<ResultSurface>& own, const std::vector<NodeMatch>& matches,
                const std::vector<ReportFrame>& frames, ReportSurface& s) {
  if (std::none_of(fields.begin(), fields.end(), [](const auto& f) { return f.has_value(); })) return;
  struct Found {
    ValueRange nodes, facets;
    double usual = 0.0;  ///< largest of the results'
    void add(const Found& other) {
      nodes.add(other.nodes);
      facets.add(other.facets);
      usual = std::max(usual, other.usual);
    }
  };
  const std::size_t n = fields.size();
  // gaps have been taken out by read_field: what is 0 now is one
  const auto shown = [&](std::size_t i, std::size_t k) { return map_values(own[i], kAsTheyAre, fields[i]->states[k]); };
  const auto finish = [&](const Found& found, ColourMap map) {
    const auto scale = [&](ValueRange range) {
      if (field == "gap" && map == ColourMap::Sequential && !range.empty()) range.least = std::max(range.least, 0.0);
      ScaleKind kind;
      kind.map = map;
      kind.pressure = field == "pressure";
      kind.usual = found.usual;
      return ReportScale{map_scale(kind, range), range};
    };
    return std::pair{scale(found.nodes), scale(found.facets)};
  };
  const auto fill = [&](const Found& all, const std::vector<Found>& each, ColourMap map, ReportQuantity& q) {
    std::tie(q.nodes.all, q.facets.all) = finish(all, map);
    for (const Found& found : each) {
      const auto pair = finish(found, map);
      q.nodes.frames.push_back(pair.first);
      q.facets.frames.push_back(pair.second);
    }
  };

  Found all;
  std::vector<Found> of_frames(frames.size());
  for (std::size_t i = 0; i < n; ++i) {
    if (!fields[i]) continue;
    std::vector<Found> of_states(fields[i]->states.size());
    tbb::parallel_for(std::size_t{0}, of_states.size(), [&](std::size_t k) {
      if (fields[i]->states[k].empty()) return;
      const MapValues v = shown(i, k);
      of_states[k].nodes.add(v.vertices);
      of_states[k].facets.add(v.facets);
      if (field != "space") return;
      std::vector<std::pair<double, double>> areas;
      add_areas(own[i], v.facets, areas);
      of_states[k].usual = most_of_area_below(std::move(areas));
    });
    Found mine;
    for (const Found& found : of_states) mine.add(found);
    if (field == "space") {
      std::vector<std::pair<double, double>> areas;
      for (const std::vector<double>& values : fields[i]->states) add_areas(own[i], values, areas);
      mine.usual = most_of_area_below(std::move(areas));
    }
    all.add(mine);
    for (std::size_t f = 0; f < frames.size(); ++f)
      if (frames[f].states[i] >= 0) of_frames[f].add(of_states[fields[i]->fixed ? 0 : at(frames[f].states[i])]);
  }
  s.scales.push_back({field, -1, -1, {}, {}});
  fill(all, of_frames, ColourMap::Sequential, s.scales.back());

  struct Pair {
    std::size_t a, b;
    bool same;
    std::vector<Found> frames;
  };
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b) {
      const bool same = s.same_mesh[a] && s.same_mesh[b];
      if (fields[a] && fields[b] && (b + 1 == n || same))
        pairs.push_back({a, b, same, std::vector<Found>(frames.size())});
    }
  }
  tbb::parallel_for(std::size_t{0}, pairs.empty() ? 0 : frames.size(), [&](std::size_t f) {
    std::vector<std::optional<MapValues>> values(n);
    for (std::size_t i = 0; i < n; ++i) {
      if (!fields[i] || frames[f].states[i] < 0) continue;
      const std::size_t k = fields[i]->fixed ? 0 : at(frames[f].states[i]);
      if (!fields[i]->states[k].empty()) values[i] = shown(i, k);
    }
    for (Pair& pair : pairs) {
      if (!values[pair.a] || !values[pair.b]) continue;
      const MapValues &x = *values[pair.a], &y = *values[pair.b];
      Found& found = pair.frames[f];
      const std::vector<double> carried =
          pair.same ? std::vector<double>() : carry_values(matches[pair.a], own[pair.a], x.vertices);
      const std::vector<double>& from = pair.same ? x.vertices : carried;
      for (std::size_t i = 0; i < y.vertices.size(); ++i) found.nodes.add(from[i] - y.vertices[i]);
      if (pair.same)
        for (std::size_t i = 0; i < y.facets.size(); ++i) found.facets.add(x.facets[i] - y.facets[i]);
      else
        found.facets = found.nodes;  // facets of other meshes have no difference: nodes are shown
    }
  });
  for (const Pair& pair : pairs) {
    Found together;
    for (const Found& found : pair.frames) together.add(found);
    s.differences.push_back({field, static_cast<int>(pair.a), static_cast<int>(pair.b), {}, {}});
    fill(together, pair.frames, ColourMap::Diverging, s.differences.back());
  }
}

/// `compared`: the state of each file whose mesh is shown.
ReportSurface make_surface(const std::vector<ResultFile>& files, const std::vector<int>& compared,
                           const std::vector<std::string>& names, const CompareOptions& options,
                           const ComparedSurface* how, const ReportData& data, std::vector<std::string>& warnings) {
  ReportSurface s;
  s.names = names;
  const std::size_t n = files.size();
  std::vector<ResultSurface> own;
  std::vector<std::vector<int>> in_state(n);  // result, state -> surface of the state's mesh, -1
  for (std::size_t i = 0; i < n; ++i) {
    const int surface = find_surface(files[i], compared[i], names[i]);
    own.push_back(compared_surface(files[i], compared[i], surface, options.areas));
    for (int k = 0; k < static_cast<int>(files[i].plot.states.size()); ++k)
      in_state[i].push_back(
          same_surface(files[i], k, names[i], compared[i], surface) ? find_surface(files[i], k, names[i]) : -1);
    s.pressure.push_back(read_field(files[i], in_state[i], "contact pressure", false, true, warnings));
    s.thickness.push_back(read_field(files[i], in_state[i], "cartilage thickness", true, false, warnings));
    s.space.push_back(read_field(files[i], in_state[i], "joint space", true, false, warnings));
    s.gap.push_back(read_field(files[i], in_state[i], "contact gap", true, true, warnings));
    if (s.gap.back() && nothing_but_zeros(*s.gap.back())) s.gap.back().reset();
  }

  std::vector<NodeMatch> matches;
  for (std::size_t i = 0; i + 1 < n; ++i) matches.push_back(match_nodes(own.back(), own[i]));
  for (std::size_t i = 0; i < n; ++i) {
    const bool same = i + 1 == n || matches[i].same_mesh;
    const std::size_t shown = same ? n - 1 : i;
    s.same_mesh.push_back(same);
    s.geometry.push_back(own[shown]);
    s.node_ids.emplace_back();
    const XpltMesh& mesh = mesh_of(files[shown], compared[shown]);
    for (int node : own[shown].mesh.model_nodes) s.node_ids.back().push_back(mesh.node_ids[at(node)]);
    s.carry.push_back(same ? std::nullopt : std::optional<ReportCarry>(make_carry(matches[i], own[i])));
  }
  s.title = names.front();
  for (std::size_t i = 1; i < n; ++i)
    if (names[i] != names.front()) s.title += " = " + names[i];
  place_camera(s, own.front(), compared.front(), options);
  for (std::size_t i = 0; i < n; ++i) {
    if (!s.pressure[i]) continue;
    ReportField& field = *s.pressure[i];
    const MapMesh mesh = make_map_mesh(own[i]);
    field.edges.resize(field.states.size());
    tbb::parallel_for(std::size_t{0}, field.states.size(), [&](std::size_t k) {
      const std::vector<double>& p = field.states[k];
      field.edges[k] = p.empty() ? std::numeric_limits<double>::infinity()
                                 : edge_level(mesh, p, point_values(mesh, nodal_average(own[i], p)));
    });
  }

  add_scales("pressure", s.pressure, own, matches, data.frames, s);
  add_scales("thickness", s.thickness, own, matches, data.frames, s);
  add_scales("space", s.space, own, matches, data.frames, s);
  add_scales("gap", s.gap, own, matches, data.frames, s);

  s.regions = {""};
  s.regions.insert(s.regions.end(), options.regions.begin(), options.regions.end());
  if (options.thirds) s.regions.insert(s.regions.end(), {"anterior", "superior", "posterior"});
  const std::vector<std::vector<FacetMask>> masks = region_masks(files, compared, s, own, options);

  // Numbers of every state, and what frames need of them: pressure at the result's own nodes, at the reference's.
  const auto values = [&](std::size_t i, std::size_t k) {
    SurfaceValues v;
    if (s.pressure[i]) v.pressure = s.pressure[i]->states[s.pressure[i]->fixed ? 0 : k];
    return v;
  };
  s.measures.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    s.measures[i].resize(files[i].plot.states.size(), std::vector<ReportMeasures>(masks.size()));
    tbb::parallel_for(std::size_t{0}, s.measures[i].size(), [&](std::size_t k) {
      const SurfaceValues v = values(i, k);
      if (v.pressure.empty()) return;
      for (std::size_t r = 0; r < masks.size(); ++r)
        s.measures[i][k][r] = {true, measure(own[i], v, {0.0}, masks[r][i])};
    });
  }
  s.patterns.resize(data.frames.size(), std::vector<std::vector<std::optional<ReportPattern>>>(
                                            masks.size(), std::vector<std::optional<ReportPattern>>(n)));
  const bool profile = how != nullptr && !how->profiles.empty();
  if (profile) s.profiles.resize(data.frames.size(), std::vector<std::vector<double>>(n));
  std::vector<std::vector<double>> areas;
  for (const auto& mask : masks) areas.push_back(nodal_areas(own.back(), mask.back()));
  tbb::parallel_for(std::size_t{0}, data.frames.size(), [&](std::size_t f) {
    const std::vector<int>& states = data.frames[f].states;
    std::vector<std::vector<double>> nodal(n);
    for (std::size_t i = n; i-- > 0;) {
      if (states[i] < 0) continue;
      const std::vector<double> p = values(i, at(states[i])).pressure;
      if (p.empty()) continue;
      nodal[i] = nodal_average(own[i], p);
      if (profile)
        for (const ProfileBin& bin : pressure_profile(own[i], p, how->axis, how->center, options.bin))
          s.profiles[f][i].push_back(bin.mean);
      if (i + 1 == n || nodal[n - 1].empty()) continue;
      const std::vector<double> carried = carry_values(matches[i], own[i], nodal[i]);
      for (std::size_t r = 0; r < masks.size(); ++r) s.patterns[f][r][i] = pattern(carried, nodal[n - 1], areas[r]);
    }
  });
  if (profile) {
    std::size_t bins = 0;
    for (const auto& frame : s.profiles)
      for (const auto& p : frame) bins = std::max(bins, p.size());
    for (std::size_t b = 0; b <= bins; ++b) s.bins.push_back(options.bin * static_cast<double>(b));
  }
  return s;
}

/// Triangles of faces that belong to one solid element only, and of shells.
ReportContext make_context(const XpltMesh& mesh) {
  ReportContext context;
  std::unordered_map<int, ElementShape> shapes;
  for (int i = 0; i <= static_cast<int>(ElementShape::Line3); ++i)
    shapes[xplt_element_type(static_cast<ElementShape>(i))] = static_cast<ElementShape>(i);
  std::vector<Vector3d> positions(mesh.node_ids.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    positions[i] = Vector3d(mesh.coordinates[3 * i], mesh.coordinates[3 * i + 1], mesh.coordinates[3 * i + 2]);

  struct Face {
    std::vector<int> nodes;
    int part = 0, times = 0;
    bool shell = false;
  };
  std::map<std::vector<int>, Face> faces;  // by sorted corners
  for (const XpltDomain& domain : mesh.domains) {
    const auto shape = shapes.find(domain.element_type);
    if (shape == shapes.end() || domain.part < 1 || domain.part > static_cast<int>(mesh.parts.size())) continue;
    const int n = xplt_nodes_per_element(domain.element_type);
    if (faces.size() > 20 * kMostContextTriangles) break;
    for (int e = 0; e < xplt_elements(domain); ++e) {
      for (const std::vector<int>& local : element_faces(shape->second)) {
        Face face;
        for (int k : local) face.nodes.push_back(domain.nodes[at(e * n + k)]);
        face.part = domain.part - 1;
        face.shell = element_faces(shape->second).size() == 1;
        std::vector<int> key(face.nodes.begin(), face.nodes.begin() + facet_corners(static_cast<int>(local.size())));
        std::sort(key.begin(), key.end());
        Face& known = faces[key];
        face.times = known.times + (face.shell ? 0 : 1);
        if (known.nodes.empty() || (face.shell && !known.shell))
          known = std::move(face);
        else
          known.times = face.times;
      }
    }
  }
  std::vector<std::vector<std::array<int, 3>>> triangles(mesh.parts.size());
  std::size_t count = 0;
  for (const auto& entry : faces) {
    const Face& face = entry.second;
    if (face.times > 1 && !face.shell) continue;
    const bool finite =
        std::all_of(face.nodes.begin(), face.nodes.end(), [&](int i) { return positions[at(i)].allFinite(); });
    if (!finite) continue;
    for (const auto& t : split_facet(face.nodes.data(), static_cast<int>(face.nodes.size()), positions)) {
      triangles[at(face.part)].push_back(t);
      ++count;
    }
  }
  if (count > kMostContextTriangles || faces.size() > 20 * kMostContextTriangles) {
    context.note = "The rest of the mesh is left out: it is too large to be drawn as a veil.";
    return context;
  }
  std::unordered_map<int, std::int32_t> vertex;
  for (std::size_t p = 0; p < triangles.size(); ++p) {
    if (triangles[p].empty()) continue;
    for (const auto& t : triangles[p]) {
      for (int node : t) {
        const auto added = vertex.try_emplace(node, static_cast<std::int32_t>(vertex.size()));
        if (added.second)
          for (int k = 0; k < 3; ++k) context.vertices.push_back(static_cast<float>(positions[at(node)][k]));
        context.triangles.push_back(added.first->second);
      }
    }
    context.parts.push_back(mesh.parts[p]);
    context.begin.push_back(static_cast<std::int32_t>(context.triangles.size() / 3));
  }
  return context;
}

void add_results(const std::vector<ResultFile>& files, ReportData& data) {
  for (const ResultFile& file : files) {
    ReportResult r;
    r.label = file.label;
    r.file = file_name(file.path);
    r.software = file.plot.software;
    for (const XpltState& state : file.plot.states) r.times.push_back(state.time);
    data.results.push_back(std::move(r));
  }
}

/// Cells may name files.
void drop_folders(ReportData& data, const std::vector<std::string>& paths) {
  for (std::string& line : data.warnings) line = without_folders(line, paths);
  for (ReportText& text : data.texts) text.text = without_folders(text.text, paths);
  for (TitledTable& t : data.tables) t.title = without_folders(t.title, paths);
}

std::vector<double> times_of(const Analysis& analysis) {
  std::vector<double> times;
  for (const StateResult& s : analysis.states) times.push_back(s.when.time);
  return times;
}

/// A chart with a curve per contact.
template <class Get>
ReportChart contact_chart(const Analysis& analysis, const std::string& title, const std::string& caption,
                          const std::string& quantity, const std::string& dimension, Get get) {
  ReportChart chart{title, caption, quantity, dimension, false, times_of(analysis), {}, {}};
  for (std::size_t c = 0; c < analysis.joint.contacts.size(); ++c) {
    chart.names.push_back(analysis.joint.contacts[c].name);
    chart.values.emplace_back();
    for (const StateResult& s : analysis.states) chart.values.back().push_back(get(s.statistics[c]));
  }
  return chart;
}

std::vector<ReportChart> run_charts(const Analysis& analysis) {
  const Joint& joint = analysis.joint;
  std::vector<ReportChart> charts;
  charts.push_back(contact_chart(analysis, "Contact force", "Resultant of each contact.", "force", "force",
                                 [](const ContactStatistics& s) { return s.force.norm(); }));
  charts.push_back(contact_chart(analysis, "Peak pressure", "Largest pressure of a spring.", "peak pressure",
                                 "pressure", [](const ContactStatistics& s) { return s.peak; }));
  charts.push_back(contact_chart(analysis, "Mean pressure", "Over the springs that carry, weighted by area.",
                                 "mean pressure", "pressure", [](const ContactStatistics& s) { return s.mean; }));
  charts.push_back(
      contact_chart(analysis, "Contact area", "Of the springs that carry.", "contact area", "area",
                    [](const ContactStatistics& s) { return s.springs_active > 0 ? s.contact_area : 0.0; }));

  const std::vector<int> bodies = reported_bodies(joint);
  const auto body_chart = [&](const std::string& title, const std::string& caption, const std::string& quantity,
                              const std::string& dimension, auto get) {
    ReportChart chart{title, caption, quantity, dimension, false, times_of(analysis), {}, {}};
    for (int b : bodies) {
      chart.names.push_back(joint.bodies[at(b)].name);
      chart.values.emplace_back();
      for (const StateResult& s : analysis.states) chart.values.back().push_back(get(s, b));
    }
    const bool moves = std::any_of(chart.values.begin(), chart.values.end(), [](const std::vector<double>& v) {
      return std::any_of(v.begin(), v.end(), [](double x) { return x != 0; });
    });
    if (moves) charts.push_back(std::move(chart));
  };
  body_chart("Motion of the bodies", "Distance of the centre of mass from its reference position.", "translation",
             "length", [&](const StateResult& s, int b) {
               return (s.equilibrium.poses[at(b)].center - joint.bodies[at(b)].center_of_mass).norm();
             });
  body_chart("Rotation of the bodies", "Angle from the reference orientation.", "rotation", "degrees",
             [&](const StateResult& s, int b) {
               return kDegrees * Eigen::AngleAxisd(s.equilibrium.poses[at(b)].rotation).angle();
             });

  ReportChart springs{"Ligaments and cables", "Tension.", "tension", "force", false, times_of(analysis), {}, {}};
  springs.names = spring_names(joint);
  for (std::size_t l = 0; l < joint.ligaments.size(); ++l) {
    springs.values.emplace_back();
    for (const StateResult& s : analysis.states)
      springs.values.back().push_back(l < s.equilibrium.ligament_force.size() ? s.equilibrium.ligament_force[l] : kNaN);
  }
  for (std::size_t c = 0; c < joint.cables.size(); ++c) {
    springs.values.emplace_back();
    for (const StateResult& s : analysis.states)
      springs.values.back().push_back(c < s.equilibrium.cable_force.size() ? s.equilibrium.cable_force[c] : kNaN);
  }
  if (!springs.names.empty()) charts.push_back(std::move(springs));

  ReportChart balance{"Balance",
                      "Force that is left unbalanced over the load; nothing where all motions are prescribed.",
                      "unbalanced force / load",
                      "",
                      true,
                      times_of(analysis),
                      {"unbalanced force / load"},
                      {{}}};
  for (const StateResult& s : analysis.states) {
    const double r = s.equilibrium.residual_force / s.equilibrium.load;
    balance.values.front().push_back(std::isfinite(r) && r > 0 ? r : kNaN);
  }
  if (std::any_of(balance.values.front().begin(), balance.values.front().end(),
                  [](double x) { return !std::isnan(x); }))
    charts.push_back(std::move(balance));
  return charts;
}

}  // namespace

std::string without_folders(std::string text, const std::vector<std::string>& files) {
  for (const std::string& path : files)
    if (path.find('/') != std::string::npos) replace_all(text, path, file_name(path));
  return text;
}

std::string command_text(const std::vector<std::string>& words, const std::vector<std::string>& files) {
  std::string text;
  for (std::string word : words) {
    if (text.empty()) {
      word = file_name(word);
    } else if (!word.empty() && word.front() == '/' && word.size() > 1) {
      word = fs::path(word).has_filename() ? file_name(word) : file_name(word.substr(0, word.size() - 1));
    } else {
      word = without_folders(word, files);
      const std::size_t equals = word.find("=/");
      if (word.compare(0, 2, "--") == 0 && equals != std::string::npos)
        word = word.substr(0, equals + 1) + file_name(word.substr(equals + 1));
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

ReportData compare_report(const std::vector<ResultFile>& files, const CompareOptions& options,
                          const Comparison& comparison, const std::vector<std::string>& words) {
  ReportData data;
  data.kind = "compare";
  for (std::size_t i = 0; i + 1 < files.size(); ++i)
    data.title += fmt::format("{}{}", i == 0 ? "" : i + 2 == files.size() ? " and " : ", ", files[i].label);
  data.title += " against " + files.back().label;
  data.command = command_text(words, comparison.paths);
  data.units = unit_names(comparison.units);
  add_results(files, data);
  make_frames(files, comparison.states, data);
  data.warnings = comparison.warnings;
  for (const ComparedSurface& surface : comparison.surfaces) {
    data.surfaces.push_back(
        make_surface(files, comparison.states, surface.names, options, &surface, data, data.warnings));
    if (!surface.asked_for) data.surfaces.back().note = "not every result has pressure here";
  }
  data.context = make_context(mesh_of(files.front(), comparison.states.front()));
  data.tables = compare_tables(comparison);
  drop_folders(data, comparison.paths);
  return data;
}

ReportData run_report(const JointModel& model, const Analysis& analysis, const ResultFile& plot,
                      const std::string& recognised, const std::vector<std::string>& words,
                      const std::vector<std::string>& paths) {
  ReportData data;
  data.kind = "run";
  data.title = plot.label;
  data.command = command_text(words, paths);
  data.units = unit_names(plot.plot.units);
  const std::vector<ResultFile> files = {plot};
  add_results(files, data);
  data.warnings = model_remarks(model, analysis.joint);
  for (const std::string& line : result_remarks(model, analysis)) data.warnings.push_back(line);
  if (!plot.plot.states.empty()) {
    const int last = static_cast<int>(plot.plot.states.size()) - 1;
    make_frames(files, {last}, data);
    // springs' surfaces first: their facets carry the springs' own force
    std::vector<std::string> names;
    for (const bool source : {true, false}) {
      for (const ContactPair& pair : analysis.joint.contacts) {
        const Layer& layer = source ? pair.source_layer() : pair.target_layer();
        const std::string& name = model.surfaces[at(layer.surface)].name;
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
      }
    }
    for (const std::string& name : names) {
      const int surface = find_surface(plot, last, name);
      if (surface < 0 || !(result_surface(plot, last, surface).mesh.size() > 0)) continue;
      data.surfaces.push_back(make_surface(files, {last}, {name}, {}, nullptr, data, data.warnings));
    }
    data.context = make_context(mesh_of(plot, last));
  }
  data.charts = run_charts(analysis);
  data.tables = run_tables(model, analysis);
  if (!recognised.empty()) data.texts.push_back({"What was recognised", recognised});
  std::vector<std::string> all = paths;
  all.insert(all.end(), model.files.begin(), model.files.end());
  drop_folders(data, all);
  return data;
}

}  // namespace dea
