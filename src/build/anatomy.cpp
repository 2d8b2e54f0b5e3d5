#include <febiodea/build/anatomy.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <febiodea/base/error.h>
#include <febiodea/base/names.h>
#include <febiodea/base/numbers.h>
#include <febiodea/build/region.h>
#include <febiodea/geometry/ray_caster.h>

namespace dea {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A quarter of the values lie below it.
double first_quartile(std::vector<double> values) {
  const auto quarter = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 4);
  std::nth_element(values.begin(), quarter, values.end());
  return *quarter;
}

/// Three quarters of the landmarks lie as far from the nearest bone, or farther: scans may hold half a pelvis and a
/// femur's upper end. x and y of the landmarks times `sign`.
double distance_to_bones(const std::vector<RayCaster>& bones, const std::vector<Landmark>& landmarks, double sign) {
  std::vector<double> distances;
  for (const Landmark& l : landmarks) {
    const Vector3d x(sign * l.point.x(), sign * l.point.y(), l.point.z());
    double nearest = kInfinity;
    for (const RayCaster& bone : bones)
      nearest = std::min(nearest, (position(bone.mesh(), bone.closest(x)) - x).norm());
    distances.push_back(nearest);
  }
  return first_quartile(distances);
}

/// Landmarks lie on bones, or near them where a scan is cut off.
void check_place(const std::vector<BoneRequest>& bones, const std::vector<Landmark>& landmarks, Anatomy& anatomy) {
  std::vector<RayCaster> casters;
  for (const BoneRequest& b : bones) casters.emplace_back(mesh_of(b.surface));
  constexpr double kOff = 10, kFar = 30;  // mm
  const double as_is = distance_to_bones(casters, landmarks, 1);
  if (as_is < kOff) return;
  const double turned = distance_to_bones(casters, landmarks, -1);
  if (turned < 0.3 * as_is)
    throw InputError(fmt::format(
        "landmarks: found three quarters of them {:.3g} or more away from the bones, and {:.3g} with x and y "
        "turned over, expected them in the bones' axes: one is LPS, the other RAS; turn the landmarks over",
        as_is, turned));
  if (as_is > kFar)
    anatomy.findings.push_back(fmt::format(
        "three quarters of the landmarks lie {:.3g} or more away from the bones: are they in the bones' axes "
        "and unit?",
        as_is));
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

/// By what is said, by the landmarks' names, by where the hip lies in the pelvis.
void find_side(const AnatomyRequest& request, const std::optional<Matrix3d>& pelvis,
               const std::optional<BallInSocket>& hip, Anatomy& anatomy) {
  const std::optional<BodySide> by_names = side_of(request.landmarks);
  if (request.side && by_names && *request.side != *by_names)
    throw InputError(fmt::format("side: found {}, and landmarks of the {}, expected one side", name(*request.side),
                                 name(*by_names)));
  anatomy.side = request.side ? request.side : by_names;
  if (anatomy.side || !pelvis) return;
  std::optional<Vector3d> center = hip_center(request.landmarks, {});
  if (!center && hip) center = hip->ball_sphere.center;
  if (!center) return;
  Vector3d middle = Vector3d::Zero();
  for (const Landmark& spine : front_spines(request.landmarks)) middle += spine.point / 2;
  anatomy.side = pelvis->col(2).dot(*center - middle) > 0 ? BodySide::Right : BodySide::Left;
  anatomy.findings.push_back(fmt::format("side: {}, where the hip's centre lies in the pelvis", name(*anatomy.side)));
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
  BodyAxes body{body_axes(scan), fmt::format("of the scanner, {} ({})", name(scan), why), true};
  anatomy.findings.push_back(
      fmt::format("axes: the scanner's, as there are no landmarks of the pelvis; {} ({}){}", name(scan), why,
                  known ? "" : fmt::format("; side: {}, to which the socket opens", name(*anatomy.side))));
  return body;
}

void add_hip(const std::vector<BoneRequest>& bones, const AnatomyRequest& request, const BallInSocket& hip,
             const std::optional<Matrix3d>& pelvis, Anatomy& anatomy) {
  const BoneRequest &socket = bones[at(hip.socket)], &head = bones[at(hip.ball)];
  const Vector3d opening = opening_of(socket.surface, hip.socket_sphere);
  constexpr double kSideways = 0.2;  // a socket opens sideways by 0.5 and more
  if (!pelvis && std::abs(opening.x()) < kSideways) {
    anatomy.findings.push_back(
        "hip: not measured, for the socket opens neither to the left nor to the right along the scanner's x; landmarks "
        "of the pelvis would say how it lies");
    return;
  }
  if (pelvis && opening.dot(pelvis->col(2)) * lateral_sign(*anatomy.side) < -kSideways)
    throw InputError(fmt::format(
        "hip: found the socket open towards the middle of the body, for the landmarks, expected it to open to "
        "the {}; are they in the bones' axes?",
        name(*anatomy.side)));
  BodyAxes body;
  if (pelvis)
    body = {*pelvis, "of the pelvis, by landmarks", false};
  else
    body = axes_of_scanner(request, opening, anatomy);
  HipMeasures m = measure_hip(socket.surface, head.surface, hip, body.axes, *anatomy.side);
  m.socket_bone = socket.name;
  m.head_bone = head.name;
  m.axes_words = body.words;
  m.axes_of_scanner = body.of_scanner;
  anatomy.findings.push_back(
      fmt::format("hip: \"{}\" is the socket, \"{}\" the head, by spheres through what faces each other", m.socket_bone,
                  m.head_bone));
  if (m.anteversion_anatomic < 0)
    anatomy.findings.push_back(
        fmt::format("hip: the socket opens backwards by {:.1f} degrees; if it does not, the axes are wrong",
                    -m.anteversion_anatomic));
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
  if (!request.landmarks.empty()) check_place(bones, request.landmarks, anatomy);
  std::optional<BallInSocket> hip;
  if (request.hip) hip = find_hip(bones, request);
  const std::optional<Matrix3d> pelvis = pelvis_axes(request.landmarks);
  find_side(request, pelvis, hip, anatomy);
  if (!request.landmarks.empty()) add_frames(request, hip, anatomy);
  if (hip) add_hip(bones, request, *hip, pelvis, anatomy);
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
