#include "views/map/map_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "io/results/inside_rows.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"
#include "src/base/time_text.h"
#include "src/base/unit_names.h"
#include "src/results/headline.h"
#include "views/map/map_scale.h"
#include "views/text/table.h"

namespace dea {

namespace {

constexpr int kMostPanels = 100;
constexpr double kShortestLoad = 0.25;  ///< of its length, as it is seen

/// Three digits, as on paper.
std::string number(double x, bool plus = false) {
  const double size = std::abs(x);
  const int before = size > 0 ? static_cast<int>(std::floor(std::log10(size))) : 0;
  const std::string digits = size > 0 && (before > 5 || before < -4)
                                 ? fmt::format("{:.2e}", size)
                                 : fmt::format("{:.{}f}", size, std::clamp(2 - before, 0, 6));
  return (x < 0 ? "\u2212" : plus && x > 0 ? "+" : "") + digits;
}

void require_field(const ResultFile& file, const std::string& field) {
  if (find_variable(file.xplt, XpltGroup::Surface, field) >= 0) return;
  const std::vector<std::string> of_rows = row_field_names(file);
  if (std::find(of_rows.begin(), of_rows.end(), field) != of_rows.end()) return;
  std::vector<std::string> scalars;
  for (const XpltVariable& v : file.xplt.variables)
    if (v.group == XpltGroup::Surface && v.type == XpltType::Float && v.format != XpltFormat::Region)
      scalars.push_back(v.name);
  scalars.insert(scalars.end(), of_rows.begin(), of_rows.end());
  throw InputError(fmt::format("{}: found no surface field \"{}\"{}, expected one of {}", file.path, field,
                               did_you_mean(field, scalars), name_list(scalars, field)));
}

int require_surface(const ResultFile& file, int state, const std::string& name) {
  const int surface = find_surface(file, state, name);
  if (surface >= 0) return surface;
  std::vector<std::string> names;
  for (const XpltFacets& s : mesh_of(file, state).surfaces) names.push_back(s.name);
  throw InputError(fmt::format("{}: found no surface \"{}\"{}, expected one of {}", file.path, name,
                               did_you_mean(name, names), name_list(names, name)));
}

/// One state of each file.
using Row = std::vector<int>;

std::vector<Row> choose_states(const std::vector<ResultFile>& files, const MapOptions& o) {
  std::vector<Row> rows;
  if (o.states == "last") {
    Row row;
    for (const ResultFile& file : files) row.push_back(static_cast<int>(file.xplt.states.size()) - 1);
    return {row};
  }
  std::vector<double> times;
  if (o.states == "all") {
    const std::vector<XpltState>& states = files.front().xplt.states;
    if (files.size() == 1) {  // a file may have two states at one time
      for (int i = 0; i < static_cast<int>(states.size()); ++i) rows.push_back({i});
      return rows;
    }
    for (const XpltState& state : states) times.push_back(state.time);
  } else {
    try {
      times = parse_numbers(o.states);
    } catch (const BadValue&) {
    }
    if (times.empty())
      throw UsageError(fmt::format("{}: {}", o.states_option,
                                   bad_value(o.states, "all, last or times t1,t2,...", {"all", "last"}).what()));
  }
  for (double t : times) {
    Row row;
    for (const ResultFile& file : files) row.push_back(find_state(file, t));
    rows.push_back(row);
  }
  return rows;
}

constexpr const char* kPressure = "contact pressure";
constexpr const char* kSpace = "joint space";

/// The largest value of a field on a surface in any state; 0 where it has none.
double largest_ever(const ResultFile& file, const std::string& surface, const std::string& field) {
  double most = 0.0;
  for (int state = 0; state < static_cast<int>(file.xplt.states.size()); ++state) {
    const int index = find_surface(file, state, surface);
    if (index < 0) continue;
    for (double x : shown_values(file, state, index, field, true))
      if (std::isfinite(x)) most = std::max(most, x);
  }
  return most;
}

/// The surfaces that carry the field in all files. First those with springs in one of them, of these the one with the
/// highest pressure anywhere in the first file, whatever is asked for: pictures of other fields and times are of the
/// same surface. Then those with values. Files without pressure: as they come, FEBio's primary surface first.
std::vector<std::string> loaded_surfaces(const std::vector<ResultFile>& files, const std::vector<Row>& rows,
                                         const std::string& field) {
  struct Found {
    bool springs;
    double pressure, most;
    std::string name;
  };
  const ResultFile& first = files.front();
  std::vector<Found> found;
  for (const XpltFacets& s : mesh_of(first, rows.front().front()).surfaces) {
    double most = 0.0;
    bool carried = false, everywhere = true, springs = false;
    for (const Row& row : rows) {
      for (std::size_t i = 0; i < files.size(); ++i) {
        const int surface = find_surface(files[i], row[i], s.name);
        if (surface < 0) {
          everywhere = false;
          continue;
        }
        const std::vector<double> values = shown_values(files[i], row[i], surface, field);
        everywhere = everywhere && !values.empty();
        carried = carried || !values.empty();
        springs = springs || has_springs(files[i], row[i], surface);
        for (double x : values) most = std::max(most, std::abs(x));
      }
    }
    if (carried && everywhere) found.push_back({springs, largest_ever(first, s.name, kPressure), most, s.name});
  }
  std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
    return a.springs != b.springs ? a.springs : a.pressure > b.pressure;
  });
  std::vector<std::string> names;
  for (const Found& f : found)
    if (f.most > 0 || names.empty()) names.push_back(f.name);
  return names;
}

