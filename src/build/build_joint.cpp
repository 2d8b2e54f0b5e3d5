#include "src/build/build_joint.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "src/base/disjoint_sets.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/parallel.h"
#include "src/base/say.h"
#include "src/build/clear_overlap.h"
#include "src/build/mend_surface.h"
#include "src/build/remesh.h"
#include "src/build/shared_space.h"

namespace dea {

double asked_thickness(const CartilageRequest& c) {
  switch (c.way) {
    case CartilageRequest::Way::Uniform:
      return c.thickness;
    case CartilageRequest::Way::HalfGap:
      return c.most;
    case CartilageRequest::Way::Points:
      return *std::max_element(c.thickness_there.begin(), c.thickness_there.end());
    case CartilageRequest::Way::Segmented:
      break;
  }
  return 0.0;
}

namespace {

/// More triangles than these are not made of one layer's surface.
constexpr double kMostTriangles = 1'000'000;

using Eigen::Vector3d;
using Way = CartilageRequest::Way;
using Triangle = std::array<int, 3>;

/// A bone, ready to be asked.
struct Bone {
  TriangleSurface surface;
  std::vector<Vector3d> normals;
  RayCaster caster;
  explicit Bone(TriangleSurface s) : surface(std::move(s)), normals(point_normals(surface)), caster(mesh_of(surface)) {}
};

/// Normals of the bone at points on it, smoothed over two of its edges: a scan is rough at the scale of its triangles.
std::vector<Vector3d> directions_at(const Bone& bone, const std::vector<Vector3d>& points) {
  std::vector<Vector3d> normals = bone.normals;
  for (int c = 0; c < 3; ++c) {
    std::vector<double> component(normals.size());
    for (std::size_t i = 0; i < normals.size(); ++i) component[i] = normals[i][c];
    component = smoothed(bone.surface, std::move(component), 2 * mean_edge(bone.surface));
    for (std::size_t i = 0; i < normals.size(); ++i) normals[i][c] = component[i];
  }
  std::vector<Vector3d> directions(points.size(), Vector3d::Zero());
  const SurfaceMesh& mesh = bone.caster.mesh();
  parallel_for(points.size(), [&](std::size_t i) {
    const SurfacePoint at_bone = bone.caster.closest(points[i]);
    const auto& corners = mesh.triangles[at(at_bone.triangle)];
    for (std::size_t k = 0; k < 3; ++k)
      directions[i] += at_bone.weights[k] * normals[at(mesh.model_nodes[at(corners[k])])].normalized();
    directions[i].normalize();
  });
  return directions;
}

TriangleSurface turned(TriangleSurface s) {
  for (auto& t : s.triangles) std::swap(t[1], t[2]);
  return s;
}

std::string place_text(const Vector3d& x) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", x.x(), x.y(), x.z()); }

/// Between the points of one and the surface of the other.
double least_distance(const Bone& a, const Bone& b) {
  std::vector<double> distances(a.surface.points.size());
  parallel_for(distances.size(), [&](std::size_t i) { distances[i] = distance_to(b.caster, a.surface.points[i]); });
  return *std::min_element(distances.begin(), distances.end());
}

/// How many points of a (at most some thousands are asked) face b.
int facing_points(const Bone& a, const Bone& b, double reach) {
  std::vector<Vector3d> points, normals;
  const std::size_t step = 1 + a.surface.points.size() / 5000;
  for (std::size_t i = 0; i < a.surface.points.size(); i += step) {
    points.push_back(a.surface.points[i]);
    normals.push_back(a.normals[i]);
  }
  const std::vector<double> gaps = facing_gaps(points, normals, b.caster, reach);
  return static_cast<int>(std::count_if(gaps.begin(), gaps.end(), [](double g) { return std::isfinite(g); }));
}

/// Open bones have no inside: the sides that face each other are their outsides.
void turn_open_bones(const BuildRequest& request, std::vector<Bone>& bones, BuildReport& report) {
  for (std::size_t a = 0; a < bones.size(); ++a) {
    if (request.bones[a].closed) continue;
    const Bone other_side(turned(bones[a].surface));
    int as_is = 0, other = 0;
    for (std::size_t b = 0; b < bones.size(); ++b) {
      if (b == a) continue;
      const double reach = 3 * least_distance(bones[a], bones[b]) + 0.1 * size_of(bones[b].surface);
      const auto both = [&](const Bone& x) {
        int count = facing_points(x, bones[b], reach);
        if (!request.bones[b].closed) count = std::max(count, facing_points(x, Bone(turned(bones[b].surface)), reach));
        return count;
      };
      as_is += both(bones[a]);
      other += both(other_side);
    }
    if (other <= as_is) continue;
    bones[a] = other_side;
    report.findings.push_back(
        fmt::format("{}: open surface, turned so that it faces the other bone", request.bones[a].name));
  }
}

/// Where edges of a bone pass through the other one's surface, farther than `tolerance` to both sides.
void refuse_crossing(const BuildRequest& request, const std::vector<Bone>& bones, std::size_t a, std::size_t b) {
  const double tolerance = 1e-4 * size_of(bones[b].surface);
  const TriangleSurface& s = bones[a].surface;
  std::vector<char> crosses(s.triangles.size(), 0);
  parallel_for(s.triangles.size(), [&](std::size_t t) {
    for (std::size_t k = 0; k < 3; ++k) {  // neighbours have the edge the other way round: both sides are seen
      const Vector3d &from = s.points[at(s.triangles[t][k])], along = s.points[at(s.triangles[t][(k + 1) % 3])] - from;
      const double length = along.norm();
      if (length <= 2 * tolerance) continue;
      const LineHit hit = bones[b].caster.nearest_facing(from + tolerance / length * along, along / length, 0, 0,
                                                         length - 2 * tolerance);
      crosses[t] |= hit.point.triangle >= 0 && hit.distance > 0;
    }
  });
  const auto found = std::find(crosses.begin(), crosses.end(), 1);
  if (found == crosses.end()) return;
  const Triangle& t = s.triangles[static_cast<std::size_t>(found - crosses.begin())];
  throw InputError(
      fmt::format("bones \"{}\" and \"{}\" interpenetrate: found {} triangles of the first that pass through the "
                  "surface of the second, "
                  "one at {}, expected bones apart; segment them anew or move one",
                  request.bones[a].name, request.bones[b].name, std::count(crosses.begin(), crosses.end(), 1),
                  place_text(s.points[at(t[0])])));
}

/// One surface under two names: no point of it lies inside the other, for all lie on it.
void refuse_same_surface(const BuildRequest& request, const std::vector<Bone>& bones, std::size_t a, std::size_t b) {
  const double tolerance = 1e-4 * size_of(bones[b].surface);
  const auto box = box_of(bones[b].surface);
  const std::vector<Vector3d>& points = bones[a].surface.points;
  std::vector<char> on_other(points.size(), 0);
  parallel_for(points.size(), [&](std::size_t i) {
    on_other[i] = box.contains(points[i]) && distance_to(bones[b].caster, points[i]) < tolerance;
  });
  const auto count = static_cast<std::size_t>(std::count(on_other.begin(), on_other.end(), 1));
  if (2 * count > points.size())
    throw InputError(fmt::format(
        "bones \"{}\" and \"{}\": found {} of {} points of the first on the surface of the second, expected "
        "two bones; are both given the same file?",
        request.bones[a].name, request.bones[b].name, count, points.size()));
}

/// Points of one bone within the other; an open one has no inside, there edges tell.
void refuse_overlap(const BuildRequest& request, const std::vector<Bone>& bones) {
  for (std::size_t a = 0; a < bones.size(); ++a)
    for (std::size_t b = 0; b < bones.size(); ++b) {
      if (a == b) continue;
      refuse_same_surface(request, bones, a, b);
      if (!request.bones[b].closed) {
        refuse_crossing(request, bones, a, b);
        continue;
      }
      const auto box = box_of(bones[b].surface);
      const std::vector<Vector3d>& points = bones[a].surface.points;
      const RayCaster& caster = bones[b].caster;
      const std::vector<Vector3d> at_vertices = angle_weighted_normals(caster.mesh());
      std::vector<double> depth(points.size(), 0.0);
      parallel_for(points.size(), [&](std::size_t i) {
        if (!box.contains(points[i])) return;
        depth[i] = std::max(0.0, -signed_distance(caster, at_vertices, points[i]));
      });
      const auto deepest = std::max_element(depth.begin(), depth.end());
      if (*deepest > 1e-4 * size_of(bones[b].surface))
        throw InputError(
            fmt::format("bones \"{}\" and \"{}\" interpenetrate: found a point of the first {:.3g} inside the second, "
                        "at {}, expected bones apart; "
                        "segment them anew or move one",
                        request.bones[a].name, request.bones[b].name, *deepest,
                        place_text(points[static_cast<std::size_t>(deepest - depth.begin())])));
    }
}

/// Up to which gap the bones' surfaces belong to the joint; 0: nobody asks.
double reach_of(const BuildRequest& request, BuildReport& report) {
  if (request.reach) return *request.reach;
  double most = 0;
  for (const CartilageRequest& c : request.cartilages) most = std::max(most, asked_thickness(c));
  if (most == 0) return 0;
  const double reach = 3 * most;
  report.findings.push_back(
      fmt::format("cartilage where the bones face each other within {:.4g}, 3 times the thickest layer ({})", reach,
                  request.wording({"reach"})));
  return reach;
}

/// Per point of a bone the least gap to all others.
std::vector<double> gaps_to_others(const std::vector<Bone>& bones, std::size_t bone,
                                   const std::vector<Vector3d>& points, const std::vector<Vector3d>& normals,
                                   double reach) {
  std::vector<double> gaps(points.size(), kInfinity);
  for (std::size_t b = 0; b < bones.size(); ++b) {
    if (b == bone) continue;
    const std::vector<double> to = facing_gaps(points, normals, bones[b].caster, reach);
    for (std::size_t i = 0; i < gaps.size(); ++i) gaps[i] = std::min(gaps[i], to[i]);
  }
  return gaps;
}

/// Half the gap grows towards its rim until it is cut off: that rim is no anatomy, and is not left as it is.
double fade_of(const CartilageRequest& c, const BuildRequest& request) {
  return request.fade.value_or(c.way == Way::HalfGap ? request.rim_length : 0.0);
}

/// Points with a thickness lie on their bone.
void refuse_far_places(const CartilageRequest& c, const BuildRequest& request, const std::vector<Bone>& bones) {
  const Bone& bone = bones[at(c.bone)];
  double nearest = kInfinity;
  for (const Vector3d& x : c.places) nearest = std::min(nearest, distance_to(bone.caster, x));
  if (nearest > 0.2 * size_of(bone.surface))
    throw InputError(
        fmt::format("thickness of \"{}\": found its nearest point {:.4g} away from the bone, expected points on the "
                    "bone; are both in one frame and unit?",
                    request.bones[at(c.bone)].name, nearest));
}

std::vector<double> thickness_of(const CartilageRequest& c, const BuildRequest& request, const std::vector<Bone>& bones,
                                 const TriangleSurface& region, double reach) {
  std::vector<double> thickness(region.points.size(), c.thickness);
  double least = 0.1 * asked_thickness(c);
  if (c.way == Way::HalfGap) {
    least = c.least;
    thickness =
        gaps_to_others(bones, at(c.bone), region.points, directions_at(bones[at(c.bone)], region.points), 2 * reach);
    fill_unknown(region, thickness, 2 * c.most);
    for (double& t : thickness) t = std::clamp(t / 2, c.least, c.most);
    thickness = smoothed(region, std::move(thickness), request.rim_length);
  } else if (c.way == Way::Points) {
    refuse_far_places(c, request, bones);
    parallel_for(thickness.size(), [&](std::size_t i) {
      double nearest = kInfinity;
      for (std::size_t p = 0; p < c.places.size(); ++p) {
        const double distance = (c.places[p] - region.points[i]).squaredNorm();
        if (distance < nearest) {
          nearest = distance;
          thickness[i] = c.thickness_there[p];
        }
      }
    });
  }
  const double fade = fade_of(c, request);
  if (fade > 0) fade_at_rim(thickness, distances_to_rim(region), fade, least);
  return thickness;
}

/// Patches of one kind that are below a twentieth of the largest of their closed surface become the other kind: on a
/// rough surface single triangles look the other way than the side on which they lie. True: there were any.
bool turn_specks(const TriangleSurface& s, const std::vector<std::array<int, 3>>& neighbours,
                 const std::vector<int>& shell, std::vector<char>& outer, char kind) {
  constexpr double kSpeck = 0.05;
  DisjointSets joined(outer.size());
  for (std::size_t t = 0; t < outer.size(); ++t)
    for (const int n : neighbours[t])
      if (n >= 0 && outer[at(n)] == outer[t]) joined.join(static_cast<int>(t), n);
  std::vector<double> area(outer.size(), 0.0), largest(outer.size(), 0.0);
  for (std::size_t t = 0; t < outer.size(); ++t)
    area[at(joined.root(static_cast<int>(t)))] += area_vector(s, s.triangles[t]).norm();
  for (std::size_t t = 0; t < outer.size(); ++t)
    if (outer[t] == kind) largest[at(shell[t])] = std::max(largest[at(shell[t])], area[t]);
  bool any = false;
  for (std::size_t t = 0; t < outer.size(); ++t) {
    if (outer[t] != kind || area[at(joined.root(static_cast<int>(t)))] >= kSpeck * largest[at(shell[t])]) continue;
    outer[t] = kind == 0;
    any = true;
  }
  return any;
}

/// Where a side was not whole, its rim is ragged: triangles with two neighbours of the other kind join these.
void smooth_rim(const std::vector<std::array<int, 3>>& neighbours, std::vector<char>& outer) {
  for (int round = 0; round < 2; ++round) {
    const std::vector<char> before = outer;
    for (std::size_t t = 0; t < outer.size(); ++t) {
      int others = 0;
      for (const int n : neighbours[t]) others += n >= 0 && before[at(n)] != before[t];
      if (others >= 2) outer[t] = !before[t];
    }
  }
}

/// The side of a segmented cartilage that looks away from its bone; an open sheet as a whole.
TriangleSurface outer_side(const BuildRequest& request, const CartilageRequest& c, const Bone& bone,
                           BuildReport& report) {
  const std::string& name = request.bones[at(c.bone)].name;
  TriangleSurface s = c.outer;
  std::vector<char> outer(s.triangles.size(), 0);
  std::vector<double> facing(s.triangles.size());
  double balance = 0, nearest = kInfinity;
  for (std::size_t t = 0; t < outer.size(); ++t) {
    const auto& k = s.triangles[t];
    const Vector3d n = area_vector(s, k), x = (s.points[at(k[0])] + s.points[at(k[1])] + s.points[at(k[2])]) / 3;
    const SurfacePoint closest = bone.caster.closest(x);
    nearest = std::min(nearest, (x - position(bone.caster.mesh(), closest)).norm());
    facing[t] = n.normalized().dot(bone.caster.mesh().normals[at(closest.triangle)]);
    balance += facing[t] * n.norm();
  }
  if (nearest > 0.2 * size_of(s))
    throw InputError(fmt::format(
        "cartilage of \"{}\": found it {:.4g} away from the bone where it is nearest, expected it on the bone; "
        "are both in one frame and unit?",
        name, nearest));
  if (!rim_edges(s.triangles, edge_neighbours(s.triangles)).empty()) {
    if (balance < 0) {
      s = turned(std::move(s));
      report.findings.push_back(fmt::format("{}: cartilage surface turned, it looked into the bone", name));
    }
    return s;
  }
  for (std::size_t t = 0; t < outer.size(); ++t) outer[t] = facing[t] > 0.3;
  const auto neighbours = edge_neighbours(s.triangles);
  const std::vector<int> shell = connected_parts(s).part;
  const bool islands = turn_specks(s, neighbours, shell, outer, 1), holes = turn_specks(s, neighbours, shell, outer, 0);
  if (islands || holes) {
    smooth_rim(neighbours, outer);
    turn_specks(s, neighbours, shell, outer, 1);
    turn_specks(s, neighbours, shell, outer, 0);
  }
  s = mend_surface(part_of(s, outer)).surface;
  if (s.triangles.empty())
    throw InputError(
        fmt::format("cartilage of \"{}\": found a closed surface with no side away from the bone, expected one", name));
  report.findings.push_back(fmt::format(
      "{}: closed cartilage surface, its side away from the bone is the articular surface ({} of {} triangles)", name,
      s.triangles.size(), c.outer.triangles.size()));
  return s;
}

/// Each connected part is a layer.
std::vector<TriangleSurface> parts_of(const TriangleSurface& s) {
  const SurfaceParts of = connected_parts(s);
  std::vector<TriangleSurface> parts;
  for (int p = 0; p < static_cast<int>(of.area.size()); ++p) {
    std::vector<char> wanted(of.part.size());
    for (std::size_t t = 0; t < wanted.size(); ++t) wanted[t] = of.part[t] == p;
    parts.push_back(part_of(s, wanted));
  }
  return parts;
}

TriangleSurface with_edge(const BuildRequest& request, TriangleSurface s) {
  if (!request.edge) return s;
  const double area = area_of(s), of_one = std::sqrt(3.0) / 4 * *request.edge * *request.edge;
  if (area / of_one > kMostTriangles)
    throw InputError(
        Fault{.found = say("found an edge of {:g}, which would make {:.2g} triangles of a region of {:.4g},",
                           *request.edge, area / of_one, area),
              .expected = say("expected one that makes no more than {:.2g}: {:.2g} or longer ({})", kMostTriangles,
                              1.05 * std::sqrt(area / kMostTriangles * 4 / std::sqrt(3.0)), NamedSetting{"edge"})});
  s = remeshed(s, *request.edge);
  return part_of(s, std::vector<char>(s.triangles.size(), 1));
}

BoneRegion region_of(const BuildRequest& request, const CartilageRequest& c, const std::vector<Bone>& bones,
                     double reach) {
  RegionOptions options;
  options.reach = reach;
  options.rim_length = request.rim_length;
  options.fill_holes = request.fill_holes;
  options.given = c.region;
  const Bone& bone = bones[at(c.bone)];
  const BoneRegion region = find_region(
      bone.surface, gaps_to_others(bones, at(c.bone), bone.surface.points, bone.normals, 2 * reach), options);
  if (region.surface.triangles.empty())
    throw InputError(
        c.region ? Fault{.found = say("bone \"{}\": found no part of it in the region that was given,",
                                      request.bones[at(c.bone)].name),
                         .expected = say("expected one; correct {}", NamedSetting{"region"})}
                 : Fault{.found = say("bone \"{}\": found no part of it that faces another bone within {:.4g},",
                                      request.bones[at(c.bone)].name, reach),
                         .expected = say("expected one; a larger {}, a smaller {} or {} may do", NamedSetting{"reach"},
                                         NamedSetting{"rim"}, NamedSetting{"region", "", "NAME=FILE"})});
  return region;
}

/// A surface within the bone, or the bone's own.
void refuse_no_cartilage(const std::string& name, const Bone& bone, const Beneath& beneath, double mean) {
  const auto under = static_cast<std::size_t>(std::count(beneath.under.begin(), beneath.under.end(), 1));
  if (2 * under > beneath.under.size())
    throw InputError(fmt::format(
        "cartilage of \"{}\": found {} of {} points inside the bone, expected the cartilage's outer surface; "
        "are the files of bone and cartilage exchanged?",
        name, under, beneath.under.size()));
  if (mean < 1e-5 * size_of(bone.surface))
    throw InputError(
        fmt::format("cartilage of \"{}\": found its surface {:.2g} from the bone in the mean, expected the cartilage's "
                    "outer surface; is the file the bone's own?",
                    name, mean));
}

std::string way_words(const CartilageRequest& c) {
  switch (c.way) {
    case Way::Segmented:
      return "segmented";
    case Way::Uniform:
      return fmt::format("uniform {:.4g}", c.thickness);
    case Way::HalfGap:
      return fmt::format("half the gap, {:.4g} to {:.4g}", c.least, c.most);
    case Way::Points:
      return "thickness at points";
  }
  return "";
}

/// Columns that could not be made sound were left out. Where that is much of a layer, its surface is none.
void refuse_lost(const BuiltLayer& layer, const LayerReport& said) {
  constexpr double kMostLost = 0.25;
  if (said.changes.lost_part() > kMostLost || layer.triangles.empty())
    throw InputError(
        Fault{.found = say("{}: found no sound elements between its surface and the bone over {:.0f} % of its area,",
                           layer.name, 100 * said.changes.lost_part()),
              .expected = say("expected a surface that lies over the bone without folds; other triangles may do ({})",
                              NamedSetting{"edge"})});
}

/// All layers of one cartilage.
void add_cartilage(const BuildRequest& request, const CartilageRequest& c, const std::vector<Bone>& bones, double reach,
                   BuiltJoint& joint, BuildReport& report) {
  const Bone& bone = bones[at(c.bone)];
  BoneRegion region;
  if (c.way == Way::Segmented)
    region.surface = outer_side(request, c, bone, report);
  else
    region = region_of(request, c, bones, reach);
  const std::vector<TriangleSurface> parts = parts_of(region.surface);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const TriangleSurface whole = with_edge(request, parts[p]), surface = without_slivers(whole);
    LayerReport said;
    said.slivers = static_cast<int>(whole.triangles.size() - surface.triangles.size());
    said.way = way_words(c);
    said.fade = fade_of(c, request);
    said.holes_filled = region.holes_filled;
    said.parts_left_out = region.parts_left_out;
    BuiltLayer layer;
    if (c.way == Way::Segmented) {
      const Beneath beneath = bone_beneath(surface, bone.caster);
      double mean = 0;
      for (const double t : beneath.thickness) mean += t / static_cast<double>(beneath.thickness.size());
      refuse_no_cartilage(request.bones[at(c.bone)].name, bone, beneath, mean);
      const double least = request.least_thickness.value_or(0.1 * mean);
      said.thin.least = least;
      said.missed = static_cast<int>(std::count(beneath.missed.begin(), beneath.missed.end(), 1));
      said.under = static_cast<int>(std::count(beneath.under.begin(), beneath.under.end(), 1));
      said.beside = static_cast<int>(std::count(beneath.beside.begin(), beneath.beside.end(), 1));
      const std::vector<double> areas = point_areas(surface);
      for (std::size_t v = 0; v < areas.size(); ++v)
        if (beneath.thickness[v] < least) {
          ++said.raised;
          said.raised_area += areas[v];
        }
      layer = layer_under_surface(surface, beneath, bone.caster, least, request.elements_through, said.changes);
      if (said.fade > 0) fade_layer(layer, said.fade, least, request.elements_through, said.changes);
    } else {
      layer = layer_on_bone(surface, directions_at(bone, surface.points),
                            thickness_of(c, request, bones, surface, reach), request.elements_through, said.changes);
    }
    const std::string& name = request.bones[at(c.bone)].name;
    layer.name = name + "_cartilage" + (parts.size() > 1 ? fmt::format("_{}", p + 1) : "");
    layer.body = c.bone;
    refuse_lost(layer, said);
    said.quality = sheet_quality(layer, request.elements_through);
    joint.layers.push_back(std::move(layer));
    report.layers.push_back(said);
  }
}

/// Up to which gap articular surfaces face each other.
double joint_reach(const BuildReport& report, double reach) {
  for (const LayerReport& l : report.layers) reach = std::max(reach, 3 * l.quality.mean_line);
  return reach;
}

/// How each layer comes to its end, but those whose surface thins out by itself.
void tell_rims(const BuildRequest& request, const BuiltJoint& joint, BuildReport& report) {
  constexpr double kThinRim = 0.15;  // of the mean thickness
  for (std::size_t l = 0; l < joint.layers.size(); ++l) {
    LayerReport& r = report.layers[l];
    if (joint.layers[l].bare) continue;
    r.rim = sheet_rim(joint.layers[l]);
    if (r.rim.rims == 0) continue;
    if (r.fade > 0)
      report.findings.push_back(fmt::format(
          "{}: thins out over {:.3g} before its rim, to {:.3g} in the mean there{} ({})", joint.layers[l].name, r.fade,
          r.rim.thickness, request.fade ? "" : ", for half the gap has no rim of its own; 0 lets it end",
          request.wording({"fade"})));
    else if (r.rim.thickness > kThinRim * r.quality.mean_line)
      report.findings.push_back(
          fmt::format("{}: ends at its rim, {:.3g} thick in the mean there; where it is pressed there, patches of "
                      "pressure follow the "
                      "rim: a width to thin out over avoids them ({})",
                      joint.layers[l].name, r.rim.thickness, request.wording({"fade"})));
  }
}

/// Layers made here give way to each other and to segmented ones.
void thin_overlaps(const BuildRequest& request, double reach, BuiltJoint& joint, BuildReport& report) {
  std::vector<char> made;
  for (const BuiltLayer& l : joint.layers) {
    const auto own = [&](const CartilageRequest& c) { return c.bone == l.body && c.way != Way::Segmented; };
    made.push_back(std::any_of(request.cartilages.begin(), request.cartilages.end(), own));
  }
  if (std::count(made.begin(), made.end(), 1) == 0) return;
  const std::vector<Thinned> thinned = clear_overlaps(joint.layers, made, joint_reach(report, reach));
  for (std::size_t l = 0; l < joint.layers.size(); ++l) {
    if (thinned[l].vertices == 0) continue;
    report.findings.push_back(
        fmt::format("{}: {} of {} points thinned by up to {:.3g}, where it would overlap the other cartilage",
                    joint.layers[l].name, thinned[l].vertices, joint.layers[l].articular.size(), thinned[l].most));
    make_sound(joint.layers[l], {request.elements_through, true, nullptr, 0.0, {}}, report.layers[l].changes);
    refuse_lost(joint.layers[l], report.layers[l]);
    report.layers[l].quality = sheet_quality(joint.layers[l], request.elements_through);
  }
}

/// Layers of one bone lie side by side: where they take up the same space both would bear the load.
void refuse_shared_space(const BuiltJoint& joint, BuildReport& report) {
  for (std::size_t a = 0; a < joint.layers.size(); ++a)
    for (std::size_t b = a + 1; b < joint.layers.size(); ++b) {
      const BuiltLayer &first = joint.layers[a], &second = joint.layers[b];
      if (first.body != second.body || first.bare || second.bare) continue;
      const SharedSpace shared = shared_space(first, second);
      const std::string found = fmt::format(
          "{:.4g} mm^2 of articular surface, {:.3g} % of the smaller one's, whose columns lie in the other, "
          "as at {}",
          shared.area, 100 * shared.share, place_text(shared.where));
      // a part of a layer's area that matters; dea takes a state for no solution if two partners press as much twice
      if (shared.share > kMuchArea)
        throw InputError(fmt::format(
            "{} and {}: found {}, expected layers of one bone side by side, for both would bear the load "
            "there; leave one out of the file or region of cartilage, or cut them so that they end where they meet",
            first.name, second.name, found));
      if (shared.area > 0)
        report.findings.push_back(
            fmt::format("{} and {}: {}; the load counts twice where both are pressed", first.name, second.name, found));
    }
}

/// Segmented layers are raised to a least thickness; what gave way so that no element is inside out may be thinner.
void find_thin_places(const BuiltJoint& joint, BuildReport& report) {
  for (std::size_t l = 0; l < joint.layers.size(); ++l) {
    LayerReport& r = report.layers[l];
    if (r.thin.least > 0) r.thin = thin_places(joint.layers[l], r.quality.thickness, r.thin.least);
  }
}

/// Half the gap that is asked for has a least thickness; what gave way to the other cartilage, or so that no element is
/// inside out, may be thinner.
void tell_below_least(const BuildRequest& request, const BuiltJoint& joint, BuildReport& report) {
  for (std::size_t l = 0; l < joint.layers.size(); ++l) {
    const BuiltLayer& layer = joint.layers[l];
    const auto own = [&](const CartilageRequest& c) { return c.bone == layer.body && c.way == Way::HalfGap; };
    const auto cartilage = std::find_if(request.cartilages.begin(), request.cartilages.end(), own);
    if (cartilage == request.cartilages.end()) continue;
    const std::vector<double>& thickness = report.layers[l].quality.thickness;
    std::size_t below = 0;
    for (std::size_t v = 0; v < thickness.size(); ++v)  // asked for along the lines through the layer
      below += (layer.articular[v] - layer.bone[v]).norm() < (1 - 1e-6) * cartilage->least ||
               thickness[v] < (1 - kMuchThinned) * cartilage->least;
    const auto thinnest = std::min_element(thickness.begin(), thickness.end());
    report.layers[l].below_least = static_cast<int>(below);
    if (below > 0)
      report.findings.push_back(
          fmt::format("{}: {} of {} points thinner than the least thickness that was asked for, {:.4g}: {:.3g} at the "
                      "least, at {}; the bones are closer there than two such layers, or elements would be inside out",
                      layer.name, below, layer.articular.size(), cartilage->least, *thinnest,
                      place_text(layer.articular[static_cast<std::size_t>(thinnest - thickness.begin())])));
  }
}

void add_contacts(const BuildRequest& request, double reach, BuiltJoint& joint, BuildReport& report) {
  const double within = report.reach = joint_reach(report, reach);
  std::vector<RayCaster> faces;
  for (const BuiltLayer& l : joint.layers) faces.emplace_back(mesh_of(l.face()));
  for (std::size_t a = 0; a < joint.layers.size(); ++a)
    for (std::size_t b = a + 1; b < joint.layers.size(); ++b) {
      if (joint.layers[a].body == joint.layers[b].body) continue;
      if (joint.layers[a].bare && joint.layers[b].bare) continue;
      const auto named = [&](std::size_t l) { return joint.bodies[at(joint.layers[l].body)].name == request.primary; };
      bool second = report.layers[b].quality.area < report.layers[a].quality.area;
      if (joint.layers[a].bare != joint.layers[b].bare) second = joint.layers[a].bare;
      if (!request.primary.empty() && named(a) != named(b)) second = named(b);
      const std::size_t primary = second ? b : a, secondary = second ? a : b;
      const std::vector<double> gaps = joint_gaps(joint.layers[primary], faces[secondary], within);
      const auto facing = std::count_if(gaps.begin(), gaps.end(), [](double g) { return std::isfinite(g); });
      if (static_cast<double>(facing) < 0.02 * static_cast<double>(gaps.size())) continue;
      joint.contacts.push_back({fmt::format("{}_on_{}", joint.layers[secondary].name, joint.layers[primary].name),
                                static_cast<int>(primary), static_cast<int>(secondary)});
      report.contacts.push_back({*std::min_element(gaps.begin(), gaps.end()),
                                 static_cast<double>(facing) / static_cast<double>(gaps.size())});
    }
}

/// A ball's centre by a sphere, else the middle of its contact surfaces.
void set_center(const BoneRequest& bone, int body, BuiltJoint& joint, BuildReport& report) {
  BuiltBody& b = joint.bodies[at(body)];
  TriangleSurface all;
  for (const BuiltLayer& l : joint.layers)
    if (l.body == body) all.append({l.bare ? l.articular : l.bone, l.triangles});
  const SurfaceMesh mesh = mesh_of(all);
  const SphereFit fit = fit_sphere(mesh);
  b.ball = fit.rms < 0.05 * fit.radius && fit.radius < size_of(all);
  if (bone.center) {
    b.center = *bone.center;
    b.center_words = "as given";
  } else if (b.ball) {
    b.center = fit.center;
    b.center_words =
        fmt::format("of the sphere through its joint surface, radius {:.4g}, rms {:.2g}", fit.radius, fit.rms);
  } else {
    b.center = surface_extent(mesh).centroid;
    b.center_words = "the middle of its joint surface, which is no ball";
  }
  report.findings.push_back(fmt::format("{}: centre {}, {}", b.name, place_text(b.center), b.center_words));
}

}  // namespace

