#include "tests/build/segmented_joints.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <random>

#include "src/base/numbers.h"
#include "src/build/mend_surface.h"
#include "tests/build/build_shapes.h"

namespace dea::test {

namespace {

using Eigen::Vector3d;

/// Numbers that are the same with every library.
struct Draw {
  std::mt19937 engine;
  double in(double from, double to) { return from + (to - from) * static_cast<double>(engine()) / 4294967296.0; }
  bool chance(double part) { return in(0, 1) < part; }
  int below(int n) { return static_cast<int>(engine() % static_cast<unsigned>(n)); }
};

/// A place on a disc of radius 1, with the distance to its rim.
struct Place {
  double x, y;
  double rim() const { return 1 - std::hypot(x, y); }
};

/// A disc of rings, triangles of about 1 / rings, numbered from the middle; the last ring is the rim.
struct Disc {
  std::vector<Place> places;
  std::vector<std::array<int, 3>> triangles;
  std::vector<int> rim;
};

Disc disc(int rings, double jitter, Draw& draw) {
  Disc d;
  d.places.push_back({0, 0});
  const auto first = [](int ring) { return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1); };
  for (int r = 1; r <= rings; ++r)
    for (int i = 0; i < 6 * r; ++i) {
      const bool at_rim = r == rings;
      const double off = at_rim ? 0 : jitter / rings * draw.in(-1, 1), turn = jitter / r * draw.in(-1, 1);
      const double angle = 2 * kPi * i / (6 * r) + turn, radius = static_cast<double>(r) / rings + off;
      d.places.push_back({radius * std::cos(angle), radius * std::sin(angle)});
      if (at_rim) d.rim.push_back(first(r) + i);
    }
  for (int r = 0; r < rings; ++r)
    for (int side = 0; side < 6; ++side)
      for (int i = 0; i <= r; ++i) {
        const auto inner = [&](int k) { return r == 0 ? 0 : first(r) + (side * r + k) % (6 * r); };
        const auto outer = [&](int k) { return first(r + 1) + (side * (r + 1) + k) % (6 * (r + 1)); };
        d.triangles.push_back({inner(i), outer(i), outer(i + 1)});
        if (i < r) d.triangles.push_back({inner(i), outer(i + 1), inner(i + 1)});
      }
  return d;
}

enum class Shell { Closed, Open, OpenWithWall };

/// A disc above, the same below, joined at the rim; without the disc below, or without the wall at the rim too.
TriangleSurface shell(const Disc& d, const std::vector<Vector3d>& above, const std::vector<Vector3d>& below,
                      Shell kind = Shell::Closed) {
  TriangleSurface s{above, d.triangles};
  if (kind == Shell::Open) return s;
  const int first = static_cast<int>(above.size()), n = static_cast<int>(d.rim.size());
  s.points.insert(s.points.end(), below.begin(), below.end());
  if (kind == Shell::Closed)
    for (const auto& t : d.triangles) s.triangles.push_back({t[0] + first, t[2] + first, t[1] + first});
  for (int i = 0; i < n; ++i) {
    const int a = d.rim[at(i)], b = d.rim[at((i + 1) % n)];
    s.triangles.push_back({a, b + first, b});
    s.triangles.push_back({a, a + first, b + first});
  }
  return s;
}

/// The bone's side of a joint surface, over a disc of its own.
struct Side {
  std::function<Vector3d(double, double)> bone;  ///< of a place on the disc, may be asked up to 1.4 outside
  bool up = true;                                ///< the joint space is above
  double size = 10;                              ///< radius of the disc [mm]

