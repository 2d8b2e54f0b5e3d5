// src/springs/gaps.h – where springs end at a pose, and how their gaps change.
#pragma once
#include <vector>

#include "src/geometry/foot_parts.h"
#include "src/springs/springs.h"

namespace dea {

/// Casts every spring's ray at a pose (S1, S2) and cuts feet at the target's rim: all of the states but pressures,
/// strains and their rates, which are zero; `rim` has all springs that are covered in part. Parallel over springs; each
/// is computed by itself, so the result does not depend on the number of threads.
SpringStates find_gaps(const SpringBed& bed, const Pose& source, const Pose& target);

/// So many springs, all of whose numbers are zero.
SpringStates empty_states(std::size_t n);

/// What of the target's triangles lies under spring i, whose ray meets the target (L8). `surface`: the target's, whole
/// or divided; `first`: its triangle that the ray meets; `end`, `own`: triangles from `end` on, and those that are not
/// in `own`, unless it is empty, are no part of the contact. Never empty: where nothing but rounding is left, all on
/// triangle `first`.
std::vector<SurfacePart> parts_under_spring(const SpringBed& bed, const RelativePose& relative,
                                            const SurfaceMesh& surface, const SpringStates& states, int i, int first,
                                            int end, const std::vector<char>& own = {});

/// The part of a triangle beside the source's surface, seen along `direction`, over which there is target, `gap` away
/// hereabouts. Both in the source's reference frame.
double covered_part(const SpringBed& bed, const RelativePose& relative, const std::array<Vector3d, 3>& triangle,
                    const Vector3d& direction, double gap);

/// kappa: d(overlap) = kappa . (delta_target - delta_source) at the end of spring i (E2), less what its rest length
/// loses by the target's thickness there, times its strain (E3). Global frame.
Vector3d overlap_rate(const SpringBed& bed, const SpringStates& states, int i, double strain_target,
                      const Pose& target);

/// How the overlap changes with the place of the spring's foot in its triangle, through the source's own bulge and
/// thickness, per length, global frame.
Vector3d source_overlap_gradient(const SpringBed& bed, const SpringStates& states, int i, double strain_source,
                                 const Pose& source);

}  // namespace dea
