#include "src/run/cost.h"

#include <cmath>

namespace dea {

namespace {

// Measured on joints of 1,728 to 995,328 springs (law linear), and of 28,544 to 1,027,584 layer triangles: the factors
// of their matrices grow as n log n.
constexpr double kBytesPerSpring = 720;
constexpr double kBytesPerLayerTriangle = 65;  // times log2 of their number

// Between two solutions, measured on all samples with refine 1 to 3: without layers within 15 per cent, but 40 per cent
// too much for the hip; layers within a third.
constexpr double kKeptPerNode = 1300;  // of the model: nodes, elements, surfaces, what finds points on them
constexpr double kKeptPerSpring = 280;
constexpr double kKeptShareOfLayer = 0.85;

double layer_bytes(double triangles) {
  return triangles > 1 ? kBytesPerLayerTriangle * triangles * std::log2(triangles) : 0.0;
}

}  // namespace

SpringCost spring_cost(const Joint& joint, int refine) {
  SpringCost cost;
  for (const ContactPair& pair : joint.contacts) {
    const double parts = std::pow(refine > 0 ? refine : pair.refine, 2);
    const double springs = parts * pair.source_layer().spring_surface().size();
    cost.springs += springs;
    cost.bytes += kBytesPerSpring * springs;
    if (pair.law != Law::Layer) continue;
    for (const Layer& layer : pair.layers) {
      const double triangles = layer.rigid ? 0.0 : parts * layer.face.mesh.size();
      cost.layer_triangles += triangles;
      cost.layer_bytes += layer_bytes(triangles);
      cost.bytes += layer_bytes(triangles);
    }
  }
  return cost;
}

double kept_bytes(const JointModel& model, const Joint& joint) {
  const SpringCost cost = spring_cost(joint);
  return kKeptPerNode * static_cast<double>(model.nodes.size()) + kKeptPerSpring * cost.springs +
         kKeptShareOfLayer * cost.layer_bytes;
}

int largest_refine(const Joint& joint, double bytes) {
  int fits = 0;
  while (fits < 1000 && spring_cost(joint, fits + 1).bytes <= bytes) ++fits;
  return fits;
}

}  // namespace dea
