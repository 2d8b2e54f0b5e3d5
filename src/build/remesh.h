// src/build/remesh.h – other triangles for the same surface, by CGAL. Compiled by itself: nothing else includes
// it.
#pragma once
#include <cstddef>

#include "src/geometry/triangle_surface.h"

namespace dea {

/// Triangles with edges near this length, on the surface; its rim stays where it is.
TriangleSurface remeshed(const TriangleSurface& surface, double edge);

/// The surface without triangles that are all but a line (less high than 1/58 of their longest edge): needles lose
/// their short edge, of flat ones the long edge is turned. One without such triangles stays as it is.
TriangleSurface without_slivers(const TriangleSurface& surface);

/// About this many triangles, by collapsing the edges that change the shape least (Lindstrom and Turk).
TriangleSurface decimated(const TriangleSurface& surface, std::size_t triangles);

}  // namespace dea
