#include "views/map/hip_picture.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "src/base/numbers.h"
#include "views/map/pen.h"

namespace dea {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPanel = 300.0, kBetween = 22.0, kEdge = 16.0, kHeader = 62.0, kSmall = 14.0, kHead = 15.5;
constexpr double kTop = kEdge + 26 + kHeader;  // of the panels
constexpr Rgb kInk = {0.08, 0.08, 0.09}, kPale = {0.35, 0.35, 0.36}, kSocket = {0.15, 0.15, 0.16},
              kFemur = {0.6, 0.6, 0.61}, kAngle = {0.10, 0.38, 0.72}, kRoofLine = {0.80, 0.30, 0.05};

/// A panel's square: from lengths about a centre to the paper.
struct Square {
  double left = 0.0, top = 0.0, reach = 1.0;  // reach: half of its width
  Vector2d operator()(const Vector2d& x) const {
    return {left + kPanel / 2 * (1 + x.x() / reach), top + kPanel / 2 * (1 - x.y() / reach)};
  }
  double length(double x) const { return x * kPanel / (2 * reach); }
};

void line(Pen& pen, const Square& square, const Vector2d& from, const Vector2d& to) {
  const auto eighths = [](const Vector2d& p) { return Vector2d((8 * p).array().round() / 8); };  // files stay small
  pen.line(eighths(square(from)), eighths(square(to)));
}

void circle(Pen& pen, const Square& square, const Vector2d& center, double radius) {
  pen.circle(square(center), square.length(radius));
}

void dot(Pen& pen, const Square& square, const Vector2d& x, double radius) {
  pen.circle(square(x), radius);
  pen.fill();
}

/// Words on a white ground, their middle at x.
void label(Pen& pen, const Square& square, const Vector2d& x, const std::string& text, const Rgb& colour) {
  pen.font(kSmall, true);
  const Vector2d middle = square(x);
  const double width = pen.width(text);
  pen.use({1, 1, 1}, 0.85);
  pen.rectangle(middle.x() - width / 2 - 2, middle.y() - kSmall / 2 - 2, width + 4, kSmall + 4);
  pen.use(colour);
  pen.text(middle.x() - width / 2, middle.y() + 0.36 * kSmall, text);
}

void header(Pen& pen, const Square& square, const std::string& title, const std::string& below) {
  pen.use(kInk);
  pen.font(kHead, true);
  pen.text(square.left, square.top - 30, title);
  pen.use(kPale);
  pen.font(kSmall);
  pen.text(square.left, square.top - 10, below);
}

/// Words at the left and right end, near the bottom.
void ends(Pen& pen, const Square& square, const std::string& left, const std::string& right) {
  pen.use(kPale);
  pen.font(kSmall);
  pen.text(square.left + 4, square.top + kPanel - 6, left);
  pen.text(square.left + kPanel - 4 - pen.width(right), square.top + kPanel - 6, right);
}

void frame_of(Pen& pen, const Square& square) {
  pen.use({0.8, 0.8, 0.8});
  pen.box(square.left, square.top, kPanel, kPanel);
  pen.stroke(1);
}

std::string degrees(double angle) {
  return std::isfinite(angle) ? fmt::format("{:.1f}°", std::abs(angle) < 0.05 ? 0.0 : angle) : "–";
}

/// The angle between straight up and the line to the edge.
void draw_edge_angle(Pen& pen, const Square& square, const Vector2d& edge, double angle, double radius) {
  const Vector2d center = Vector2d::Zero();
  pen.use(kAngle);
  line(pen, square, center, {0, 1.75 * radius});
  pen.stroke(1.2);
  line(pen, square, center, 1.35 * edge);
  pen.stroke(1.6);
  const Vector2d c = square(center);
  const double up = -kPi / 2, to = up + angle / kDegreesPerRadian;
  pen.arc(c, square.length(0.6 * radius), std::min(up, to), std::max(up, to));
  pen.stroke(1.6);
  dot(pen, square, center, 2.5);
  dot(pen, square, edge, 4);
}

void draw_roof(Pen& pen, const Square& square, const Vector2d& end, const Vector2d& edge, double radius) {
  pen.use(kRoofLine);
  line(pen, square, end, edge);
  pen.stroke(1.8);
  line(pen, square, end, {end.x() + 1.3 * radius, end.y()});
  pen.stroke(1);
  dot(pen, square, end, 4);
}

void draw_section(Pen& pen, const Square& square, const HipSection& section, const HipMeasures& m, double angle,
                  const char* word) {
  pen.save();
  pen.clip(square.left, square.top, kPanel, kPanel);
  for (const auto& piece : section.head_lines) line(pen, square, piece[0], piece[1]);
  pen.use(kFemur);
  pen.stroke(1.6);
  for (const auto& piece : section.socket_lines) line(pen, square, piece[0], piece[1]);
  pen.use(kSocket);
  pen.stroke(1.6);
  const Vector3d off = m.socket.center - m.head.center;
  const double above = off.dot(section.across.cross(section.up)),
               radius = std::sqrt(std::max(0.0, m.socket.radius * m.socket.radius - above * above));
  pen.dashed(4, 4);
  pen.use(kPale);
  circle(pen, square, {off.dot(section.across), off.dot(section.up)}, radius);
  circle(pen, square, Vector2d::Zero(), m.head.radius);
  pen.stroke(0.9);
  pen.undashed();
  if (section.edge && section.roof_end) draw_roof(pen, square, *section.roof_end, *section.edge, m.head.radius);
  if (section.edge) {
    draw_edge_angle(pen, square, *section.edge, angle, m.head.radius);
    label(pen, square, {0.0, -0.25 * m.head.radius}, fmt::format("{} {}", word, degrees(angle)), kAngle);
  }
  if (section.roof_end)
    label(pen, square, {0.0, -0.5 * m.head.radius}, fmt::format("AI {}", degrees(m.acetabular_index)), kRoofLine);
  pen.restore();
  frame_of(pen, square);
}

void draw_rim(Pen& pen, const Square& square, const HipMeasures& m) {
  if (m.rim.empty()) {
    frame_of(pen, square);
    return;
  }
  const Vector3d right = m.axes.col(1).cross(m.rim_normal).normalized(), up = m.rim_normal.cross(right);
  const auto flat = [&](const Vector3d& x) { return Vector2d(right.dot(x - m.rim_center), up.dot(x - m.rim_center)); };
  pen.use(kAngle);
  circle(pen, square, Vector2d::Zero(), m.rim_radius);
  pen.stroke(1.2);
  pen.use(kPale);
  pen.dashed(4, 4);
  circle(pen, square, flat(m.head.center), m.head.radius);
  pen.stroke(0.9);
  pen.undashed();
  for (std::size_t i = 0; i < m.rim.size(); ++i) {
    pen.use(m.rim_in_plane[i] ? kSocket : kRoofLine);
    dot(pen, square, flat(m.rim[i]), m.rim_in_plane[i] ? 1.8 : 1.5);
  }
  pen.use(kAngle);
  dot(pen, square, flat(m.head.center), 2.5);
  frame_of(pen, square);
  const bool front_right = right.dot(m.axes.col(0)) > 0;
  ends(pen, square, front_right ? "behind" : "in front", front_right ? "in front" : "behind");
}

double left_of(int panel) { return kEdge + panel * (kPanel + kBetween); }

}  // namespace

