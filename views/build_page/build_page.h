// views/build_page/build_page.h – a joint made by `dea build` as one HTML file that needs nothing else
// (docs/from_scans.md, "The page").
#pragma once
#include <string>
#include <vector>

#include "views/data/build_json.h"

namespace dea {

struct BuildPageInput {
  const BuildSummary& summary;
  const BuildRequest& request;
  std::vector<TriangleSurface> bones;  ///< per body, to be drawn: coarse enough for it; may be empty
  std::vector<std::string> words;      ///< the command line
  std::vector<std::string> files;      ///< in it, of which only the names are shown
};

/// The page. The same input gives the same bytes; no name is taken for markup.
std::string build_page_html(const BuildPageInput& input);

}  // namespace dea
