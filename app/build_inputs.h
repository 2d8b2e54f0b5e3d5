// app/build_inputs.h – what `dea build` is asked for, and what it reads.
#pragma once
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "app/commands.h"
#include "io/files/output.h"
#include "src/build/anatomy.h"
#include "src/build/build_joint.h"
#include "src/model/settings.h"

namespace dea {

/// A plane across an axis.
struct MirrorPlane {
  int axis = 0;
  double at = 0.0;
};

/// A file for one of the request's cartilages.
struct CartilageFile {
  std::size_t cartilage = 0;
  std::string path;
};

/// Landmarks, and the bone with which they are placed (-1: none).
struct LandmarkSource {
  int bone = -1;
  std::string path;
};

/// What is to be read, and how.
struct BuildSources {
  double scale = 1.0;  ///< of all coordinates, to mm; of landmarks: AnatomyRequest::landmark_scale
  std::vector<MirrorPlane> mirrors;
  std::vector<std::string> bones;  ///< as the request's
  std::vector<CartilageFile> outer, places, regions;
  LoadTable loads;     ///< no file: none
  MotionTable motion;  ///< no file: none
  std::vector<MotionTable>
      place_tables;  ///< per bone: of whose rows --place takes one, and how it is read; no file: none
  std::vector<LandmarkSource> landmarks;
  std::vector<char> placed;              ///< per bone: by --place
  std::vector<Eigen::Isometry3d> poses;  ///< per bone: from its files' axes to the joint's, in mm
};

struct BuildInputs {
  BuildRequest request;
  BuiltModelSettings model;
  AnatomyRequest anatomy;
  BuildSources sources;
  std::vector<NamedPath> files;    ///< all that are read
  std::vector<double> load_times;  ///< of --loads, per row; empty: none
};

}  // namespace dea
