// Maps of results: geometry on paper with answers on paper, colours in the picture, and the program `dea plot`.
#include <cairo.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <map>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "tests/io/plot_files.h"
#include "tests/program.h"
#include "views/map/draw_map.h"
#include "views/map/map_figure.h"
#include "views/map/map_geometry.h"
#include "views/map/map_scale.h"

namespace dea::plot_test {

namespace fs = std::filesystem;
using test::cap;
using test::file_text;
using test::Finished;
using test::PlotPatch;
using test::result_of;
using test::run_program;
using test::sheet;
using test::TemporaryFolder;

ResultSurface surface_of(const PlotPatch& p) {
  std::vector<int> begin = {0}, nodes;
  for (const auto& f : p.facets) {
    nodes.insert(nodes.end(), f.begin(), f.end());
    begin.push_back(static_cast<int>(nodes.size()));
  }
  return make_result_surface("surface", begin, nodes, p.nodes);
}

double enclosed(const std::vector<Polyline>& lines) {
  double area = 0.0;
  for (const Polyline& line : lines) {
    EXPECT_TRUE(line.closed);
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      const Vector2d &a = line.points[i], &b = line.points[(i + 1) % line.points.size()];
      area += 0.5 * (a.x() * b.y() - a.y() * b.x());
    }
  }
  return area;
}

double length(const Polyline& line) {
  double sum = 0.0;
  for (std::size_t i = 1; i < line.points.size(); ++i) sum += (line.points[i] - line.points[i - 1]).norm();
  return sum;
}

