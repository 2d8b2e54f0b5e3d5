// io/build/landmarks.h – landmarks from tables, and frames as a settings file.
#pragma once
#include <string>
#include <vector>

#include "src/build/frames.h"

namespace dea {

struct LandmarkFile {
  std::vector<Landmark> landmarks;  ///< as they stand in the file, in its unit
  std::string axes;                 ///< LPS or RAS, if the file says so
};

/// CSV with a column of names (name, label or landmark) and x, y, z, or Slicer's: its table of control points (label
/// and r, a, s or l, p, s), .fcsv and .mrk.json. Points that Slicer calls undefined are passed over. Throws InputError.
LandmarkFile read_landmarks(const std::string& path);

/// A settings file with the frames, for dea run and dea study.
std::string frames_as_settings(const std::vector<AnatomicalFrame>& frames);

}  // namespace dea
