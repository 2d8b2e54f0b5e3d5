#include <febiodea/views/page/page_context.h>

#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>

#include <febiodea/base/numbers.h>
#include <febiodea/model/element_faces.h>

namespace dea {

namespace {

constexpr std::size_t kMostContextTriangles = 150000;

struct Face {
  std::vector<int> nodes;
  int part = 0, times = 0;
  bool shell = false;
};
using Faces = std::map<std::vector<int>, Face>;  // by sorted corners

bool too_many(const Faces& faces) { return faces.size() > 20 * kMostContextTriangles; }

/// Adds a face, or notes that it is there once more. A shell takes the place of a solid element's face.
void add_face(Faces& faces, Face face) {
  std::vector<int> key(face.nodes.begin(), face.nodes.begin() + facet_corners(static_cast<int>(face.nodes.size())));
  std::sort(key.begin(), key.end());
  Face& known = faces[key];
  face.times = known.times + (face.shell ? 0 : 1);
  if (known.nodes.empty() || (face.shell && !known.shell))
    known = std::move(face);
  else
    known.times = face.times;
}

Faces faces_of(const XpltMesh& mesh) {
  Faces faces;
  for (const XpltDomain& domain : mesh.domains) {
    const std::optional<ElementShape> shape = xplt_element_shape(domain.element_type);
    if (!shape || domain.part < 1 || domain.part > static_cast<int>(mesh.parts.size())) continue;
    const int n = nodes_per_element(*shape);
    if (too_many(faces)) break;
    for (int e = 0; e < xplt_elements(domain); ++e) {
      for (const std::vector<int>& local : element_faces(*shape)) {
        Face face;
        for (int k : local) face.nodes.push_back(domain.nodes[at(e * n + k)]);
        face.part = domain.part - 1;
        face.shell = is_shell(*shape);
        add_face(faces, std::move(face));
      }
    }
  }
  return faces;
}

using Triangles = std::vector<std::array<int, 3>>;

/// Per part the triangles of faces that are seen from outside.
std::vector<Triangles> outer_triangles(const XpltMesh& mesh, const Faces& faces,
                                       const std::vector<Vector3d>& positions) {
  std::vector<Triangles> triangles(mesh.parts.size());
  for (const auto& entry : faces) {
    const Face& face = entry.second;
    if (face.times > 1 && !face.shell) continue;
    const bool finite =
        std::all_of(face.nodes.begin(), face.nodes.end(), [&](int i) { return positions[at(i)].allFinite(); });
    if (!finite) continue;
    const Triangles parts = split_facet(face.nodes.data(), static_cast<int>(face.nodes.size()), positions);
    triangles[at(face.part)].insert(triangles[at(face.part)].end(), parts.begin(), parts.end());
  }
  return triangles;
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
    context.parts.push_back(mesh.parts[p]);
    context.begin.push_back(static_cast<std::int32_t>(context.triangles.size() / 3));
  }
  return context;
}

}  // namespace dea
