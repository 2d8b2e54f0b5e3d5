// Springs between nodes: FEBio keeps each set of them as a domain with a discrete material.
#include <FECore/FEDiscreteDomain.h>
#include <FECore/FEMesh.h>

#include "plugin/fe_reading.h"

namespace dea::fe {

namespace {

/// Index of the discrete set a domain of springs was made from; a new one if there is none.
int discrete_set_of(Reading& reading, FEDomain& fe) {
  auto& sets = reading.model.discrete_sets;
  for (std::size_t i = 0; i < sets.size(); ++i)
    if (sets[i].name == fe.GetName()) return static_cast<int>(i);
  DiscreteSet set = {fe.GetName(), {}, kNowhere};
  for (int i = 0; i < fe.Elements(); ++i) set.pairs.push_back({fe.ElementRef(i).m_node[0], fe.ElementRef(i).m_node[1]});
  sets.push_back(std::move(set));
  return static_cast<int>(sets.size()) - 1;
}

void read_springs(Reading& reading, FEDomain& fe) {
  if (type_of(fe).rfind("deformable-spring", 0) == 0)  // made of pieces that bend
    return unsupported(reading, "discrete elements of type \"wire\"", "make it type spring, or take it out");
  if (fe.GetMaterial() == nullptr) fail(reading, "discrete elements without a material: give them one");
  const febio::DiscreteMaterial material =
      febio::discrete_material(reading, component_of(reading, *fe.GetMaterial(), "discrete_material"));
  if (!material.unsupported.empty()) return unsupported(reading, material.unsupported, material.advice);
  DiscreteSprings springs = material.springs;
  springs.set = discrete_set_of(reading, fe);
  springs.name = fe.GetName();
  springs.origin = kNowhere;
  reading.model.discrete_springs.push_back(std::move(springs));
}

}  // namespace

void read_discrete(Reading& reading) {
  FEMesh& mesh = reading.fem.GetMesh();
  for (int i = 0; i < mesh.Domains(); ++i)
    if (mesh.Domain(i).Class() == FE_DOMAIN_DISCRETE) read_springs(reading, mesh.Domain(i));
}

}  // namespace dea::fe