MapValues field_values(const ResultFile& file, int state, const ResultSurface& surface, int index,
                       const std::string& field, bool clamped) {
  std::vector<double> facets = shown_values(file, state, index, field);
  if (facets.empty())
    throw InputError(fmt::format("{}: surface \"{}\" has no \"{}\" at time {}", file.path, surface.name, field,
                                 time_text(file.xplt.states[at(state)].time)));
  if (clamped && is_pressure(field))
    for (double& x : facets) x = std::max(x, 0.0);  // as everywhere: contact is where pressure is above 0
  return map_values(surface, field, std::move(facets));
}

MapValues difference(const NodeMatch& match, const ResultSurface& surface, const MapValues& a,
                     const ResultSurface& reference, const MapValues& b) {
  const auto minus = [](const std::vector<double>& x, const std::vector<double>& y) {
    std::vector<double> out;
    for (std::size_t i = 0; i < y.size(); ++i) out.push_back(x[i] == 0 && y[i] == 0 ? kNaN : x[i] - y[i]);
    return out;
  };
  MapValues d;
  const std::vector<double> carried = carry_values(match, reference, b.vertices);
  d.vertices = minus(a.vertices, carried);
  d.facets = minus(a.facets, match.same_mesh ? b.facets : facet_average(surface, carried));
  return d;
}

bool to_be_seen(const MapSurface& s, int facet) {
  for (int t = 0; t < s.mesh.size(); ++t)
    if (s.mesh.facet[at(t)] == facet && s.projection.layer[at(t)] >= 0 && !s.projection.back[at(t)] &&
        s.projection.hidden[at(t)] < 0.5)
      return true;
  return false;
}

/// The facet, or the point of a smooth figure, of the largest value (of absolute values, in a difference); -1: none.
int largest(const MapFigure& figure, const MapPanel& panel) {
  const std::vector<double>& shown = figure.smooth ? panel.points : panel.facets;
  const auto size = [&](double x) { return is_diverging(figure.map) ? std::abs(x) : x; };
  int best = -1;
  for (std::size_t i = 0; i < shown.size(); ++i)
    if (std::isfinite(shown[i]) && (best < 0 || size(shown[i]) > size(shown[at(best)]))) best = static_cast<int>(i);
  return best >= 0 && size(shown[at(best)]) > 0 ? best : -1;
}

/// Where the largest value is, if it can be seen.
std::optional<Vector2d> place_of(const MapFigure& figure, const MapSurface& s, int best) {
  if (best < 0) return std::nullopt;
  if (!figure.smooth)
    return to_be_seen(s, best) ? std::optional<Vector2d>(on_map(s.view, s.surface.facet_centers[at(best)]))
                               : std::nullopt;
  for (int t = 0; t < s.mesh.size(); ++t) {
    const auto& v = s.mesh.triangles[at(t)];
    if (std::find(v.begin(), v.end(), best) == v.end() || !to_be_seen(s, s.mesh.facet[at(t)])) continue;
    return s.projection.points[at(best)];
  }
  return std::nullopt;
}