void turn_open_bones(BuildRequest& request, BuildReport& report) {
  if (std::all_of(request.bones.begin(), request.bones.end(), [](const BoneRequest& b) { return b.closed; })) return;
  std::vector<Bone> bones;
  for (const BoneRequest& b : request.bones) bones.emplace_back(b.surface);
  turn_open_bones(request, bones, report);
  for (std::size_t b = 0; b < bones.size(); ++b) request.bones[b].surface = bones[b].surface;
}

BuiltJoint build_joint(const BuildRequest& request, BuildReport& report) {
  std::vector<Bone> bones;
  for (const BoneRequest& b : request.bones) bones.emplace_back(b.surface);
  const double reach = reach_of(request, report);
  for (std::size_t a = 0; a < bones.size() && reach > 0; ++a) {
    double nearest = kInfinity;
    for (std::size_t b = 0; b < bones.size(); ++b)
      if (b != a) nearest = std::min(nearest, least_distance(bones[a], bones[b]));
    if (nearest > reach)
      throw InputError(
          fmt::format("bone \"{}\": found the nearest other bone {:.4g} away, expected one within {:.4g}; are the "
                      "bones in one frame and unit?",
                      request.bones[a].name, nearest, reach));
  }
  turn_open_bones(request, bones, report);
  refuse_overlap(request, bones);
  BuiltJoint joint;
  joint.ligaments = request.ligaments;
  for (std::size_t b = 0; b < bones.size(); ++b) {
    const BoneRequest& bone = request.bones[b];
    BuiltBody body;
    static_cast<BoneLoads&>(body) = bone;
    joint.bodies.push_back(body);
    const auto own = [&](const CartilageRequest& c) { return c.bone == static_cast<int>(b); };
    const auto cartilage = std::find_if(request.cartilages.begin(), request.cartilages.end(), own);
    if (cartilage != request.cartilages.end()) {
      add_cartilage(request, *cartilage, bones, reach, joint, report);
      if (request.whole_bones)
        joint.bodies[b].shell = request.most_bone_triangles > 0
                                    ? decimated(bones[b].surface, request.most_bone_triangles)
                                    : bones[b].surface;
    } else {
      BuiltLayer bare{bone.name + "_bone",       static_cast<int>(b), true, bones[b].surface.points, {},
                      bones[b].surface.triangles};
      LayerReport said;
      said.way = "no cartilage";
      said.quality = sheet_quality(bare, 1);
      said.rim = sheet_rim(bare);
      report.layers.push_back(said);
      joint.layers.push_back(std::move(bare));
      report.findings.push_back(fmt::format("{}: no cartilage is given, the bare bone bears", bone.name));
    }
    set_center(bone, static_cast<int>(b), joint, report);
  }
  thin_overlaps(request, reach, joint, report);
  refuse_shared_space(joint, report);
  find_thin_places(joint, report);
  tell_below_least(request, joint, report);
  tell_rims(request, joint, report);
  add_contacts(request, reach, joint, report);
  if (joint.contacts.empty())
    throw InputError(
        "found no two articular surfaces that face each other, expected a contact; are all surfaces in one frame and "
        "unit?");
  return joint;
}

}  // namespace dea
