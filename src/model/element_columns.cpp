#include "src/model/element_columns.h"

#include <array>
#include <unordered_map>

#include "src/base/numbers.h"
#include "src/model/element_faces.h"

namespace dea {

namespace {

/// The face of an element across from another one; -1: it has none.
int opposite_face(const ElementType& type, int face) {
  const std::size_t faces = type.faces.size();
  if (faces == 6) return std::array<int, 6>{2, 3, 0, 1, 5, 4}[at(face)];
  const auto triangle = [&](int f) { return facet_corners(static_cast<int>(type.faces[at(f)].size())) == 3; };
  if (faces == 5 && triangle(3) && triangle(4)) return face == 3 ? 4 : face == 4 ? 3 : -1;  // a penta, no pyramid
  return -1;
}

/// Faces of the elements, by their corners: the elements on both sides.
class SolidFaces {
 public:
  explicit SolidFaces(const std::vector<ElementBlock>& blocks) : blocks_(blocks) {
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const ElementBlock& block = blocks[b];
      first_.push_back(count_);
      count_ += block.size();
      block_.resize(at(count_), b);
      if (element_type(block.shape).kind != ElementKind::Solid) continue;
      for (int e = first_.back(); e < count_; ++e)
        for (int f = 0; f < static_cast<int>(element_faces(block.shape).size()); ++f) {
          Sides& sides = sides_.try_emplace(key(e, f)).first->second;
          if (sides.count < 2) sides.of[at(sides.count)] = {e, f};
          ++sides.count;
        }
    }
  }
  struct Side {
    int element = -1, face = -1;
  };
  /// The only element with this face; element -1: there are none or two.
  Side only(const FaceKey& face) const {
    const auto found = sides_.find(face);
    return found == sides_.end() || found->second.count != 1 ? Side{} : found->second.of[0];
  }
  /// The element across a face of another; element -1: none.
  Side across(const Side& from) const {
    const Sides& sides = sides_.at(key(from.element, from.face));
    if (sides.count != 2) return {};
    return sides.of[0].element == from.element ? sides.of[1] : sides.of[0];
  }
  /// Across the element; face -1: none.
  Side opposite(const Side& from) const {
    return {from.element, opposite_face(element_type(blocks_[block_[at(from.element)]].shape), from.face)};
  }
  int size() const { return count_; }

 private:
  struct Sides {
    std::array<Side, 2> of;
    int count = 0;
  };
  FaceKey key(int element, int face) const {
    const std::size_t b = block_[at(element)];
    const ElementBlock& block = blocks_[b];
    const std::vector<int>& local = element_faces(block.shape)[at(face)];
    const int* nodes =
        block.nodes->data() + static_cast<std::ptrdiff_t>(element - first_[b]) * nodes_per_element(block.shape);
    std::array<int, 4> corners = {};
    const int n = facet_corners(static_cast<int>(local.size()));
    for (int k = 0; k < n; ++k) corners[at(k)] = nodes[local[at(k)]];
    return face_key(corners.data(), n);
  }
  const std::vector<ElementBlock>& blocks_;
  std::vector<int> first_;          // per block: number of its first element
  std::vector<std::size_t> block_;  // per element
  int count_ = 0;
  std::unordered_map<FaceKey, Sides, FaceKeyHash> sides_;
};

}  // namespace

ElementColumns element_columns(const std::vector<ElementBlock>& blocks, const std::vector<int>& begin,
                               const std::vector<int>& facet_nodes) {
  ElementColumns columns;
  columns.of_facet.resize(begin.size() - 1);
  columns.whole.assign(begin.size() - 1, 0);
  if (blocks.empty()) return columns;
  const SolidFaces faces(blocks);
  for (std::size_t f = 0; f + 1 < begin.size(); ++f) {
    const int corners = facet_corners(begin[f + 1] - begin[f]);
    if (corners == 0) continue;
    SolidFaces::Side side = faces.only(face_key(facet_nodes.data() + begin[f], corners));
    std::vector<int>& column = columns.of_facet[f];
    while (side.element >= 0 && static_cast<int>(column.size()) < faces.size()) {  // a ring of elements has no end
      column.push_back(side.element);
      side = faces.opposite(side);
      if (side.face < 0) break;
      const SolidFaces::Side next = faces.across(side);
      columns.whole[f] = next.element < 0;
      side = next;
    }
  }
  return columns;
}

}  // namespace dea