struct Pixels {
  int width = 0, height = 0;
  std::vector<std::array<int, 3>> rgb;
  const std::array<int, 3>& at(int x, int y) const {
    return rgb[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

Pixels read_png(const std::string& bytes) {
  struct Source {
    const std::string* bytes;
    std::size_t done;
  } source = {&bytes, 0};
  const auto read = [](void* from, unsigned char* to, unsigned int n) {
    Source& s = *static_cast<Source*>(from);
    if (s.done + n > s.bytes->size()) return CAIRO_STATUS_READ_ERROR;
    std::memcpy(to, s.bytes->data() + s.done, n);
    s.done += n;
    return CAIRO_STATUS_SUCCESS;
  };
  cairo_surface_t* image = cairo_image_surface_create_from_png_stream(read, &source);
  EXPECT_EQ(cairo_surface_status(image), CAIRO_STATUS_SUCCESS);
  Pixels p;
  p.width = cairo_image_surface_get_width(image);
  p.height = cairo_image_surface_get_height(image);
  for (int y = 0; y < p.height; ++y) {
    const unsigned char* row = cairo_image_surface_get_data(image) + y * cairo_image_surface_get_stride(image);
    for (int x = 0; x < p.width; ++x) p.rgb.push_back({row[4 * x + 2], row[4 * x + 1], row[4 * x]});
  }
  cairo_surface_destroy(image);
  return p;
}

/// The colour in which a fraction of the scale is drawn: the middle of its step of 1/128.
std::array<int, 3> drawn(ColourMap map, double fraction) {
  const Rgb c = colour(map, (std::floor(fraction * 128) + 0.5) / 128);
  return {static_cast<int>(std::lround(255 * c.r)), static_cast<int>(std::lround(255 * c.g)),
          static_cast<int>(std::lround(255 * c.b))};
}

bool alike(const std::array<int, 3>& a, const std::array<int, 3>& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (std::abs(a[k] - b[k]) > 1) return false;
  return true;
}

/// Number and middle of the pixels of a colour, left of the colour bar (at 96 dpi).
struct Found {
  int count = 0;
  double x = 0.0, y = 0.0;
};
Found find(const Pixels& p, const std::array<int, 3>& rgb) {
  Found f;
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width - 90; ++x)
      if (alike(p.at(x, y), rgb)) {
        ++f.count;
        f.x += x;
        f.y += y;
      }
  f.x /= std::max(1, f.count);
  f.y /= std::max(1, f.count);
  return f;
}

MapOptions plain() {
  MapOptions o;
  o.contours = std::vector<double>{};
  return o;
}

std::string png(const MapFigure& figure) { return picture(figure, {PictureFormat::Png, 100, 96, false}); }

TEST(MapGeometry, HemisphereAlongItsAxisIsADisc) {
  for (bool socket : {false, true}) {
    const PlotPatch p = cap(20, 90, 24, 64, socket);
    const ResultSurface s = surface_of(p);
    const MapMesh mesh = make_map_mesh(s);
    const MapView view = view_from({0, 0, socket ? -1.0 : 1.0}, {0, 1, 0});
    EXPECT_NEAR((view.right.cross(view.up) - view.toward).norm(), 0, 1e-15);
    EXPECT_NEAR((view.up - Vector3d(0, 1, 0)).norm(), 0, 1e-15);
    const Projection q = project(mesh, view, std::vector<double>(mesh.triangles.size(), 0.0));
    EXPECT_EQ(q.layers, 1);
    EXPECT_FALSE(q.from_behind);
    for (std::size_t i = 0; i < s.mesh.vertices.size(); ++i) {
      EXPECT_NEAR(q.points[i].x(), (socket ? -1 : 1) * s.mesh.vertices[i].x(), 1e-12);
      EXPECT_NEAR(q.points[i].y(), s.mesh.vertices[i].y(), 1e-12);
    }
    for (std::size_t t = 0; t < q.layer.size(); ++t) {
      EXPECT_EQ(q.layer[t], 0);
      EXPECT_EQ(q.back[t], 0);
      EXPECT_EQ(q.hidden[t], 0.0);
    }
    // The outline is the regular polygon of the rim's nodes.
    const std::vector<Polyline> edge = outline(mesh, q, TriangleMask(mesh.triangles.size(), 1));
    ASSERT_EQ(edge.size(), 1u);
    EXPECT_EQ(edge[0].points.size(), 64u);
    EXPECT_NEAR(std::abs(enclosed(edge)), 32 * 400 * std::sin(2 * kPi / 64), 1e-9);
  }
}

TEST(MapGeometry, SidewaysHemisphereHidesItsFarHalf) {
  const MapMesh mesh = make_map_mesh(surface_of(cap(20, 90, 24, 64, false)));
  const Projection q =
      project(mesh, view_from({1, 0.013, 0}, {0, 0, 1}), std::vector<double>(mesh.triangles.size(), 0.0));
  EXPECT_EQ(q.layers, 2);
  double hidden = 0.0;
  for (int t = 0; t < mesh.size(); ++t) {
    const auto i = static_cast<std::size_t>(t);
    if (q.layer[i] < 0) continue;
    const double x = mesh.points[static_cast<std::size_t>(mesh.triangles[i][0])].x();
    if (std::abs(x) > 2) {
      EXPECT_EQ(q.back[i], x < 0) << x;
    }
    if (x > 2) {
      EXPECT_EQ(q.hidden[i], 0.0);
    }
    if (x < -2) hidden = std::max(hidden, 1.0 - q.hidden[i]);
  }
  EXPECT_LT(hidden, 1e-9);
}

TEST(MapGeometry, UnrolledAnglesAndAreasAreExact) {
  for (bool socket : {false, true}) {
    for (double degrees : {40.0, 90.0, 130.0}) {
      const PlotPatch p = cap(25, degrees, 40, 120, socket);
      const ResultSurface s = surface_of(p);
      MapView view;
      ASSERT_TRUE(unroll(s, {0, 1, 0}, view));
      EXPECT_NEAR(view.radius, 25, 0.02);
      EXPECT_NEAR((view.pole - Vector3d(0, 0, 1)).norm(), 0, 1e-9);
      EXPECT_NEAR((view.toward - Vector3d(0, 0, socket ? -1 : 1)).norm(), 0, 1e-9);
      view.radius = 25;
      view.center.setZero();
      for (double t : {0.0, 10.0, 60.0, 90.0, 120.0}) {
        const double a = t * kPi / 180;
        const Vector2d m = on_map(view, 25 * Vector3d(0, std::sin(a), std::cos(a)));
        EXPECT_NEAR(m.x(), 0, 1e-9);
        EXPECT_NEAR(m.y(), 50 * std::sin(0.5 * a), 1e-9);
      }
      const MapMesh mesh = make_map_mesh(s);
      const Projection q = project(mesh, view, std::vector<double>(mesh.triangles.size(), 0.0));
      const double area = std::abs(enclosed(outline(mesh, q, TriangleMask(mesh.triangles.size(), 1))));
      EXPECT_NEAR(area / (2 * kPi * 625 * (1 - std::cos(degrees * kPi / 180))), 1, 1e-3);
    }
  }
  MapView view;
  EXPECT_FALSE(unroll(surface_of(sheet(4, 4, 1, 1)), {0, 0, 0}, view));
  // A box's corner is no sphere.
  EXPECT_FALSE(
      unroll(surface_of(sheet(8, 2, 2, 1,
                              [](double x, double y) { return x < 1 ? Vector3d(x, y, 0) : Vector3d(1, y, 1 - x); })),
             {0, 0, 0}, view));
}

TEST(MapGeometry, ContourOfALinearFieldIsAStraightLine) {
  const PlotPatch p = sheet(7, 5, 7, 5);
  const ResultSurface s = surface_of(p);
  const MapMesh mesh = make_map_mesh(s);
  const Projection q = project(mesh, view_from({0, 0, 1}, {0, 1, 0}), std::vector<double>(mesh.triangles.size(), 0.0));
  const TriangleMask all(mesh.triangles.size(), 1);
  std::vector<double> values;
  for (const Vector3d& x : s.mesh.vertices) values.push_back(x.x() + 0.5 * x.y());
  values = point_values(mesh, values);
  for (double level : {1.3, 2.0, 4.75, 8.1}) {
    const std::vector<Polyline> lines = contour(mesh, q, all, values, level);
    ASSERT_EQ(lines.size(), 1u) << level;
    // From where x + y/2 = level enters the rectangle to where it leaves.
    const double y0 = std::max(0.0, 2 * (level - 7)), y1 = std::min(5.0, 2 * level);
    for (const Polyline& line : {lines[0], smoothed(lines[0])}) {
      EXPECT_FALSE(line.closed);
      EXPECT_NEAR(length(line), (y1 - y0) * std::sqrt(1.25), 1e-12);
      for (const Vector2d& x : line.points) EXPECT_NEAR(x.x() + 0.5 * x.y(), level, 1e-12);
    }
    const double below = 0.5 * (2 * level) * level - (level > 2.5 ? (level - 2.5) * (level - 2.5) : 0) -
                         (level > 7 ? (level - 7) * (level - 7) : 0);
    EXPECT_NEAR(enclosed(region_above(mesh, q, all, values, level)), 35 - below, 1e-12) << level;
    EXPECT_NEAR(area_above(mesh, values, level), 35 - below, 1e-12) << level;
  }
}

TEST(MapGeometry, ContourOfAHillIsOneClosedLine) {
  const PlotPatch p = sheet(40, 40, 2, 2);
  const ResultSurface s = surface_of(p);
  const MapMesh mesh = make_map_mesh(s);
  const Projection q = project(mesh, view_from({0, 0, 1}, {0, 1, 0}), std::vector<double>(mesh.triangles.size(), 0.0));
  std::vector<double> values;
  for (const Vector3d& x : s.mesh.vertices) values.push_back(1 - (x - Vector3d(1, 1, 0)).squaredNorm());
  const std::vector<Polyline> lines =
      contour(mesh, q, TriangleMask(mesh.triangles.size(), 1), point_values(mesh, values), 0.5);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_TRUE(lines[0].closed);
  EXPECT_NEAR(enclosed(lines), kPi * 0.5, 0.005);  // the higher side on the left
  EXPECT_NEAR(enclosed({smoothed(lines[0])}), kPi * 0.5, 0.005);
}

TEST(MapGeometry, EveryFacetShapeCoversItsArea) {
  // The unit square as 4 triangles, 1 quad, quadratic ones, and a quad with a node twice.
  const std::vector<Vector3d> nodes = {{0, 0, 0},   {1, 0, 0},   {1, 1, 0},   {0, 1, 0},    {0.5, 0, 0},
                                       {1, 0.5, 0}, {0.5, 1, 0}, {0, 0.5, 0}, {0.5, 0.5, 0}};
  const std::vector<std::vector<std::vector<int>>> shapes = {{{0, 1, 2}, {0, 2, 3}},
                                                             {{0, 1, 2, 3}},
                                                             {{0, 1, 2, 3, 4, 5, 6, 7}},
                                                             {{0, 1, 2, 3, 4, 5, 6, 7, 8}},
                                                             {{0, 1, 2, 4, 5, 8}, {0, 2, 3, 8, 6, 7}},
                                                             {{0, 1, 2, 2}, {0, 2, 3}}};
  for (const auto& facets : shapes) {
    const MapMesh mesh = make_map_mesh(surface_of({nodes, facets}));
    const Projection q =
        project(mesh, view_from({0, 0, 1}, {0, 1, 0}), std::vector<double>(mesh.triangles.size(), 0.0));
    const std::vector<Polyline> edge = outline(mesh, q, TriangleMask(mesh.triangles.size(), 1));
    EXPECT_EQ(edge.size(), 1u);
    EXPECT_NEAR(enclosed(edge), 1, 1e-12);
    for (const PlotPatch& p : {PlotPatch{nodes, facets}}) {
      const MapFigure f = make_map_figure({result_of("a", p, {std::vector<double>(facets.size(), 3.0)})}, nullptr, {});
      EXPECT_EQ(f.high, 3.0);
    }
  }
}

std::vector<double> ticks(double low, double high) {
  MapScale s;
  s.low = low;
  s.high = high;
  s.step = scale_step(low, high);
  return scale_ticks(s);
}

TEST(MapScale, NumbersAreRound) {
  EXPECT_EQ(ticks(0, 6.7), (std::vector<double>{0, 2, 4, 6}));
  EXPECT_EQ(ticks(0, 5), (std::vector<double>{0, 1, 2, 3, 4, 5}));
  const std::vector<double> small = ticks(-3e-5, 3e-5);
  ASSERT_EQ(small.size(), 7u);
  EXPECT_NEAR(small[1], -2e-5, 1e-15);
  EXPECT_EQ(small[3], 0.0);
  EXPECT_LT(ticks(1e17, 1e17 + 64).size(), 20u);  // numbers this large have no steps this small: no endless loop
  for (double high = 1e-3; high < 1e3; high *= 1.07) {
    const std::size_t n = ticks(0, high).size();
    EXPECT_GE(n, 3u) << high;
    EXPECT_LE(n, 7u) << high;
  }
}

TEST(MapScale, LinesAreAtTheNumbersBetweenTheEnds) {
  ScaleKind kind;
  ValueRange range;
  range.add({0.0, 1.0, 5.0, std::nan("")});
  MapScale s = map_scale(kind, range);
  EXPECT_EQ(scale_lines(s, kind.map), (std::vector<double>{1, 2, 3, 4}));
  range.add(-1.5);  // overlap: the line at 0 is where it begins
  s = map_scale(kind, range);
  EXPECT_EQ(s.low, -1.5);
  EXPECT_EQ(scale_lines(s, kind.map), (std::vector<double>{0, 2, 4}));
  kind.map = ColourMap::Diverging;
  s = map_scale(kind, range);
  EXPECT_EQ(s.low, -5);
  EXPECT_EQ(scale_lines(s, kind.map), (std::vector<double>{-4, -2, 2, 4}));
  EXPECT_TRUE(map_scale(kind, {}).empty);
}

TEST(MapScale, NothingIsNoZero) {
  const ResultSurface s = surface_of(sheet(3, 1, 3, 1));
  const MapValues space = map_values(s, "joint space", {0, 2, std::nan("")});
  EXPECT_TRUE(std::isnan(space.facets[0]) && std::isnan(space.facets[2]));
  const MapValues pressure = map_values(s, "contact pressure", {0, 2, 4});
  EXPECT_EQ(pressure.facets, (std::vector<double>{0, 2, 4}));
  for (std::size_t v = 0; v < s.mesh.vertices.size(); ++v) {
    const double x = s.mesh.vertices[v].x();
    EXPECT_EQ(pressure.vertices[v], x < 0.5 ? 0 : x < 1.5 ? 1 : x < 2.5 ? 3 : 4);
    if (x < 0.5 || x > 2.5)
      EXPECT_TRUE(std::isnan(space.vertices[v]));
    else
      EXPECT_EQ(space.vertices[v], 2);
  }
}

TEST(MapFigure, AStateWithoutASolutionSaysSo) {
  const PlotPatch p = sheet(4, 1, 4, 1);
  ResultFile a = result_of("a", p, {{0, 1, 1, 0}, {0, 9, 9, 0}}), b = result_of("b", p, {{0, 0, 0, 0}, {0, 2, 2, 0}});
  a.xplt.states[1].status = kStatusNotConverged;
  a.xplt.software = "FEBioDEA 1.0.0";
  MapOptions o;
  o.states = "all";
  const MapFigure both = make_map_figure({a}, nullptr, o);
  ASSERT_EQ(both.panels.size(), 2u);
  EXPECT_EQ(both.panels[0].numbers.front().find("no solution"), std::string::npos) << both.panels[0].numbers.front();
  EXPECT_EQ(both.panels[1].numbers.front().rfind("no solution: p99", 0), 0u) << both.panels[1].numbers.front();
  EXPECT_EQ(both.panels[1].numbers.back(), "no solution");
  const std::string warning = "warning: a.xplt: the state at time 1 is no solution; do not use its numbers";
  EXPECT_EQ(std::count(both.remarks.begin(), both.remarks.end(), warning), 1);
  const MapFigure minus = make_map_figure({b}, &a, {});
  EXPECT_EQ(minus.panels[0].numbers.back(), "no solution");
  EXPECT_EQ(std::count(minus.remarks.begin(), minus.remarks.end(), warning), 1);
}

TEST(MapFigure, TheScaleIsThatOfAllStates) {
  const PlotPatch p = sheet(4, 1, 4, 1);
  const ResultFile a = result_of("a", p, {{0, 0, 0, 0}, {0, 9, 9, 0}, {0, 1, 3, 0}}),
                   b = result_of("b", p, {{0, 0, 0, 0}, {0, 2, 2, 0}, {0, 1, 2, 0}});
  MapOptions o;
  EXPECT_EQ(make_map_figure({a}, nullptr, o).high, 9);
  EXPECT_EQ(make_map_figure({b, a}, nullptr, o).high, 9);
  EXPECT_EQ(make_map_figure({a}, &b, o).high, 7);
  EXPECT_EQ(make_map_figure({a}, &b, o).contours, (std::vector<double>{-5, 5}));
  EXPECT_FALSE(make_map_figure({a}, nullptr, o).beyond_high);
  o.states = "0";
  const MapFigure nothing = make_map_figure({a}, nullptr, o);
  EXPECT_TRUE(nothing.empty);
  EXPECT_EQ(nothing.high, 9);
  o.states = "last";
  o.scale_of_shown = true;
  EXPECT_EQ(make_map_figure({a}, nullptr, o).high, 3);
  EXPECT_EQ(make_map_figure({a}, &b, o).high, 1);
  EXPECT_EQ(make_map_figure({a}, nullptr, o).contours, (std::vector<double>{0.5, 1, 1.5, 2, 2.5}));
  // A state that is not drawn may hold what is no number.
  ResultFile c = a;
  c.xplt.states[1].variables[0][0].values[1] = std::numeric_limits<float>::quiet_NaN();
  o.scale_of_shown = false;
  EXPECT_EQ(make_map_figure({c}, nullptr, o).high, 9);
}

TEST(MapFigure, PanelsScaleAndNumbers) {
  const PlotPatch p = sheet(4, 1, 4, 1);
  const ResultFile a = result_of("a", p, {{0, 0, 0, 0}, {0, 1, 3, 0}}, "mm-N-s");
  const ResultFile b = result_of("b", p, {{0, 0, 0, 0}, {0, 2, 8, 0}}, "mm-N-s");
  const MapFigure f = make_map_figure({a, b}, nullptr, plain());
  ASSERT_EQ(f.panels.size(), 2u);
  EXPECT_EQ(f.low, 0);
  EXPECT_EQ(f.high, 8);
  EXPECT_EQ(f.unit, "MPa");
  EXPECT_EQ(f.length_unit, "mm");
  EXPECT_EQ(f.panels[0].title, "a");
  // 1 3 is a ramp from 0 to 4: above 0.05 * 10 / 4 it is 1.9375 long, with the mean (0.125 + 4) / 2. 2 8 is one over
  // d = 1/4 + sqrt(1/16 + 1/4) of the first facet and all of the next, of slope 4 / d^2: 1.754 of it is above 0.34. The
  // largest nodal averages are 2 and 5; p99 and peak are no less than the mean.
  EXPECT_EQ(f.panels[0].numbers[0], "p99 2.062, mean 2.062 MPa, area 1.938 mm\u00b2, peak 2.062 MPa");
  EXPECT_EQ(f.panels[1].numbers[0], "p99 5.697, mean 5.697 MPa, area 1.754 mm\u00b2, peak 5.697 MPa");
  ASSERT_TRUE(f.panels[0].center_of_pressure);
  EXPECT_NEAR(f.panels[0].center_of_pressure->x(), (1 * 1.5 + 3 * 2.5) / 4, 1e-6);
  EXPECT_NEAR(f.panels[0].peak->x(), 2.5, 1e-6);
  EXPECT_TRUE(std::isnan(f.panels[0].facets[0]));

  MapOptions o = plain();
  o.states = "all";
  EXPECT_EQ(make_map_figure({a}, nullptr, o).panels[0].numbers[0], "no contact");
  EXPECT_EQ(make_map_figure({a}, nullptr, o).panels[1].title, "time 1");
  o.high = 2;
  EXPECT_TRUE(make_map_figure({a}, nullptr, o).beyond_high);
}

TEST(MapFigure, SurfacesSideBySide) {
  // Two plateaus with pressures to 4 and 6 in two files: a panel each, by surface and file, one scale, the time in
  // each.
  ResultFile a = result_of("a", sheet(2, 2, 2, 2), {{0, 0, 0, 0}, {1, 2, 3, 4}}), b = a;
  a.xplt.states[1].variables[0].push_back({2, {1, 2, 3, 6}});
  b.label = "b";
  b.xplt.states[1].variables[0].push_back({2, {1, 1, 1, 1}});
  MapOptions o = plain();
  o.surfaces = {"surface", "bare"};
  const auto titles = [](const MapFigure& f) {
    std::vector<std::string> out;
    for (const MapPanel& panel : f.panels) out.push_back(panel.title);
    return out;
  };
  const MapFigure one = make_map_figure({a}, nullptr, o);
  EXPECT_EQ(titles(one), (std::vector<std::string>{"surface, time 1", "bare, time 1"}));
  EXPECT_EQ(one.high, 6);
  EXPECT_EQ(one.surfaces.size(), 2u);
  const MapFigure two = make_map_figure({a, b}, nullptr, o);
  EXPECT_EQ(titles(two), (std::vector<std::string>{"a, surface", "b, surface", "a, bare", "b, bare"}));
  EXPECT_EQ(two.columns, 2);
  const MapFigure difference = make_map_figure({a}, &b, o);
  EXPECT_EQ(difference.high, 5);
  EXPECT_EQ(difference.panels.size(), 2u);
}

TEST(MapFigure, NumbersOfPressureAreTheHeadlinesThoseOfDifferencesOfWhatIsDrawn) {
  const PlotPatch p = sheet(4, 1, 4, 1);
  const ResultFile a = result_of("a", p, {{0, 1, 3, 0}}, "mm-N-s");
  MapOptions o = plain();
  o.smooth = true;
  EXPECT_EQ(make_map_figure({a}, nullptr, o).panels[0].numbers[0],
            "p99 2.062, mean 2.062 MPa, area 1.938 mm\u00b2, peak 2.062 MPa");
  const ResultFile c = result_of("c", p, {{0, 0, 2, 0}});
  EXPECT_EQ(make_map_figure({a}, &c, o).panels[0].numbers[1].substr(0, 6), "nodes:");
  EXPECT_EQ(make_map_figure({a}, &c, plain()).panels[0].numbers[0], "facets: +1.00 to +1.00, rms 1.00 MPa");
}

TEST(MapFigure, AFileWithoutPressureIsNoJointWithoutContact) {
  const PlotPatch p = sheet(4, 1, 4, 1);
  const ResultFile a = result_of("a", p, {{0, 0, 0, 0}, {0, 1, 3, 0}}),
                   b = result_of("b", p, {{0, 0, 0, 0}, {0, 0, 0, 0}});
  const MapFigure f = make_map_figure({a, b}, nullptr, plain());
  EXPECT_EQ(f.panels[1].numbers, std::vector<std::string>{"no pressure in this file"});
  ASSERT_EQ(f.remarks.size(), 1u);
  EXPECT_EQ(f.remarks[0].find("note: surface \"surface\" has no pressure anywhere in b; FEBio"), 0u) << f.remarks[0];
  EXPECT_EQ(make_map_figure({a}, &b, plain()).panels[0].numbers[0], "no pressure in b");
  // At a time without contact, in a file that has pressure at another.
  MapOptions o = plain();
  o.states = "0";
  EXPECT_EQ(make_map_figure({a, a}, nullptr, o).panels[0].numbers[0], "no contact");
  EXPECT_TRUE(make_map_figure({a, a}, nullptr, o).remarks.empty());
}

// A sphere pressed on a flat along its axis: the patch of pressure is even about the middle of the sheet, so the force
// on the sheet is -p A along its normal and the arrow ends at the middle. Seen from (0, -sin a, cos a), with z up, a
// force along -z is turned by a to the paper: its arrow points down and is sin a long.
TEST(MapFigure, TheLoadHasTheSizeAndDirectionOfTheForce) {
  const double a = 60 * kPi / 180;
  std::vector<double> p(36, 0.0);
  for (int j = 2; j < 4; ++j)
    for (int i = 2; i < 4; ++i) p[at(i + 6 * j)] = 2.5;
  MapOptions o = plain();
  o.load = true;
  o.toward = Vector3d(0, -std::sin(a), std::cos(a));
  o.up = Vector3d::UnitZ();
  const ResultFile file = result_of("a", sheet(6, 6, 60, 60), {p}, "mm-N-s");
  const MapFigure f = make_map_figure({file}, nullptr, o);
  const MapPanel& panel = f.panels[0];
  ASSERT_TRUE(panel.load && panel.center_of_pressure);
  EXPECT_NEAR(panel.load->x(), 0, 1e-12);
  EXPECT_NEAR(panel.load->y(), -std::sin(a), 1e-12);
  EXPECT_EQ(panel.numbers.back(), "load 1000 N");  // 2.5 MPa on 20 mm x 20 mm
  EXPECT_TRUE(panel.numbers.front().ends_with(", peak 2.5 MPa, load 1000 N")) << panel.numbers.front();
  EXPECT_LT((*panel.center_of_pressure - on_map(f.surfaces[0].view, Vector3d(30, 30, 0))).norm(), 1e-6);
  EXPECT_TRUE(f.signs.load);
  MapOptions above = o;  // along the force: its size alone
  above.toward = above.up = Vector3d::UnitZ();
  above.body = {above.up, Vector3d::UnitY(), ""};  // what is anterior is on top then
  const MapFigure seen_from_above = make_map_figure({file}, nullptr, above);
  EXPECT_FALSE(seen_from_above.panels[0].load || seen_from_above.signs.load);
  EXPECT_EQ(seen_from_above.panels[0].numbers.back(), "load 1000 N");
  EXPECT_EQ(seen_from_above.surfaces[0].edges, (EdgeNames{"right", "anterior", "left", "posterior"}));
  o.load = false;
  EXPECT_FALSE(make_map_figure({file}, nullptr, o).panels[0].load);
  o.load = true;
  o.field = "joint space";
  EXPECT_FALSE(make_map_figure({file}, nullptr, o).panels[0].load);
}

// The same of a sphere on a flat that `dea run` solved: what the map adds up to is the force of the contact, to the
// error of the map's own facets.
TEST(MapFigure, TheLoadOfASolvedSphereIsItsContactForce) {
  const TemporaryFolder folder;
  const std::string model = DEA_SAMPLES_DIR "/sphere_on_flat/sphere_on_flat.feb";
  ASSERT_EQ(run_program(folder.path, {DEA_PROGRAM, "run", model, "-o", "r.xplt", "-q"}, 60).code, 0);
  const ResultFile file = read_result((folder.path / "r.xplt").string(), "r");
  const int state = static_cast<int>(file.xplt.states.size()) - 1,
            variable = find_variable(file.xplt, XpltGroup::Surface, "contact force");
  const int surface = find_surface(file, state, "base_articular");
  double force = 0.0;
  for (const XpltRegion& region : file.xplt.states.back().variables[at(variable)])
    if (region.region == surface + 1) force = -region.values[2];
  MapOptions o = plain();
  o.load = true;
  o.surfaces = {"base_articular"};
  o.toward = Vector3d(0, -1, 1);
  o.up = Vector3d::UnitZ();
  const MapPanel panel = make_map_figure({file}, nullptr, o).panels[0];
  ASSERT_TRUE(panel.load);
  EXPECT_NEAR(panel.load->x(), 0, 2e-3);  // the mesh is not quite even about the axis
  EXPECT_NEAR(panel.load->y(), -std::sqrt(0.5), 2e-3);
  EXPECT_NEAR(std::stod(panel.numbers.back().substr(5)) / force, 1, 0.01);
}

// What is anterior lies to the right for who looks at the body from its right side, to the left from its left side.
TEST(MapGeometry, EdgesHaveTheNamesOfTheBodysDirections) {
  const Vector3d up = Vector3d::UnitZ();
  const BodyDirections body = {up, Vector3d::UnitY(), ""};  // so the body's right is x
  EXPECT_EQ(edge_names(view_from({1, 0, 0}, up), body), (EdgeNames{"anterior", "superior", "posterior", "inferior"}));
  EXPECT_EQ(edge_names(view_from({-1, 0, 0}, up), body), (EdgeNames{"posterior", "superior", "anterior", "inferior"}));
  EXPECT_EQ(edge_names(view_from({0, 1, 0}, up), body), (EdgeNames{"left", "superior", "right", "inferior"}));
  EXPECT_EQ(edge_names(view_from({0, -1, 0}, up), {up, Vector3d::UnitY(), "right"}),
            (EdgeNames{"lateral", "superior", "medial", "inferior"}));
  EXPECT_EQ(edge_names(view_from({0, -1, 0}, up), {up, Vector3d::UnitY(), "left"}),
            (EdgeNames{"medial", "superior", "lateral", "inferior"}));
  EXPECT_EQ(edge_names(view_from({0, 0, -1}, {0, 1, 0}), body), (EdgeNames{"left", "anterior", "right", "posterior"}));
  EXPECT_EQ(edge_names(view_from({1, 0, 0}, up), {}), EdgeNames());
  // an oblique front need not be across the top
  EXPECT_EQ(edge_names(view_from({1, 0, 0}, up), {up, Vector3d(0, 1, 1), ""})[0], "anterior");
}

TEST(MapFigure, CutOffFilesAreSaid) {
  ResultFile a = result_of("a", sheet(2, 1, 2, 1), {{1, 2}});
  a.xplt.truncated = true;
  const MapFigure f = make_map_figure({a}, nullptr, plain());
  ASSERT_EQ(f.remarks.size(), 1u);
  EXPECT_EQ(f.remarks[0], "warning: a.xplt: the last state is cut off and left out; the one before is at time 0");
}

TEST(MapFigure, OneSurfaceForAllFieldsAndTimes) {
  // "bare" has the higher pressure, but not in state 0, and the smaller joint space.
  ResultFile a = result_of("a", sheet(2, 1, 2, 1), {{1, 2}, {1, 2}});
  a.xplt.states[0].variables[0].push_back({2, {0, 0}});
  a.xplt.states[1].variables[0].push_back({2, {0, 5}});
  for (XpltState& s : a.xplt.states) s.variables[1].push_back({2, {0.5f, 0.25f}});
  for (const char* field : {"contact pressure", "joint space"}) {
    for (const char* states : {"0", "last", "all"}) {
      MapOptions o = plain();
      o.field = field;
      o.states = states;
      EXPECT_EQ(make_map_figure({a}, nullptr, o).surfaces[0].name, "bare") << field << states;
    }
  }
}

TEST(MapFigure, JointSpaceThatFacesNothingDoesNotSetTheScale) {
  std::vector<double> space(100, 1.0);
  for (std::size_t i = 0; i < 4; ++i) space[i] = 50;
  space[50] = 2;
  MapOptions o = plain();
  o.field = "joint space";
  const ResultFile a = result_of("a", sheet(100, 1, 100, 1), {space, std::vector<double>(100, 0.5)});
  for (const char* states : {"0", "1"}) {  // one scale for all states
    o.states = states;
    const MapFigure f = make_map_figure({a}, nullptr, o);
    EXPECT_EQ(f.high, 1);
    EXPECT_EQ(f.beyond_high, std::string(states) == "0");
  }
  o.high = 60;
  EXPECT_EQ(make_map_figure({a}, nullptr, o).high, 60);
}

TEST(MapFigure, RoundingIsNoPattern) {
  MapOptions o = plain();
  o.field = "joint space";
  const MapFigure f = make_map_figure({result_of("a", sheet(3, 1, 3, 1), {{2, 2.0000002, 2}})}, nullptr, o);
  EXPECT_EQ(f.low, 0);
  EXPECT_NEAR(f.high, 2, 1e-6);
}

TEST(MapFigure, SmoothContactHasTheAreaOfTheFacets) {
  const PlotPatch p = sheet(20, 20, 10, 10);
  std::vector<double> pressure;
  double area = 0.0;
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 20; ++i) {
      pressure.push_back(std::max(0.0, 6 - 0.5 * ((i - 9.5) * (i - 9.5) + (j - 9.5) * (j - 9.5)) / 4));
      area += pressure.back() > 0 ? 0.25 : 0.0;
    }
  MapOptions o = plain();
  o.smooth = true;
  const MapFigure f = make_map_figure({result_of("a", p, {pressure})}, nullptr, o);
  EXPECT_NEAR(area_above(f.surfaces[0].mesh, f.panels[0].points, f.panels[0].edge), area, 1e-6 * area);
}

TEST(MapFigure, Differences) {
  const PlotPatch p = sheet(4, 1, 4, 1);
  const ResultFile a = result_of("a", p, {{0, 1, 3, 0}}), b = result_of("b", p, {{0, 2, 2.5, 1}});
  const MapFigure f = make_map_figure({a}, &b, plain());
  EXPECT_EQ(f.map, ColourMap::Diverging);
  EXPECT_EQ(f.low, -1);
  EXPECT_EQ(f.high, 1);
  EXPECT_TRUE(std::isnan(f.panels[0].facets[0]));
  EXPECT_EQ(std::vector<double>(f.panels[0].facets.begin() + 1, f.panels[0].facets.end()),
            (std::vector<double>{-1, 0.5, -1}));
  // On another mesh: nodal values carried over; two constants differ by a constant.
  const PlotPatch fine = sheet(9, 3, 4, 1);
  const ResultFile c = result_of("c", fine, {std::vector<double>(27, 2.0)}), d = result_of("d", p, {{5, 5, 5, 5}});
  const MapFigure carried = make_map_figure({d}, &c, plain());
  for (double x : carried.panels[0].facets) EXPECT_NEAR(x, 3.0, 1e-6);
}

TEST(MapFigure, ResultsThatAgreeHaveADifferenceOfZero) {
  const PlotPatch p = sheet(3, 1, 3, 1);
  const ResultFile a = result_of("a", p, {{0, 1, 3}});
  const MapFigure f = make_map_figure({a}, &a, plain());
  EXPECT_FALSE(f.empty);
  EXPECT_EQ(f.panels[0].facets[1], 0);
  EXPECT_EQ(f.low, -1);
  EXPECT_EQ(f.panels[0].numbers[0].rfind("facets: 0.00 to 0.00, rms 0.00", 0), 0u) << f.panels[0].numbers[0];
}

TEST(MapFigure, SignedFieldsKeepTheirSign) {
  const PlotPatch p = sheet(3, 1, 3, 1);
  for (const char* name : {"pressure difference", "pressure gap"}) {
    ResultFile a = result_of("a", p, {{-2, 1, 3}});
    for (XpltVariable& v : a.xplt.variables)
      if (v.name == "contact pressure") v.name = name;
    MapOptions o = plain();
    o.field = name;
    const MapFigure f = make_map_figure({a}, nullptr, o);
    EXPECT_EQ(f.panels[0].facets[0], -2) << name;
    EXPECT_EQ(f.map, name == std::string("pressure gap") ? ColourMap::Sequential : ColourMap::Diverging);
  }
}

TEST(MapFigure, OtherTimesAndPlacesAreSaid) {
  const PlotPatch p = sheet(3, 1, 3, 1);
  const ResultFile a = result_of("a", p, {{1, 1, 3}, {2, 2, 2}}), b = result_of("b", p, {{1, 1, 3}});
  const MapFigure beside = make_map_figure({a, b}, nullptr, plain());
  ASSERT_FALSE(beside.remarks.empty());
  EXPECT_NE(beside.remarks.back().find("different times"), std::string::npos);
  EXPECT_NE(beside.panels[0].title.find("time"), std::string::npos);
  const MapFigure minus = make_map_figure({a}, &b, plain());
  ASSERT_FALSE(minus.remarks.empty());
  EXPECT_NE(minus.remarks.back().find("--at T"), std::string::npos);
  PlotPatch far = p;
  for (Vector3d& x : far.nodes) x += Vector3d(1e3, 0, 0);
  const ResultFile away = result_of("far", far, {{1, 1, 3}});
  EXPECT_THROW(make_map_figure({b}, &away, plain()), InputError);
}

TEST(MapFigure, ZeroIsNoValueOfAJointSpace) {
  const PlotPatch p = sheet(3, 1, 3, 1);
  MapOptions o = plain();
  o.field = "joint space";
  o.smooth = true;
  const MapFigure f = make_map_figure({result_of("a", p, {{0, 2, 4}})}, nullptr, o);
  const auto point = [&](double x) {
    for (std::size_t i = 0; i < f.surfaces[0].mesh.points.size(); ++i)
      if ((f.surfaces[0].mesh.points[i] - Vector3d(x, 0, 0)).norm() < 1e-6) return f.panels[0].points[i];
    return -1.0;
  };
  EXPECT_TRUE(std::isnan(point(0)));
  EXPECT_EQ(point(1), 2);  // not (0 + 2) / 2
  EXPECT_EQ(point(2), 3);
}

TEST(Picture, AValueHasItsColourAtItsPlace) {
  const PlotPatch p = sheet(4, 2, 4, 2);
  MapOptions o = plain();
  o.high = 8;
  o.up = {0, 1, 0};
  const MapFigure f = make_map_figure({result_of("a", p, {{1, 4, 0, 0, 0, 0, 0, 7}})}, nullptr, o);
  const Pixels image = read_png(png(f));
  const Found one = find(image, drawn(ColourMap::Sequential, 1.0 / 8)),
              four = find(image, drawn(ColourMap::Sequential, 0.5));
  const Found seven = find(image, drawn(ColourMap::Sequential, 7.0 / 8));
  ASSERT_GT(one.count, 1000);
  const double side = std::sqrt(one.count);
  // Facet (0, 0) is below left, (1, 0) beside it, (3, 1) above right (with the mark of the peak on it).
  EXPECT_NEAR(four.x - one.x, side, 0.06 * side);
  EXPECT_NEAR(four.y - one.y, 0, 0.06 * side);
  EXPECT_NEAR(seven.x - one.x, 3 * side, 0.15 * side);
  EXPECT_NEAR(one.y - seven.y, side, 0.2 * side);
  EXPECT_GT(find(image, {227, 227, 230}).count, 4 * one.count);  // five facets without contact, some under marks

  // A difference of 0 is the middle of the other map.
  const ResultFile a = result_of("a", p, {{1, 1, 1, 1, 1, 1, 1, 1}}), b = result_of("b", p, {{1, 1, 1, 1, 1, 1, 1, 2}});
  const Pixels other = read_png(png(make_map_figure({a}, &b, plain())));
  EXPECT_GT(find(other, drawn(ColourMap::Diverging, 0.5)).count, 5000);
}

TEST(Picture, FacetsBehindOthersDoNotShow) {
  // A wide sheet below with pressure 7, a narrow one 1 above it with pressure 2; drawn in either order of facets.
  for (bool swapped : {false, true}) {
    PlotPatch p;
    p.nodes = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {1, 1, 1}, {3, 1, 1}, {3, 3, 1}, {1, 3, 1}};
    p.facets = {{0, 1, 2, 3}, {4, 5, 6, 7}};
    std::vector<double> pressure = {7, 2};
    if (swapped) {
      std::swap(p.facets[0], p.facets[1]);
      std::swap(pressure[0], pressure[1]);
    }
    MapOptions o = plain();
    o.high = 8;
    const MapFigure f = make_map_figure({result_of("a", p, {pressure})}, nullptr, o);
    const Pixels image = read_png(png(f));
    const int low = find(image, drawn(ColourMap::Sequential, 7.0 / 8)).count,
              high = find(image, drawn(ColourMap::Sequential, 2.0 / 8)).count;
    EXPECT_NEAR(static_cast<double>(low) / high, 3.0, 0.15);
    ASSERT_EQ(f.remarks.size(), 1u);
    EXPECT_NE(f.remarks[0].find("20 % of the area"), std::string::npos) << f.remarks[0];
  }
}

