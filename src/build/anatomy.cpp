#include "src/build/anatomy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/base/value_above.h"
#include "src/build/mend_surface.h"
#include "src/build/region.h"
#include "src/geometry/ray_caster.h"

namespace dea {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Three quarters of the landmarks lie as far from the nearest bone, or farther: scans may hold half a pelvis and a
/// femur's upper end. All times `scale`, x and y times `sign` too.
double distance_to_bones(const std::vector<RayCaster>& bones, const std::vector<Landmark>& landmarks, double scale,
                         double sign) {
  std::vector<double> distances;
  for (const Landmark& l : landmarks) {
    const Vector3d x = scale * Vector3d(sign * l.point.x(), sign * l.point.y(), l.point.z());
    double nearest = kInfinity;
    for (const RayCaster& bone : bones) nearest = std::min(nearest, distance_to(bone, x));
    distances.push_back(nearest);
  }
  return value_above(distances, 0.25);
}

constexpr double kOff = 10, kFar = 30;  // mm: a landmark off its bone, and one that belongs to no bone

double largest_side(const std::vector<Landmark>& landmarks) {
  Eigen::AlignedBox3d box;
  for (const Landmark& l : landmarks) box.extend(l.point);
  return box.sizes().maxCoeff();
}

struct Unit {
  const char* name;
  double size;  // mm
};
constexpr Unit kUnits[] = {{"mm", 1}, {"cm", 10}, {"m", 1000}};

/// Landmarks of one file that lie on the bones if they are taken in another unit, or that are a hundred times as large
/// or as small as the bones. `scale`: what they were multiplied by already.
void refuse_other_unit(const std::vector<RayCaster>& bones, double bone_size, const std::vector<Landmark>& landmarks,
                       double scale) {
  const double size = largest_side(landmarks), as_is = distance_to_bones(bones, landmarks, 1, 1);
  const auto alike = [&](double factor, double ratio) {
    return landmarks.size() < 2 || (factor * size * ratio > bone_size && factor * size < bone_size * ratio);
  };
  constexpr double kAlike = 30, kSurelyNot = 100;  // a whole leg's landmarks on a scanned tenth of it: 10
  const bool fits = alike(1, kAlike);
  if (as_is <= kFar && fits) return;
  const Unit* unit = nullptr;
  const double near_by = fits ? std::min(kFar, 0.3 * as_is) : std::max(kFar, 2 * bone_size);
  double least = kInfinity, nearest = 0;
  for (const Unit& u : kUnits) {
    const double factor = u.size / scale;
    if (std::abs(factor - 1) < 1e-9 || !alike(factor, kAlike)) continue;
    const double there =
        std::min(distance_to_bones(bones, landmarks, factor, 1), distance_to_bones(bones, landmarks, factor, -1));
    const double odd = landmarks.size() < 2 ? there : std::abs(std::log(factor * size / bone_size));
    if (there >= near_by || odd >= least) continue;
    least = odd;
    nearest = there;
    unit = &u;
  }
  const auto found = [&] {
    return fmt::format("found {} {:.3g} away from the bones, which are {:.3g} large",
                       landmarks.size() < 2 ? "a landmark" : fmt::format("landmarks {:.3g} large", size), as_is,
                       bone_size);
  };
  if (unit != nullptr)
    throw InputError(
        Fault{.place = landmarks.front().file,
              .found = say("{}, and {:.3g} away if they are multiplied by {:g},", found(), nearest, unit->size / scale),
              .expected = say("expected both in one unit: the landmarks look like {} ({})", unit->name,
                              NamedSetting{"landmark-units", "", unit->name})});
  if (as_is > kFar && !alike(1, kSurelyNot))
    throw InputError(Fault{.place = landmarks.front().file,
                           .found = found() + ",",
                           .expected = say("expected both of one size, in one unit ({}) and in the same axes",
                                           NamedSetting{"landmark-units"})});
}

/// Landmarks lie on bones, or near them where a scan is cut off. Returns how far they lie if that is far; empty: near.
std::string check_place(const std::vector<BoneRequest>& bones, const AnatomyRequest& request) {
  std::vector<RayCaster> casters;
  for (const BoneRequest& b : bones) casters.emplace_back(mesh_of(b.surface));
  const double size = size_of_bones(bones);
  std::map<std::string, std::vector<Landmark>> files;
  for (const Landmark& l : request.landmarks) files[l.file].push_back(l);
  for (const auto& [file, landmarks] : files) refuse_other_unit(casters, size, landmarks, request.landmark_scale);
  const double as_is = distance_to_bones(casters, request.landmarks, 1, 1);
  if (as_is < kOff) return "";
  const double turned = distance_to_bones(casters, request.landmarks, 1, -1);
  if (turned < 0.3 * as_is)
    throw InputError(Fault{
        .found = say("landmarks: found three quarters of them {:.3g} or more away from the bones, and {:.3g} with x "
                     "and y turned over,",
                     as_is, turned),
        .expected = say("expected them in the bones' axes: one is LPS, the other RAS; turn the landmarks over with {}",
                        NamedSetting{"flip-landmarks"})});
  if (as_is <= kFar) return "";
  return fmt::format(
      "three quarters of the landmarks lie {:.3g} or more away from the bones: are they in the bones' axes and unit?",
      as_is);
}

std::optional<BallInSocket> find_hip(const std::vector<BoneRequest>& bones, const AnatomyRequest& request) {
  std::vector<TriangleSurface> surfaces;
  for (const BoneRequest& b : bones) surfaces.push_back(b.surface);
  const std::optional<BallInSocket> hip = find_ball_in_socket(surfaces, request.socket, request.head);
  if (!hip && request.socket >= 0)
    throw InputError(fmt::format(
        "hip: found no socket of \"{}\" about a ball of \"{}\", expected parts of spheres that face each other",
        bones[at(request.socket)].name, bones[at(request.head)].name));
  return hip;
}

/// The side on which the hip's centre lies in the pelvis. nullopt: no pelvis, or no centre.
std::optional<BodySide> side_in_pelvis(const AnatomyRequest& request, const std::optional<Matrix3d>& pelvis,
                                       const std::optional<BallInSocket>& hip) {
  if (!pelvis) return std::nullopt;
  std::optional<Vector3d> center = hip_center(request.landmarks, {});
  if (!center && hip) center = hip->ball_sphere.center;
  if (!center) return std::nullopt;
  Vector3d middle = Vector3d::Zero();
  for (const Landmark& spine : front_spines(request.landmarks)) middle += spine.point / 2;
  return pelvis->col(2).dot(*center - middle) > 0 ? BodySide::Right : BodySide::Left;
}

/// By what is said, by the landmarks' names, by where the hip lies in the pelvis: all that know it agree.
void find_side(const AnatomyRequest& request, const std::optional<Matrix3d>& pelvis,
               const std::optional<BallInSocket>& hip, Anatomy& anatomy) {
  const std::optional<BodySide> by_names = side_of(request.landmarks), by_place = side_in_pelvis(request, pelvis, hip);
  const std::string names = sided_names(request.landmarks);
  if (request.side && by_names && *request.side != *by_names)
    throw InputError(fmt::format("side: found {} as given, and landmarks of the {}, {}, expected one side",
                                 name(*request.side), name(*by_names), names));
  anatomy.side = request.side ? request.side : by_names;
  anatomy.side_words = request.side ? "as given" : by_names ? "by the landmarks " + names : "";
  if (anatomy.side && by_place && *anatomy.side != *by_place)
    throw InputError(
        fmt::format("side: found {}, {}, and the hip's centre on the {} of the middle of RASIS and LASIS, expected one "
                    "side; {}, or right and left of the pelvis are exchanged",
                    name(*anatomy.side), anatomy.side_words, name(*by_place),
                    request.side ? "either the side is the other one" : "either " + names + " are the other leg's"));
  if (anatomy.side || !by_place) return;
  anatomy.side = by_place;
  anatomy.side_words = "where the hip's centre lies in the pelvis";
  anatomy.findings.push_back(fmt::format("side: {}, {}", name(*anatomy.side), anatomy.side_words));
}

std::string axes_text(const Matrix3d& axes) {
  std::string text;
  for (int k = 0; k < 3; ++k)
    text += fmt::format("{}{} ({:.4f}, {:.4f}, {:.4f})", k > 0 ? ", " : "", "xyz"[k], axes(0, k) + 0.0,
                        axes(1, k) + 0.0, axes(2, k) + 0.0);
  return text;
}

void add_frames(const AnatomyRequest& request, const std::optional<BallInSocket>& hip, Anatomy& anatomy) {
  FramesRequest frames;
  frames.landmarks = request.landmarks;
  frames.side = anatomy.side;
  frames.hip_center = hip_center(request.landmarks, anatomy.side);
  frames.hip_center_words = "HJC";
  frames.has_femur = hip.has_value();
  if (hip) {
    const Vector3d& fitted = hip->ball_sphere.center;
    const double off = frames.hip_center ? (*frames.hip_center - fitted).norm() : 0.0;
    if (off > 0.2 * hip->ball_sphere.radius)
      anatomy.findings.push_back(
          fmt::format("landmark HJC lies {:.3g} from the centre of the sphere through the head; HJC counts", off));
    if (!frames.hip_center) {
      frames.hip_center = fitted;
      frames.hip_center_words =
          fmt::format("the centre of the sphere through the head, radius {:.4g}", hip->ball_sphere.radius);
    }
  }
  FramesFound found = make_frames(frames);
  anatomy.frames = std::move(found.frames);
  for (const std::string& finding : found.findings) anatomy.findings.push_back(finding);
  for (const AnatomicalFrame& f : anatomy.frames)
    anatomy.findings.push_back(fmt::format("frame of the {} ({}): {}", f.name, f.words, axes_text(f.axes)));
}

struct BodyAxes {
  Matrix3d axes;
  std::string words;
  bool of_scanner = false;
};

constexpr double kSideways = 0.2;  // a socket opens sideways by 0.5 and more

/// Without landmarks of the pelvis: the scanner's axes, and the side by where the socket opens. A socket opens sideways
/// and, but for few, forwards.
BodyAxes axes_of_scanner(const AnatomyRequest& request, const Vector3d& opening, Anatomy& anatomy) {
  const auto opens_to = [&](ScanAxes scan) {
    return opening.dot(body_axes(scan).col(2)) > 0 ? BodySide::Right : BodySide::Left;
  };
  const bool forwards_in_lps = opening.dot(body_axes(ScanAxes::LPS).col(0)) > 0;
  ScanAxes scan = request.scan_axes.value_or(forwards_in_lps ? ScanAxes::LPS : ScanAxes::RAS);
  std::string why = request.scan_axes ? "as given" : "for the socket opens forwards then";
  if (anatomy.side && opens_to(scan) != *anatomy.side) {
    if (request.scan_axes)
      throw InputError(
          fmt::format("side: found {}, and in {} axes the socket opens to the {}, expected it to open to "
                      "its own side",
                      name(*anatomy.side), name(scan), name(opens_to(scan))));
    scan = scan == ScanAxes::LPS ? ScanAxes::RAS : ScanAxes::LPS;
    why = fmt::format("for the socket opens to the {} then", name(*anatomy.side));
  }
  const bool known = anatomy.side.has_value();
  anatomy.side = opens_to(scan);
  if (!known) anatomy.side_words = "to which the socket opens";
  BodyAxes body{body_axes(scan), fmt::format("of the scanner, {} ({})", name(scan), why), true};
  anatomy.findings.push_back(
      fmt::format("axes: the scanner's, as there are no landmarks of the pelvis; {} ({}){}", name(scan), why,
                  known ? "" : fmt::format("; side: {}, {}", name(*anatomy.side), anatomy.side_words)));
  return body;
}

/// The axes in which a hip is measured; the side too, if nobody knew it. nullopt: nobody knows how the socket lies.
std::optional<BodyAxes> axes_of_hip(const AnatomyRequest& request, const std::optional<Matrix3d>& pelvis,
                                    const Vector3d& opening, Anatomy& anatomy) {
  if (pelvis) {
    if (opening.dot(pelvis->col(2)) * lateral_sign(*anatomy.side) < -kSideways)
      throw InputError(
          fmt::format("hip: found the socket open towards the middle of the body, for the landmarks, expected it to "
                      "open to the {}; are they in the bones' axes?",
                      name(*anatomy.side)));
    return BodyAxes{*pelvis, "of the pelvis, by landmarks", false};
  }
  if (std::abs(opening.x()) >= kSideways) return axes_of_scanner(request, opening, anatomy);
  anatomy.findings.push_back(
      "hip: not measured, for the socket opens neither to the left nor to the right along the scanner's x; landmarks "
      "of the pelvis would say how it lies");
  return std::nullopt;
}

/// What no hip has in these axes, or few: a left one in those of a right one, and the other way round.
std::vector<std::string> odd_directions(const HipMeasures& m, const Vector3d& opening,
                                        const std::optional<Vector3d>& neck, const Anatomy& anatomy) {
  std::vector<std::string> odd;
  const Vector3d& axis = m.rim.empty() ? opening : m.rim_normal;
  const double side = lateral_sign(m.side), forwards = axis.dot(m.axes.col(0)),
               lateral = side * axis.dot(m.axes.col(2));
  if (forwards < 0)
    odd.push_back(fmt::format("a socket that opens backwards by {:.1f} degrees", arc_of_sine(-forwards)));
  if (lateral < 0)
    odd.push_back(
        fmt::format("a socket that opens towards the middle of the body by {:.1f} degrees", arc_of_sine(-lateral)));
  if (m.anterior_center_edge > 90)
    odd.push_back(fmt::format("an anterior center-edge angle of {:.1f} degrees", m.anterior_center_edge));
  if (!neck) return odd;
  const auto look_at_neck = [&](const Matrix3d& axes, const std::string& of) {
    const double medial = -side * neck->dot(axes.col(2)), up = neck->dot(axes.col(1));
    if (medial < 0) odd.push_back(fmt::format("a neck of the femur that points away from the body's middle{}", of));
    if (up < 0) odd.push_back(fmt::format("a neck of the femur that points downwards{}", of));
  };
  look_at_neck(m.axes, "");
  for (const AnatomicalFrame& f : anatomy.frames)
    if (f.name == "femur") look_at_neck(f.axes, " in the femur's frame");
  return odd;
}

void add_hip(const std::vector<BoneRequest>& bones, const BallInSocket& hip, const BodyAxes& body,
             const Vector3d& opening, const Wording& wording, Anatomy& anatomy) {
  const BoneRequest &socket = bones[at(hip.socket)], &head = bones[at(hip.ball)];
  HipMeasures m = measure_hip(socket.surface, head.surface, hip, body.axes, *anatomy.side);
  m.socket_bone = socket.name;
  m.head_bone = head.name;
  m.axes_words = body.words;
  m.axes_of_scanner = body.of_scanner;
  anatomy.findings.push_back(
      fmt::format("hip: \"{}\" is the socket, \"{}\" the head, by spheres through what faces each other", m.socket_bone,
                  m.head_bone));
  const std::vector<std::string> odd =
      odd_directions(m, opening, neck_direction(head.surface, hip.ball_sphere), anatomy);
  if (!odd.empty())
    anatomy.warnings.push_back(worded(
        say("hip: found {}, in axes {}, side {} ({}), expected a socket that opens forwards and to its side, a neck "
            "that points inwards and up: as it is, a left hip may be taken for a right one, or a right one for a left; "
            "check {}, {} and {}, and look at the picture of {}",
            fmt::format("{}", fmt::join(odd, ", ")), m.axes_words, name(m.side), anatomy.side_words,
            NamedSetting{"side"}, NamedSetting{"landmarks"}, NamedSetting{"scan-axes"}, NamedSetting{"hip-figure"}),
        wording));
  for (const std::string& missing : m.missing) anatomy.findings.push_back("hip: " + missing);
  anatomy.hip = std::move(m);
}

const AnatomicalFrame& frame_called(const Anatomy& anatomy, const std::string& name) {
  std::vector<std::string> names;
  for (const AnatomicalFrame& f : anatomy.frames) {
    if (f.name == name) return f;
    names.push_back(f.name);
  }
  throw UsageError(fmt::format("frame:{}: there is no frame of this name{}; the landmarks give {}", name,
                               did_you_mean(name, names), name_list(names)));
}

}  // namespace

