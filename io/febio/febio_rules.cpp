// What FEBio's words mean for DEA.
#include "io/febio/febio_rules.h"

#include <fmt/format.h>

#include <algorithm>

#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/parse.h"
#include "src/base/say.h"
#include "src/base/time_text.h"
#include "src/geometry/surface_mesh.h"
#include "src/model/load_curve.h"

namespace dea::febio {

namespace {

/// Type words in one place of the file: lists with commas.
struct Words {
  const char* told;   ///< that DEA takes and that are worth a mention, in this order
  const char* read;   ///< further ones that DEA takes
  const char* febio;  ///< further ones of FEBio
  const char* otherwise;
};

/// In the order of WordOf.
constexpr Words kWords[] = {
    {"sliding-elastic,sliding-facet-on-facet,sliding-node-on-facet,sliding-biphasic,tied-elastic,tied-node-on-facet,"
     "tied-facet-on-facet,sticky",
     "sliding-biphasic-mixed,sliding-biphasic-solute,sliding-multiphasic,sliding2,sliding3,mortar-sliding,"
     "sliding-tension-compression,facet-to-facet sliding,sliding_with_gaps,sliding,dea,tied-biphasic,tied-multiphasic,"
     "tied,facet-to-facet tied,mortar-tied",
     "periodic boundary,rigid_wall,surface constraint,contact potential,discrete contact,discrete contact2,"
     "edge-to-surface contact potential,edge-to-surface sliding contact,tied-line,rigid sliding",
     "choose one of them where two bones meet, or take this one out"},
    {"rigid spherical joint,rigid revolute joint,rigid prismatic joint,rigid cylindrical joint,rigid planar joint,"
     "rigid lock,generic rigid joint,rigid spring,rigid contractile force,rigid damper,rigid angular damper",
     "rigid joint", "", "choose one of them, or take this one out"},
    {"rigid_fixed,rigid_displacement,rigid_rotation,rigid_rotation_vector,rigid_euler_angles,rigid_force,rigid_moment,"
     "rigid_follower_force,rigid_follower_moment,rigid_axial_force,rigid_cable,nodal_load",
     "nodal_force,initial_rigid_velocity,initial_rigid_angular_velocity,fix,prescribe,force,follower force,"
     "follower moment",
     "", "choose one of them, or take this one out"},
    {"linear spring,tension-only linear spring,nonlinear spring,experimental spring",
     "linear,tension-only linear,nonlinear", "torsion spring,Hill,discrete composite",
     "choose one of them for a ligament, or take the spring out"},
    {"solid,biphasic,solute,multiphasic", "explicit-solid,CG-solid",
     "fluid,fluid-FSI,fluid-solutes,heat,reaction-diffusion,polar "
     "fluid,thermo-fluid,multiphasic-FSI,biphasic-FSI,rigid",
     "all as the solid alone, without flow: make it one of them, or it is no model for DEA"},
    {"zero displacement,prescribed displacement,rigid",
     "zero shell displacement,zero rotation,zero fluid pressure,prescribed fluid pressure,zero concentration,"
     "prescribed concentration,fix,prescribe",
     "prescribed deformation,rigid deformation,linear constraint,normal displacement,prescribed rotation,"
     "prescribed shell displacement",
     "fix the nodes, or fasten them to a rigid body and move that (rigid_displacement, rigid_rotation)"},
};

std::vector<std::string> read_words(const Words& words) {
  return split_words(fmt::format("{},{}", words.told, words.read));
}

}  // namespace

void list_once(std::vector<Remark>& remarks, RemarkIndex& index, const std::string& what, Origin origin,
               const Sentence& advice) {
  const auto [place, is_new] = index.try_emplace(what, remarks.size());
  if (is_new)
    remarks.push_back({what, 1, origin, advice});
  else
    ++remarks[place->second].count;
}

std::vector<int> rigid_material_of_nodes(const JointModel& model) {
  std::vector<int> material(model.nodes.size(), -1);
  for (const RigidNodes& set : model.rigid_nodes)
    for (const int node : set.nodes) material[at(node)] = set.material;
  for (const Domain& domain : model.domains) {
    if (domain.material < 0 || !model.materials[at(domain.material)].rigid) continue;
    for (const int node : domain.nodes) material[at(node)] = domain.material;
  }
  return material;
}

void refuse_moved_rigid_nodes(JointModel& model, RemarkIndex& unsupported) {
  std::vector<PrescribedNodes>& all = model.prescribed_nodes;
  if (all.empty()) return;
  const std::vector<int> body = rigid_material_of_nodes(model);
  const auto rigid_node = [&](const PrescribedNodes& p) {
    return std::find_if(p.nodes.begin(), p.nodes.end(), [&](int n) { return body[at(n)] >= 0; });
  };
  const std::string_view version = model.version;
  for (const PrescribedNodes& p : all) {
    const auto node = rigid_node(p);
    if (node == p.nodes.end()) continue;
    const char dof = static_cast<char>('x' + p.component);
    const std::string how =
        version == "3.0"                       ? "rigid_constraint of type prescribe"
        : version == "2.5" || version == "2.0" ? fmt::format("<prescribed bc=\"{}\"> of its rigid_body in {}", dof,
                                                             version == "2.5" ? "Boundary" : "Constraints")
        : version == "1.2" ? fmt::format("<trans_{} type=\"prescribed\"> of its rigid_body in Constraints", dof)
                           : "rigid_bc of type rigid_displacement";
    const Material& material = model.materials[at(body[at(*node)])];
    list_once(model.unsupported, unsupported,
              fmt::format("prescribed displacement {} of node {} of rigid body {}", quote(p.name),
                          model.node_ids[at(*node)], quote(material.name)),
              p.origin, fmt::format("FEBio refuses it too: prescribe the motion of that body ({})", how));
  }
  all.erase(
      std::remove_if(all.begin(), all.end(), [&](const PrescribedNodes& p) { return rigid_node(p) != p.nodes.end(); }),
      all.end());
}

bool known_module(const std::string& m) {
  return m.empty() || m.find("solid") != m.npos || m == "biphasic" || m == "solute" || m == "multiphasic";
}

std::string analysis_remark(const std::string& module, bool dynamic) {
  if (!dynamic) return "";
  const bool solid = module.empty() || module.find("solid") != std::string::npos;
  return solid ? "analysis DYNAMIC: DEA is quasi-static, inertia is left out"
               : "analysis TRANSIENT: DEA uses the drained solid, fluid flow is left out";
}

std::optional<Contact::Kind> contact_kind(const std::string& type) {
  static const std::vector<std::string> known = read_words(kWords[static_cast<std::size_t>(WordOf::Contact)]);
  if (!one_of(type, known)) return std::nullopt;
  return type == "sticky" || type.find("tied") != type.npos ? Contact::Kind::Tied : Contact::Kind::Sliding;
}

std::string word_advice(WordOf place, const std::string& word) {
  const Words& words = kWords[static_cast<std::size_t>(place)];
  const std::vector<std::string> read = read_words(words);
  // A word of FEBio's own is no slip of the keyboard.
  const bool febio = one_of(word, split_words(words.febio));
  if (!febio && one_of(word, read))
    return fmt::format("{} is a word of another version than the file says; {}", quote(word), words.otherwise);
  const std::string meant = febio ? "" : nearest_name(word, read);
  std::vector<std::string> listed = split_words(words.told);
  if (!meant.empty() && !one_of(meant, listed)) listed.push_back(meant);
  return fmt::format("{}DEA reads {}; {}", meant.empty() ? "" : fmt::format("did you mean {}? ", quote(meant)),
                     name_list(listed, meant, 12), words.otherwise);
}

int plane_axis(const JointModel& model, const Surface& surface) {
  int axis = -1;
  const SurfaceMesh mesh = make_surface_mesh(surface.begin, surface.nodes, model.nodes);
  for (const Vector3d& n : mesh.normals) {
    int here = -1;
    if (!(n.cwiseAbs().maxCoeff(&here) > 1 - 1e-6) || (axis >= 0 && here != axis)) return -1;
    axis = here;
  }
  return axis;
}

Sentence load_advice(const std::string& tag, const std::string& type) {
  const std::string kind = type.empty() ? tag : type;
  const NamedSetting force = {.setting = "force", .of = "BODY", .value = "x,y,z", .bare = true};
  if (tag == "body_load" || tag == "body_force")
    return say(
        "DEA's cartilage has no weight; give that of a bone as a force on its rigid body (rigid force of the file, or "
        "{}), and take this load out",
        force);
  if (tag == "surface_load" || kind.find("pressure") != kind.npos || kind.find("traction") != kind.npos)
    return say(
        "surfaces carry the pressure of contact only; give the load to the rigid body behind them as a force (rigid "
        "force of the file, or {}), and take this one out",
        force);
  const std::string word = word_advice(WordOf::RigidCondition, kind);
  return word.rfind("did you mean", 0) == 0
             ? word
             : "DEA takes loads on rigid bodies and on their nodes: give it as one of these, or take it out";
}

std::vector<ContactParameter> unused_contact_parameters(const std::string& type) {
  const bool unlimited = one_of(type, {"sliding-facet-on-facet", "facet-to-facet sliding", "sliding-node-on-facet",
                                       "sliding_with_gaps", "sliding"});
  std::vector<ContactParameter> unused = {{"fric_coeff", 0},
                                          {"mu", 0},
                                          {"tension", 0},
                                          {"offset", 0},
                                          {"search_radius", unlimited ? 0.0 : 1.0},
                                          {"node_reloc", 0},
                                          {"flip_primary", 0},
                                          {"flip_secondary", 0},
                                          {"shell_bottom_primary", 0},
                                          {"shell_bottom_secondary", 0},
                                          {"offset_shells", 0},
                                          {"contact_frac", 0},
                                          {"max_traction", 0}};
  if (ties_by_search_radius(type))
    std::erase_if(unused, [](const ContactParameter& p) { return std::string_view(p.name) == "search_radius"; });
  return unused;
}

void check_times(LoadController& curve) {
  using Interpolate = LoadController::Interpolate;
  const Interpolate kind = curve.interpolate;
  const bool jumps = kind == Interpolate::Linear || kind == Interpolate::Step || kind == Interpolate::SmoothStep;
  for (std::size_t i = 1; i < curve.points.size() && curve.unsupported.empty(); ++i) {
    const double before = curve.points[i - 1][0], t = curve.points[i][0];
    if (t < before)
      curve.unsupported = fmt::format("times that go back from {} to {}", time_text(before), time_text(t));
    if (t == before && !jumps) curve.unsupported = fmt::format("a smooth curve with time {} twice", time_text(t));
  }
  // FEBio refuses these, with as many points as there are; a smooth curve takes any number.
  const std::size_t least = jumps || kind == Interpolate::Smooth ? 0 : kind == Interpolate::C2Smooth ? 3 : 2;
  if (curve.points.size() < least && curve.unsupported.empty()) {
    curve.unsupported = fmt::format("{} points, interpolation {} needs {}", curve.points.size(),
                                    quote(word_of(kind, kInterpolateWords)), least);
  }
  if (!curve.unsupported.empty() || jumps || curve.points.size() < 2) return;
  try {
    value(curve, (curve.points.front()[0] + curve.points.back()[0]) / 2);
  } catch (const InputError& error) {
    curve.unsupported = error.what();
  }
}

ThicknessText thickness_text(const std::string& type, std::string_view text) {
  text = trim(text);
  if (type == "map") return ThicknessText::Map;
  if (!type.empty()) return type == "const" ? ThicknessText::Number : ThicknessText::Refused;
  if (text.empty()) return ThicknessText::Nothing;
  const bool meant_as_one = text.find_first_not_of("+-.,0123456789") == std::string_view::npos;
  return meant_as_one || whole_double(text) ? ThicknessText::Number : ThicknessText::Map;
}

std::optional<std::vector<SymmetryPlane>> planes_of_text(std::string_view text) {
  std::vector<SymmetryPlane> planes;
  if (trimmed(std::string(text)).empty()) return planes;
  for (const std::string& part : split_at_commas(std::string(text))) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos) return std::nullopt;
    const std::string axis = trimmed(part.substr(0, equals));
    const std::size_t k = axis.size() == 1 ? std::string_view("xyz").find(axis) : std::string_view::npos;
    if (k == std::string_view::npos) return std::nullopt;
    try {
      planes.push_back({static_cast<int>(k), parse_number(trimmed(part.substr(equals + 1)))});
    } catch (const BadValue&) {
      return std::nullopt;
    }
  }
  return planes;
}

std::string text_of_planes(const std::vector<SymmetryPlane>& planes) {
  std::string text;
  for (const SymmetryPlane& plane : planes)
    text += fmt::format("{}{}={}", text.empty() ? "" : ", ", "xyz"[plane.axis], plane.at);
  return text;
}

std::vector<double> must_points(const LoadController& curve, double begin, double end) {
  std::vector<double> times;
  const double close = 1e-9 * (end - begin);
  for (const auto& point : curve.points) {
    if (point[0] > begin + close && point[0] < end + close) times.push_back(std::min(point[0], end));
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

void refuse_unusable_controllers(JointModel& model) {
  for_each_controller(model, [&](int controller, Origin origin) {
    if (controller < 0) return;
    const LoadController& curve = model.controllers[at(controller)];
    if (curve.unsupported.empty()) return;
    model.unsupported.push_back({fmt::format("load controller {} with {}", curve.id, curve.unsupported), 1, origin,
                                 "give its points: type loadcurve, with times that go up"});
  });
}

}  // namespace dea::febio