TEST(Picture, NoLightBetweenFacets) {
  // Seen askew, so that all edges are slanted: no pixel inside is lighter than the lightest facet.
  const PlotPatch p = sheet(12, 12, 12, 12);
  std::vector<double> pressure;
  for (int i = 0; i < 144; ++i) pressure.push_back(i * 7 % 5 == 0 ? 1.0 : 0.2);
  for (bool smooth : {false, true}) {
    MapOptions o = plain();
    o.high = 4;
    o.smooth = smooth;
    o.up = {1, 3, 0};
    const MapFigure f = make_map_figure({result_of("a", p, {pressure})}, nullptr, o);
    const Pixels image = read_png(png(f));
    const Found middle = find(image, drawn(ColourMap::Sequential, smooth ? 0.08 : 0.05));
    ASSERT_GT(middle.count, 20);
    // The map is the widest thing left of the bar; a disc about its middle holds facets (and two marks) only.
    const Found dark = find(image, drawn(ColourMap::Sequential, 0.05));
    int light = 0, inside = 0;
    const int cx = static_cast<int>(dark.count > 0 ? dark.x : middle.x),
              cy = static_cast<int>(dark.count > 0 ? dark.y : middle.y);
    for (int y = cy - 60; y <= cy + 60; ++y)
      for (int x = cx - 60; x <= cx + 60; ++x) {
        const auto& c = image.at(x, y);
        ++inside;
        if (c[0] > 110) ++light;  // both colours are dark violet and blue; marks are white and small
      }
    EXPECT_LT(light, 260) << inside;  // two marks of some 100 white pixels
  }
}

