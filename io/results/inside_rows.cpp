#include "io/results/inside_rows.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "src/base/decompositions.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/time_text.h"
#include "src/model/element_columns.h"
#include "src/model/element_faces.h"
#include "src/results/inside_numbers.h"

namespace dea {

namespace {

using Eigen::Matrix3d;
using NodeGradients = Eigen::Matrix<double, Eigen::Dynamic, 3>;

constexpr const char* kStress = "stress";
constexpr const char* kStrain = "Lagrange strain";

/// Elements of all domains, with what of them can be asked for by their number.
struct MeshElements {
  const XpltMesh& mesh;
  std::vector<int> first;  ///< per domain: number of its first element
  int count = 0;
  explicit MeshElements(const XpltMesh& m) : mesh(m) {
    for (const XpltDomain& d : mesh.domains) {
      first.push_back(count);
      count += xplt_elements(d);
    }
  }
  std::size_t domain_of(int element) const {
    return at(std::upper_bound(first.begin(), first.end(), element) - first.begin() - 1);
  }
  std::optional<ElementShape> shape(int element) const {
    return xplt_element_shape(mesh.domains[domain_of(element)].element_type);
  }
  const int* nodes(int element) const {
    const std::size_t d = domain_of(element);
    const XpltDomain& domain = mesh.domains[d];
    return domain.nodes.data() +
           static_cast<std::ptrdiff_t>(element - first[d]) * xplt_nodes_per_element(domain.element_type);
  }
  Vector3d node(int i) const {
    const float* x = mesh.coordinates.data() + 3 * static_cast<std::ptrdiff_t>(i);
    return {x[0], x[1], x[2]};
  }
};

/// Domains with values of an element variable in a state.
std::vector<const XpltRegion*> regions_of(const ResultFile& result, int state, const char* field) {
  const XpltMesh& mesh = mesh_of(result, state);
  std::vector<const XpltRegion*> regions(mesh.domains.size(), nullptr);
  const int index = find_variable(result.xplt, XpltGroup::Domain, field);
  if (index < 0) return regions;
  const XpltVariable& variable = result.xplt.variables[at(index)];
  if (variable.type != XpltType::Mat3s || variable.format != XpltFormat::Item) return regions;
  for (const XpltRegion& region : result.xplt.states[at(state)].variables[at(index)]) {
    const int domain = region.region - 1;
    if (domain < 0 || at(domain) >= regions.size()) continue;
    if (region.values.size() == 6 * at(xplt_elements(mesh.domains[at(domain)]))) regions[at(domain)] = &region;
  }
  return regions;
}

/// Of an element with six numbers; none: its domain has no values.
std::optional<Matrix3d> tensor_of(const MeshElements& elements, const std::vector<const XpltRegion*>& regions,
                                  int element) {
  const std::size_t d = elements.domain_of(element);
  if (regions[d] == nullptr) return std::nullopt;
  const float* v = regions[d]->values.data() + 6 * static_cast<std::ptrdiff_t>(element - elements.first[d]);
  Matrix3d m;
  m << v[0], v[3], v[5], v[3], v[1], v[4], v[5], v[4], v[2];
  return m;
}

/// Gradients of the shape functions in the element's own coordinates at its centroid; none: a shape without.
std::optional<NodeGradients> gradients_at_centroid(ElementShape shape) {
  using S = ElementShape;
  NodeGradients g(nodes_per_element(shape), 3);
  g.setZero();
  const double signs[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                              {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
  const double tet[4][3] = {{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  switch (shape) {
    case S::Hex8:
      for (int i = 0; i < 8; ++i)
        for (int k = 0; k < 3; ++k) g(i, k) = signs[i][k] / 8;
      return g;
    case S::Hex20: {  // corners, then the middles of the edges below, above and upright
      const int edge[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                               {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
      for (int i = 0; i < 8; ++i)
        for (int k = 0; k < 3; ++k) g(i, k) = -signs[i][k] / 8;
      for (int e = 0; e < 12; ++e)
        for (int k = 0; k < 3; ++k) g(8 + e, k) = (signs[edge[e][0]][k] + signs[edge[e][1]][k]) / 8;
      return g;
    }
    case S::Penta6:
      for (int i = 0; i < 6; ++i) {
        const int corner = i % 3;
        for (int k = 0; k < 2; ++k) g(i, k) = 0.5 * (corner == 0 ? -1 : corner == k + 1 ? 1 : 0);
        g(i, 2) = (i < 3 ? -1 : 1) / 6.0;
      }
      return g;
    case S::Tet4:
      for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 3; ++k) g(i, k) = tet[i][k];
      return g;
    case S::Tet10: {  // at a corner's 4 L - 1 = 0; edges: both ends' gradients
      const int edge[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
      for (int e = 0; e < 6; ++e)
        for (int k = 0; k < 3; ++k) g(4 + e, k) = tet[edge[e][0]][k] + tet[edge[e][1]][k];
      return g;
    }
    default:
      return std::nullopt;
  }
}

/// Lagrange strain of the displacements at an element's centroid.
std::optional<Matrix3d> strain_of_displacement(const MeshElements& elements, const std::vector<float>& u, int element) {
  const std::optional<ElementShape> shape = elements.shape(element);
  const std::optional<NodeGradients> gradients = shape ? gradients_at_centroid(*shape) : std::nullopt;
  if (!gradients) return std::nullopt;
  Matrix3d before = Matrix3d::Zero(), after = Matrix3d::Zero();
  const int* nodes = elements.nodes(element);
  for (Eigen::Index i = 0; i < gradients->rows(); ++i) {
    const float* d = u.data() + 3 * static_cast<std::ptrdiff_t>(nodes[i]);
    const Vector3d X = elements.node(nodes[i]), x = X + Vector3d(d[0], d[1], d[2]);
    before += X * gradients->row(i);
    after += x * gradients->row(i);
  }
  if (!(std::abs(before.determinant()) > 0)) return std::nullopt;
  const Matrix3d F = after * before.inverse();
  return Matrix3d(0.5 * (F.transpose() * F - Matrix3d::Identity()));
}

double volume_of(const MeshElements& elements, int element) {
  const int* nodes = elements.nodes(element);
  const Vector3d origin = elements.node(nodes[0]);
  double volume = 0.0;
  for (const std::vector<int>& face : element_faces(*elements.shape(element))) {  // of the corners
    const int n = facet_corners(static_cast<int>(face.size()));
    std::array<Vector3d, 4> x;
    for (int k = 0; k < n; ++k) x[at(k)] = elements.node(nodes[face[at(k)]]) - origin;
    volume += x[0].dot(x[1].cross(x[2])) / 6;
    if (n == 4) volume += x[0].dot(x[2].cross(x[3])) / 6;
  }
  return std::abs(volume);
}

ElementMeasures measures_of(const Matrix3d& stress, const std::optional<Matrix3d>& strain) {
  const Eigen::VectorXd s = symmetric_eigenvalues(stress);
  const double shear = 0.5 * (s[2] - s[0]);
  if (!strain) return {shear, kNaN, kNaN};
  const Eigen::VectorXd e = symmetric_eigenvalues(*strain);
  return {shear, e[2], e[0]};
}

}  // namespace

const char* name(InsideRow row) { return word_of(row, {"bone", "surface"}); }

RowElements row_elements(const ResultFile& result, int state, int surface, InsideRow row) {
  const XpltMesh& mesh = mesh_of(result, state);
  const MeshElements elements(mesh);
  std::vector<ElementBlock> blocks;
  std::vector<int> number;  // per solid element, counted through the blocks: that of the mesh
  const std::vector<const XpltRegion*> stress = regions_of(result, state, kStress);
  for (std::size_t d = 0; d < mesh.domains.size(); ++d) {
    const std::optional<ElementShape> shape = xplt_element_shape(mesh.domains[d].element_type);
    if (stress[d] == nullptr || !shape || element_type(*shape).kind != ElementKind::Solid) continue;
    blocks.push_back({*shape, &mesh.domains[d].nodes});
    for (int e = 0; e < blocks.back().size(); ++e) number.push_back(elements.first[d] + e);
  }
  const XpltFacets& facets = mesh.surfaces[at(surface)];
  const ElementColumns columns = element_columns(blocks, facets.begin, facets.nodes);
  RowElements out;
  for (std::size_t f = 0; f < columns.of_facet.size(); ++f) {
    const std::vector<int>& column = columns.of_facet[f];
    const bool there = !column.empty() && (row == InsideRow::Surface || columns.whole[f]);
    out.element.push_back(there ? number[at(row == InsideRow::Surface ? column.front() : column.back())] : -1);
    out.volume.push_back(there ? volume_of(elements, out.element.back()) : 0.0);
  }
  return out;
}

std::vector<ElementMeasures> row_measures(const ResultFile& result, int state, const RowElements& row) {
  const MeshElements elements(mesh_of(result, state));
  const std::vector<const XpltRegion*> stress = regions_of(result, state, kStress),
                                       strain = regions_of(result, state, kStrain);
  const std::vector<float>* u = displacement_of(result, state);
  std::vector<ElementMeasures> out(row.element.size(), {kNaN, kNaN, kNaN});
  bool any = false;
  for (std::size_t f = 0; f < out.size(); ++f) {
    const int e = row.element[f];
    const std::optional<Matrix3d> s = e < 0 ? std::nullopt : tensor_of(elements, stress, e);
    if (!s) continue;
    std::optional<Matrix3d> own = tensor_of(elements, strain, e);
    if (!own && u != nullptr) own = strain_of_displacement(elements, *u, e);
    if (!s->allFinite() || (own && !own->allFinite()))
      throw InputError(fmt::format("{}: time {}: stress or strain of an element is not a number", result.path,
                                   time_text(result.xplt.states[at(state)].time)));
    out[f] = measures_of(*s, own);
    any = true;
  }
  return any ? out : std::vector<ElementMeasures>();
}

std::string row_field_name(int measure, InsideRow row) {
  return fmt::format("{}, row at the {}", kInsideMeasures[measure].words, name(row));
}

std::vector<std::string> row_field_names(const ResultFile& result) {
  std::vector<std::string> names;
  if (find_variable(result.xplt, XpltGroup::Domain, kStress) < 0) return names;
  for (const InsideRow row : kInsideRows)
    for (int m = 0; m < 3; ++m) names.push_back(row_field_name(m, row));
  return names;
}

std::vector<double> row_field_values(const ResultFile& result, int state, int surface, const std::string& field) {
  for (const InsideRow row : kInsideRows)
    for (int m = 0; m < 3; ++m) {
      if (field != row_field_name(m, row)) continue;
      std::vector<double> values;
      for (const ElementMeasures& of : row_measures(result, state, row_elements(result, state, surface, row)))
        values.push_back(of[at(m)]);
      return values;
    }
  return {};
}

std::vector<double> shown_values(const ResultFile& result, int state, int surface, const std::string& field,
                                 bool undefined) {
  if (find_variable(result.xplt, XpltGroup::Surface, field) >= 0)
    return facet_values(result, state, surface, field, undefined);
  return row_field_values(result, state, surface, field);
}

}  // namespace dea
