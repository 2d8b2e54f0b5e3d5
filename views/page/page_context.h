// febiodea/views/page/page_context.h – the rest of the mesh, which a page draws as a veil around the surfaces.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <febiodea/io/xplt/xplt.h>

namespace dea {

/// Outside of the first result's elements, coarse enough to be drawn as a veil.
struct PageContext {
  std::vector<float> vertices;            ///< 3 each
  std::vector<std::int32_t> triangles;    ///< 3 each
  std::vector<std::string> parts;         ///< materials
  std::vector<std::int32_t> begin = {0};  ///< per part + 1: range of its triangles
  std::string note;                       ///< why there is none
};

/// Triangles of faces that belong to one solid element only, and of shells.
PageContext make_context(const XpltMesh& mesh);

}  // namespace dea
