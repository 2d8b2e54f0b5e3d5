// src/build/hip_measures.h – how the socket of a hip covers the head: spheres, rim, angles, by the bones'
// surfaces.
//
// Frame: points and directions are in the scans' axes. Lengths: the scans'. Angles: degrees; of a right and of the
// mirrored left hip they are the same. docs/from_scans.md says how each is defined.
#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "src/base/numbers.h"
#include "src/build/frames.h"
#include "src/geometry/surface_mesh.h"
#include "src/geometry/triangle_surface.h"

namespace dea {

/// Two bones, one a ball in the bowl of the other. Spheres by least squares through the bones' points that lie within 5
/// % of the radius of it and look away from its centre (ball) or towards it (bowl), until no point comes or goes.
struct BallInSocket {
  int socket = -1, ball = -1;  ///< which of the bones
  SphereFit socket_sphere, ball_sphere;
  int socket_points = 0, ball_points = 0;
};

/// Surfaces are mended and oriented outwards. By the parts that face each other; of several pairs that with the most
/// points. nullopt: there is none. `socket`, `ball`: this pair only; -1: any.
std::optional<BallInSocket> find_ball_in_socket(const std::vector<TriangleSurface>& bones, int socket = -1,
                                                int ball = -1);

/// Both bones cut by a plane through the head's centre.
struct HipSection {
  Eigen::Vector3d across = Eigen::Vector3d::UnitX();  ///< to the right of the picture: lateral, or anterior; unit
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();      ///< unit
  std::vector<std::array<Eigen::Vector2d, 2>> socket_lines, head_lines;  ///< across, up; from the head's centre
  std::optional<Eigen::Vector2d> edge;                                   ///< the socket's outer edge
  std::optional<Eigen::Vector2d> roof_end;  ///< coronal: of the roof at the fossa, on the socket's sphere
};

struct HipMeasures {
  std::string socket_bone, head_bone;
  BodySide side = BodySide::Right;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns forwards, up, to the right
  std::string axes_words;                              ///< "of the pelvis (RASIS, ...)", or which scanner's
  bool axes_of_scanner = false;
  SphereFit head, socket;
  int head_points = 0, socket_points = 0;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< the head's centre from the socket's: forwards, up, lateral
  // rim: in 360 directions about its axis the outermost point of the socket as the head's centre sees it
  std::vector<Eigen::Vector3d> rim;  ///< those that were found, in their order round the axis
  std::vector<char> rim_in_plane;    ///< per point: it bears the plane; 0: the notch, and others off it
  Eigen::Vector3d rim_center = Eigen::Vector3d::Zero();  ///< of the circle through the points of the plane
  Eigen::Vector3d rim_normal = Eigen::Vector3d::Zero();  ///< unit, out of the socket: the socket's axis
  double rim_radius = kNaN, rim_rms = kNaN;              ///< of the circle; of the points' distances from the plane
  // angles [degrees], NaN: cannot be measured, `missing` says why
  double lateral_center_edge = kNaN;   ///< Wiberg 1939: coronal plane; > 0: the edge is lateral of the centre
  double anterior_center_edge = kNaN;  ///< the same in the sagittal plane; > 0: the edge is in front of the centre
  double acetabular_index = kNaN;      ///< Toennis: roof against the horizontal, > 0: it rises laterally
  // of rim_normal, as Murray 1993, J Bone Joint Surg Br 75:228, defines them. Radiographic: inclination between the
  // body's long axis and the axis projected on the coronal plane, anteversion between the axis and that plane.
  // Anatomic: inclination between axis and long axis, anteversion between the axis projected on the transverse plane
  // and the line across. Anteversion > 0: it opens forwards
  double inclination_radiographic = kNaN, anteversion_radiographic = kNaN;
  double inclination_anatomic = kNaN, anteversion_anatomic = kNaN;
  HipSection coronal, sagittal;
  std::vector<std::string> missing;  ///< what cannot be measured, and why, a line each
};

/// The angles, in the order in which they are shown.
struct HipAngle {
  const char* key;   ///< of JSON
  const char* name;  ///< for people
  double HipMeasures::*value;
};
inline constexpr HipAngle kHipAngles[] = {
    {"lateral_center_edge", "lateral center-edge angle", &HipMeasures::lateral_center_edge},
    {"anterior_center_edge", "anterior center-edge angle", &HipMeasures::anterior_center_edge},
    {"acetabular_index", "acetabular index (Toennis)", &HipMeasures::acetabular_index},
    {"inclination_radiographic", "inclination of the rim, radiographic", &HipMeasures::inclination_radiographic},
    {"anteversion_radiographic", "anteversion of the rim, radiographic", &HipMeasures::anteversion_radiographic},
    {"inclination_anatomic", "inclination of the rim, anatomic", &HipMeasures::inclination_anatomic},
    {"anteversion_anatomic", "anteversion of the rim, anatomic", &HipMeasures::anteversion_anatomic}};

/// `axes`: columns forwards, up, to the right (AnatomicalFrame). Never throws: what cannot be measured is missing.
HipMeasures measure_hip(const TriangleSurface& socket_bone, const TriangleSurface& head_bone,
                        const BallInSocket& spheres, const Eigen::Matrix3d& axes, BodySide side);

/// The mean direction in which a socket opens: from its surface towards the centre, unit.
Eigen::Vector3d opening_of(const TriangleSurface& socket_bone, const SphereFit& socket);

/// From the neck to the head's centre, unit: against where the bone goes on between 1.3 and 1.6 radii from it. nullopt:
/// nothing is there, or it lies to all sides, as where a ball has no neck.
std::optional<Eigen::Vector3d> neck_direction(const TriangleSurface& head_bone, const SphereFit& head);

/// The angle with this sine, to rounding [degrees].
double arc_of_sine(double sine);

}  // namespace dea