void describe(const MapFigure& figure, const MapValues& values, MapPanel& panel) {
  const MapSurface& s = figure.surfaces[at(panel.surface)];
  const std::string unit = figure.unit.empty() ? "" : fmt::format(" {}", figure.unit);
  const std::string area_unit = figure.length_unit.empty() ? "" : fmt::format(" {}\u00b2", figure.length_unit);
  // Pressure: the headline numbers. Anything else: all of nodes or all of facets, as they are drawn.
  const std::vector<double>& of = figure.smooth ? values.vertices : values.facets;
  const std::vector<double> areas = figure.smooth ? nodal_areas(s.surface) : s.surface.facet_areas;
  const char* where = figure.smooth ? "nodes" : "facets";
  ValueRange shown;
  shown.add(of);
  // where two results agree exactly a difference of 0 is the answer
  const bool zero = shown.least == 0 && shown.most == 0;
  if (shown.empty() || (zero && !is_diverging(figure.map))) {
    panel.numbers = {figure.pressure ? "no contact" : "no values"};
    return;
  }
  double area = 0.0, sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (!std::isfinite(of[i])) continue;
    area += areas[i];
    sum += areas[i] * of[i];
    squares += areas[i] * of[i] * of[i];
  }
  if (!figure.pressure || is_diverging(figure.map)) {
    const bool both = is_diverging(figure.map);
    const std::string range = fmt::format("{}: {} to {}", where, number(shown.least, both), number(shown.most, both)),
                      typical = both ? "rms " + number(std::sqrt(squares / area)) : "mean " + number(sum / area);
    panel.numbers = {fmt::format("{}, {}{}", range, typical, unit), range + unit, range};
    return;
  }
  std::vector<double> pressure = values.facets;
  for (double& p : pressure)
    if (!std::isfinite(p)) p = 0.0;
  const Headline h = headline(s.surface, pressure);
  const std::string p99 = fmt::format("p99 {}", four_digits(h.p99)),
                    mean = fmt::format("{}, mean {}{}", p99, four_digits(h.mean), unit),
                    area_of = fmt::format("{}, area {}{}", mean, four_digits(h.area), area_unit);
  panel.numbers = {fmt::format("{}, peak {}{}", area_of, four_digits(h.peak), unit), area_of, mean, p99 + unit, p99};
  double force = 0.0;
  Vector3d center = Vector3d::Zero(), resultant = Vector3d::Zero();
  for (std::size_t f = 0; f < pressure.size(); ++f) {
    const double weight = s.surface.facet_areas[f] * pressure[f];
    force += weight;
    center += weight * s.surface.facet_centers[f];
    resultant -= pressure[f] * s.surface.area_vectors[f];  // on this surface, into it
  }
  if (!(force > 0)) return;
  panel.center_of_pressure = on_map(s.view, center / force);
  if (!figure.signs.load || !(resultant.norm() > 0)) return;
  const Vector2d seen = Vector2d(s.view.right.dot(resultant), s.view.up.dot(resultant)) / resultant.norm();
  if (seen.norm() > kShortestLoad) panel.load = seen;
  const std::string size = fmt::format("load {}{}{}", four_digits(resultant.norm()),
                                       figure.force_unit.empty() ? "" : " ", figure.force_unit);
  panel.numbers = {fmt::format("{}, {}", panel.numbers[0], size), fmt::format("{}, {}", area_of, size),
                   fmt::format("{}, {}", p99 + unit, size), size};
}

const std::vector<double>& shown(const MapFigure& figure, const MapValues& values) {
  return figure.smooth ? values.vertices : values.facets;
}

/// All states in which the file (and the reference) has the field on the surface; a state that holds values that are no
/// numbers is drawn by nobody, they are passed over. `areas`: of joint space, value and area.
void add_states(const ResultFile& file, const ResultFile* minus, const std::string& name, const MapFigure& figure,
                const MapOptions& o, ValueRange& range, std::vector<std::pair<double, double>>& areas) {
  ResultSurface s, reference;
  std::optional<NodeMatch> match;
  int mesh = -1, other_mesh = -1;
  for (int state = 0; state < static_cast<int>(file.xplt.states.size()); ++state) {
    const int index = find_surface(file, state, name);
    if (index < 0) continue;
    std::vector<double> facets = shown_values(file, state, index, o.field, true);
    if (facets.empty()) continue;
    if (file.xplt.states[at(state)].mesh != mesh) {
      s = result_surface(file, state, index);
      match.reset();
    }
    mesh = file.xplt.states[at(state)].mesh;
    if (is_pressure(o.field) && minus == nullptr)
      for (double& x : facets) x = std::max(x, 0.0);
    const MapValues v = map_values(s, o.field, std::move(facets));
    if (minus == nullptr) {
      range.add(shown(figure, v));
      if (o.field == kSpace) add_areas(s, v.facets, areas);
      continue;
    }
    for (int k = 0; k < static_cast<int>(minus->xplt.states.size()); ++k) {
      if (!same_time(minus->xplt.states[at(k)].time, file.xplt.states[at(state)].time)) continue;
      const int other = find_surface(*minus, k, name);
      std::vector<double> taken = other < 0 ? std::vector<double>() : shown_values(*minus, k, other, o.field, true);
      if (taken.empty()) continue;
      if (minus->xplt.states[at(k)].mesh != other_mesh || !match) {
        reference = result_surface(*minus, k, other);
        match = match_nodes(s, reference);
      }
      other_mesh = minus->xplt.states[at(k)].mesh;
      range.add(shown(figure, difference(*match, s, v, reference, map_values(reference, o.field, taken))));
      break;
    }
  }
}

