#include "views/page/page_context.h"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <unordered_map>

#include "src/base/numbers.h"
#include "src/model/element_faces.h"

namespace dea {

namespace {

constexpr std::size_t kMostContextTriangles = 150000;

struct Face {
  std::vector<int> nodes;
  std::size_t domain = 0;
  int times = 0;
  bool shell = false;
};
using Faces = std::map<std::vector<int>, Face>;  // by sorted corners

bool too_many(const Faces& faces) { return faces.size() > 20 * kMostContextTriangles; }

/// Adds a face, or notes that it is there once more. A shell takes the place of a solid element's face.
void add_face(Faces& faces, Face face) {
  std::vector<int> key(face.nodes.begin(), face.nodes.begin() + facet_corners(static_cast<int>(face.nodes.size())));
  std::sort(key.begin(), key.end());
  Face& known = faces[key];
  const int times = known.times + (face.shell ? 0 : 1);
  if (known.nodes.empty() || (face.shell && !known.shell)) known = std::move(face);
  known.times = times;
}

Faces faces_of(const XpltMesh& mesh) {
  Faces faces;
  for (std::size_t d = 0; d < mesh.domains.size(); ++d) {
    const XpltDomain& domain = mesh.domains[d];
    const std::optional<ElementShape> shape = xplt_element_shape(domain.element_type);
    if (!shape || domain.part < 1 || domain.part > static_cast<int>(mesh.parts.size())) continue;
    const int n = nodes_per_element(*shape);
    if (too_many(faces)) break;
    for (int e = 0; e < xplt_elements(domain); ++e) {
      for (const std::vector<int>& local : element_faces(*shape)) {
        Face face;
        for (int k : local) face.nodes.push_back(domain.nodes[at(e * n + k)]);
        face.domain = d;
        face.shell = is_shell(*shape);
        add_face(faces, std::move(face));
      }
    }
  }
  return faces;
}

using Triangles = std::vector<std::array<int, 3>>;

/// Per domain the triangles of faces that are seen from outside.
std::vector<Triangles> outer_triangles(const XpltMesh& mesh, const Faces& faces,
                                       const std::vector<Vector3d>& positions) {
  std::vector<Triangles> triangles(mesh.domains.size());
  for (const auto& entry : faces) {
    const Face& face = entry.second;
    if (face.times > 1 && !face.shell) continue;
    const bool finite =
        std::all_of(face.nodes.begin(), face.nodes.end(), [&](int i) { return positions[at(i)].allFinite(); });
    if (!finite) continue;
    const FacetTriangles parts = split_facet(face.nodes.data(), static_cast<int>(face.nodes.size()), positions);
    triangles[face.domain].insert(triangles[face.domain].end(), parts.begin(), parts.end());
  }
  return triangles;
}

/// Of a great many nodes some that are spread evenly: a rigid motion needs no more.
constexpr std::size_t kMostMotionNodes = 2000;

std::vector<int> some_of(std::vector<int> nodes) {
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  const std::size_t step = nodes.size() / kMostMotionNodes + 1;
  std::vector<int> some;
  for (std::size_t i = 0; i < nodes.size(); i += step) some.push_back(nodes[i]);
  return some;
}

bool is_motion(const std::optional<PagePose>& pose, double length) {
  return pose && (pose->translation.norm() > 1e-9 * length || pose->rotation.vec().norm() > 1e-9);
}

}  // namespace

PageContext make_context(const XpltMesh& mesh) {
  PageContext context;
  std::vector<Vector3d> positions(mesh.node_ids.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    positions[i] = Vector3d(mesh.coordinates[3 * i], mesh.coordinates[3 * i + 1], mesh.coordinates[3 * i + 2]);
  const Faces faces = faces_of(mesh);
  const std::vector<Triangles> triangles = outer_triangles(mesh, faces, positions);
  std::size_t count = 0;
  for (const Triangles& part : triangles) count += part.size();
  if (count > kMostContextTriangles || too_many(faces)) {
    context.note = "The rest of the mesh is left out: it is too large to be drawn as a veil.";
    return context;
  }
  std::unordered_map<int, std::int32_t> vertex;
  for (std::size_t p = 0; p < triangles.size(); ++p) {
    if (triangles[p].empty()) continue;
    for (const auto& t : triangles[p]) {
      for (int node : t) {
        const auto added = vertex.try_emplace(node, static_cast<std::int32_t>(vertex.size()));
        if (added.second)
          for (int k = 0; k < 3; ++k) context.vertices.push_back(static_cast<float>(positions[at(node)][k]));
        context.triangles.push_back(added.first->second);
      }
    }
    context.parts.push_back(mesh.parts[at(mesh.domains[p].part - 1)]);
    context.domains.push_back(p);
    context.begin.push_back(static_cast<std::int32_t>(context.triangles.size() / 3));
  }
  return context;
}

std::optional<PagePose> motion_of(const ResultFile& file, int state, const std::vector<int>& nodes) {
  const XpltMesh& mesh = mesh_of(file, state);
  const int index = find_variable(file.xplt, XpltGroup::Nodal, "displacement");
  if (index < 0 || nodes.size() < 3) return std::nullopt;
  for (const XpltRegion& region : file.xplt.states[at(state)].variables[at(index)]) {
    if (region.values.size() != mesh.coordinates.size()) continue;
    Eigen::Matrix3Xd from(3, nodes.size()), to(3, nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const std::size_t place = 3 * at(nodes[i]) + at(k);
        from(k, static_cast<Eigen::Index>(i)) = mesh.coordinates[place];
        to(k, static_cast<Eigen::Index>(i)) =
            static_cast<double>(mesh.coordinates[place]) + static_cast<double>(region.values[place]);
      }
    if (!from.allFinite() || !to.allFinite()) return std::nullopt;
    const Eigen::Matrix3Xd around = from.colwise() - from.rowwise().mean();
    const Eigen::Vector3d spread = Eigen::JacobiSVD<Eigen::Matrix3d>(around * around.transpose()).singularValues();
    if (!(spread[1] > 1e-12 * spread[0])) return std::nullopt;
    const Eigen::Matrix4d m = Eigen::umeyama(from, to, false);
    return PagePose{Eigen::Quaterniond(Eigen::Matrix3d(m.topLeftCorner<3, 3>())).normalized(),
                    m.topRightCorner<3, 1>()};
  }
  return std::nullopt;
}

void add_motion(const ResultFile& file, int state, const std::vector<int>& surfaces, PageContext& context) {
  if (context.triangles.empty()) return;
  const int mesh_index = file.xplt.states[at(state)].mesh;
  const XpltMesh& mesh = mesh_of(file, state);
  std::vector<std::vector<int>> parts, sides;
  for (const std::size_t domain : context.domains) parts.push_back(some_of(mesh.domains[domain].nodes));
  for (int surface : surfaces) sides.push_back(some_of(mesh.surfaces[at(surface)].nodes));
  double length = 0.0;
  for (float x : context.vertices) length = std::max(length, std::abs(static_cast<double>(x)));
  bool moves = false;
  const auto motions = [&](int s, const std::vector<std::vector<int>>& of) {
    std::vector<std::optional<PagePose>> out;
    for (const std::vector<int>& nodes : of) {
      out.push_back(file.xplt.states[at(s)].mesh == mesh_index ? motion_of(file, s, nodes) : std::nullopt);
      moves = moves || is_motion(out.back(), length);
    }
    return out;
  };
  for (int s = 0; s < static_cast<int>(file.xplt.states.size()); ++s) {
    context.parts_move.push_back(motions(s, parts));
    context.surfaces_move.push_back(motions(s, sides));
  }
  if (moves) return;
  context.parts_move.clear();
  context.surfaces_move.clear();
}

}  // namespace dea
