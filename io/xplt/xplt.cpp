#include "io/xplt/xplt.h"

#include <algorithm>
#include <cassert>

#include "src/base/numbers.h"

namespace dea {

int floats_per_value(const XpltVariable& variable) {
  static constexpr int kFloats[] = {1, 3, 6, 3, 21, 9, 1, 3};  // by the type's code; of an array per entry
  const bool array = variable.type == XpltType::Array || variable.type == XpltType::ArrayVec3;
  return kFloats[static_cast<std::size_t>(variable.type)] * (array ? variable.array_size : 1);
}

namespace {

/// Code of a facet that is no element of ours.
constexpr int kTri10 = 15;

/// By the format's code.
const auto& shapes_by_code() {
  using E = ElementShape;
  static constexpr std::array<std::optional<E>, 20> kShapes = {
      E::Hex8, E::Penta6, E::Tet4,  E::Quad4,   E::Tri3,  E::Line2,     E::Hex20, E::Tet10, E::Tet15,  E::Hex27,
      E::Tri6, E::Quad8,  E::Quad9, E::Penta15, E::Tet20, std::nullopt, E::Pyra5, E::Tet5,  E::Pyra13, E::Line3};
  return kShapes;
}

}  // namespace

std::optional<ElementShape> xplt_element_shape(int element_type) {
  const auto& shapes = shapes_by_code();
  return element_type >= 0 && element_type < static_cast<int>(shapes.size()) ? shapes[at(element_type)] : std::nullopt;
}

bool written_by_dea(const XpltFile& file) { return file.software.rfind("FEBioDEA", 0) == 0; }

int xplt_nodes_per_element(int element_type) {
  if (element_type == kTri10) return 10;
  const std::optional<ElementShape> shape = xplt_element_shape(element_type);
  return shape ? nodes_per_element(*shape) : 0;
}

int xplt_element_type(ElementShape shape) {
  const auto& shapes = shapes_by_code();
  const auto found = std::find(shapes.begin(), shapes.end(), shape);
  assert(found != shapes.end());
  return static_cast<int>(found - shapes.begin());
}

int xplt_elements(const XpltDomain& domain) { return static_cast<int>(domain.element_ids.size()); }

std::size_t element_count(const XpltMesh& mesh) {
  std::size_t count = 0;
  for (const XpltDomain& domain : mesh.domains) count += domain.element_ids.size();
  return count;
}

int find_variable(const XpltFile& file, XpltGroup group, const std::string& name) {
  for (std::size_t i = 0; i < file.variables.size(); ++i) {
    if (file.variables[i].group == group && file.variables[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

namespace {

std::int64_t distinct_nodes(const XpltMesh& mesh, const std::vector<int>& nodes) {
  std::vector<char> seen(mesh.node_ids.size(), 0);
  std::int64_t count = 0;
  for (const int node : nodes) {
    char& mark = seen.at(static_cast<std::size_t>(node));
    count += mark == 0;
    mark = 1;
  }
  return count;
}

// `slots`: values per item in the MULT format.
std::int64_t values_in_region(const XpltMesh& mesh, XpltFormat format, const std::vector<int>& nodes,
                              std::int64_t items, std::int64_t slots) {
  switch (format) {
    case XpltFormat::Node:
      return distinct_nodes(mesh, nodes);
    case XpltFormat::Item:
      return items;
    case XpltFormat::Mult:
      return items * slots;
    case XpltFormat::Region:
      return 1;
  }
  assert(false);
  return 0;
}

}  // namespace

std::int64_t floats_in_region(const XpltMesh& mesh, const XpltVariable& variable, int region) {
  const int floats = floats_per_value(variable);
  const auto is_among = [region](const auto& all) { return region >= 1 && at(region) <= all.size(); };
  switch (variable.group) {
    case XpltGroup::Global:
      return region == 0 ? floats : -1;
    case XpltGroup::Nodal:  // whatever its format says
      return region == 0 ? static_cast<std::int64_t>(mesh.node_ids.size()) * floats : -1;
    case XpltGroup::Domain: {
      if (!is_among(mesh.domains)) return -1;
      const XpltDomain& domain = mesh.domains[at(region - 1)];
      const int nodes = xplt_nodes_per_element(domain.element_type);
      return values_in_region(mesh, variable.format, domain.nodes, xplt_elements(domain), nodes) * floats;
    }
    case XpltGroup::Surface:
    case XpltGroup::Edge: {
      const std::vector<XpltFacets>& all = variable.group == XpltGroup::Surface ? mesh.surfaces : mesh.edges;
      if (!is_among(all)) return -1;
      const XpltFacets& facets = all[at(region - 1)];
      return values_in_region(mesh, variable.format, facets.nodes, facets.size(), facets.max_nodes) * floats;
    }
  }
  return -1;
}

}  // namespace dea