/// What the panels of a figure, or of all figures of an animation, show together.
struct Together {
  /// Of one surface, per facet: sum of the sizes of values, number of panels with a value. And where panels have
  /// their largest value; whether one of them has pressure.
  struct OfSurface {
    std::vector<double> load, count;
    std::set<int> largest;
    bool pressed = false;
  };
  std::vector<OfSurface> surfaces;
  ValueRange range;
  double usual = 0.0;  ///< of joint space: the value that 95 % of a panel's area stay below, the largest of panels
  bool gaps = false;   ///< places without a value
};

void add_panels(const MapFigure& figure, const MapOptions& o, const ResultFile* minus, Together& all) {
  const bool space = o.field == kSpace && minus == nullptr;
  all.surfaces.resize(figure.surfaces.size());
  for (const MapPanel& panel : figure.panels) {
    Together::OfSurface& on = all.surfaces[at(panel.surface)];
    on.load.resize(panel.facets.size());
    on.count.resize(panel.facets.size());
    for (std::size_t f = 0; f < panel.facets.size(); ++f) {
      const double x = panel.facets[f];
      if (!std::isfinite(x)) {
        all.gaps = true;
        continue;
      }
      on.load[f] += std::abs(x);
      on.count[f] += 1.0;
      on.pressed = on.pressed || (figure.pressure && minus == nullptr && x > 0);
    }
    on.largest.insert(largest(figure, panel));
    all.range.add(figure.smooth ? panel.points : panel.facets);
    if (!space || !o.scale_of_shown) continue;
    std::vector<std::pair<double, double>> areas;
    add_areas(figure.surfaces[at(panel.surface)].surface, panel.facets, areas);
    all.usual = std::max(all.usual, most_of_area_below(std::move(areas)));
  }
}

void choose_scale(const std::vector<ResultFile>& files, const ResultFile* minus, const std::vector<std::string>& names,
                  const MapOptions& o, const Together& panels, MapFigure& figure) {
  ScaleKind kind = {figure.map, figure.pressure, 0.0, o.low, o.high};
  ValueRange range = panels.range;
  // Joint space is also there where nothing faces, as the closest distance: the edge of a ball must not set the scale.
  const bool space = o.field == kSpace && minus == nullptr;
  if (o.scale_of_shown) {
    kind.usual = panels.usual;
  } else {
    for (const ResultFile& file : files)
      for (const std::string& name : names) {
        std::vector<std::pair<double, double>> areas;
        add_states(file, minus, name, figure, o, range, areas);
        if (space) kind.usual = std::max(kind.usual, most_of_area_below(std::move(areas)));
      }
  }
  const MapScale scale = map_scale(kind, range);
  const double least_width = 1e-5 * std::max(std::abs(scale.low), std::abs(scale.high));
  if (!(scale.high > scale.low) || scale.high - scale.low < least_width)
    throw UsageError(
        fmt::format("--max {:g}: found no width of the colour scale, expected more than {:g}", scale.high, scale.low));
  figure.low = scale.low;
  figure.high = scale.high;
  figure.empty = map_scale(kind, panels.range).empty;
  const double tolerance = 1e-6 * (scale.high - scale.low);
  figure.beyond_low = !figure.empty && panels.range.least < scale.low - tolerance;
  figure.beyond_high = !figure.empty && panels.range.most > scale.high + tolerance;
  figure.ticks = scale_ticks(scale);
  figure.contours = o.contours ? *o.contours : scale_lines(scale, figure.map);
}

/// How much of what the panels show is out of sight. Per surface: is it so much that a mark amid it would mislead?
std::vector<char> remark_hidden(const Together& panels, MapFigure& figure) {
  std::vector<char> misleading;
  for (std::size_t k = 0; k < figure.surfaces.size(); ++k) {
    const MapSurface& s = figure.surfaces[k];
    const std::vector<double>& count = panels.surfaces[k].count;
    double all = 0.0, hidden = 0.0;
    for (int t = 0; t < s.mesh.size(); ++t) {
      const double area = s.mesh.areas[at(t)] * count[at(s.mesh.facet[at(t)])];
      all += area;
      const bool out = s.projection.layer[at(t)] < 0 || s.projection.back[at(t)];
      hidden += area * (out ? 1.0 : s.projection.hidden[at(t)]);
    }
    misleading.push_back(hidden > 0.2 * all);
    if (hidden > 0.01 * all)
      figure.remarks.push_back(
          fmt::format("note: surface \"{}\": {:.0f} % of the area with values is turned away or hidden in this view, "
                      "choose another with --view x,y,z or --view unrolled",
                      s.name, std::max(1.0, 100.0 * hidden / all)));
    if (s.projection.from_behind)
      figure.remarks.push_back(fmt::format("note: surface \"{}\" is seen from its bone's side", s.name));
  }
  return misleading;
}

