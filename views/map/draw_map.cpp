#include "views/map/draw_map.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"
#include "views/map/map_scale.h"
#include "views/map/pen.h"

namespace dea {

namespace {

constexpr double kMillimetre = 96.0 / 25.4;  // lengths on paper are in pixels of 1/96 inch, as in SVG
constexpr double kText = 15.0, kBold = 15.5, kTitle = 18.0;
constexpr double kMargin = 16.0, kGap = 22.0, kBarWidth = 17.0, kBarLine = 18.0;
constexpr double kLegendLine = 24.0, kAxesRoom = 92.0;
constexpr double kEdgeNames = 16.0;  // room for a direction's name beyond a map's edge
constexpr double kMostPixels = 20000.0;

/// From lengths of the surface to the paper.
struct Placing {
  Vector2d origin = Vector2d::Zero();  ///< on paper, of the map's origin
  double scale = 1.0;
  Vector2d operator()(const Vector2d& x) const { return {origin.x() + scale * x.x(), origin.y() - scale * x.y()}; }
};

double distance_to_chord(const Vector2d& x, const Vector2d& a, const Vector2d& b) {
  const Vector2d d = b - a;
  const double t = d.squaredNorm() > 0 ? std::clamp((x - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
  return (x - a - t * d).norm();
}

/// Adds lines to the path, without points that a straight line passes within `tolerance` [px] anyway, and rounded to an
/// eighth of a pixel: files stay small.
void trace(Pen& pen, const Placing& place, const std::vector<Polyline>& lines, double tolerance = 0.0) {
  for (const Polyline& line : lines) {
    std::vector<Vector2d> points;
    for (const Vector2d& point : line.points) {
      const Vector2d p = (8.0 * place(point)).array().round() / 8.0;
      if (points.empty() || p != points.back()) points.push_back(p);
    }
    if (points.empty()) continue;
    pen.move_to(points[0]);
    for (std::size_t from = 0, to = 1; to < points.size(); ++to) {
      if (to + 1 < points.size() && to - from < 50) {
        bool straight = true;
        for (std::size_t k = from + 1; k <= to && straight; ++k)
          straight = distance_to_chord(points[k], points[from], points[to + 1]) <= tolerance;
        if (straight) continue;
      }
      pen.line_to(points[to]);
      from = to;
    }
    if (line.closed) pen.close();
  }
}

void fill(Pen& pen, const Placing& place, const std::vector<Polyline>& outline, const Rgb& colour,
          double tolerance = 0.0) {
  if (outline.empty()) return;
  trace(pen, place, outline, tolerance);
  pen.use(colour);
  pen.fill();
}

/// 0 at the low end of the scale, 1 at the high one.
double fraction(const MapFigure& figure, double value) { return (value - figure.low) / (figure.high - figure.low); }

/// The step that a value lies in; beyond the scale the nearer end. The value must not be NaN.
int band(const MapFigure& figure, double value) {
  return std::clamp(static_cast<int>(std::floor(fraction(figure, value) * kBands)), 0, kBands - 1);
}

/// Every band is drawn over those below it, so that no light shines through between them.
void fill_values(Pen& pen, const Placing& place, const MapFigure& figure, const MapPanel& panel,
                 const TriangleMask& valued) {
  const MapSurface& s = figure.surfaces[at(panel.surface)];
  if (figure.smooth) {
    ValueRange range;
    for (int t = 0; t < s.mesh.size(); ++t)
      if (valued[at(t)])
        for (int v : s.mesh.triangles[at(t)]) range.add(panel.points[at(v)]);
    const double start = std::max(panel.edge, range.least);
    if (!(range.most >= start)) return;
    for (int b = band(figure, start); b <= band(figure, range.most); ++b) {
      const double level = std::max(start, figure.low + (figure.high - figure.low) * b / kBands);
      const double from = b == band(figure, start) ? start : level;
      // The line between two bands can hardly be seen, the edge of contact can.
      fill(pen, place, region_above(s.mesh, s.projection, valued, panel.points, from), band_colour(figure.map, b),
           from == start ? 0.0 : 0.2);
    }
    return;
  }
  std::vector<int> bands(s.mesh.triangles.size(), -1), present;
  for (int t = 0; t < s.mesh.size(); ++t) {
    if (!valued[at(t)]) continue;
    bands[at(t)] = band(figure, panel.facets[at(s.mesh.facet[at(t)])]);
    present.push_back(bands[at(t)]);
  }
  std::sort(present.begin(), present.end());
  present.erase(std::unique(present.begin(), present.end()), present.end());
  for (int b : present) {
    TriangleMask in(bands.size());
    for (std::size_t t = 0; t < bands.size(); ++t) in[t] = bands[t] >= b;
    fill(pen, place, outline(s.mesh, s.projection, in), band_colour(figure.map, b));
  }
}

/// White on dark colours, black on light ones.
void stroke_contour(Pen& pen, const MapFigure& figure, double level) {
  const Rgb under = colour(figure.map, fraction(figure, level));
  pen.use(white_line(under) ? Rgb{1, 1, 1} : Rgb{0, 0, 0}, 0.75);
  pen.stroke(1.0);
}

void draw_contours(Pen& pen, const Placing& place, const MapFigure& figure, const MapPanel& panel,
                   const TriangleMask& valued) {
  const MapSurface& s = figure.surfaces[at(panel.surface)];
  for (double level : figure.contours) {
    if (level < panel.edge) continue;
    std::vector<Polyline> lines = contour(s.mesh, s.projection, valued, panel.points, level);
    for (Polyline& line : lines) line = smoothed(line);
    trace(pen, place, lines);
    stroke_contour(pen, figure, level);
  }
}

/// Black on white, or white on black: to be seen on every colour.
void stroke_marker(Pen& pen, double size) {
  pen.use({1, 1, 1});
  pen.stroke_first(4.0 * size);
  pen.use({0, 0, 0});
  pen.stroke(1.6 * size);
}

/// A triangle that stands on the place.
void peak_marker(Pen& pen, const Vector2d& p, double size) {
  pen.triangle(p, p + size * Vector2d(-5.5, -10.0), p + size * Vector2d(5.5, -10.0));
  stroke_marker(pen, size);
}

void center_marker(Pen& pen, const Vector2d& p, double size) {
  const Vector2d across(6.0 * size, 0), down(0, 6.0 * size);
  pen.line(p - across, p + across);
  pen.line(p - down, p + down);
  stroke_marker(pen, size);
}

/// Ends at its tip.
void arrow(Pen& pen, const Vector2d& tail, const Vector2d& tip, double size) {
  const Vector2d along = (tip - tail).normalized(), across(-along.y(), along.x());
  const Vector2d neck = tip - 9.0 * size * along;
  pen.line(tail, tip);
  pen.line(neck + 4.0 * size * across, tip);
  pen.line(neck - 4.0 * size * across, tip);
  stroke_marker(pen, size);
}

using Box = Eigen::AlignedBox2d;

/// Angles from the pole of an unrolled map at which there are circles.
std::vector<double> angle_circles(const MapSurface& s) {
  double reach = 0.0;
  for (int t = 0; t < s.mesh.size(); ++t)
    if (s.projection.layer[at(t)] >= 0)
      for (int v : s.mesh.triangles[at(t)]) reach = std::max(reach, s.projection.points[at(v)].norm());
  const double most = 2.0 * std::asin(std::min(1.0, reach / (2.0 * s.view.radius))) * 180.0 / kPi;
  const double step = most > 50 ? 30.0 : most > 25 ? 15.0 : most > 12 ? 5.0 : 2.0;
  std::vector<double> angles;
  for (int k = 1; k * step < most + 0.02 * step && k * step < 179; ++k) angles.push_back(k * step);
  return angles;
}

double circle_radius(const MapSurface& s, double degrees) {
  return 2.0 * s.view.radius * std::sin(0.5 * degrees * kPi / 180.0);
}

/// Of the surface on the map, and of the circles about its pole.
Box extent(const MapSurface& s) {
  Box box;
  for (int t = 0; t < s.mesh.size(); ++t) {
    if (s.projection.layer[at(t)] < 0) continue;
    for (int v : s.mesh.triangles[at(t)]) box.extend(s.projection.points[at(v)]);
  }
  if (box.isEmpty()) box.extend(Vector2d(0, 0));
  if (s.view.unrolled) {
    const std::vector<double> angles = angle_circles(s);
    const double r = angles.empty() ? 0.0 : circle_radius(s, angles.back());
    box.extend(Vector2d(-r, -r));
    box.extend(Vector2d(r, r));
  }
  return box;
}

bool touches(const std::array<Vector2d, 3>& triangle, const Box& box) {
  Box around;
  for (const Vector2d& p : triangle) around.extend(p);
  if (!around.intersects(box)) return false;
  const Vector2d &low = box.min(), &high = box.max();
  for (int k = 0; k < 3; ++k) {  // an edge with the whole box beyond it
    const Vector2d& p = triangle[at(k)];
    const Vector2d d = triangle[at((k + 1) % 3)] - p, q = triangle[at((k + 2) % 3)] - p;
    const double inside = d.x() * q.y() - d.y() * q.x() < 0 ? -1.0 : 1.0;
    bool beyond = true;
    for (const Vector2d& corner : {low, high, Vector2d(low.x(), high.y()), Vector2d(high.x(), low.y())})
      beyond = beyond && inside * (d.x() * (corner - p).y() - d.y() * (corner - p).x()) < 0;
    if (beyond) return false;
  }
  return true;
}

/// Circles of equal angle from the pole of an unrolled map, each with its angle: where there are no values, if
/// possible.
void draw_angles(Pen& pen, const Placing& place, const MapPanel& panel, const MapSurface& s, const Box& box,
                 const Paper& paper) {
  const Vector2d middle = place(Vector2d(0, 0)), low = place({box.min().x(), box.max().y()}),
                 high = place({box.max().x(), box.min().y()});
  pen.font(12.5);
  std::vector<std::array<Vector2d, 3>> valued;  // on paper
  for (int t = 0; t < s.mesh.size(); ++t) {
    if (s.projection.layer[at(t)] < 0 || !std::isfinite(panel.facets[at(s.mesh.facet[at(t)])])) continue;
    const auto corner = [&](std::size_t k) { return place(s.projection.points[at(s.mesh.triangles[at(t)][k])]); };
    valued.push_back({corner(0), corner(1), corner(2)});
  }
  std::vector<Box> taken;
  const auto take = [&](const Vector2d& p, double r) { taken.emplace_back(p - Vector2d(r, r), p + Vector2d(r, r)); };
  if (panel.peak) take(place(*panel.peak) - Vector2d(0, 5), 8);
  if (panel.center_of_pressure) take(place(*panel.center_of_pressure), 8);
  for (double angle : angle_circles(s)) {
    pen.circle(middle, circle_radius(s, angle) * place.scale);
    pen.dashed(1.0, 4.0);
    pen.use({1, 1, 1}, 0.6);
    pen.stroke_first(2.2);
    pen.use({0, 0, 0}, 0.9);
    pen.stroke(1.0);
    pen.undashed();
  }
  for (double angle : angle_circles(s)) {
    const double r = circle_radius(s, angle) * place.scale;
    const std::string text = fmt::format("{:g}\u00b0", angle);
    const Vector2d half(0.5 * pen.width(text) + 2, 7);
    std::size_t least = static_cast<std::size_t>(-1);
    Vector2d best = middle + r * Vector2d(0, 1);
    for (int k = 0; k < 48 && least > 0; ++k) {  // below the pole, or the next place to both sides
      const int places = (k + 1) / 2;
      const double turn = (k % 2 == 0 ? 1 : -1) * places * 7.5 * kPi / 180.0;
      const Vector2d p = middle + r * Vector2d(std::sin(turn), std::cos(turn));
      if (p.x() < low.x() - 1 || p.x() > high.x() + 1 || p.y() < low.y() - 1 || p.y() > high.y() + 1) continue;
      std::size_t covered = 0;
      for (const auto& triangle : valued) covered += touches(triangle, {p - half, p + half}) ? 1 : 0;
      for (const Box& b : taken)
        if (((p + half).array() > b.min().array()).all() && ((p - half).array() < b.max().array()).all())
          covered += 1000000;
      if (covered >= least) continue;
      least = covered;
      best = p;
    }
    taken.emplace_back(best - half, best + half);
    pen.use(paper.text);
    pen.text_on(best.x() - half.x() + 2, best.y() + 4.5, text, paper.background);
  }
}

/// The load comes from outside, along the force, to the centre of pressure. It is short where the force is nearly along
/// the view; one that would be too short for want of `room` [px] is left out.
void draw_load(Pen& pen, const Placing& place, const MapPanel& panel, const Box& room, double marks) {
  if (!panel.load) return;
  const Vector2d tip = place(*panel.center_of_pressure), back(-panel.load->x(), panel.load->y());
  double length = 0.5 * room.sizes().maxCoeff();
  for (int k = 0; k < 2; ++k) {
    const double left = back[k] > 0 ? room.max()[k] - tip[k] : tip[k] - room.min()[k];
    if (std::abs(back[k]) > 0) length = std::min(length, left / std::abs(back[k]));
  }
  if (!(length * back.norm() > 26.0 * marks)) return;
  arrow(pen, tip + length * back, tip + 8.0 * marks * back.normalized(), marks);  // the cross stays free
}

/// Directions of the body beyond the map's edges, in `room` [px].
void draw_edges(Pen& pen, const EdgeNames& names, const Box& room, const Paper& paper) {
  pen.font(12.5);
  pen.use(paper.faint);
  const Vector2d middle = room.center();
  const double x[] = {room.max().x(), middle.x(), room.min().x(), middle.x()},
               y[] = {middle.y(), room.min().y(), middle.y(), room.max().y()};
  for (std::size_t k = 0; k < names.size(); ++k) {
    pen.save();
    pen.shift(x[k], y[k]);
    if (k % 2 == 0) pen.turn(-0.5 * kPi);
    pen.text(-0.5 * pen.width(names[k]), k < 2 ? (k == 0 ? -3 : 12) : (k == 2 ? 12 : -3), names[k]);
    pen.restore();
  }
}

/// `marks`: their size, 1 on a map of usual size.
void draw_panel(Pen& pen, const Placing& place, const MapFigure& figure, const MapPanel& panel, const Paper& paper,
                const Box& room, double marks) {
  const MapSurface& s = figure.surfaces[at(panel.surface)];
  for (int layer = 0; layer < s.projection.layers; ++layer) {
    const PanelMasks masks = panel_masks(figure, panel, layer);
    fill(pen, place, outline(s.mesh, s.projection, masks.all), paper.nothing);
    fill(pen, place, outline(s.mesh, s.projection, masks.away), paper.turned_away);
    if (!figure.empty) {
      fill_values(pen, place, figure, panel, masks.valued);
      draw_contours(pen, place, figure, panel, masks.interpolated);
    }
    trace(pen, place, rim(s.mesh, s.projection, masks.all));
    pen.use(paper.line);
    pen.stroke(1.0);
  }
  if (s.view.unrolled) draw_angles(pen, place, panel, s, extent(s), paper);
  draw_edges(pen, s.edges, room, paper);
  const double edge = s.edges == EdgeNames() ? 0.0 : kEdgeNames;
  draw_load(pen, place, panel, {room.min().array() + edge, room.max().array() - edge}, marks);
  if (panel.center_of_pressure) center_marker(pen, place(*panel.center_of_pressure), marks);
  if (panel.peak) peak_marker(pen, place(*panel.peak), marks);
}

std::string tick_text(double x, double step) {
  const double size = std::max(std::abs(x), step);
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6);
  const std::string digits =
      size >= 1e6 || step < 1e-4 ? fmt::format("{:.6g}", std::abs(x)) : fmt::format("{:.{}f}", std::abs(x), decimals);
  return x < -1e-9 * step ? "\u2212" + digits : digits;
}

/// Where the letters of a text begin, and its end.
std::vector<std::size_t> letters(const std::string& text) {
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < text.size(); ++i)
    if ((static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) starts.push_back(i);
  starts.push_back(text.size());
  return starts;
}

/// Words cut in their middle to what there is room for; `kept` at their end stays.
std::string fitted(const Pen& pen, const std::string& text, double room, const std::string& kept = "") {
  if (pen.width(text) <= room) return text;
  const std::string lead = text.substr(0, text.size() - kept.size());
  const std::vector<std::size_t> at_letter = letters(lead);
  const std::size_t n = at_letter.size() - 1,
                    ends = kept.empty() ? 0 : std::min<std::size_t>(n, 2);  // the ", " before what is kept
  for (std::size_t left = n - ends; left-- > 1;) {
    const std::size_t front = (left + 1) / 2, back = left / 2;
    std::string cut = lead.substr(0, at_letter[front]);
    cut.append("\u2026").append(lead, at_letter[n - ends - back]).append(kept);
    if (pen.width(cut) <= room) return cut;
  }
  return kept.empty() ? "\u2026" : kept;
}

double widest(const Pen& pen, const std::vector<std::string>& texts) {
  double most = 0.0;
  for (const std::string& text : texts) most = std::max(most, pen.width(text));
  return most;
}

/// Words in `lines` lines of about the same length.
std::vector<std::string> broken(const Pen& pen, const std::string& text, int lines) {
  std::vector<std::string> out(1);
  const double each = pen.width(text) / lines;
  for (const std::string& word : split(text, ' ')) {
    const std::string longer = out.back().empty() ? word : out.back() + " " + word;
    const bool full = !out.back().empty() && pen.width(longer) - 0.5 * pen.width(word) > each;
    if (full && static_cast<int>(out.size()) < lines)
      out.push_back(word);
    else
      out.back() = longer;
  }
  return out;
}

std::string bar_title(const MapFigure& figure) {
  return figure.quantity + (figure.unit.empty() ? "" : " [" + figure.unit + "]");
}

/// Lines of the bar's title that are no longer than `room`; four, if they are all longer.
std::vector<std::string> bar_title_lines(const Pen& pen, const MapFigure& figure, double room) {
  std::vector<std::string> lines;
  for (int n = 1; n <= 4; ++n) {
    lines = broken(pen, bar_title(figure), n);
    if (widest(pen, lines) <= room) break;
  }
  return lines;
}

std::vector<std::string> tick_texts(const MapFigure& figure) {
  const double step = figure.ticks.size() > 1 ? figure.ticks[1] - figure.ticks[0] : 1.0;
  std::vector<std::string> texts;
  for (double tick : figure.ticks) texts.push_back(tick_text(tick, step));
  return texts;
}

/// Colour bar with its ticks to the right; arrows where values go on beyond its ends. The title has room from `top` to
/// `bottom`.
void draw_bar(Pen& pen, const MapFigure& figure, const Paper& paper, double x, double y, double height, double top,
              double bottom) {
  const double each = height / kBands;
  for (int b = 0; b < kBands; ++b) {  // each reaches down to the end, so that there are no seams
    pen.use(band_colour(figure.map, kBands - 1 - b));
    pen.rectangle(x, y + b * each, kBarWidth, height - b * each);
  }
  for (double level : figure.contours) {
    const double f = fraction(figure, level);
    if (!(f > 0 && f < 1)) continue;
    pen.line({x, y + (1 - f) * height}, {x + kBarWidth, y + (1 - f) * height});
    stroke_contour(pen, figure, level);
  }
  const auto arrow = [&](double base, double tip, const Rgb& c) {
    pen.triangle({x, base}, {x + kBarWidth, base}, {x + 0.5 * kBarWidth, tip});
    pen.use(c);
    pen.fill();
  };
  if (figure.beyond_high) arrow(y, y - 12, band_colour(figure.map, kBands - 1));
  if (figure.beyond_low) arrow(y + height, y + height + 12, band_colour(figure.map, 0));
  pen.font(kText);
  const std::vector<std::string> texts = tick_texts(figure);
  for (std::size_t k = 0; k < texts.size(); ++k) {
    const double ty = y + (1 - fraction(figure, figure.ticks[k])) * height;
    pen.line({x + kBarWidth, ty}, {x + kBarWidth + 4, ty});
    pen.use(paper.line);
    pen.stroke(1.0);
    pen.use(paper.text);
    pen.text(x + kBarWidth + 8, ty + 0.35 * kText, texts[k]);
  }
  const std::vector<std::string> lines = bar_title_lines(pen, figure, bottom - top);
  const double longest = std::max(1e-9, widest(pen, lines)), title_x = x + kBarWidth + 8 + widest(pen, texts) + 10;
  const double shrink = std::min(1.0, (bottom - top) / longest);
  const double middle = std::clamp(y + 0.5 * height, top + 0.5 * shrink * longest, bottom - 0.5 * shrink * longest);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    pen.save();
    pen.shift(title_x + 0.75 * kText + static_cast<double>(k) * kBarLine, middle);
    pen.turn(-0.5 * kPi);
    pen.font(kText * shrink);
    pen.text(-0.5 * pen.width(lines[k]), 0, lines[k]);
    pen.restore();
  }
  pen.font(kText);
}

double bar_room(const Pen& pen, const MapFigure& figure, std::size_t lines) {
  const double ticks = widest(pen, tick_texts(figure));
  return kBarWidth + 8 + ticks + 10 + kText + 4 + static_cast<double>(lines - 1) * kBarLine;
}

/// The global axes as they lie on the map, but one that points at the viewer or away.
void draw_axes(Pen& pen, const MapView& view, const Paper& paper, double x, double y) {
  constexpr double kLength = 24.0;
  pen.font(12.5);
  for (int k = 0; k < 3; ++k) {
    const Vector3d axis = Vector3d::Unit(k);
    const Vector2d d(view.right.dot(axis), -view.up.dot(axis));
    const std::string name(1, "xyz"[k]);
    bool hidden = d.norm() < 0.12;
    for (int other = 0; other < 3; ++other) {  // a short one on top of a longer one
      const Vector2d o(view.right[other], -view.up[other]);
      hidden = hidden || (d.norm() < 0.5 * o.norm() && d.dot(o) > 0.9 * d.norm() * o.norm());
    }
    if (hidden) continue;
    const double tx = x + kLength * d.x(), ty = y + kLength * d.y();
    pen.line({x, y}, {tx, ty});
    pen.use(paper.faint);
    pen.stroke(1.4);
    const Vector2d u = d.normalized();
    pen.use(paper.text);
    pen.text(tx + 8 * u.x() - 0.5 * pen.width(name), ty + 8 * u.y() + 4, name);
  }
}

double nice_length(double most) {
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  for (double m : {5.0, 2.0})
    if (m * power <= most) return m * power;
  return power;
}

/// Where everything goes [px].
struct Layout {
  int columns = 1, rows = 1;
  double width = 0, height = 0, panel_width = 0, map_height = 0, top = 0, header = 0, bar = 0, scale = 1, footer = 0;
  double panel_x(int i) const { return kMargin + (i % columns) * (panel_width + kGap); }
  double panel_y(int i) const {
    const int row = i / columns;
    return top + row * (header + map_height + kGap);
  }
};

/// One sign of the legend, its middle 8 px to the right of `p`, and what it means.
struct Entry {
  std::string text;
  std::function<void(Pen&, const Vector2d& p)> sign;
};

/// The legend, from left to right and on in the next line. Draws only if told; returns its lines.
int legend(Pen& pen, const std::vector<Entry>& entries, const Paper& paper, double left, double x, double y,
           double right, bool drawn) {
  int lines = 1;
  pen.font(kText);
  for (const Entry& e : entries) {
    const double width = 23 + pen.width(e.text);
    if (x + width > right && x > left) {
      x = left;
      y += kLegendLine;
      ++lines;
    }
    if (drawn) {
      e.sign(pen, {x, y});
      pen.use(paper.text);
      pen.text(x + 23, y + 0.35 * kText, e.text);
    }
    x += width + 22;
  }
  return lines;
}

bool one_view(const MapFigure& figure) {
  const MapView& view = figure.surfaces.front().view;
  return std::all_of(figure.surfaces.begin(), figure.surfaces.end(), [&](const MapSurface& s) {
    return (s.view.toward - view.toward).norm() + (s.view.up - view.up).norm() < 1e-9;
  });
}

std::vector<Entry> legend_entries(const MapFigure& figure, const Paper& paper) {
  const auto square = [&paper](const Rgb& c) {
    return [&paper, c](Pen& pen, const Vector2d& p) {
      pen.use(c);
      pen.rectangle(p.x() + 1, p.y() - 7, 14, 14);
      pen.box(p.x() + 1, p.y() - 7, 14, 14);
      pen.use(paper.line);
      pen.stroke(0.8);
    };
  };
  std::vector<Entry> entries;
  if (figure.signs.peak)
    entries.push_back({figure.pressure && !is_diverging(figure.map) ? "peak" : "largest",
                       [](Pen& pen, const Vector2d& p) { peak_marker(pen, p + Vector2d(8, 5), 1.0); }});
  if (figure.signs.center_of_pressure)
    entries.push_back(
        {"centre of pressure", [](Pen& pen, const Vector2d& p) { center_marker(pen, p + Vector2d(8, 0), 1.0); }});
  if (figure.signs.load)
    entries.push_back(
        {"load", [](Pen& pen, const Vector2d& p) { arrow(pen, p + Vector2d(0, 5), p + Vector2d(16, -5), 0.8); }});
  if (figure.signs.nothing) entries.push_back({figure.pressure ? "no contact" : "no value", square(paper.nothing)});
  if (figure.signs.turned_away) entries.push_back({"turned away", square(paper.turned_away)});
  if (figure.surfaces.front().view.unrolled)
    entries.push_back({"angle from the axis (equal-area map)", [&paper](Pen& pen, const Vector2d& p) {
                         pen.circle(p + Vector2d(8, 0), 7);
                         pen.dashed(1.0, 4.0);
                         pen.use(paper.text);
                         pen.stroke(1.2);
                         pen.undashed();
                       }});
  return entries;
}

std::string scale_bar_text(const MapFigure& figure, double length) {
  return fmt::format("{:g}{}", length, figure.length_unit.empty() ? "" : " " + figure.length_unit);
}

double scale_bar_length(const Layout& l) { return nice_length(std::min(90.0, 0.4 * l.panel_width) / l.scale); }

/// Where the legend begins: right of axes and scale bar.
double legend_start(const Pen& pen, const MapFigure& figure, const Layout& l) {
  double x = kMargin + (one_view(figure) ? kAxesRoom : 0.0);
  if (figure.surfaces.front().view.unrolled) return x;
  const double length = scale_bar_length(l);
  return x + length * l.scale + 8 + pen.width(scale_bar_text(figure, length)) + 26;
}

/// Letters, and with them lines, marks and margins: how large they are for the wished font size. A picture is laid out
/// for usual letters on paper that is as much smaller, then enlarged.
double letter_scale(const PictureOptions& options) { return options.font_size / kUsualFontSize; }

/// `bar_lines`: of the bar's title.
Layout lay_out(Pen& pen, const MapFigure& figure, const PictureOptions& options, const Paper& paper,
               std::size_t bar_lines) {
  Layout l;
  const double letters = letter_scale(options), millimetre = kMillimetre / letters;
  const int n = static_cast<int>(figure.panels.size());
  l.columns = figure.columns > 0 && figure.columns <= 6 ? figure.columns
              : n <= 4                                  ? (n == 4 ? 2 : n)
                                                        : std::min(6, static_cast<int>(std::ceil(std::sqrt(1.4 * n))));
  if (options.columns > 0) l.columns = std::min(n, options.columns);
  l.bar = figure.empty ? 0.0 : kGap + bar_room(pen, figure, bar_lines);
  const double widths[] = {130, 190, 230};
  const double millimetres = options.width > 0 ? options.width
                             : l.columns <= 3  ? widths[l.columns - 1]
                                               : 64.0 * l.columns + 30;
  l.width = std::round(millimetres * millimetre);
  const auto panel_width = [&](int columns) {
    return (l.width - 2 * kMargin - l.bar - (columns - 1) * kGap) / columns;
  };
  const int usual = l.columns;
  // Fewer side by side where there is little room; a row of files stays whole, or is cut into equal parts.
  while (options.columns <= 0 && l.columns > 1 &&
         (panel_width(l.columns) < 120.0 || (figure.columns > 0 && usual % l.columns != 0)))
    --l.columns;
  l.rows = (n + l.columns - 1) / l.columns;
  l.panel_width = panel_width(l.columns);
  if (!(l.panel_width >= 60))
    throw UsageError(fmt::format(
        "--width {:g}: found {:.0f} mm for each of the panels side by side ({}), expected {:.0f} mm or more: "
        "about --width {:.0f}",
        millimetres, std::max(0.0, l.panel_width / millimetre), l.columns, std::ceil(60 / millimetre),
        std::ceil((62 * l.columns + 2 * kMargin + l.bar + (l.columns - 1) * kGap) / millimetre)));
  Vector2d most = Vector2d::Constant(1e-300);
  for (const MapSurface& s : figure.surfaces) most = most.cwiseMax(extent(s).sizes());
  const bool named = std::any_of(figure.surfaces.begin(), figure.surfaces.end(),
                                 [](const MapSurface& s) { return s.edges != EdgeNames(); });
  const double round = 8.0 + (named ? kEdgeNames : 0.0);  // room for markers and labels at the rim
  l.scale = std::min((l.panel_width - 2 * round) / most.x(), (1.15 * l.panel_width - 2 * round) / most.y());
  l.map_height = most.y() * l.scale + 2 * round;
  l.map_height = std::max(l.map_height, l.rows == 1 && !figure.empty ? 110.0 : 30.0);
  l.top = kMargin + (figure.title.empty() ? 0.0 : kTitle + 14);
  l.header = 2 * kText + 14;
  const double start = legend_start(pen, figure, l), left = kMargin + (one_view(figure) ? kAxesRoom : 0.0);
  const int lines = legend(pen, legend_entries(figure, paper), paper, left, start, 0.0, l.width - kMargin, false);
  l.footer = std::max(one_view(figure) ? 80.0 : 0.0, 26 + (lines - 1) * kLegendLine + 26.0);
  l.height = std::ceil(l.panel_y(l.rows * l.columns - 1) + l.header + l.map_height + l.footer);
  return l;
}

void draw_footer(Pen& pen, const MapFigure& figure, const Layout& l, const Paper& paper) {
  const MapView& view = figure.surfaces.front().view;
  const double y = l.height - l.footer + 26;
  double x = kMargin;
  if (one_view(figure)) {
    draw_axes(pen, view, paper, x + 36, l.height - l.footer + 36);
    x += kAxesRoom;
  }
  pen.font(kText);
  const double start = legend_start(pen, figure, l);
  if (!view.unrolled) {
    const double length = scale_bar_length(l), px = length * l.scale;
    pen.line({x, y - 4}, {x, y + 4});
    pen.line({x, y}, {x + px, y});
    pen.line({x + px, y - 4}, {x + px, y + 4});
    pen.use(paper.text);
    pen.stroke(1.4);
    pen.text(x + px + 8, y + 0.35 * kText, scale_bar_text(figure, length));
  }
  legend(pen, legend_entries(figure, paper), paper, x, start, y, l.width - kMargin, true);
}

void draw(Pen& pen, const MapFigure& figure, const Layout& l, const Paper& paper) {
  pen.use(paper.background);
  pen.all();
  if (!figure.title.empty()) {
    pen.font(kTitle, true);
    pen.use(paper.text);
    pen.text(kMargin, kMargin + kTitle - 3, fitted(pen, figure.title, l.width - 2 * kMargin));
  }
  for (int i = 0; i < static_cast<int>(figure.panels.size()); ++i) {
    const MapPanel& panel = figure.panels[at(i)];
    const double x = l.panel_x(i), y = l.panel_y(i);
    pen.font(kBold, true);
    pen.use(paper.text);
    const double room = l.panel_width + 0.5 * kGap;
    if (pen.width(panel.when) > room) pen.font(kBold * room / pen.width(panel.when), true);
    pen.text(x, y + kBold - 2, fitted(pen, panel.title, room, panel.when));
    pen.font(kText);
    pen.use(paper.faint);
    const auto line = std::find_if(panel.numbers.begin(), panel.numbers.end(),
                                   [&](const std::string& text) { return pen.width(text) <= l.panel_width; });
    pen.text(x, y + 2 * kText + 4, line == panel.numbers.end() ? panel.numbers.back() : *line);
    Placing place;
    place.scale = l.scale;
    const Vector2d middle = extent(figure.surfaces[at(panel.surface)]).center();
    place.origin = {x + 0.5 * l.panel_width - l.scale * middle.x(),
                    y + l.header + 0.5 * l.map_height + l.scale * middle.y()};
    const Box frame(Vector2d(x, y + l.header), Vector2d(x + l.panel_width, y + l.header + l.map_height));
    draw_panel(pen, place, figure, panel, paper, frame,
               std::clamp(std::min(l.panel_width, l.map_height) / 220.0, 0.45, 1.0));
  }
  if (!figure.empty) {
    const double height = std::min(l.map_height - 16, 300.0);
    draw_bar(pen, figure, paper, l.width - kMargin - l.bar + kGap, l.top + l.header + 0.5 * (l.map_height - height),
             height, l.top, l.height - l.footer);
  }
  draw_footer(pen, figure, l, paper);
}

Layout measured_layout(const MapFigure& figure, const PictureOptions& options, const Paper& colours) {
  Layout layout;
  measured([&](Pen& pen) {
    pen.font(kText);
    std::size_t lines = 1;
    for (int k = 0; k < 4; ++k) {  // a longer title of the bar takes of the maps' room
      layout = lay_out(pen, figure, options, colours, lines);
      const std::size_t needed =
          figure.empty ? 1 : bar_title_lines(pen, figure, layout.height - layout.footer - layout.top).size();
      if (needed <= lines) break;
      lines = needed;
    }
  });
  const double zoom = letter_scale(options) * options.dpi / 96.0, w = std::round(zoom * layout.width),
               h = std::round(zoom * layout.height);
  if (options.format == PictureFormat::Png && (w > kMostPixels || h > kMostPixels))
    throw UsageError(
        fmt::format("--dpi {:g}: found a picture of {:.0f} x {:.0f} pixels, expected {:.0f} or fewer "
                    "each way: less --dpi or --width",
                    options.dpi, w, h, kMostPixels));
  return layout;
}

/// The figure laid out and drawn by `on_paper`: drawn or drawn_image.
template <class OnPaper>
auto laid_out(const MapFigure& figure, const PictureOptions& options, const OnPaper& on_paper) {
  const Paper colours = paper(options.dark, figure.map);
  const Layout layout = measured_layout(figure, options, colours);
  const double letters = letter_scale(options);
  const PaperSize size = {options.format, letters * layout.width, letters * layout.height, options.dpi, options.text};
  return on_paper(size, [&](Pen& pen) {
    pen.zoom(letters);
    draw(pen, figure, layout, colours);
  });
}

}  // namespace

Rgb band_colour(ColourMap map, int band) { return colour(map, (band + 0.5) / kBands); }

Paper paper(bool dark, ColourMap map) {
  const auto grey = [](double x) { return Rgb{x, x, x + 0.012}; };
  const bool middle = is_diverging(map);
  const double nothing = dark ? (middle ? 0.24 : 0.36) : (middle ? 0.72 : 0.89);
  Paper p = dark ? Paper{{0.051, 0.067, 0.09}, grey(0.92), grey(0.66), grey(0.75), grey(nothing), grey(nothing - 0.1)}
                 : Paper{{1, 1, 1}, grey(0.08), grey(0.35), grey(0.3), grey(nothing), grey(nothing - 0.12)};
  if (map == ColourMap::Gray) {  // grey is a value
    p.nothing = dark ? Rgb{0.15, 0.21, 0.32} : Rgb{0.80, 0.87, 0.96};
    p.turned_away = dark ? Rgb{0.10, 0.15, 0.24} : Rgb{0.69, 0.77, 0.89};
  }
  return p;
}

PanelMasks panel_masks(const MapFigure& figure, const MapPanel& panel, int layer) {
  const MapSurface& s = figure.surfaces[at(panel.surface)];
  PanelMasks masks;
  masks.all = layer_triangles(s.mesh, s.projection, layer);
  masks.away = masks.valued = masks.interpolated = TriangleMask(masks.all.size());
  for (std::size_t t = 0; t < masks.all.size(); ++t) {
    masks.away[t] = masks.all[t] && s.projection.back[t];
    const auto& v = s.mesh.triangles[t];
    const bool seen = masks.all[t] && !masks.away[t];
    masks.interpolated[t] =
        seen && std::all_of(v.begin(), v.end(), [&](int i) { return std::isfinite(panel.points[at(i)]); });
    masks.valued[t] = figure.smooth ? masks.interpolated[t] : seen && std::isfinite(panel.facets[at(s.mesh.facet[t])]);
  }
  return masks;
}

std::string picture(const MapFigure& figure, const PictureOptions& options) { return laid_out(figure, options, drawn); }

Image map_image(const MapFigure& figure, const PictureOptions& options) {
  PictureOptions png = options;
  png.format = PictureFormat::Png;
  return laid_out(figure, png, drawn_image);
}

}  // namespace dea
