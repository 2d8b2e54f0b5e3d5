// src/springs/posed_bed.h – the layers of a contact as operators, and the contact at a pose: values.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "src/springs/layer_contact.h"
#include "src/springs/part_operator.h"
#include "src/springs/springs.h"

namespace dea {

/// A layer as one contact presses it.
struct BedLayer {
  std::shared_ptr<const LayerOperator> layer;  ///< the same for all contacts that press it; none: a bare rigid surface
  /// Where other contacts press it too, per triangle of the contact's own surface: its number in the layer's face, and
  /// how many corners it is turned there (corner k of the one is corner k + turn of the other). Empty: as they are.
  std::vector<int> triangle;
  std::vector<unsigned char> turn;
  std::vector<char> own;  ///< per triangle of the layer's mesh: of the contact's surface; empty: the pressed ones are
  std::shared_ptr<const PartOperator> part;  ///< what gives way under the surface in a layer's place; none: nothing
  std::vector<int> part_node;                ///< per vertex of the surface: the part's node

  /// The triangle of the layer's mesh at a point of the surface's triangle `t`.
  int mesh_triangle(int t, const Barycentric& w) const;
};

/// The two layers of a contact, or parts, as operators, each on its own mesh: factorised once, whatever the poses.
struct LayerBed {
  BedLayer source, target;
  LayerFeet whole;                   ///< the springs' whole feet on the source's layer
  std::vector<int> source_triangle;  ///< per spring: the triangle of the source's mesh it stands on; bare: empty
  std::vector<FootPair> pairs;       ///< of the springs, between parts without a layer (P4)
  std::vector<char> ends;  ///< per triangle of the source's surface: it ends there, other than in a plane of symmetry
};

/// Tension of a ligament at a length; nothing: it does not act.
using TieLaw = std::function<std::optional<Tension>(int ligament, double length)>;

/// A contact with Law::Layer at a pose.
struct PosedBed {
  const SpringBed* bed = nullptr;  ///< not owned
  Pose source, target;
  Motions motions = kAllMotions;  ///< whose rates are asked for
  bool active = true;             ///< false: it does not press
  const TieLaw* law = nullptr;    ///< not owned; of a bed of ties
};

}  // namespace dea
