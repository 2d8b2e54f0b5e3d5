#include "src/version.h"

#include <fmt/format.h>
#include <tinyxml2.h>
#include <zlib.h>

#include <CLI/Version.hpp>
#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "src/base/parallel.h"

namespace dea {

std::string version_text() {
  std::string text = fmt::format("FEBioDEA {} (commit {})\n", kVersion, kCommit);
  text += fmt::format("Eigen {}.{}.{}, {}, tinyxml2 {}.{}.{}, fmt {}.{}.{}, CLI11 {}, nlohmann/json {}.{}.{}, zlib {}",
                      EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION, thread_library_version(),
                      TINYXML2_MAJOR_VERSION, TINYXML2_MINOR_VERSION, TINYXML2_PATCH_VERSION, FMT_VERSION / 10000,
                      FMT_VERSION / 100 % 100, FMT_VERSION % 100, CLI11_VERSION, NLOHMANN_JSON_VERSION_MAJOR,
                      NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH, zlibVersion());
  return text;
}

}  // namespace dea
