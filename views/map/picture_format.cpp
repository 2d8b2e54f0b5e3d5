#include "views/map/picture_format.h"

#include <fmt/format.h>

#include "io/files/output.h"
#include "src/base/error.h"

namespace dea {

PictureFormat picture_format(const std::string& option, const std::string& path) {
  const std::string extension = extension_of(path);
  if (!draws_pixels() && (extension == ".png" || extension == ".pdf"))
    throw UsageError(fmt::format("{} {}: {}", option, path, kSvgAlone));
  if (extension == ".png") return PictureFormat::Png;
  if (extension == ".svg") return PictureFormat::Svg;
  if (extension == ".pdf") return PictureFormat::Pdf;
  throw draws_pixels() ? UsageError(wrong_ending(option, path, ".png, .svg or .pdf", ".png"))
                       : UsageError(wrong_ending(option, path, ".svg", ".svg"));
}

}  // namespace dea