TEST(Picture, VectorsWithoutBitmapsAndTheSameEveryTime) {
  const PlotPatch p = cap(20, 80, 16, 48, true);
  std::vector<double> pressure;
  for (std::size_t f = 0; f < p.facets.size(); ++f)  // falls to all sides from a place off the pole
    pressure.push_back(
        std::max(0.0, 5 - 0.2 * (p.nodes[static_cast<std::size_t>(p.facets[f][0])] - Vector3d(8, 0, 18)).norm() *
                              (1 + 0.1 * std::sin(static_cast<double>(f)))));
  for (bool smooth : {false, true}) {
    for (bool unrolled : {false, true}) {
      MapOptions o;
      o.smooth = smooth;
      o.unrolled = unrolled;
      const MapFigure f = make_map_figure({result_of("a", p, {pressure})}, nullptr, o);
      for (PictureFormat format : {PictureFormat::Png, PictureFormat::Svg, PictureFormat::Pdf}) {
        const std::string once = picture(f, {format, 0, 100, false});
        EXPECT_TRUE(once == picture(f, {format, 0, 100, false}));
        EXPECT_FALSE(once == picture(f, {format, 0, 100, true}));
        if (format == PictureFormat::Svg) {
          EXPECT_EQ(once.find("nan"), std::string::npos);
          EXPECT_EQ(once.find("inf"), std::string::npos);
          EXPECT_EQ(once.find("<image"), std::string::npos);
          EXPECT_LT(once.size(), 700000u);
        }
        if (format == PictureFormat::Pdf) {
          if (once.find("/ObjStm") == once.npos) {  // cairo 1.18 packs it
            EXPECT_NE(once.find("20000101000000Z"), std::string::npos);
          }
          EXPECT_EQ(once.find("/Subtype /Image"), std::string::npos);
        }
      }
    }
  }
}

