// tests/src/part_meshes.h – blocks of any element shape, for tests of deformable parts.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

#include "src/springs/part_operator.h"

namespace dea::test {

/// Elements with more nodes than corners: those on edges half-way, in faces and inside at the middle.
inline PartMesh with_more_nodes(const PartMesh& simple, ElementShape shape) {
  PartMesh mesh;
  mesh.nodes = simple.nodes;
  std::map<std::vector<int>, int> middles;
  const auto middle = [&](std::vector<int> of) {
    std::sort(of.begin(), of.end());
    const auto place = middles.emplace(of, mesh.size());
    if (place.second) {
      Vector3d sum = Vector3d::Zero();
      for (int node : of) sum += simple.nodes[at(node)] / static_cast<double>(of.size());
      mesh.nodes.push_back(sum);
    }
    return place.first->second;
  };
  const int count = nodes_per_element(shape);
  for (int e = 0; e < simple.elements(); ++e) {
    const std::vector<int> corners(simple.element_node.begin() + simple.begin[at(e)],
                                   simple.element_node.begin() + simple.begin[at(e) + 1]);
    const auto of = [&](std::initializer_list<int> local) {
      std::vector<int> nodes;
      for (int k : local) nodes.push_back(corners[at(k)]);
      return middle(nodes);
    };
    std::vector<int> all(at(count), -1);
    std::copy(corners.begin(), corners.end(), all.begin());
    for (const std::vector<int>& face : element_faces(shape)) {
      const std::size_t n = face.size() < 6 ? face.size() : face.size() / 2;
      for (std::size_t k = n; k < 2 * n && k < face.size(); ++k)
        all[at(face[k])] = of({face[k - n], face[(k - n + 1) % n]});
    }
    if (shape == ElementShape::Hex27) {
      const int faces[6][4] = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {0, 1, 2, 3}, {4, 5, 6, 7}};
      for (int f = 0; f < 6; ++f) all[at(20 + f)] = of({faces[f][0], faces[f][1], faces[f][2], faces[f][3]});
      all[26] = middle(corners);
    } else if (shape == ElementShape::Tet15) {
      all[10] = of({0, 1, 2});
      all[11] = of({0, 1, 3});
      all[12] = of({1, 2, 3});
      all[13] = of({0, 2, 3});
      all[14] = middle(corners);
    }
    mesh.shape.push_back(shape);
    mesh.material.push_back(simple.material[at(e)]);
    mesh.element_node.insert(mesh.element_node.end(), all.begin(), all.end());
    mesh.begin.push_back(static_cast<int>(mesh.element_node.size()));
  }
  mesh.elastic = simple.elastic;
  return mesh;
}

/// A block of n[0] x n[1] x n[2] cells on [0, size], nodes moved by `warp`; each cell one hexahedron, or two prisms,
/// six tetrahedra or pyramids.
inline PartMesh block_of(ElementShape shape, const std::array<int, 3>& n, const Vector3d& size, const Matrix6d& D,
                         const std::function<Vector3d(const Vector3d&)>& warp = nullptr) {
  using S = ElementShape;
  PartMesh mesh;
  mesh.elastic = {D};
  const auto node = [&](int i, int j, int k) { return (k * (n[1] + 1) + j) * (n[0] + 1) + i; };
  for (int k = 0; k <= n[2]; ++k)
    for (int j = 0; j <= n[1]; ++j)
      for (int i = 0; i <= n[0]; ++i) {
        const Vector3d x(size[0] * i / n[0], size[1] * j / n[1], size[2] * k / n[2]);
        mesh.nodes.push_back(warp ? warp(x) : x);
      }
  const S simple = shape == S::Hex20 || shape == S::Hex27   ? S::Hex8
                   : shape == S::Penta15                    ? S::Penta6
                   : shape == S::Tet10 || shape == S::Tet15 ? S::Tet4
                                                            : shape;
  const auto add = [&](const std::vector<int>& nodes) {
    mesh.shape.push_back(simple);
    mesh.material.push_back(0);
    mesh.element_node.insert(mesh.element_node.end(), nodes.begin(), nodes.end());
    mesh.begin.push_back(static_cast<int>(mesh.element_node.size()));
  };
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        const std::vector<int> c = {
            node(i, j, k),     node(i + 1, j, k),     node(i + 1, j + 1, k),     node(i, j + 1, k),
            node(i, j, k + 1), node(i + 1, j, k + 1), node(i + 1, j + 1, k + 1), node(i, j + 1, k + 1)};
        if (simple == S::Hex8) {
          add(c);
        } else if (simple == S::Penta6) {
          add({c[0], c[1], c[2], c[4], c[5], c[6]});
          add({c[0], c[2], c[3], c[4], c[6], c[7]});
        } else if (simple == S::Tet4) {
          const int tets[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
          for (const auto& t : tets) add({c[at(t[0])], c[at(t[1])], c[at(t[2])], c[at(t[3])]});
        } else {
          Vector3d middle = Vector3d::Zero();
          for (int v : c) middle += mesh.nodes[at(v)] / 8;
          mesh.nodes.push_back(middle);
          const int top = mesh.size() - 1;
          const int quads[6][4] = {{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};
          for (const auto& q : quads) add({c[at(q[0])], c[at(q[1])], c[at(q[2])], c[at(q[3])], top});
        }
      }
  return simple == shape ? mesh : with_more_nodes(mesh, shape);
}

inline const std::vector<ElementShape>& stiff_shapes() {
  using S = ElementShape;
  static const std::vector<S> shapes = {S::Hex8, S::Hex20, S::Hex27, S::Penta6, S::Penta15,
                                        S::Tet4, S::Tet10, S::Tet15, S::Pyra5};
  return shapes;
}

}  // namespace dea::test
