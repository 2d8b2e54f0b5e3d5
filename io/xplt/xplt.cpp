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
constexpr std::array<std::optional<ElementShape>, 20> kShapesByCode = {
    ElementShape::Hex8,  ElementShape::Penta6, ElementShape::Tet4,  ElementShape::Quad4,   ElementShape::Tri3,
    ElementShape::Line2, ElementShape::Hex20,  ElementShape::Tet10, ElementShape::Tet15,   ElementShape::Hex27,
    ElementShape::Tri6,  ElementShape::Quad8,  ElementShape::Quad9, ElementShape::Penta15, ElementShape::Tet20,
    std::nullopt,        ElementShape::Pyra5,  ElementShape::Tet5,  ElementShape::Pyra13,  ElementShape::Line3};

}  // namespace

std::optional<ElementShape> xplt_element_shape(int element_type) {
  const bool known = element_type >= 0 && at(element_type) < kShapesByCode.size();
  return known ? kShapesByCode[at(element_type)] : std::nullopt;
}

bool written_by_dea(const XpltFile& file) { return file.software.rfind("FEBioDEA", 0) == 0; }

int xplt_nodes_per_element(int element_type) {
  if (element_type == kTri10) return 10;
  const std::optional<ElementShape> shape = xplt_element_shape(element_type);
  return shape ? nodes_per_element(*shape) : 0;
}

int xplt_element_type(ElementShape shape) {
  const auto found = std::find(kShapesByCode.begin(), kShapesByCode.end(), shape);
  assert(found != kShapesByCode.end());
  return static_cast<int>(found - kShapesByCode.begin());
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
      break;
  }
  return 1;
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
