// febiodea/views/page/page_context.h – the rest of the mesh, which a page draws as a veil around the surfaces.
#pragma once
#include <febiodea/views/page/page_data.h>

namespace dea {

/// Triangles of faces that belong to one solid element only, and of shells.
PageContext make_context(const XpltMesh& mesh);

}  // namespace dea