std::vector<std::string> hip_panels() {
  std::vector<std::string> boxes;
  for (int i = 0; i < 3; ++i)
    boxes.push_back(fmt::format("{} {} {} {}", left_of(i) - 6, kTop - 48, kPanel + 12, kPanel + 54));
  return boxes;
}

std::vector<std::string> hip_words(const HipMeasures& m) {
  std::string missing;
  for (const std::string& what : m.missing)
    missing += (missing.empty() ? "Not measured: " : ", ") + what.substr(0, what.find(':'));
  return {fmt::format("Dark: {}. Grey: {}. Dashed: spheres of head (radius {:.4g}) and socket ({:.4g}). Both sections "
                      "pass through the head's centre.",
                      m.socket_bone, m.head_bone, m.head.radius, m.socket.radius),
          fmt::format("Rim: dark points bear the plane (rms {:.2g}), orange ones lie off it. Above radiographic, "
                      "anatomic inclination {}, anteversion {}.",
                      m.rim_rms, degrees(m.inclination_anatomic), degrees(m.anteversion_anatomic)),
          missing};
}

std::string hip_picture(const HipMeasures& m, PictureFormat format, double dpi) {
  const double width = left_of(2) + kPanel + kEdge, height = kTop + kPanel + 84;
  const auto square = [&](int column) { return Square{left_of(column), kTop, 2 * m.socket.radius}; };
  return drawn({format, width, height, dpi}, [&](Pen& pen) {
    pen.use({1, 1, 1});
    pen.rectangle(0, 0, width, height);
    pen.use(kInk);
    pen.font(18, true);
    pen.text(kEdge, kEdge + 18, fmt::format("Hip, {}", name(m.side)));
    pen.font(kSmall);
    pen.use(kPale);
    pen.text(kEdge + 130, kEdge + 18, fmt::format("axes {}", m.axes_words));
    header(pen, square(0), "Coronal section",
           fmt::format("center-edge {}, acetabular index {}", degrees(m.lateral_center_edge),
                       degrees(m.acetabular_index)));
    draw_section(pen, square(0), m.coronal, m, m.lateral_center_edge, "LCE");
    ends(pen, square(0), "medial", "lateral");
    header(pen, square(1), "Sagittal section", fmt::format("center-edge {}", degrees(m.anterior_center_edge)));
    draw_section(pen, square(1), m.sagittal, m, m.anterior_center_edge, "ACE");
    ends(pen, square(1), "behind", "in front");
    header(pen, square(2), "Rim, from outside",
           fmt::format("inclination {}, anteversion {}", degrees(m.inclination_radiographic),
                       degrees(m.anteversion_radiographic)));
    draw_rim(pen, square(2), m);
    pen.use(kPale);
    pen.font(kSmall);
    double y = kTop + kPanel + 4;
    for (const std::string& line : hip_words(m)) pen.text(kEdge, y += 22, line);
  });
}

}  // namespace dea