/// Results that are cut off; and surfaces without pressure in one of them, which look as if nothing touched them.
/// Returns, per file, the surfaces that have none.
std::vector<std::vector<std::string>> remark_files(const std::vector<const ResultFile*>& files,
                                                   const std::vector<std::string>& names, const MapOptions& o,
                                                   MapFigure& figure) {
  std::vector<std::vector<std::string>> without(files.size());
  for (const ResultFile* file : files) {
    if (is_newer(file->xplt)) figure.remarks.push_back(newer_note(*file));
    if (file->xplt.truncated)
      figure.remarks.push_back(
          fmt::format("warning: {}: the last state is cut off and left out; the one before is at time {}", file->path,
                      time_text(file->xplt.states.back().time)));
  }
  if (!is_pressure(o.field)) return without;
  for (const std::string& name : names) {
    std::vector<char> pressed;
    for (const ResultFile* file : files) pressed.push_back(largest_ever(*file, name, o.field) > 0);
    if (std::find(pressed.begin(), pressed.end(), 1) == pressed.end()) continue;
    std::string unpressed;
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (pressed[i]) continue;
      without[i].push_back(name);
      unpressed += fmt::format("{}{}", unpressed.empty() ? "" : ", ", files[i]->label);
    }
    if (!unpressed.empty())
      figure.remarks.push_back(
          fmt::format("note: surface \"{}\" has no pressure anywhere in {}; FEBio computes a contact's pressure on its "
                      "primary surface only, unless told otherwise",
                      name, unpressed));
  }
  return without;
}

void choose_units(const std::vector<const ResultFile*>& files, const MapOptions& o, MapFigure& figure) {
  std::string system;
  for (const ResultFile* file : files) {
    if (system.empty()) system = file->xplt.units;
    if (!file->xplt.units.empty() && file->xplt.units != system)
      throw InputError(
          fmt::format("{}: found units {}, expected {} as in the files before", file->path, file->xplt.units, system));
  }
  const ResultFile& first = *files.front();
  const int variable = find_variable(first.xplt, XpltGroup::Surface, o.field);
  std::string dimension = variable >= 0 ? first.xplt.variables[at(variable)].units : "";
  if (dimension.empty() && (is_pressure(o.field) || is_stress(o.field))) dimension.assign(1, 'P');
  const UnitNames units = unit_names(system);
  figure.unit = dimension == "P" ? units.pressure : dimension == "L" ? units.length : "";
  figure.length_unit = units.length;
  figure.force_unit = units.force;
}

/// The surfaces to show.
std::vector<std::string> choose_names(const std::vector<ResultFile>& files, const std::vector<Row>& rows,
                                      const MapOptions& o, MapFigure& figure) {
  if (!o.surfaces.empty()) return o.surfaces;
  const std::vector<std::string> loaded = loaded_surfaces(files, rows, o.field);
  if (loaded.empty())
    throw InputError(fmt::format("{}: found no surface{} with \"{}\"", files.front().path,
                                 files.size() > 1 ? " of this and the other files" : "", o.field));
  if (loaded.size() > 1)
    figure.remarks.push_back(fmt::format("note: shown is surface \"{}\"; there are values on {} too (--surface NAME)",
                                         loaded.front(), name_list({loaded.begin() + 1, loaded.end()})));
  return {loaded.front()};
}

/// File, surface and mesh of each of the figure's surfaces.
using SurfaceKeys = std::vector<std::pair<std::size_t, std::pair<std::string, int>>>;

/// Figures in the making: what is asked for, what of the files answers it, and what is made of it so far.
struct Work {
  const std::vector<ResultFile>& files;
  const ResultFile* minus;
  const MapOptions& options;
  bool animated;                                       ///< a figure per row
  std::vector<Row> rows = {};                          ///< of states
  std::vector<std::string> names = {};                 ///< of surfaces
  std::vector<std::vector<std::string>> without = {};  ///< per file, last of minus: surfaces without pressure in it
  MapFigure figure = {};
  SurfaceKeys keys = {};              ///< of the figure's surfaces
  Together together = {};             ///< of all panels
  std::vector<char> misleading = {};  ///< per surface, see remark_hidden
};

bool has_none(const Work& r, std::size_t file, const std::string& name) {
  return std::find(r.without[file].begin(), r.without[file].end(), name) != r.without[file].end();
}