TEST(Picture, ColumnsAreAsWishedOrAsFit) {
  const ResultFile a = result_of("a", sheet(4, 4, 1, 1), {std::vector<double>(16, 1.0)});
  const MapFigure f = make_map_figure({a, a, a}, nullptr, plain());
  const auto size = [&](double width, int columns) {
    PictureOptions o = {PictureFormat::Png, width, 96, false};
    o.columns = columns;
    const Pixels p = read_png(picture(f, o));
    return Vector2d(p.width, p.height);
  };
  EXPECT_LT(size(230, 0).y(), size(230, 0).x());
  EXPECT_GT(size(130, 1).y(), 2 * size(130, 1).x());
  EXPECT_GT(size(80, 0).y(), 2 * size(80, 0).x());  // one below the other by itself
  EXPECT_THROW(size(70, 3), UsageError);
}

TEST(Picture, TitlesOfTheBarHaveRoom) {
  // A low map: the title of its bar is broken, not cut: the picture with the whole of it differs from that of a part.
  const PlotPatch p = sheet(40, 4, 40, 4);
  MapFigure f = make_map_figure({result_of("a", p, {std::vector<double>(160, 1.0)})}, nullptr, plain());
  f.quantity = "difference of a field with a long name";
  const std::string whole = png(f);
  f.quantity = "difference of a field with a long one";
  EXPECT_FALSE(png(f) == whole);
}

