// io/febio/febio_rules.h – what FEBio's words mean for DEA, whoever brings them: a .feb file (io/feb) or
// FEBio's own model (plugin).
#pragma once
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "io/febio/febio_text.h"
#include "src/model/joint_model.h"

namespace dea::febio {

/// Remarks listed once each, with how often they occur.
using RemarkIndex = std::unordered_map<std::string, std::size_t>;
/// `advice`: what to do about it (Remark::advice). Its remark.
void list_once(std::vector<Remark>& remarks, RemarkIndex& index, const std::string& what, Origin origin,
               const Sentence& advice = {});

/// Modules whose mechanics are those of a solid (drained); "" is FEBio's default, solid.
bool known_module(const std::string& module);

/// What is left out of an analysis that is not static: a remark, "" for a static one.
/// `dynamic`: the analysis is the second of its module's kinds (DYNAMIC of a solid, TRANSIENT of the others).
std::string analysis_remark(const std::string& module, bool dynamic);

/// Nothing: a contact we know nothing about.
std::optional<Contact::Kind> contact_kind(const std::string& type);

/// What to do about a type word that DEA does not take, by the place it stands in: the word that may have been meant,
/// and the words that DEA reads.
enum class WordOf { Contact, Connector, RigidCondition, DiscreteMaterial, Module, Boundary };
std::string word_advice(WordOf place, const std::string& word);

/// The axis (0, 1, 2) that a surface is at right angles to: a symmetry plane there holds its nodes in that component.
/// -1: it is curved, or no axis is.
int plane_axis(const JointModel& model, const Surface& surface);
inline constexpr const char* kPlaneAdvice =
    "DEA knows planes of symmetry at right angles to x, y or z, on a surface of the model: turn the model, or hold the "
    "plane's nodes in one component (zero displacement)";

/// What to do about a load that is not on rigid bodies: type "pressure", "const", ... of element `tag`.
Sentence load_advice(const std::string& tag, const std::string& type);

/// Contact parameters that could change the result and that DEA does not use, with FEBio's defaults.
struct ContactParameter {
  const char* name;
  double usual;
};
std::vector<ContactParameter> unused_contact_parameters(const std::string& type);

/// What stands in `<primary_thickness>` or `<secondary_thickness>` of a contact of type dea. `type`: the attribute.
/// Without one it is a number where it can be read as one, or seems to be meant as one (1,8), and else the name of a
/// map.
enum class ThicknessText { Nothing, Number, Map, Refused };
ThicknessText thickness_text(const std::string& type, std::string_view text);

/// Planes of symmetry as a contact of type dea states them: "x=0, y=-12.5". Empty: no plane. Nothing: the text is no
/// such list.
std::optional<std::vector<SymmetryPlane>> planes_of_text(std::string_view text);
/// The numbers read back the same.
std::string text_of_planes(const std::vector<SymmetryPlane>& planes);
/// What is wrong with a text that is no list of planes.
inline constexpr const char* kPlanesExpected = "expected planes across axes, as in \"x=0, y=-12.5\"";

/// FEBio's words, in the order of LoadController::Interpolate and Extend; FEBio also takes the place in this order.
inline constexpr std::initializer_list<const char*> kInterpolateWords = {
    "linear", "step", "smooth", "cubic spline", "control points", "approximation", "smooth step", "C2-smooth"};
inline constexpr std::initializer_list<const char*> kExtendWords = {"constant", "extrapolate", "repeat",
                                                                    "repeat offset"};

/// Times or a number of points that a curve cannot be evaluated with; refused only where the curve is used.
void check_times(LoadController& curve);
/// Times of `curve` inside a step from `begin` to `end` that a result must have.
std::vector<double> must_points(const LoadController& curve, double begin, double end);
/// Calls `f` with the controller and the origin of everything that a controller may scale.
template <class F>
void for_each_controller(JointModel& model, F f) {
  for (auto& c : model.rigid_prescribed) f(c.value.controller, c.origin);
  for (auto& c : model.prescribed_nodes) f(c.value.controller, c.origin);
  for (auto& c : model.rigid_loads) f(c.value.controller, c.origin);
  for (auto& c : model.rigid_followers) f(c.controller, c.origin);
  for (auto& c : model.rigid_axial_forces) f(c.force.controller, c.origin);
  for (auto& c : model.rigid_cables) f(c.force.controller, c.origin);
  for (auto& c : model.rigid_joints) {
    for (Scaled& value : c.value) f(value.controller, c.origin);
  }
  for (auto& c : model.nodal_forces) f(c.controller, c.origin);
  for (auto& c : model.discrete_springs) f(c.scale.controller, c.origin);
}
/// Per node the rigid material that has it, by an element or a rigid node set; -1: none.
std::vector<int> rigid_material_of_nodes(const JointModel& model);
/// Displacements of nodes that differ from node to node: what they are called, and what to do about them.
inline constexpr const char* kMovedApart = "prescribed displacement of nodes that differs from node to node";
inline constexpr const char* kMovedApartAdvice =
    "DEA moves rigid bodies only: prescribe the motion of the body that holds these nodes";
/// Takes the prescribed displacements out that move nodes of rigid bodies, and lists them as unsupported: FEBio refuses
/// them.
void refuse_moved_rigid_nodes(JointModel& model, RemarkIndex& unsupported);
/// Lists as unsupported every use of a controller that cannot be evaluated.
void refuse_unusable_controllers(JointModel& model);

}  // namespace dea::febio