/// A column per file, else per surface; 0: as fits.
int choose_columns(const Work& r) {
  const std::size_t rows = r.animated ? 1 : r.rows.size(), count = rows * r.names.size() * r.files.size();
  if (count > at(kMostPanels))
    throw UsageError(fmt::format("found {} panels to draw, expected {} or fewer{}", count, kMostPanels,
                                 r.animated ? "" : ": choose states with --at t1,t2,..., or --animate FILE.gif"));
  if (r.files.size() > 1) return static_cast<int>(r.files.size());
  return rows > 1 && r.names.size() > 1 ? static_cast<int>(r.names.size()) : 0;
}

/// What a panel shows.
struct PanelSource {
  std::size_t file;
  int state, surface;  ///< in the file
  std::string name;    ///< of the surface
  double time;
  bool same_times;     ///< are the states of its row, and of what is taken away, at one time?
  bool solved = true;  ///< is its state, and that of what is taken away, a solution?
};

bool row_at_one_time(const Work& r, const Row& row, double time) {
  for (std::size_t k = 0; k < r.files.size(); ++k)
    if (!same_time(r.files[k].xplt.states[at(row[k])].time, time)) return false;
  return true;
}

/// The figure's surface for this source; added if it is not among them yet.
int figure_surface(Work& r, const PanelSource& from) {
  const ResultFile& file = r.files[from.file];
  const SurfaceKeys::value_type key = {from.file, {from.name, file.xplt.states[at(from.state)].mesh}};
  const auto known = std::find(r.keys.begin(), r.keys.end(), key);
  const int place = static_cast<int>(known - r.keys.begin());
  if (known != r.keys.end()) return place;
  r.keys.push_back(key);
  MapSurface s;
  s.name = from.name;
  s.surface = result_surface(file, from.state, from.surface);
  if (s.surface.mesh.size() == 0) throw InputError(fmt::format("{}: surface \"{}\" has no area", file.path, from.name));
  s.mesh = make_map_mesh(s.surface);
  r.figure.surfaces.push_back(std::move(s));
  return place;
}

/// `values` minus those of the result to take away. Sets from.same_times.
MapValues take_away(Work& r, PanelSource& from, const ResultSurface& surface, const MapValues& values) {
  MapFigure& figure = r.figure;
  const ResultFile &file = r.files[from.file], &minus = *r.minus;
  const int state =
      r.options.states == "last" ? static_cast<int>(minus.xplt.states.size()) - 1 : find_state(minus, from.time);
  const int other = require_surface(minus, state, from.name);
  from.solved = from.solved && is_solution(minus, state);
  if (!is_solution(minus, state)) figure.remarks.push_back(no_solution_warning(minus, state));
  const ResultSurface reference = result_surface(minus, state, other);
  const NodeMatch match = match_nodes(surface, reference);
  if (!(match.covered > 0))
    throw InputError(fmt::format("{}: surface \"{}\" lies nowhere on that of {}", file.path, from.name, minus.path));
  if (match.covered < 0.99)
    figure.remarks.push_back(
        fmt::format("warning: surface \"{}\" of {} covers only {:.1f} % of that of {}; grey: no difference there",
                    from.name, minus.label, 100 * match.covered, file.label));
  const double taken = minus.xplt.states[at(state)].time;
  if (!same_time(taken, from.time)) {
    from.same_times = false;
    figure.remarks.push_back(fmt::format("warning: {} is shown at time {}, {} at {}; --at T compares at one time",
                                         file.label, time_text(from.time), minus.label, time_text(taken)));
  }
  return difference(match, surface, values, reference,
                    field_values(minus, state, reference, other, r.options.field, false));
}

void set_title(const Work& r, const PanelSource& from, MapPanel& panel) {
  const auto add = [&](const std::string& part) {
    if (!panel.title.empty()) panel.title += ", ";
    panel.title += part;
  };
  if (r.minus != nullptr)
    add(fmt::format("{} \u2212 {}", r.files[from.file].label, r.minus->label));
  else if (r.files.size() > 1 || r.options.labelled)
    add(r.files[from.file].label);
  const bool alone = r.files.size() == 1 && r.minus == nullptr;
  if (r.names.size() > 1 || (alone && r.rows.size() == 1)) add(from.name);
  if (r.rows.size() > 1 || r.animated || !from.same_times || alone) {
    add("");
    panel.when = "time " + time_text(from.time);
    panel.title += panel.when;
  }
}

/// What stands in place of a panel's numbers; empty: numbers.
std::string nothing_there(const Work& r, const PanelSource& from) {
  const bool none = has_none(r, from.file, from.name);
  if (r.minus == nullptr) return none ? "no pressure in this file" : "";
  if (!none && !has_none(r, r.files.size(), from.name)) return "";
  return "no pressure in " + (none ? r.files[from.file] : *r.minus).label;
}

