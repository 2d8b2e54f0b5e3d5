// febiodea/views/map/picture_format.h – what a picture's file is.
#pragma once
#include <string>

namespace dea {

enum class PictureFormat { Png, Svg, Pdf };

/// By the ending of the file's name. Throws UsageError in the name of the option, "-o".
PictureFormat picture_format(const std::string& option, const std::string& path);

}  // namespace dea