TEST(Picture, OtherColoursOnRequest) {
  const PlotPatch p = sheet(4, 2, 4, 2);
  const ResultFile a = result_of("a", p, {{1, 4, 0, 0, 0, 0, 0, 7}});
  for (ColourMap map : {ColourMap::Viridis, ColourMap::Cividis, ColourMap::Gray}) {
    MapOptions o = plain();
    o.high = 8;
    o.colours = map;
    const Pixels image = read_png(png(make_map_figure({a}, nullptr, o)));
    EXPECT_GT(find(image, drawn(map, 1.0 / 8)).count, 1000);
    EXPECT_GT(find(image, drawn(map, 0.5)).count, 1000);
    // where grey is a value, no contact has another colour
    EXPECT_EQ(find(image, {227, 227, 230}).count > 4000, map != ColourMap::Gray);
    EXPECT_THROW(make_map_figure({a}, &a, o), UsageError);
  }
  MapOptions o;
  o.colours = ColourMap::Diverging;
  EXPECT_NO_THROW(make_map_figure({a}, &a, o));
  EXPECT_THROW(make_map_figure({a}, nullptr, o), UsageError);
}

TEST(Picture, LettersHaveTheSizeThatIsAsked) {
  // Twice as large: a picture of half the width in usual letters, enlarged. Its colours cover four times as much.
  const ResultFile a = result_of("a", sheet(4, 4, 1, 1), {std::vector<double>(16, 1.0)});
  const MapFigure f = make_map_figure({a}, nullptr, plain());
  PictureOptions usual = {PictureFormat::Png, 60, 96, false}, large = {PictureFormat::Png, 120, 96, false};
  large.font_size = 2 * kUsualFontSize;
  const Pixels one = read_png(picture(f, usual)), two = read_png(picture(f, large));
  EXPECT_NEAR(two.width, 2 * one.width, 2);
  EXPECT_NEAR(two.height, 2 * one.height, 2);
  large.width = 120;
  large.font_size = kUsualFontSize;
  EXPECT_LT(read_png(picture(f, large)).height, 2 * one.height);  // less of it is margin and letters
  PictureOptions narrow = {PictureFormat::Svg, 50, 96, false};
  narrow.font_size = 4 * kUsualFontSize;
  EXPECT_THROW(picture(f, narrow), UsageError);
}

