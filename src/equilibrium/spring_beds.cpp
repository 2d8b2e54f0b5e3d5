#include "src/equilibrium/spring_beds.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/base/numbers.h"
#include "src/springs/place.h"
#include "src/springs/press.h"

namespace dea {

SpringBeds make_spring_beds(const Joint& joint, const StopFlag* stop) {
  SpringBeds beds;
  beds.least_thickness = kInfinity;
  double area = 0.0, inertia = 0.0;
  beds.reach = 0.0;
  for (const ContactPair& pair : joint.contacts) {
    end_if_stopped(stop);
    beds.beds.push_back(place_springs(joint, pair));
    for (const Layer& layer : pair.layers) {
      const SurfaceExtent extent = surface_extent(layer.articular);
      area += extent.area;
      inertia += extent.area * extent.radius_of_gyration * extent.radius_of_gyration;
      for (const Vector3d& x : layer.articular.vertices)
        beds.reach = std::max(beds.reach, (x - joint.bodies[at(layer.body)].center_of_mass).norm());
      // a feather edge must not bring the steps to a halt
      if (!layer.rigid)
        beds.least_thickness =
            std::min(beds.least_thickness, std::max(layer.min_thickness(), 0.1 * layer.mean_thickness()));
    }
  }
  beds.length = area > 0 ? std::sqrt(inertia / area) : 1.0;
  return beds;
}

PressedContact press_contact(const SpringBed& bed, const std::vector<Pose>& poses, const PressOptions& options,
                             PressMemory* memory) {
  const Pose &source = poses[at(bed.source_body)], &target = poses[at(bed.target_body)];
  SpringStates springs = press_springs(bed, source, target, options, memory);
  const ContactWrench wrench = contact_wrench(springs, source, target);
  return {std::move(springs), wrench};
}

}  // namespace dea
