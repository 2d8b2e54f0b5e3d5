#include "io/run/spring_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "io/files/free_memory.h"
#include "src/base/error.h"
#include "src/base/say.h"
#include "src/run/cost.h"

namespace dea {

std::string spring_cost_note(const Recognition& r, const Wording& wording) {
  constexpr double kMany = 1e6;  // springs or layer triangles
  int refine = 1;
  for (const ContactPair& pair : r.joint.contacts) refine = std::max(refine, pair.refine);
  if (!r.recognised || refine == 1) return "";
  const SpringCost cost = spring_cost(r.joint);
  const NamedSetting given{"refine", "", std::to_string(refine)};
  const double free = free_memory();
  if (cost.bytes > kLittleMemory && cost.bytes > free) {
    const int fits = largest_refine(r.joint, free);
    throw UsageError(Fault{
        .given = given,
        .found = fmt::format("{:.0f} springs need about {} of memory, and {} are free;", cost.springs,
                             gigabytes(cost.bytes), gigabytes(free)),
        .expected = fits > 0 ? say("{} is the largest that fits", NamedSetting{"refine", "", std::to_string(fits)})
                             : Sentence("no division fits")});
  }
  if (std::max(cost.springs, cost.layer_triangles) <= kMany) return "";
  const std::string layers =
      cost.layer_triangles > 0 ? fmt::format(" and {:.0f} triangles of the layers", cost.layer_triangles) : "";
  return fmt::format(
      "note: {5}: {1:.0f} springs ({2:.0f} triangles, each divided into {0} x {0}){3}, about {4} "
      "of memory",
      refine, cost.springs, spring_cost(r.joint, 1).springs, layers, gigabytes(cost.bytes), wording(given));
}

}  // namespace dea