double size_of_bones(const std::vector<BoneRequest>& bones) {
  double size = 0;
  for (const BoneRequest& b : bones) size = std::max(size, box_of(b.surface).sizes().maxCoeff());
  return size;
}

const char* name(ScanAxes axes) { return word_of(axes, {"LPS", "RAS"}); }

Matrix3d body_axes(ScanAxes axes) {
  const double sign = axes == ScanAxes::LPS ? -1 : 1;
  Matrix3d body = Matrix3d::Zero();
  body(1, 0) = sign;  // forwards: against P, along A
  body(2, 1) = 1;
  body(0, 2) = sign;  // to the right: against L, along R
  return body;
}

Anatomy find_anatomy(const std::vector<BoneRequest>& bones, const AnatomyRequest& request) {
  Anatomy anatomy;
  std::string far;
  if (!request.landmarks.empty()) far = check_place(bones, request);
  try {
    std::optional<BallInSocket> hip;
    if (request.hip) hip = find_hip(bones, request);
    const std::optional<Matrix3d> pelvis = pelvis_axes(request.landmarks);
    find_side(request, pelvis, hip, anatomy);
    std::optional<BodyAxes> body;
    Vector3d opening = Vector3d::Zero();
    if (hip) {
      opening = opening_of(bones[at(hip->socket)].surface, hip->socket_sphere);
      body = axes_of_hip(request, pelvis, opening, anatomy);
    }
    if (!request.landmarks.empty()) add_frames(request, hip, anatomy);
    if (body) add_hip(bones, *hip, *body, opening, request.wording, anatomy);
  } catch (const InputError& e) {
    if (far.empty()) throw;
    Fault fault = e.fault;
    Sentence& last = fault.expected.empty() ? fault.found : fault.expected;
    last = say("{}; {}", last, far);
    throw InputError(fault);
  }
  if (!far.empty()) anatomy.findings.insert(anatomy.findings.begin(), far);
  return anatomy;
}

void leave_frames(BuildRequest& request, const Anatomy& anatomy) {
  for (BoneRequest& b : request.bones) {
    if (!b.force_frame.empty()) b.force = frame_called(anatomy, b.force_frame).axes * b.force;
    b.force_frame.clear();
  }
  for (CartilageRequest& c : request.cartilages) {
    if (!c.region || c.region->frame.empty()) continue;
    const AnatomicalFrame& f = frame_called(anatomy, c.region->frame);
    c.region->point = f.origin + f.axes * c.region->point;
    c.region->normal = f.axes * c.region->normal;
    c.region->frame.clear();
  }
}

}  // namespace dea