  Vector3d normal(double x, double y) const {
    const double e = 1e-4;
    const Vector3d n = (bone(x + e, y) - bone(x - e, y)).cross(bone(x, y + e) - bone(x, y - e)).normalized();
    return up ? n : Vector3d(-n);
  }
};

/// What a scan does to its surfaces.
struct Scan {
  double edge = 1;        ///< of the triangles [mm]
  double jitter = 0.15;   ///< of their points, of the edge
  double noise = 0;       ///< half a voxel [mm]
  bool steps = false;     ///< noise is that of a voxel's steps along z, not a throw of dice
  double rim_angle = 45;  ///< of the cartilage [degrees]; 0: thins out to nothing, level
  double poke = 0;        ///< how deep the articular surface lies in the bone at a place [mm]
  double float_gap = 0;   ///< between the cartilage's far side and the bone [mm], < 0: in it
  Shell kind = Shell::Closed;
  double thickness = 2;  ///< of the cartilage [mm]
};

Vector3d noisy(const Vector3d& x, const Vector3d& normal, const Scan& scan, Draw& draw) {
  if (scan.noise == 0) return x;
  if (!scan.steps) return x + scan.noise * draw.in(-1, 1) * normal;
  Vector3d y = x;
  y.z() = 2 * scan.noise * std::round(x.z() / (2 * scan.noise));
  return y;
}

double thickness_at(const Scan& scan, double from_rim) {
  if (scan.rim_angle <= 0) {
    const double s = std::min(1.0, from_rim / (2.5 * scan.thickness));
    return scan.thickness * s * s * (3 - 2 * s);
  }
  if (scan.rim_angle >= 89.9) return scan.thickness;
  return std::min(scan.thickness, from_rim * std::tan(scan.rim_angle * kPi / 180));
}

/// Cartilage on a side; the rim of both faces is one where it has no thickness there.
TriangleSurface cartilage_shell(const Side& side, const Scan& scan, Draw& draw) {
  const Disc d = disc(std::max(3, static_cast<int>(std::lround(side.size / scan.edge))), scan.jitter, draw);
  const Place poked{draw.in(-0.4, 0.4), draw.in(-0.4, 0.4)};
  const double poked_size = draw.in(0.1, 0.25);
  std::vector<Vector3d> above, below;
  for (const Place& p : d.places) {
    const Vector3d x = side.bone(p.x, p.y), n = side.normal(p.x, p.y);
    double t = thickness_at(scan, std::max(0.0, p.rim()) * side.size);
    if (scan.poke > 0) {
      const double away = std::hypot(p.x - poked.x, p.y - poked.y) / poked_size;
      t -= (scan.thickness + scan.poke) * std::exp(-away * away);
    }
    above.push_back(noisy(x + t * n, n, scan, draw));
    // where it ends in an edge, both faces have the same points
    const bool edge = p.rim() < 1e-9 && t <= 0 && scan.poke == 0;
    below.push_back(edge ? above.back() : noisy(x + std::min(scan.float_gap, 0.6 * t) * n, n, scan, draw));
  }
  TriangleSurface s = shell(d, above, below, scan.kind);
  return side.up ? s : [&] {
    for (auto& t : s.triangles) std::swap(t[1], t[2]);
    return s;
  }();
}

/// A closed bone whose joint surface reaches a third beyond the cartilage.
TriangleSurface bone_block(const Side& side, const Scan& scan, double depth, Draw& draw) {
  const double beyond = 1.35;
  const Disc d = disc(std::max(4, static_cast<int>(std::lround(beyond * side.size / scan.edge))), scan.jitter, draw);
  std::vector<Vector3d> above, below;
  for (const Place& p : d.places) {
    const Vector3d x = side.bone(beyond * p.x, beyond * p.y);
    above.push_back(noisy(x, side.normal(beyond * p.x, beyond * p.y), scan, draw));
    below.push_back(x + Vector3d(0, 0, side.up ? -depth : depth));
  }
  TriangleSurface s = shell(d, above, below);
  if (!side.up)
    for (auto& t : s.triangles) std::swap(t[1], t[2]);
  return s;
}

/// z = x^2 / 2 rx + y^2 / 2 ry at the height, over an ellipse; `sharp`: a ridge (or a groove) along y instead of round.
Side quadric(double rx, double ry, double height, bool up, double size, double stretch, double sharp,
             double shift_x = 0) {
  Side s;
  s.up = up;
  s.size = size;
  s.bone = [=](double u, double v) {
    const double x = size * u, y = size * stretch * v;
    const double across = sharp > 0 ? 0.6 * size * (std::sqrt(x * x + sharp * sharp) - sharp) : x * x / 2;
    return Vector3d(x + shift_x, y, height + across / rx + y * y / (2 * ry));
  };
  return s;
}

/// Part of a sphere about (0, 0, height) up to `polar` [rad] from the pole that looks up or down, from outside.
Side sphere_side(double radius, double height, double polar, bool up, double squash) {
  Side s;
  s.up = up;
  s.size = radius * polar;
  s.bone = [=](double u, double v) {
    const double r = std::hypot(u, v), angle = polar * r, k = r > 0 ? std::sin(angle) / r : polar;
    return Vector3d(radius * k * u, squash * radius * k * v, height + (up ? 1 : -1) * radius * std::cos(angle));
  };
  return s;
}

void add_bone(SegmentedJoint& j, const std::string& name, const TriangleSurface& bone,
              const TriangleSurface& cartilage) {
  CartilageRequest c;
  c.bone = static_cast<int>(j.request.bones.size());
  c.outer = mend_surface(cartilage).surface;
  j.request.bones.push_back(bone_request(name, bone));
  if (!cartilage.triangles.empty()) j.request.cartilages.push_back(c);
}

void load(SegmentedJoint& j, std::size_t bone, double force) {
  j.request.bones[bone].fixed = false;
  j.request.bones[bone].force = {0, 0, force};
}

Scan draw_scan(double size, Draw& draw) {
  Scan s;
  s.edge = std::max(size / 32, 0.3 * std::pow(4 / 0.3, draw.in(0, 1)));
  s.edge = std::min(s.edge, size / 3);
  s.thickness = draw.in(0.8, 3.0);
  s.rim_angle = draw.chance(0.2) ? 0 : draw.chance(0.25) ? 90 : draw.in(5, 85);
  if (draw.chance(0.7)) s.noise = 0.5 * std::min(draw.in(0.2, 0.6), s.edge);
  s.steps = draw.chance(0.3);
  if (draw.chance(0.25)) s.poke = draw.in(0.05, 0.4);
  if (draw.chance(0.4)) s.float_gap = draw.in(-0.3, 0.4);
  if (draw.chance(0.2)) s.kind = s.edge < 1 ? Shell::OpenWithWall : Shell::Open;
  return s;
}

std::string words_of(const Scan& s) {
  return fmt::format("edge {:.2g} thick {:.2g} rim {:.0f}{}{}{}{}", s.edge, s.thickness, s.rim_angle,
                     s.noise > 0 ? fmt::format(" {} {:.2g}", s.steps ? "steps" : "noise", s.noise) : "",
                     s.poke > 0 ? fmt::format(" pokes {:.2g}", s.poke) : "",
                     s.float_gap != 0 ? fmt::format(" floats {:.2g}", s.float_gap) : "",
                     s.kind == Shell::Closed ? ""
                     : s.kind == Shell::Open ? " open"
                                             : " open, with a wall");
}

void append(TriangleSurface& s, const TriangleSurface& more) { s.append(more); }

/// A load of 0.4 to 1.5 MPa over a third of the joint's surface: more than that crushes thin cartilage on rough bone.
double bearable(double size, const Scan& scan, const Scan& other, Draw& draw) {
  const double thin = std::min(1.0, std::min(scan.thickness, other.thickness) / 2);
  return draw.in(0.4, 1.5) * thin * kPi * size * size / 3;
}

/// Two sides that rest on each other, the first below; gap: between their articular surfaces at the middle.
void two_sides(SegmentedJoint& j, const std::string& lower, const Side& below, const std::string& upper,
               const Side& above, const Scan& scan, const Scan& other, double size, Draw& draw) {
  add_bone(j, lower, bone_block(below, scan, draw.in(8, 20), draw), cartilage_shell(below, scan, draw));
  add_bone(j, upper, bone_block(above, other, draw.in(8, 20), draw), cartilage_shell(above, other, draw));
  load(j, 1, -bearable(size, scan, other, draw));
}

}  // namespace