TEST(Picture, LettersOfAnSvgAsText) {
  const PlotPatch p = cap(20, 80, 8, 24, true);
  MapOptions o;
  o.unrolled = true;
  MapFigure f = make_map_figure({result_of("a", p, {std::vector<double>(p.facets.size(), 2.0)})}, nullptr, o);
  f.title = "Walking <1> & surface7";
  PictureOptions look = {PictureFormat::Svg, 0, 96, false};
  const std::string shapes = picture(f, look);
  look.text = true;
  const std::string text = picture(f, look);
  EXPECT_TRUE(text == picture(f, look));
  EXPECT_EQ(shapes.find("<text"), std::string::npos);
  const auto letters_are_shapes = [](const std::string& svg) {  // cairo 1.16, 1.18
    return svg.find("<symbol") != svg.npos || svg.find("id=\"glyph-") != svg.npos;
  };
  EXPECT_TRUE(letters_are_shapes(shapes));
  EXPECT_FALSE(letters_are_shapes(text));  // no letter is a shape
  EXPECT_NE(text.find(">Walking &lt;1&gt; &amp; surface7</text>"), std::string::npos);
  for (const char* word : {">surface, time 0<", ">contact pressure<", ">centre of pressure<", ">30\u00b0<", ">2.0<"})
    EXPECT_NE(text.find(word), std::string::npos) << word;
  // The bar's title is turned, the circles' angles stand on a seam.
  EXPECT_NE(text.find("transform=\"matrix("), std::string::npos);
  EXPECT_NE(text.find("paint-order=\"stroke\">30"), std::string::npos);
  // At their places: all within the paper.
  double width = 0.0, height = 0.0;
  ASSERT_EQ(std::sscanf(text.c_str() + text.find("viewBox=\"0 0 "), "viewBox=\"0 0 %lf %lf\"", &width, &height), 2);
  int places = 0;
  for (std::size_t i = text.find("<text x="); i != std::string::npos; i = text.find("<text x=", i + 1)) {
    double x = 0.0, y = 0.0;
    ASSERT_EQ(std::sscanf(text.c_str() + i, "<text x=\"%lf\" y=\"%lf\"", &x, &y), 2);
    EXPECT_TRUE(x > 0 && x < width && y > 0 && y < height) << x << " " << y;
    ++places;
  }
  EXPECT_GT(places, 10);
}

/// A folder with plot files, and the program.
struct Folder : ::testing::Test {
  TemporaryFolder folder;
  void SetUp() override {
    const PlotPatch p = cap(20, 80, 8, 24, true);
    const std::vector<double> some(p.facets.size(), 2.0), none(p.facets.size(), 0.0);
    write_xplt((folder.path / "a.xplt").string(), result_of("a", p, {none, some}, "mm-N-s").xplt);
    write_xplt((folder.path / "b.xplt").string(), result_of("b", p, {none, some, some}).xplt);
    write_xplt((folder.path / "si.xplt").string(), result_of("si", p, {none, some}, "SI").xplt);
    write_xplt((folder.path / "flat.xplt").string(), result_of("f", sheet(2, 2, 1, 1), {{1, 2, 3, 4}}).xplt);
    ResultFile bad = result_of("n", sheet(2, 2, 1, 1), {{1, 2, 3, 4}});
    write_xplt((folder.path / "zero.xplt").string(), result_of("z", p, {none}).xplt);
    XpltFile other = result_of("o", p, {none, some}).xplt;
    for (XpltFacets& surface : other.meshes[0].surfaces) surface.name = "other " + surface.name;
    write_xplt((folder.path / "other.xplt").string(), other);
    write_xplt((folder.path / "many.xplt").string(),
               result_of("m", sheet(2, 2, 1, 1), std::vector<std::vector<double>>(101, {1, 2, 3, 4})).xplt);
    std::ofstream(folder.path / "text.xplt") << "no plot file";
    std::ofstream(folder.path / "hip.feb") << "<?xml version=\"1.0\"?>\n<febio_spec version=\"4.0\">\n</febio_spec>\n";
  }
  Finished plot(std::vector<std::string> words) {
    words.insert(words.begin(), {DEA_PROGRAM, "plot"});
    return run_program(folder.path, words, 30);
  }
};

TEST_F(Folder, WritesWhatIsAskedFor) {
  struct Case {
    std::vector<std::string> words;
    std::string file, start;
  };
  const std::vector<Case> cases = {
      {{"a.xplt"}, "a.png", "\x89PNG"},
      {{"a.xplt", "-o", "map.svg"}, "map.svg", "<?xml"},
      {{"a.xplt", "b.xplt", "-o", "MAP.PDF", "--label", "x", "--label", "y"}, "MAP.PDF", "%PDF"},
      {{"a.xplt", "--states", "all", "-o", "all.png", "--smooth", "--dark"}, "all.png", "\x89PNG"},
      {{"a.xplt", "--at", "0,1", "-o", "at.png", "--view", "unrolled", "--up", "1,0,0"}, "at.png", "\x89PNG"},
      {{"a.xplt", "--minus", "b.xplt", "--at", "1", "-o", "d.png"}, "d.png", "\x89PNG"},
      {{"a.xplt", "--view", "0,1,0", "-o", "side.png", "--dpi", "50", "--width", "80"}, "side.png", "\x89PNG"},
      {{"zero.xplt", "-o", "z.svg"}, "z.svg", "<?xml"},
      {{"flat.xplt", "--load", "--view", "1,0,1", "--up", "0,0,1", "--anterior", "0,1,0", "--side", "left", "-o",
        "l.svg"},
       "l.svg",
       "<?xml"},
      {{"a.xplt", "-o", "text.svg", "--text-as", "text", "--font-size", "8", "--colour-map", "grey"},
       "text.svg",
       "<?xml"},
      {{"a.xplt", "--minus", "b.xplt", "--at", "1", "-o", "m.png", "--colour-map", "blue-white-red"},
       "m.png",
       "\x89PNG"},
      {{"flat.xplt", "--field", "joint space", "--min", "1", "--max", "3", "-o", "f.svg"}, "f.svg", "<?xml"},
      {{"flat.xplt", "--contours", "1.5,2.5", "--title", "A very long title that does not fit on paper", "-o", "t.svg",
        "--width", "60"},
       "t.svg",
       "<?xml"}};
  for (const Case& c : cases) {
    const Finished f = plot(c.words);
    EXPECT_EQ(f.code, 0) << f.err;
    EXPECT_EQ(f.out, "");
    EXPECT_EQ(file_text(folder.path / c.file).substr(0, 4), c.start.substr(0, 4)) << c.file;
  }
  const Finished quiet = plot({"a.xplt", "-q", "--view", "0,1,0", "-o", "q.png"});
  EXPECT_EQ(quiet.code, 0);
  EXPECT_EQ(quiet.err, "");
}

// A newer FEBio's file: no names of domains, another version.
TEST_F(Folder, ANewerFileGivesTheSameMapAndNumbers) {
  XpltFile nameless = read_xplt((folder.path / "a.xplt").string());
  nameless.meshes[0].domains[0].name = "";
  std::string bytes = xplt_bytes(nameless);
  ASSERT_EQ(bytes[28], 0x35);
  const auto results = [&](const std::string& content) {
    std::ofstream(folder.path / "a.xplt", std::ios::binary) << content;
    const Finished drawn = plot({"a.xplt", "-o", "a.svg"});
    const Finished compared = run_program(folder.path, {DEA_PROGRAM, "compare", "a.xplt", "b.xplt", "--csv", "-"}, 30);
    EXPECT_EQ(drawn.code + compared.code, 0) << drawn.err << compared.err;
    return std::array<std::string, 4>{file_text(folder.path / "a.svg"), compared.out, drawn.err, compared.err};
  };
  const auto named = results(file_text(folder.path / "a.xplt"));
  EXPECT_EQ(results(bytes), named);
  bytes[28] = 0x36;
  const auto newer = results(bytes);
  EXPECT_EQ(newer[0], named[0]);
  EXPECT_EQ(newer[1], named[1]);
  const std::string note =
      "note: a.xplt: a plot file of version 0x36; dea knows up to 0x35 and passes over what is new: 0 parts\n";
  EXPECT_EQ(newer[2], note + named[2]);
  EXPECT_NE(newer[3].find(note), std::string::npos) << newer[3];
}