/// Adds the panels of a state, by surface and file, and their values; panels of which there is nothing to describe have
/// their numbers already.
void add_row(Work& r, const Row& row, std::vector<MapValues>& values) {
  MapFigure& figure = r.figure;
  for (const std::string& name : r.names) {
    for (std::size_t i = 0; i < r.files.size(); ++i) {
      const ResultFile& file = r.files[i];
      const double time = file.xplt.states[at(row[i])].time;
      PanelSource from = {i, row[i], require_surface(file, row[i], name), name, time, row_at_one_time(r, row, time)};
      from.solved = is_solution(file, row[i]);
      if (!from.solved) figure.remarks.push_back(no_solution_warning(file, row[i]));
      MapPanel panel;
      panel.surface = figure_surface(r, from);
      const MapSurface& s = figure.surfaces[at(panel.surface)];
      MapValues v = field_values(file, row[i], s.surface, from.surface, r.options.field, r.minus == nullptr);
      if (r.minus != nullptr)
        v = take_away(r, from, s.surface, v);
      else
        std::replace(v.facets.begin(), v.facets.end(), 0.0, kNaN);
      panel.solved = from.solved;
      set_title(r, from, panel);
      if (!from.same_times && r.minus == nullptr)
        figure.remarks.push_back("warning: the files' last states are at different times; --at T shows one time");
      const std::string nothing = nothing_there(r, from);
      if (!nothing.empty()) panel.numbers = {nothing};
      panel.facets = v.facets;
      panel.points = point_values(s.mesh, v.vertices);
      values.push_back(std::move(v));
      figure.panels.push_back(std::move(panel));
    }
  }
}

MapView choose_view(const Work& r, const MapSurface& s, const std::vector<double>& load) {
  const MapOptions& o = r.options;
  MapView view;
  if (o.unrolled) {
    if (!unroll(s.surface, o.up, view))
      throw UsageError(fmt::format("--view unrolled: surface \"{}\" of {} is no part of a sphere; use --view x,y,z",
                                   s.name, r.files.front().path));
    return view;
  }
  const Vector3d toward = o.toward ? *o.toward : default_direction(s.surface, load);
  const auto along = [&](const Vector3d& up) { return !(up.normalized().cross(toward.normalized()).norm() > 1e-3); };
  const Vector3d& front = o.body.anterior;  // a body that is seen from above has its front on top
  if (o.up.norm() > 0 && along(o.up) && front.norm() > 0)
    return view_from(toward, front - front.dot(o.up.normalized()) * o.up.normalized());
  if (o.up.norm() > 0 && along(o.up))
    throw UsageError(fmt::format("--up {:g},{:g},{:g}: is along the view, expected a direction across it", o.up[0],
                                 o.up[1], o.up[2]));
  return view_from(toward, o.up);
}

/// One view for a surface in all files and states, found in the first.
void project_surfaces(Work& r) {
  MapFigure& figure = r.figure;
  for (std::size_t k = 0; k < figure.surfaces.size(); ++k) {
    MapSurface& s = figure.surfaces[k];
    const auto same = std::find_if(figure.surfaces.begin(), figure.surfaces.end(),
                                   [&](const MapSurface& other) { return other.name == s.name; });
    const std::vector<double>& load = r.together.surfaces[k].load;
    std::vector<double> weights(s.mesh.triangles.size(), 0.0);
    for (std::size_t t = 0; t < weights.size(); ++t) weights[t] = s.mesh.areas[t] * load[at(s.mesh.facet[t])];
    s.view = &*same != &s ? same->view : choose_view(r, s, load);
    s.edges = edge_names(s.view, r.options.body);
    s.projection = project(s.mesh, s.view, weights);
    if (s.projection.layers == 0)
      throw UsageError(fmt::format("--view: surface \"{}\" is seen edge-on, expected a direction across it", s.name));
  }
}

ColourMap chosen_map(const MapOptions& o, bool difference) {
  const ColourMap map = o.colours.value_or(difference ? ColourMap::Diverging : ColourMap::Sequential);
  if (difference && !is_diverging(map))
    throw UsageError(
        "--colour-map: found one that goes from dark to light, expected blue-white-red: a difference needs a "
        "middle");
  if (!difference && is_diverging(map))
    throw UsageError("--colour-map blue-white-red: belongs to differences, expected one that goes from dark to light");
  return map;
}

