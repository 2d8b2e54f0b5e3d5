// views/map/hip_picture.h – what was measured of a hip, as a picture.
#pragma once
#include <string>
#include <vector>

#include "src/build/hip_measures.h"
#include "views/map/picture_format.h"

namespace dea {

/// Coronal and sagittal section through the head's centre with the center-edge angles and the roof; the rim along its
/// axis, seen from outside. The file's bytes; the same for the same measures and fonts. `dpi`: of PNG.
std::string hip_picture(const HipMeasures& measures, PictureFormat format, double dpi = 200.0);

/// Its panels with their headings, as view boxes of the SVG ("x y width height"), for where three side by side are too
/// small.
std::vector<std::string> hip_panels();

/// What stands below the panels, a line each.
std::vector<std::string> hip_words(const HipMeasures& measures);

}  // namespace dea
