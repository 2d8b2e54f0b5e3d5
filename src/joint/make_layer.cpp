#include "src/joint/layer.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/base/value_above.h"
#include "src/geometry/ray_caster.h"
#include "src/geometry/thickness.h"
#include "src/joint/bare_surface.h"
#include "src/joint/compartments.h"
#include "src/joint/contact_side.h"
#include "src/joint/extended_face.h"
#include "src/joint/layer_support.h"

namespace dea {

namespace {

/// Elements of deformable parts.
std::vector<LayerElement> region_elements(const ModelParts& parts, const std::set<int>& regions) {
  std::vector<LayerElement> elements;
  for (int i = 0; i < static_cast<int>(parts.model.domains.size()); ++i) {
    const Domain& d = parts.model.domains[at(i)];
    if (!deformable(parts, d)) continue;
    for (int e = 0; e < static_cast<int>(d.element_ids.size()); ++e)
      if (regions.count(region_of(parts, d, e)) > 0) elements.push_back({i, e});
  }
  return elements;
}

/// A layer in the making.
struct LayerDraft {
  Layer layer;
  LayerBoundary boundary;  // of a layer with elements
};

void refuse_repeated_facet(const ContactSide& in) {
  const Surface& s = in.surface;
  std::map<FaceKey, int> facet_at;
  for (int f = 0; f < s.size(); ++f) {
    const auto first = facet_at.try_emplace(face_key(s.facet(f)), f);
    if (!first.second)
      throw refusal_of(
          in, say("facets {} and {} are the same; its springs would count twice:", first.first->second + 1, f + 1),
          "list each facet once");
  }
}

/// No thickness: what else is missing is told too.
InputError no_thickness(const ContactSide& in, int material, const Sentence& found, const Sentence& expected) {
  InputError error = refusal_of(in, found, expected);
  if (auto modulus = elasticity_fault(in, material, layer_elasticity(in, material))) error.others = {*modulus};
  return error;
}

Sentence name_bone_or_thickness(const ContactSide& in) {
  return say("name the bone surface with {} or give {}", setting_of(in, "bone", "SURFACE"),
             setting_of(in, "thickness"));
}

// ---- facets that are left out --------------------------------------------------------------------------------------

/// Leaves out facets that are no articular face, as the boundary tells them.
void leave_out_facets(const ContactSide& in, const CarriedSurface& carried, const LayerBoundary& boundary,
                      Layer& layer) {
  const Surface& s = in.surface;
  const auto& keep = in.parts.settings.keep_facets;
  std::vector<FaceKind> kinds = kinds_of(boundary, carried.facets);
  const auto of_kind = [&](FaceKind kind) { return std::count(kinds.begin(), kinds.end(), kind); };
  // A block on rollers or held by its sides: no facet looks at the bone. With a thickness given that need not matter.
  const bool all_turned = of_kind(FaceKind::SideWall) == s.size();
  if (std::count(keep.begin(), keep.end(), s.name) > 0 || of_kind(FaceKind::Open) == s.size() ||
      (all_turned && in.given.has_thickness()))
    kinds.clear();
  layer.facet_kinds = kinds;
  if (kinds.empty()) return;
  if (all_turned)
    throw no_thickness(
        in, layer.material,
        say("all its facets ({}) turn away from the bone of body \"{}\", as side walls do: this is no layer of "
            "cartilage on a bone;",
            s.size(), in.parts.bodies.bodies[at(layer.body)].name),
        say("select the articular face, {}", name_bone_or_thickness(in)));
  const std::string why = mostly_left_out(in.parts.model, carried.facets, kinds);
  if (!why.empty())
    throw refusal_of(in, why,
                     say("select the articular face alone, or take all facets as they are with {}",
                         NamedSetting{"keep-facets", "", s.name}));
  const FacetList kept = kept_facets(carried.facets, kinds);
  layer.articular = make_surface_mesh(kept.begin, kept.nodes, in.parts.model.nodes, nullptr, in.in_plane);
  if (facets_of(in.parts.settings, in.contact) == Facets::Flat) flatten(layer.articular);
}

// ---- the bone surface ----------------------------------------------------------------------------------------------

/// Per node: held by the body?
std::vector<char> held_by(const ModelParts& parts, int body) {
  std::vector<char> is_held(parts.model.nodes.size(), 0);
  for (std::size_t i = 0; i < is_held.size(); ++i) {
    const auto& holders = parts.holders.of_node[i];
    is_held[i] = std::find(holders.begin(), holders.end(), body) != holders.end();
  }
  return is_held;
}

/// The named bone surface. Out of the bone means: towards the articular surface.
SurfaceMesh named_bone(const ContactSide& in, const FacetList& bone_facets, const CarriedSurface& carried,
                       const LayerBoundary& boundary, const SurfaceMesh& all_articular) {
  const JointModel& model = in.parts.model;
  SurfaceMesh bone = make_surface_mesh(bone_facets.begin, bone_facets.nodes, model.nodes, nullptr, in.in_plane);
  const FacetList above = kept_facets(carried.facets, kinds_of(boundary, carried.facets));
  SurfaceMesh articular = make_surface_mesh(above.begin, above.nodes, model.nodes);
  if (articular.size() == 0) articular = all_articular;
  const RayCaster caster(articular);
  double towards = 0.0;
  for (int t = 0; t < bone.size(); ++t)
    towards += bone.areas[at(t)] *
               bone.normals[at(t)].dot(position(articular, caster.closest(bone.centroid(t))) - bone.centroid(t));
  return towards < 0 ? turned_round(bone, model.nodes, in.in_plane) : bone;
}

/// A layer on another deformable part, by a tie: what is bonded to bone is that part's other side. Taken for bone
/// itself it would make the layer too thin and too stiff.
void refuse_soft_support(const ContactSide& in, const Support& support) {
  const ModelParts& parts = in.parts;
  if (in.given.has_thickness() || !said_of(parts.settings.bone, in.surface.name).empty()) return;
  for (int region : support.regions) {
    const auto tie = parts.holders.soft_ties.find(region);
    if (tie == parts.holders.soft_ties.end()) continue;
    std::set<int> materials;
    for (const Domain& d : parts.model.domains)
      if (deformable(parts, d) && !d.nodes.empty() && parts.region[at(d.nodes[0])] == tie->second.part)
        materials.insert(d.material);
    std::string names;
    Sentence rigid;
    bool of_layer = false;  // then it cannot be made rigid without the layer
    for (int m : materials) {
      const std::string& name = parts.model.materials[at(m)].name;
      names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", name);
      rigid = rigid.empty() ? say("{}", NamedSetting{"rigid", "", name})
                            : say("{} {}", rigid, NamedSetting{"rigid", "", name});
      of_layer = of_layer || support.materials.count(m) > 0;
    }
    const Sentence one_mesh =
        say("if both are cartilage, mesh them as one layer that shares nodes, or {}", name_bone_or_thickness(in));
    throw refusal_of(in,
                     say("its layer is tied (\"{}\") to a deformable part of material {}, not to bone: it would lie on "
                         "something that gives way;",
                         tie->second.contact, names),
                     of_layer ? one_mesh : say("take that part as bone with {}, or, {}", rigid, one_mesh));
  }
}

/// Finds what the layer is bonded to: boundary and bone surface of the draft.
void find_bone(const ContactSide& in, const CarriedSurface& carried, const std::set<int>& regions, LayerDraft& draft) {
  const ModelParts& parts = in.parts;
  const JointModel& model = parts.model;
  const std::string name = said_of(parts.settings.bone, in.surface.name);
  const int named = name.empty() ? -1 : surface_index(model, name);
  std::vector<char> held = held_by(parts, draft.layer.body);
  if (named >= 0)
    for (int node : model.surfaces[at(named)].nodes) held[at(node)] = 1;
  draft.boundary = find_layer_boundary(model, region_elements(parts, regions), std::move(held));
  open_feather_facets(model, carried.facets, draft.boundary);
  if (!name.empty() && named < 0)
    throw UsageError(Fault{.given = NamedSetting{"bone", in.surface.name, name},
                           .found = no_such_name("surface", name, every_name(model.surfaces))});
  if (named >= 0) {
    draft.layer.bone =
        named_bone(in, carried_surface(parts, named).facets, carried, draft.boundary, draft.layer.articular);
  } else {
    draft.layer.bone = bonded_surface(model, draft.boundary, in.in_plane);
  }
  if (draft.layer.bone.size() > 0)
    find_side_walls(model, draft.layer.bone, draft.boundary);
  else
    find_side_walls(model, carried.facets, draft.boundary);
}

/// Nodes that the bone holds deeper in the layer than its face: the layer ends there, not at the face.
void refuse_held_inside(const ContactSide& in, const std::set<int>& regions, const LayerDraft& draft) {
  const LayerBoundary& boundary = draft.boundary;
  if (in.given.has_thickness() || !said_of(in.parts.settings.bone, in.surface.name).empty()) return;
  const JointModel& model = in.parts.model;
  std::set<int> held;
  for (const LayerElement& e : region_elements(in.parts, regions)) {
    const Domain& d = model.domains[at(e.domain)];
    const int n = nodes_per_element(d.shape);
    for (const auto& face : element_faces(d.shape))  // not centres of faces, which the faces here are without
      for (const int k : face) {
        const int node = d.nodes[at(e.element * n + k)];
        if (boundary.node_held[at(node)]) held.insert(node);
      }
  }
  for (int node : boundary.faces.nodes) held.erase(node);
  if (held.empty()) return;
  throw refusal_of(in,
                   say("{} inside its layer (node {}), held by body \"{}\", away from the layer's faces: it is "
                       "thinner there than the mesh is;",
                       held.size() == 1 ? "1 node is" : fmt::format("{} nodes are", held.size()),
                       model.node_ids[at(*held.begin())], in.parts.bodies.bodies[at(draft.layer.body)].name),
                   say("hold the nodes of its bone face alone, or {}", name_bone_or_thickness(in)));
}

/// No face of the layer is bonded to its body: without a bone surface the thickness must be given.
void do_without_bone(const ContactSide& in, Layer& layer) {
  const NamedSetting bone = setting_of(in, "bone", "SURFACE");
  if (!in.given.has_thickness())
    throw no_thickness(in, layer.material,
                       say("no face of its layer is held by body \"{}\" with all its nodes, so there is no bone "
                           "surface to measure the thickness to;",
                           in.parts.bodies.bodies[at(layer.body)].name),
                       say("name it with {} or give {}", bone, setting_of(in, "thickness")));
  if (layer.springs_at == SpringsAt::Bone)
    throw refusal_of(in, say("{} needs a bone surface;", NamedSetting{"springs-at", "", "bone"}),
                     say("name it with {}", bone));
  layer.bone = layer.articular;
}

// ---- a bare surface of a rigid body, and a layer of elements -------------------------------------------------------

Sentence use_articular_springs() { return say("use {}", NamedSetting{"springs-at", "", "articular"}); }

void finish_bare_surface(const ContactSide& in, Layer& layer) {
  const GivenLayer& given = in.given;
  if (in.contact.dea && !given.has_thickness() && (given.E || given.nu))
    throw unmeasured(in, "it does not lie on solid elements");
  layer.rigid = !given.map && given.nodes == nullptr && given.thickness.value_or(0.0) == 0.0;
  if (!layer.rigid && layer.springs_at == SpringsAt::Bone)
    throw refusal_of(in,
                     "a thickness given for a bare rigid surface lies under that surface, and the bone under "
                     "it is not in the model:",
                     use_articular_springs());
  const bool for_all = in.contact.dea == std::nullopt && in.parts.settings.thickness.count(in.surface.name) == 0;
  if (!layer.rigid && for_all && given.thickness)
    layer.findings.push_back({"cartilage-on-bare-surface",
                              {.surface = in.surface.name, .body = in.parts.bodies.bodies[at(layer.body)].name},
                              {{"thickness", *given.thickness},
                               {"given", NamedSetting{"thickness", "", fmt::format("{:g}", *given.thickness)}}}});
  layer.bone = layer.articular;
}

/// Nodes of deformable parts, ascending, whose elements have volumes (check_volume). `materials`: takes up theirs.
std::vector<int> sound_region(const ContactSide& in, const std::set<int>& regions, std::set<int>& materials) {
  std::set<int> nodes;
  for (const LayerElement& e : region_elements(in.parts, regions)) {
    const Domain& d = in.parts.model.domains[at(e.domain)];
    materials.insert(d.material);
    const int n = nodes_per_element(d.shape);
    for (int k = 0; k < n; ++k) nodes.insert(d.nodes[at(e.element * n + k)]);
    check_volume(in.parts.model, d, e.element);
  }
  return {nodes.begin(), nodes.end()};
}

void finish_bonded_layer(const ContactSide& in, const CarriedSurface& carried, const Support& support,
                         LayerDraft& draft) {
  Layer& layer = draft.layer;
  layer.material = support.main_material();
  std::set<int> materials;
  layer.region_nodes = sound_region(in, support.regions, materials);
  add_once(layer.findings, other_materials(in, layer.material, support.materials, materials));
  refuse_soft_support(in, support);
  find_bone(in, carried, support.regions, draft);
  refuse_held_inside(in, support.regions, draft);
  leave_out_facets(in, carried, draft.boundary, layer);
  if (layer.bone.size() == 0) do_without_bone(in, layer);
  refuse_touching_parts(in, layer);
}

// ---- thickness -----------------------------------------------------------------------------------------------------

/// The articular vertices' values in the user's file. None may be missing: what is between would be guessed.
void take_nodes(const ContactSide& in, Layer& layer) {
  const NodeThickness& said = *in.given.nodes;
  const JointModel& model = in.parts.model;
  if (layer.springs_at == SpringsAt::Bone)
    throw refusal_of(in, "its thickness is given at nodes of the articular surface:", use_articular_springs());
  std::vector<int> missing;
  layer.thickness.clear();
  for (int node : layer.articular.model_nodes) {
    const double* own = thickness_at(said, model.node_ids[at(node)]);
    layer.thickness.push_back(own == nullptr ? 0.0 : *own);
    if (own == nullptr) missing.push_back(model.node_ids[at(node)]);
  }
  if (!missing.empty()) {
    std::sort(missing.begin(), missing.end());
    throw InputError(Fault{.place = said.file,
                           .found = say("found no thickness for {} of the {} nodes of surface \"{}\" ({});",
                                        missing.size(), layer.thickness.size(), in.surface.name, number_list(missing)),
                           .expected = "give one for every node"});
  }
  layer.missed.assign(layer.thickness.size(), 0);
  layer.thickness_given = true;
  layer.thickness_from = said.file;
  if (layer.mean_thickness() > 0) return;
  throw InputError(Fault{.place = said.file,
                         .found = say("found thickness 0 at every node of surface \"{}\";", in.surface.name),
                         .expected = "give the cartilage's"});
}

/// How the user's file was taken.
Finding thickness_from_file(const ContactSide& in) {
  const JointModel& model = in.parts.model;
  std::set<int> own;
  for (int node : in.surface.nodes) own.insert(model.node_ids[at(node)]);
  const auto& said = in.given.nodes->at_node;
  const auto others = std::count_if(said.begin(), said.end(), [&](const auto& e) { return own.count(e.first) == 0; });
  return {"thickness-from-file",
          {.surface = in.surface.name},
          {{"file", in.given.nodes->file},
           {"nodes", said.size() - static_cast<std::size_t>(others)},
           {"passed_over", others}},
          others > 0 ? 1 : 0};
}

void take_map(const ContactSide& in, Layer& layer) {
  if (layer.springs_at == SpringsAt::Bone)
    throw refusal_of(in, "its thickness is a map on the articular surface:", use_articular_springs());
  layer.thickness = mapped_thickness(in.surface, in.contact.dea->layers[in.side].thickness_map, layer.articular);
  layer.missed.assign(layer.thickness.size(), 0);
  layer.thickness_given = true;
  if (!(layer.mean_thickness() > 0))
    throw refusal_of(
        in, "its thickness map is zero everywhere:", say("mend the map, or give {}", NamedSetting{"thickness"}));
}

void take_number(const ContactSide& in, double thickness, Layer& layer) {
  if (!(thickness > 0) || !std::isfinite(thickness))
    throw UsageError(Fault{.given = NamedSetting{"thickness", in.surface.name, fmt::format("{:g}", thickness)},
                           .found = say("surface \"{}\" lies on deformable cartilage,", in.surface.name),
                           .expected =
                               "whose thickness must be > 0; only a surface of a rigid body may have 0, which is no "
                               "cartilage"});
  const std::size_t n = layer.spring_surface().vertices.size();
  layer.thickness.assign(n, thickness);
  layer.missed.assign(n, 0);
  layer.thickness_given = true;
}

void measure(const ContactSide& in, Layer& layer) {
  MeasuredThickness measured = layer.springs_at == SpringsAt::Bone
                                   ? measure_thickness_from_bone(layer.bone, layer.articular)
                                   : measure_thickness(layer.articular, layer.bone);
  layer.thickness = std::move(measured.thickness);
  layer.missed = std::move(measured.missed);
  if (2 * layer.missed_count() > static_cast<int>(layer.missed.size()))
    throw no_thickness(
        in, layer.material,
        say("its normals meet no bone surface of body \"{}\" ({} of {} miss): this is no layer of cartilage on a bone, "
            "and closest points would give it a thickness that means nothing;",
            in.parts.bodies.bodies[at(layer.body)].name, layer.missed_count(), layer.missed.size()),
        name_bone_or_thickness(in));
  if (!(layer.mean_thickness() > 0))
    throw refusal_of(in, "its layer has no thickness: the articular and the bone surface are the same;",
                     name_bone_or_thickness(in));
}

void find_thickness(const ContactSide& in, Layer& layer) {
  if (layer.rigid) {
    layer.thickness.assign(layer.spring_surface().vertices.size(), 0.0);
    layer.missed.assign(layer.thickness.size(), 0);
  } else if (in.given.nodes != nullptr) {
    take_nodes(in, layer);
  } else if (in.given.map) {
    take_map(in, layer);
  } else if (in.given.thickness) {
    take_number(in, *in.given.thickness, layer);
  } else {
    measure(in, layer);
  }
}

/// A bone surface that the user names need not be of the layer's own elements. A gap between them counts as cartilage.
Findings gap_to_named_bone(const ContactSide& in, const CarriedSurface& carried, const LayerBoundary& boundary,
                           const Layer& layer) {
  constexpr double kSame = 0.1;  // of the elements' own thickness
  const std::string name = said_of(in.parts.settings.bone, in.surface.name);
  if (name.empty() || layer.thickness_given) return {};
  const FacetList others = faces_without(boundary, carried.facets);
  const SurfaceMesh outwards =
      make_surface_mesh(others.begin, others.nodes, in.parts.model.nodes, nullptr, in.in_plane);
  if (outwards.size() == 0) return {};
  const MeasuredThickness own =
      measure_thickness(layer.articular, turned_round(outwards, in.parts.model.nodes, in.in_plane));
  std::vector<double> of_elements, measured;
  for (std::size_t v = 0; v < own.thickness.size(); ++v)
    if (!own.missed[v] && own.thickness[v] > 0) of_elements.push_back(own.thickness[v]);  // 0: beside a side wall
  for (std::size_t v = 0; v < layer.thickness.size(); ++v)
    if (!layer.missed[v]) measured.push_back(layer.thickness[v]);
  if (of_elements.empty() || measured.empty()) return {};
  const double thick = value_above(of_elements, 0.5), taken = value_above(measured, 0.5);
  if (std::abs(taken - thick) <= kSame * thick) return {};
  return {{"gap-to-bone",
           {.surface = in.surface.name},
           {{"bone", name}, {"taken", taken}, {"elements", thick}, {"give", setting_of(in, "bone", "SURFACE")}},
           taken > thick ? 0 : 1}};
}

/// Far thicker than the surface is wide: a slip of units or digits, with which numbers end in nothing.
void refuse_too_thick(const ContactSide& in, const Layer& layer) {
  constexpr double kMostThickness = 1000.0;  // of the surface's width
  if (layer.rigid) return;
  Eigen::AlignedBox3d box;
  for (const Vector3d& x : layer.articular.vertices) box.extend(x);
  const double width = box.diagonal().norm();
  if (layer.max_thickness() > kMostThickness * width)
    throw refusal_of(in, say("its thickness is {:g}, and the whole surface {:g} across;", layer.max_thickness(), width),
                     "give it in the model's length");
}

/// The elements of a layer that is rigid with its bone, known by the map that was made of them.
void take_rigid_elements(const ContactSide& in, const CarriedSurface& carried, LayerDraft& draft) {
  Layer& layer = draft.layer;
  const std::vector<double>& map = in.contact.dea->layers[in.side].thickness_map;
  draft.boundary = rigid_boundary(in, carried, layer, map);
  if (draft.boundary.faces.size() == 0) return;
  leave_out_facets(in, carried, draft.boundary, layer);
  layer.bone = layer.articular;
  if (in.given.nodes != nullptr) return take_nodes(in, layer);
  layer.thickness = mapped_thickness(in.surface, map, layer.articular);
  layer.missed.assign(layer.thickness.size(), 0);
}

/// A modulus or Poisson's ratio that the user names for a surface without cartilage.
void refuse_elasticity_of_bare(const ContactSide& in, const Layer& layer) {
  if (!layer.rigid || layer.part >= 0) return;  // a part has its own (make_part.cpp)
  const auto refuse = [&](const char* setting, const std::map<std::string, double>& given) {
    const auto found = given.find(in.surface.name);
    if (found != given.end())
      throw UsageError(
          Fault{.given = NamedSetting{setting, in.surface.name, fmt::format("{:g}", found->second)},
                .found = say("surface \"{}\" is a bare rigid surface, without cartilage;", in.surface.name),
                .expected = say("leave it out, or give a thickness with {}", setting_of(in, "thickness"))});
  };
  refuse("E", in.parts.settings.E);
  refuse("nu", in.parts.settings.nu);
}

/// Thickness times the user's factor, wherever it comes from. The articular surface stays: the bone is taken to lie
/// deeper or less deep, so that gaps between articular surfaces are the mesh's.
void scale_thickness(const ContactSide& in, Layer& layer) {
  if (!in.given.thickness_scale) return;
  const bool named = in.parts.settings.thickness_scale.count(in.surface.name) > 0;
  const NamedSetting setting = {"thickness-scale", named ? in.surface.name : "",
                                fmt::format("{:g}", *in.given.thickness_scale)};
  if (layer.rigid && !named) return;
  if (layer.rigid)
    throw UsageError(Fault{.given = setting,
                           .found = say("surface \"{}\" is {}, without thickness;", in.surface.name,
                                        layer.part >= 0 ? "of a part that gives way" : "a bare rigid surface"),
                           .expected = say("leave it out, or give a thickness with {}", setting_of(in, "thickness"))});
  if (layer.springs_at == SpringsAt::Bone)
    throw UsageError(Fault{.given = setting,
                           .found = "springs at the bone stand on the mesh's bone surface, which stays where it is;",
                           .expected = use_articular_springs()});
  layer.thickness_scale = *in.given.thickness_scale;
  for (double& t : layer.thickness) t *= layer.thickness_scale;
  layer.findings.push_back(
      {"thickness-scaled", {.surface = in.surface.name}, {{"factor", layer.thickness_scale}, {"given", setting}}});
}

/// The surface with the body it moves with.
Layer begin_layer(const ContactSide& in, const CarriedSurface& carried, const Support& support) {
  Layer layer;
  layer.surface = in.index;
  layer.planes = in.planes;
  layer.springs_at = in.parts.settings.springs_at;
  std::vector<int> zero;
  if (carried.turned > 0)
    layer.findings.push_back(
        {"facets-turned", {.surface = in.surface.name}, {{"turned", carried.turned}, {"facets", in.surface.size()}}});
  FacetList facets = carried.facets;
  if (support.regions.empty()) {  // the elements under a map on solids know their own nodes
    BareSurface bare = bare_surface(in, carried, carried.on_shells || !in.given.map);
    facets = std::move(bare.facets);
    layer.turned = std::move(bare.turned);
    layer.stands_for = std::move(bare.stands_for);
    add_once(layer.findings, bare.findings);
  }
  layer.articular = make_surface_mesh(facets.begin, facets.nodes, in.parts.model.nodes, &zero, in.in_plane);
  if (!zero.empty())
    throw refusal_of(in, say("facet {} has no area ({} such facets);", zero.front() + 1, zero.size()),
                     "repair the mesh");
  Attachment attachment = find_attachment(in, support);
  layer.body = attachment.body;
  layer.attached_by = std::move(attachment.by);
  return layer;
}

/// The surface of a part: it has no thickness of its own, and moves with the part.
void finish_part_surface(const ContactSide& in, const Support& support, Layer& layer) {
  layer.rigid = true;
  layer.part = soft_region(in.parts, *support.regions.begin());
  layer.bone = layer.articular;
  layer.springs_at = SpringsAt::Articular;
  std::set<int> materials;
  layer.region_nodes = sound_region(in, support.regions, materials);
}

/// Modulus, thickness and what is beyond the rim, once both surfaces are known.
void finish_layer(const ContactSide& in, const CarriedSurface& carried, bool on_elements, LayerDraft& draft) {
  Layer& layer = draft.layer;
  const Facets facets = facets_of(in.parts.settings, in.contact);
  if (facets == Facets::Flat) {
    flatten(layer.articular);
    flatten(layer.bone);
  }
  for (int node : layer.articular.model_nodes) layer.mirror.push_back(in.parts.holders.held_components[at(node)]);
  if (!layer.rigid) {
    layer.elasticity = layer_elasticity(in, layer.material);
    if (const auto fault = elasticity_fault(in, layer.material, layer.elasticity)) throw InputError(*fault);
  }
  find_thickness(in, layer);
  const bool on_articular = layer.springs_at == SpringsAt::Articular;
  if (!on_elements && in.given.map && on_articular) take_rigid_elements(in, carried, draft);
  if (in.given.nodes != nullptr) layer.findings.push_back(thickness_from_file(in));
  if (on_elements) add_once(layer.findings, gap_to_named_bone(in, carried, draft.boundary, layer));
  refuse_elasticity_of_bare(in, layer);
  scale_thickness(in, layer);
  refuse_too_thick(in, layer);
  if (!layer.rigid && draft.boundary.faces.size() > 0 && on_articular)
    find_layer_face(in, facets, carried, draft.boundary, layer);
}

}  // namespace

Layer make_layer(const ModelParts& parts, const Contact& contact, int side) {
  ContactSide in = contact_side(parts, contact, side);
  find_planes(in);
  const CarriedSurface carried = carried_surface(parts, in.index);
  refuse_repeated_facet(in);
  const Support support = find_support(in, carried);
  const bool on_elements = !support.regions.empty();
  LayerDraft draft{begin_layer(in, carried, support), {}};
  const bool on_part = on_elements && soft_region(parts, *support.regions.begin()) >= 0;
  if (on_part)
    finish_part_surface(in, support, draft.layer);
  else if (on_elements)
    finish_bonded_layer(in, carried, support, draft);
  else
    finish_bare_surface(in, draft.layer);
  finish_layer(in, carried, on_elements && !on_part, draft);
  draft.layer.compartments = find_compartments(parts.model, carried, draft.layer.articular);
  return std::move(draft.layer);
}

}  // namespace dea