Work begin_figure(const std::vector<ResultFile>& files, const ResultFile* minus, const MapOptions& o, bool animated) {
  Work work = {files, minus, o, animated};
  work.rows = choose_states(files, o);
  MapFigure& figure = work.figure;
  figure.smooth = o.smooth;
  figure.pressure = is_pressure(o.field);
  figure.map = chosen_map(o, minus != nullptr || is_difference(o.field));
  std::vector<const ResultFile*> all;
  for (const ResultFile& file : files) all.push_back(&file);
  if (minus != nullptr) all.push_back(minus);
  for (const ResultFile* file : all) require_field(*file, o.field);
  choose_units(all, o, figure);
  figure.quantity = minus != nullptr ? "difference of " + o.field : o.field;
  work.names = choose_names(files, work.rows, o, figure);
  work.without = remark_files(all, work.names, o, figure);
  figure.columns = choose_columns(work);
  return work;
}

/// View, scale and what the legend explains, by what all panels show.
void settle(Work& work) {
  MapFigure& figure = work.figure;
  project_surfaces(work);
  choose_scale(work.files, work.minus, work.names, work.options, work.together, figure);
  work.misleading = remark_hidden(work.together, figure);
  std::sort(figure.remarks.begin(), figure.remarks.end());
  figure.remarks.erase(std::unique(figure.remarks.begin(), figure.remarks.end()), figure.remarks.end());
  figure.signs.nothing = work.together.gaps;
  for (std::size_t k = 0; k < figure.surfaces.size(); ++k) {
    const MapSurface& s = figure.surfaces[k];
    const Together::OfSurface& on = work.together.surfaces[k];
    for (int best : on.largest) figure.signs.peak = figure.signs.peak || place_of(figure, s, best);
    figure.signs.center_of_pressure =
        figure.signs.center_of_pressure || (on.pressed && !is_diverging(figure.map) && !work.misleading[k]);
    figure.signs.load = figure.signs.center_of_pressure && work.options.load && !work.options.unrolled;
    for (std::size_t t = 0; t < s.mesh.triangles.size(); ++t)
      figure.signs.turned_away = figure.signs.turned_away ||
                                 (s.projection.back[t] && s.projection.layer[t] >= 0 && s.projection.hidden[t] < 0.99);
  }
}

/// Before its numbers, and alone where these find no room.
void say_no_solution(MapPanel& panel) {
  for (std::string& line : panel.numbers) line = "no solution: " + line;
  panel.numbers.push_back("no solution");
}

void finish_panels(Work& work, const std::vector<MapValues>& values) {
  MapFigure& figure = work.figure;
  for (std::size_t k = 0; k < figure.panels.size(); ++k) {
    MapPanel& panel = figure.panels[k];
    const MapSurface& s = figure.surfaces[at(panel.surface)];
    panel.edge = !is_diverging(figure.map) && zero_without_contact(work.options.field)
                     ? edge_level(s.mesh, panel.facets, panel.points)
                     : -kInfinity;
    if (panel.numbers.empty()) describe(figure, values[k], panel);
    if (!panel.solved) say_no_solution(panel);
    if (work.misleading[at(panel.surface)]) panel.center_of_pressure.reset();
    if (!panel.center_of_pressure) panel.load.reset();
    panel.peak = place_of(figure, s, largest(figure, panel));
  }
  figure.signs.load = std::any_of(figure.panels.begin(), figure.panels.end(), [](const MapPanel& p) { return p.load; });
}

}  // namespace

bool all_solved(const MapFigure& figure) {
  return std::all_of(figure.panels.begin(), figure.panels.end(), [](const MapPanel& p) { return p.solved; });
}

MapFigure make_map_figure(const std::vector<ResultFile>& files, const ResultFile* minus, const MapOptions& o) {
  Work work = begin_figure(files, minus, o, false);
  std::vector<MapValues> values;
  for (const Row& row : work.rows) add_row(work, row, values);
  add_panels(work.figure, o, minus, work.together);
  settle(work);
  finish_panels(work, values);
  return std::move(work.figure);
}

std::vector<std::string> each_map_figure(const std::vector<ResultFile>& files, const ResultFile* minus,
                                         const MapOptions& o,
                                         const std::function<void(MapFigure&, int frame, int frames)>& show) {
  Work work = begin_figure(files, minus, o, true);
  MapFigure& figure = work.figure;
  const std::vector<Row>& rows = work.rows;
  std::vector<MapValues> values;
  const auto only = [&](const Row& row) {
    figure.panels.clear();
    values.clear();
    add_row(work, row, values);
  };
  for (const Row& row : rows) {  // nothing of them is kept but what they have together
    only(row);
    add_panels(figure, o, minus, work.together);
  }
  settle(work);
  const std::vector<std::string> remarks = figure.remarks;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    only(rows[i]);
    finish_panels(work, values);
    figure.remarks = remarks;
    show(figure, static_cast<int>(i), static_cast<int>(rows.size()));
  }
  return remarks;
}

}  // namespace dea
