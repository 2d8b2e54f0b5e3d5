// src/build/anatomy.h – what landmarks and bones say of a joint's anatomy: side, frames, and of a hip its
// measures.
//
// Frame, lengths: the scans'.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "src/build/build_joint.h"
#include "src/build/frames.h"
#include "src/build/hip_measures.h"

namespace dea {

/// What x, y, z of a scanner are.
enum class ScanAxes {
  LPS,  ///< left, posterior, superior: DICOM's
  RAS   ///< right, anterior, superior
};
const char* name(ScanAxes axes);
/// Columns forwards, up, to the right.
Eigen::Matrix3d body_axes(ScanAxes axes);

/// The longest side of the boxes around the bones.
double size_of_bones(const std::vector<BoneRequest>& bones);

struct AnatomyRequest {
  Wording wording = plain_wording();  ///< how warnings name options
  std::vector<Landmark> landmarks;    ///< in the bones' axes and unit; empty: the scanner's axes are the body's
  double landmark_scale = 1.0;        ///< what the numbers of their files were multiplied by, to mm
  std::optional<BodySide> side;       ///< empty: by the landmarks, else by where the socket opens
  std::optional<ScanAxes>
      scan_axes;  ///< without landmarks of the pelvis; empty: those in which the socket opens to the side, or forwards
  bool hip = true;             ///< false: no measures of a hip
  int socket = -1, head = -1;  ///< bones of the hip; -1: found
};

struct Anatomy {
  std::optional<BodySide> side;
  std::string side_words;  ///< who says so
  std::vector<AnatomicalFrame> frames;
  std::optional<HipMeasures>
      hip;  ///< nullopt: no two bones are a ball in a socket that opens sideways, or nobody wants it
  std::vector<std::string> findings;  ///< what was concluded, a line each
  std::vector<std::string> warnings;  ///< where what was measured contradicts the axes or the side, a line each
};

/// `bones`: names, and surfaces oriented outwards. Throws InputError: landmarks in another unit than the bones, or far
/// from them and near with x and y turned over; sides that contradict each other; what make_frames refuses; a hip that
/// is asked for and is none.
Anatomy find_anatomy(const std::vector<BoneRequest>& bones, const AnatomyRequest& request);

/// Numbers that were given along a frame's axes become the scans': forces, centres, regions. Throws UsageError: there
/// is no such frame.
void leave_frames(BuildRequest& request, const Anatomy& anatomy);

}  // namespace dea
