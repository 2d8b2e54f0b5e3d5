#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "src/base/decompositions.h"
#include "src/base/numbers.h"
#include "src/base/say.h"
#include "src/facts/parts.h"
#include "src/joint/part.h"

namespace dea {

namespace {

/// An element of a region.
struct RegionElement {
  const Domain& domain;
  std::size_t place;  ///< in the domain
  const int* nodes;
  int count;
  Vector3d at_node(const JointModel& model, int k) const {
    return k >= 0 && k < count ? model.nodes[at(nodes[k])] : Vector3d(Vector3d::Constant(kNaN));
  }
  Vector3d middle(const JointModel& model) const {
    Vector3d sum = Vector3d::Zero();
    for (int k = 0; k < count; ++k) sum += model.nodes[at(nodes[k])] / count;
    return sum;
  }
};

/// The axes of a material in an element: each in those before it, and the element's own take the place of the first.
/// Nothing: they are not known.
std::optional<Eigen::Matrix3d> axes_in(const JointModel& model, const RegionElement& e, const std::vector<Axes>& axes) {
  Eigen::Matrix3d Q = Eigen::Matrix3d::Identity();
  const bool own = !e.domain.axes.empty() && !e.domain.axes[e.place].isZero(0);
  if (own) Q = e.domain.axes[e.place];
  for (std::size_t k = own ? 1 : 0; k < axes.size(); ++k) {
    std::optional<Eigen::Matrix3d> next;
    if (axes[k].by == Axes::By::Nodes) {
      const std::array<int, 3>& nodes = axes[k].nodes;
      const Vector3d from = e.at_node(model, nodes[0]), a = (e.at_node(model, nodes[1]) - from).normalized();
      const Vector3d y = std::abs(a.y()) > 0.999 ? Vector3d::UnitX() : Vector3d::UnitY();
      next = axes_from(a, nodes[2] == nodes[1] ? y : Vector3d(e.at_node(model, nodes[2]) - from));
    } else {
      next = axes_at(axes[k], e.middle(model));
    }
    if (!next) return std::nullopt;
    Q *= *next;
  }
  return Q;
}

/// Along the fibres in an element; nothing: it is not known.
std::optional<Vector3d> fibre_in(const JointModel& model, const RegionElement& e, const Fibres& of) {
  const std::optional<Eigen::Matrix3d> Q = axes_in(model, e, of.axes);
  const Direction& direction = of.direction;
  auto own = e.domain.fibre.find(of.path);
  if (own == e.domain.fibre.end()) own = e.domain.fibre.find("");
  std::optional<Vector3d> v;
  if (of.spread)
    v = Vector3d::UnitX();  // the first of their axes stands for them
  else if (own != e.domain.fibre.end() && !own->second[e.place].isZero(0))
    v = own->second[e.place];
  else if (direction.by == Direction::By::Nodes)
    v = (e.at_node(model, direction.nodes[1]) - e.at_node(model, direction.nodes[0])).normalized();
  else if (direction.by == Direction::By::Element)
    v = e.domain.axes.empty() || e.domain.axes[e.place].isZero(0) ? std::nullopt
                                                                  : std::optional<Vector3d>(Vector3d::UnitX());
  else
    v = direction_at(direction, e.middle(model));
  if (!Q || !v || !(v->norm() > 0.5)) return std::nullopt;  // NaN, too
  return Vector3d(*Q * *v);
}

/// The stiffness of a material's matrix at small strain. InputError: the model does not tell it.
Matrix6d matrix_of(const JointModel& model, const RegionElement& e, const Material& m, const std::string& part) {
  const auto refuse = [&](const std::string& why) {
    throw fault_at(model, m.origin, say("material \"{}\" of part \"{}\": {};", m.name, part, why),
                   say("give {} and {} for one of its surfaces, or take it as rigid with {}", NamedSetting{"E"},
                       NamedSetting{"nu"}, NamedSetting{"rigid", "", m.name}));
  };
  if (m.stiffness.empty() && m.E > 0 && m.nu > -1 && m.nu < 0.5) return isotropic_stiffness(m.E, m.nu);
  if (m.stiffness.empty()) refuse(m.note.empty() ? "neither E and nu nor another stiffness is known of it" : m.note);
  Matrix6d D = Matrix6d::Zero();
  for (const StiffnessInAxes& of : m.stiffness) {
    const auto Q = axes_in(model, e, of.axes);
    if (!Q) refuse("its axes are given in a way that is not read");
    D += turned_stiffness(of.D, *Q);
  }
  return D;
}

/// Nearly incompressible: no element locks yet.
constexpr double kTrapped = 0.499;

/// The stiffness of a material at small strain. InputError: the model does not tell it. Fibres that are not known are
/// left out (fibre_findings tells of them).
Matrix6d elastic_of(const ModelParts& parts, const RegionElement& e, const Material& m, const std::string& part) {
  const JointModel& model = parts.model;
  Matrix6d D = matrix_of(model, e, m, part);
  if (m.fluid && parts.settings.instant) D += trapped_fluid_stiffness(D, kTrapped);
  for (const Fibres& of : m.fibres)
    if (const auto along = fibre_in(model, e, of)) {
      const double modulus = fibre_modulus(of, parts.settings.fibre_strain.value_or(0.0));
      D += of.spread ? turned_stiffness(modulus * *of.spread, *axes_in(model, e, of.axes))
                     : fibre_stiffness(modulus, of.deviatoric, *along);
    }
  return D;
}

/// Does a surface lie on a region?
bool lies_on(const ModelParts& parts, const Surface& s, int region) {
  for (int f = 0; f < s.size(); ++f)
    if (const ElementFace* face = carrier(parts, find_face(parts, s, f));
        face != nullptr && deformable(parts, parts.model.domains[at(face->domain)]))
      return region_of(parts, parts.model.domains[at(face->domain)], face->element) == region;
  return false;
}

/// What the user gives by the names of the part's surfaces: one value. Throws UsageError.
std::optional<double> given_of(const ModelParts& parts, const SoftRegion& soft, const char* setting,
                               const std::map<std::string, double>& given) {
  std::optional<double> of_part;
  for (const auto& entry : given) {
    if (std::none_of(parts.model.surfaces.begin(), parts.model.surfaces.end(),
                     [&](const Surface& s) { return s.name == entry.first && lies_on(parts, s, soft.region); }))
      continue;
    if (of_part && *of_part != entry.second)
      throw UsageError(Fault{.given = NamedSetting{setting, entry.first, fmt::format("{:g}", entry.second)},
                             .found = say("another surface of part \"{}\" has {:g};", soft.name, *of_part),
                             .expected = "expected one value for the part"});
    of_part = entry.second;
  }
  return of_part;
}

/// With the user's E and nu, which are of what is around its fibres.
Material with_given(Material material, std::optional<double> E, std::optional<double> nu) {
  if (E) {
    material.E = *E;
    material.stiffness = {};
  }
  if (nu) material.nu = *nu;
  return material;
}

/// Calls `use(element)` for each element of a region.
template <class Use>
void for_each_element(const ModelParts& parts, int region, const Use& use) {
  for (const Domain& d : parts.model.domains) {
    if (!deformable(parts, d)) continue;
    const int n = nodes_per_element(d.shape);
    for (std::size_t e = 0; e < d.element_ids.size(); ++e)
      if (region_of(parts, d, static_cast<int>(e)) == region) use(RegionElement{d, e, d.nodes.data() + e * at(n), n});
  }
}

/// The body that holds a node of a part, -1: none. Nodes that it shares with a layer are held as that is. InputError:
/// it is held by a third.
int holder_of(const ModelParts& parts, const SoftRegion& soft, int node) {
  const std::vector<int>& holders = parts.holders.of_node[at(node)];
  if (parts.region[at(node)] != soft.region) return soft.body;
  if (holders.empty()) return -1;
  for (const int body : {soft.body, soft.other})
    if (body >= 0 && std::count(holders.begin(), holders.end(), body) > 0) return body;
  const std::vector<Body>& bodies = parts.bodies.bodies;
  throw fault_at(
      parts.model, {0, 0},
      say("part \"{}\" is held by more than two bodies, \"{}\", \"{}\" and \"{}\", which is not modelled;", soft.name,
          bodies[at(soft.body)].name, bodies[at(soft.other)].name, bodies[at(holders.front())].name),
      "hold its nodes by two of them, or fasten it to the third with springs");
}

/// InputError: what holds the part leaves it a rigid motion, as two nodes do.
void check_holds(const JointModel& model, const SoftPart& part) {
  if (part.free()) return;
  const auto held = [&part](int node, int k) {
    return part.holder[at(node)] >= 0 || (part.held[at(node)] >> k & 1) != 0;
  };
  int nodes = 0;
  Vector3d middle = Vector3d::Zero();
  for (int i = 0; i < part.mesh.size(); ++i)
    if (held(i, 0) || held(i, 1) || held(i, 2)) {
      middle += part.mesh.nodes[at(i)];
      ++nodes;
    }
  middle /= std::max(1, nodes);
  const double size = std::max(1e-300, 2 * part.depth);
  Matrix6d resisted = Matrix6d::Zero();
  for (int i = 0; i < part.mesh.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (held(i, k)) {
        Eigen::Matrix<double, 6, 1> motion;
        motion << Vector3d::Unit(k), ((part.mesh.nodes[at(i)] - middle) / size).cross(Vector3d::Unit(k));
        resisted += motion * motion.transpose();
      }
  const Eigen::VectorXd values = symmetric_eigenvalues(resisted);
  if (values.minCoeff() > 1e-9 * values.maxCoeff()) return;
  throw fault_at(model, {0, 0},
                 say("part \"{}\" is held at {} of its {} nodes, which leave it a motion as a whole;", part.name, nodes,
                     part.mesh.size()),
                 say("hold it at three nodes that are not in one line, or take it as rigid with {}",
                     NamedSetting{"rigid", "", part.material}));
}

SoftPart make_part(const ModelParts& parts, const SoftRegion& soft) {
  const JointModel& model = parts.model;
  SoftPart part;
  part.name = soft.name;
  part.material = soft.material;
  part.body = soft.body;
  part.other = soft.other;
  std::vector<int>& nodes_of = part.model_nodes;
  for_each_element(parts, soft.region,
                   [&](const RegionElement& e) { nodes_of.insert(nodes_of.end(), e.nodes, e.nodes + e.count); });
  std::sort(nodes_of.begin(), nodes_of.end());
  nodes_of.erase(std::unique(nodes_of.begin(), nodes_of.end()), nodes_of.end());
  const auto E = given_of(parts, soft, "E", parts.settings.E), nu = given_of(parts, soft, "nu", parts.settings.nu);
  Eigen::AlignedBox3d box;
  for (const int node : nodes_of) {
    part.mesh.nodes.push_back(model.nodes[at(node)]);
    box.extend(model.nodes[at(node)]);
    part.holder.push_back(holder_of(parts, soft, node));
    part.held.push_back(part.holder.back() < 0 ? parts.holders.held_components[at(node)] : 0);
  }
  part.depth = 0.5 * box.sizes().minCoeff();
  for_each_element(parts, soft.region, [&](const RegionElement& e) {
    const Domain& d = e.domain;
    const Material material = with_given(model.materials[at(d.material)], E, nu);
    if (nu && !E && !material.stiffness.empty())
      throw UsageError(Fault{.given = NamedSetting{"nu", "", fmt::format("{:g}", *nu)},
                             .found = say("material \"{}\" of part \"{}\" has another stiffness in each of its axes;",
                                          material.name, part.name),
                             .expected = say("give {} with it", NamedSetting{"E"})});
    if (!has_stiffness(d.shape))
      throw fault_at(
          model, material.origin,
          say("part \"{}\" has elements {}, whose stiffness is not known;", part.name, element_type(d.shape).name),
          "mesh it with hex8, hex20, hex27, penta6, penta15, tet4, tet10, tet15 or pyra5");
    part.mesh.shape.push_back(d.shape);
    part.mesh.material.push_back(d.material);
    part.elements.push_back({static_cast<int>(&d - model.domains.data()), static_cast<int>(e.place)});
    const auto along = material.fibres.empty() ? std::nullopt : fibre_in(model, e, material.fibres.front());
    part.mesh.fibre.push_back(along.value_or(Vector3d::Zero()));
    part.mesh.elastic.push_back(elastic_of(parts, e, material, part.name));
    for (int k = 0; k < e.count; ++k) part.mesh.element_node.push_back(part.node_of(e.nodes[k]));
    part.mesh.begin.push_back(static_cast<int>(part.mesh.element_node.size()));
  });
  check_holds(model, part);
  return part;
}

}  // namespace

Findings fibre_findings(const ModelParts& parts, std::size_t region) {
  const JointModel& model = parts.model;
  const SoftRegion& soft = parts.soft[region];
  std::map<int, std::vector<char>> known;  // per material and fibres: in every element
  for_each_element(parts, soft.region, [&](const RegionElement& e) {
    const Material& m = model.materials[at(e.domain.material)];
    std::vector<char>& of = known.try_emplace(e.domain.material, m.fibres.size(), 1).first->second;
    for (std::size_t k = 0; k < of.size(); ++k)
      of[k] = of[k] && m.fibres[k].law != Fibres::Law::Unknown && fibre_in(model, e, m.fibres[k]);
  });
  Findings findings;
  for (const auto& [material, of] : known)
    for (std::size_t k = 0; k < of.size(); ++k) {
      const Material& m = model.materials[at(material)];
      const Fibres& fibres = m.fibres[k];
      const double strain = parts.settings.fibre_strain.value_or(0.0);
      findings.push_back({"part-fibres",
                          {},
                          {{"part", soft.name},
                           {"material", m.name},
                           {"type", m.type},
                           {"modulus", fibre_modulus(fibres, strain)},
                           {"strain", 100 * strain},
                           {"at_0", fibre_modulus(fibres, 0.0)},
                           {"at_3", fibre_modulus(fibres, 0.03)},
                           {"at_6", fibre_modulus(fibres, 0.06)},
                           {"give", NamedSetting{"fibre-strain", "", "0.03"}}},
                          !of[k]          ? 1
                          : fibres.spread ? 2
                                          : 0});
    }
  return findings;
}

Findings fluid_findings(const ModelParts& parts, std::size_t region) {
  const JointModel& model = parts.model;
  const SoftRegion& soft = parts.soft[region];
  const auto E = given_of(parts, soft, "E", parts.settings.E), nu = given_of(parts, soft, "nu", parts.settings.nu);
  std::map<int, bool> told;
  Findings findings;
  for_each_element(parts, soft.region, [&](const RegionElement& e) {
    const Material m = with_given(model.materials[at(e.domain.material)], E, nu);
    if (!m.fluid || std::exchange(told[e.domain.material], true)) return;
    const Matrix6d drained = matrix_of(model, e, m, soft.name);
    const double K = drained.topLeftCorner<3, 3>().sum() / 9,
                 trapped = trapped_fluid_stiffness(drained, kTrapped)(0, 0);
    findings.push_back({"part-fluid",
                        {},
                        {{"part", soft.name},
                         {"material", m.name},
                         {"type", m.type.substr(0, m.type.find('/'))},
                         {"drained", K},
                         {"trapped", K + trapped},
                         {"give", NamedSetting{"instant"}}},
                        parts.settings.instant ? 1 : 0});
  });
  return findings;
}

std::vector<SoftPart> make_parts(const ModelParts& parts) {
  std::vector<SoftPart> made;
  for (const SoftRegion& soft : parts.soft) made.push_back(make_part(parts, soft));
  return made;
}

}  // namespace dea