SegmentedJoint segmented_joint(unsigned seed) {
  Draw draw{std::mt19937(7919 * seed + 1)};
  SegmentedJoint j;
  const char* kinds[] = {"patella", "plateaus", "shoulder", "saddle", "ankle", "compartments"};
  j.kind = kinds[seed % 6];
  const double size = draw.in(8, 18);
  const Scan scan = draw_scan(size, draw);
  Scan other = draw_scan(size, draw);
  if (draw.chance(0.5)) {  // of one scan
    other.edge = scan.edge;
    other.noise = scan.noise;
    other.steps = scan.steps;
  }
  const double gap = draw.in(0.1, 1.0) + scan.thickness + other.thickness + scan.noise + other.noise;
  if (j.kind == "patella") {
    const Side trochlea =
        quadric(draw.in(9, 14), -draw.in(18, 25), 0, true, 1.2 * size, 1.0, draw.chance(0.5) ? draw.in(2, 6) : 0);
    const double sharp = draw.chance(0.5) ? draw.in(1, 5) : 0;
    two_sides(j, "femur", trochlea, "patella", quadric(draw.in(5, 8), -draw.in(35, 60), gap, false, size, 0.8, sharp),
              scan, other, size, draw);
  } else if (j.kind == "saddle") {
    two_sides(j, "trapezium", quadric(draw.in(14, 22), -draw.in(9, 14), 0, true, 0.8 * size, 1.1, 0), "metacarpal",
              quadric(draw.in(8, 12), -draw.in(16, 30), gap, false, 0.7 * size, 1.1, 0), scan, other, size, draw);
  } else if (j.kind == "shoulder") {
    const double r = draw.in(20, 26), shallow = r + scan.thickness + other.thickness + draw.in(1, 12);
    const Side glenoid = quadric(shallow, shallow, 0, true, draw.in(11, 15), 1.25, 0);
    const double polar = draw.in(0.7, 1.15);
    const Side head = sphere_side(r, gap + r, polar, false, draw.in(0.94, 1.0));
    add_bone(j, "scapula", bone_block(glenoid, scan, 15, draw), cartilage_shell(glenoid, scan, draw));
    add_bone(j, "humerus", bone_block(head, other, 3 * r, draw), cartilage_shell(head, other, draw));
    load(j, 1, -bearable(size, scan, other, draw));
  } else if (j.kind == "ankle") {
    const double width = draw.in(0.8, 1.2);
    const Side plafond = quadric(-draw.in(24, 32), -draw.in(60, 90), gap, false, size, width, 0);
    const Side dome = quadric(-draw.in(18, 22), -draw.in(30, 45), 0, true, 1.1 * size, width, 0);
    const double thick = draw.in(36, 44), under = -thick - gap;
    const Side lower = quadric(draw.in(30, 40), draw.in(40, 50), -thick, false, 0.9 * size, 1.1, 0);
    Side heel = quadric(draw.in(50, 80), draw.in(70, 110), under, true, size, 1.1, 0);
    // the talus: its dome above, its lower joint surface below, closed around
    Disc d = disc(std::max(4, static_cast<int>(std::lround(1.4 * size / scan.edge))), scan.jitter, draw);
    std::vector<Vector3d> above, below;
    for (const Place& p : d.places) {
      above.push_back(noisy(dome.bone(1.35 * p.x, 1.35 * p.y), dome.normal(1.35 * p.x, 1.35 * p.y), scan, draw));
      below.push_back(noisy(lower.bone(1.5 * p.x, 1.5 * p.y), lower.normal(1.5 * p.x, 1.5 * p.y), scan, draw));
    }
    TriangleSurface both = cartilage_shell(dome, scan, draw);
    append(both, cartilage_shell(lower, scan, draw));
    add_bone(j, "tibia", bone_block(plafond, other, 20, draw), cartilage_shell(plafond, other, draw));
    add_bone(j, "talus", shell(d, above, below), both);
    add_bone(j, "calcaneus", bone_block(heel, other, 20, draw), cartilage_shell(heel, other, draw));
    j.request.bones[1].fixed = false;
    load(j, 2, bearable(size, scan, other, draw));
  } else {  // a knee: two dishes of the tibia under two condyles; "plateaus": the femur's cartilage is one shell
    const double apart = 1.45 * size;
    const auto round_abs = [](double x) { return std::sqrt(x * x + 64); };  // a notch, no crease
    const auto dishes = [=](double x, double y) {
      return std::pow(round_abs(x) - apart, 2) / (2 * 40) + y * y / (2 * 60) + 3 * std::exp(-x * x / 30);
    };
    const auto condyles = [=, ry = draw.in(22, 30)](double x, double y) {
      return gap + std::pow(round_abs(x) - apart, 2) / (2 * 18) + y * y / (2 * ry) + 4 * std::exp(-x * x / 90);
    };
    const auto side = [](auto height, double cx, double rx, double ry, bool up) {
      Side s;
      s.up = up;
      s.size = std::max(rx, ry);
      s.bone = [=](double u, double v) { return Vector3d(cx + rx * u, ry * v, height(cx + rx * u, ry * v)); };
      return s;
    };
    const Side tibia = side(dishes, 0, 1.9 * apart, 1.5 * size, true),
               femur = side(condyles, 0, 1.9 * apart, 1.5 * size, false);
    TriangleSurface plateaus = cartilage_shell(side(dishes, -apart, size, size, true), scan, draw);
    append(plateaus, cartilage_shell(side(dishes, apart, size, size, true), scan, draw));
    TriangleSurface of_femur;
    Scan coarse = other;
    coarse.edge = std::max(other.edge, size / 16);
    j.shares = j.kind == "plateaus";
    if (j.shares) {
      of_femur = cartilage_shell(side(condyles, 0, 1.7 * apart, 1.2 * size, false), coarse, draw);
    } else {
      of_femur = cartilage_shell(side(condyles, -apart, size, 1.2 * size, false), other, draw);
      append(of_femur, cartilage_shell(side(condyles, apart, size, 1.2 * size, false), other, draw));
    }
    Scan bone_scan = scan;
    bone_scan.edge = std::max(scan.edge, size / 16);
    Scan femur_scan = other;
    femur_scan.edge = coarse.edge;
    add_bone(j, "tibia", bone_block(tibia, bone_scan, 30, draw), plateaus);
    add_bone(j, "femur", bone_block(femur, femur_scan, 40, draw), of_femur);
    load(j, 1, -bearable(size, scan, other, draw));
  }
  if (draw.chance(0.2)) j.request.fade = draw.in(1, 4);
  if (draw.chance(0.2)) j.request.elements_through = 1 + draw.below(4);
  j.words = fmt::format("{} | {}{}{}", words_of(scan), words_of(other),
                        j.request.fade ? fmt::format(" | fade {:.2g}", *j.request.fade) : "",
                        j.request.elements_through != 2 ? fmt::format(" | layers {}", j.request.elements_through) : "");
  return j;
}

}  // namespace dea::test