TEST_F(Folder, RefusesInOneLine) {
  struct Case {
    std::vector<std::string> words;
    int code;
    std::string said;
  };
  const std::vector<Case> cases = {
      {{"none.xplt"}, 3, "none.xplt: no such file: check the path"},
      {{"hip.feb"}, 3, "hip.feb: this is a FEBio model, not a plot file: \"dea run hip.feb\" writes hip_dea.xplt"},
      {{"a.xplt", "--minus", "hip.feb"}, 3, "hip.feb: this is a FEBio model"},
      {{"a.xplt", "--surface", "surfcae"}, 3, "(did you mean \"surface\"?)"},
      {{"a.xplt", "--surface", "surf"}, 3, "(did you mean \"surface\"?)"},
      {{"a.xplt", "--field", "contact presure"}, 3, "(did you mean \"contact pressure\"?)"},
      {{"a.xplt", "--unrolled"}, 2, "no option --unrolled (did you mean --view unrolled?)"},
      {{"--unrolled"}, 2, "no option --unrolled (did you mean --view unrolled?)"},
      {{"--hlp"}, 2, "dea plot: no option --hlp (did you mean \"--help\"?)"},
      {{"a.xplt", "--columns", "0"}, 2, "--columns 0"},
      {{"text.xplt"}, 3, "text.xplt"},
      {{"a.xplt", "--field", "strain"}, 3, "found no surface field \"strain\", expected one of \"contact pressure\""},
      {{"a.xplt", "--field", "contact traction"}, 3, "not one number per facet"},
      {{"a.xplt", "--surface", "socket"}, 3, "found no surface \"socket\", expected one of \"surface\", \"bare\""},
      {{"a.xplt", "--surface", "bare"}, 3, "has no \"contact pressure\" at time 1"},
      {{"a.xplt", "--at", "3"}, 3, "found no state at time 3, expected one of 0, 1"},
      {{"a.xplt", "--minus", "b.xplt", "--at", "2"}, 3, "a.xplt: found no state at time 2"},
      {{"a.xplt", "si.xplt"}, 3, "found units SI, expected mm-N-s"},
      {{"a.xplt", "--at", "soon"}, 2, "--at soon: found \"soon\", expected all, last or times"},
      {{"a.xplt", "--at", "1", "--states", "all"}, 2, "expected one of them"},
      {{"a.xplt", "-o", "map.jpg"}, 2, "ends in .png, .svg or .pdf"},
      {{"a.xplt", "-o", "-"}, 2, "-o -"},
      {{"a.xplt", "--view", "up"}, 2, "--view up: found \"up\", expected a direction x,y,z, or unrolled"},
      {{"a.xplt", "--view", "0,0,0"}, 2, "--view 0,0,0"},
      {{"a.xplt", "--view", "0,0,1", "--up", "0,0,2"}, 2, "is along the view"},
      {{"a.xplt", "--side", "left"}, 2, "--side left: belongs to --anterior"},
      {{"a.xplt", "--anterior", "0,1,0"}, 2, "--anterior: needs --up x,y,z"},
      {{"a.xplt", "--anterior", "0,1,0", "--up", "0,2,0"}, 2, "--anterior: is along --up"},
      {{"a.xplt", "--anterior", "0,1,0", "--up", "0,0,1", "--side", "lef"}, 2, "expected left or right"},
      {{"flat.xplt", "--view", "1,0,0"}, 2, "is seen edge-on"},
      {{"a.xplt", "--min", "1e17", "--max", "1.0000000000000002e17"}, 2, "found no width of the colour scale"},
      {{"flat.xplt", "--view", "unrolled"}, 2, "is no part of a sphere"},
      {{"a.xplt", "--max", "0"}, 2, "--max 0"},
      {{"a.xplt", "--minus", "b.xplt", "--min", "1"},
       2,
       "--min and --minus: found both; a difference's scale goes from -max to max"},
      {{"a.xplt", "other.xplt"}, 3, "a.xplt: found no surface of this and the other files with \"contact pressure\""},
      {{"many.xplt", "--states", "all"},
       2,
       "found 101 panels to draw, expected 100 or fewer: choose states with --at t1,t2,..., or --animate FILE.gif"},
      {{"a.xplt", "--max", "many"}, 2, "--max many"},
      {{"a.xplt", "--max", "1", "--min", "2"}, 2, "expected more than --min 2"},
      {{"a.xplt", "--minus", "b.xplt", "--max", "-1"}, 2, "expected a difference above 0"},
      {{"a.xplt", "--width", "5"}, 2, "expected a number from 20 to 2000"},
      {{"a.xplt", "--width", "21"}, 2, "--width 21: found"},
      {{"a.xplt", "--dpi", "1e9"}, 2, "--dpi 1e9"},
      {{"a.xplt", "--dpi", "2400", "--width", "2000"}, 2, "less --dpi or --width"},
      {{"a.xplt", "--dpi", "100", "-o", "a.svg"}, 2, "belongs to PNG"},
      {{"a.xplt", "--contours", "many"}, 2, "--contours many"},
      {{"a.xplt", "--colour-map", "virids"}, 2, "(did you mean \"viridis\"?)"},
      {{"a.xplt", "--colour-map", "jet"}, 2, "expected \"dea\", \"viridis\""},
      {{"a.xplt", "--minus", "b.xplt", "--at", "1", "--colour-map", "viridis"}, 2, "expected blue-white-red"},
      {{"a.xplt", "--colour-map", "blue-white-red"}, 2, "belongs to differences"},
      {{"a.xplt", "--font-size", "1"}, 2, "--font-size 1: found \"1\", expected a number from 3 to 100"},
      {{"a.xplt", "--text-as", "letters", "-o", "a.svg"},
       2,
       "--text-as letters: found \"letters\", expected shapes or text"},
      {{"a.xplt", "--text-as", "text"}, 2, "--text-as text: belongs to SVG"},
      {{"a.xplt", "--scale", "some"}, 2, "--scale some: found \"some\", expected all or shown"},
      {{"a.xplt", "--units", "mm-N"}, 2, "--units mm-N: found \"mm-N\" (did you mean \"mm-N-s\"?), expected \"SI\""},
      {{"a.xplt", "--label", "x", "--label", "y"}, 2, "found 2 labels, expected one per file (1)"},
      {{"a.xplt", "-o", "nowhere/map.png"}, 4, "there is no folder nowhere"},
  };
  std::size_t before = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder.path)) ++before;
  for (const Case& c : cases) {
    const Finished f = plot(c.words);
    EXPECT_EQ(f.code, c.code) << f.err;
    EXPECT_NE(f.err.find(c.said), std::string::npos) << c.said << "\n" << f.err;
    EXPECT_EQ(std::count(f.err.begin(), f.err.end(), '\n'), 1) << f.err;
    EXPECT_EQ(f.out, "");
  }
  std::size_t after = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder.path)) ++after;
  EXPECT_EQ(after, before);
}

TEST(PlotOfFebio, HipBesideItselfIsSmall) {
  const std::string path = std::string(DEA_REFERENCE_DIR) + "/hip_walking_febio_penalty20.xplt";
  if (!fs::exists(path)) GTEST_SKIP() << "no reference results";
  const ResultFile hip = read_result(path, "FEBio");
  for (bool smooth : {false, true}) {
    MapOptions o;
    o.smooth = smooth;
    const MapFigure f = make_map_figure({hip, hip}, nullptr, o);
    EXPECT_LT(picture(f, {PictureFormat::Svg, 0, 200, false}).size(), 1000000u);
    EXPECT_LT(picture(f, {PictureFormat::Pdf, 0, 200, false}).size(), 500000u);
  }
}

}  // namespace dea::plot_test
