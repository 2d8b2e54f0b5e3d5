// app/animation.h where there is no Cairo.
#include <fmt/format.h>

#include "app/animation.h"
#include "src/base/error.h"

namespace dea {

Animation animation_asked(const std::string& path) {
  throw UsageError(fmt::format("--animate {}: {}", path, kSvgAlone));
}

Drawn animate(const std::vector<ResultFile>&, const ResultFile*, const MapOptions&, const PictureOptions&,
              const std::string&, const Animation& animation, bool) {
  throw UsageError(fmt::format("--animate {}: {}", animation.path, kSvgAlone));
}

}  // namespace dea
