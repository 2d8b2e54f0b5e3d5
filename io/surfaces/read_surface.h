// io/surfaces/read_surface.h – files of triangle surfaces, as segmentation programs write them.
#pragma once
#include <string>

#include "src/geometry/triangle_surface.h"

namespace dea {

/// STL (binary, text), OBJ, PLY (text, binary of either byte order), VTK legacy polydata (text, binary; cells of
/// versions to 5.1), VTP (text; bytes, plain or packed by zlib). The kind is found from the content, of OBJ from the
/// ending. Polygons are cut into triangles from their first corner; all that is no point or polygon is passed over.
/// Coordinates as in the file, in double precision; points as in the file (of STL three per triangle). Throws
/// InputError ("bone.stl:12: found ..., expected ..."): no such file, no surface, damaged, a coordinate that is no
/// finite number, no triangle.
TriangleSurface read_surface(const std::string& path);

}  // namespace dea
