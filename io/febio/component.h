// io/febio/component.h – an element of FEBio's as a value: what a .feb file says (io/feb), or what FEBio's own
// model would say if it were written to one (plugin). What it means stands in interpret.h.
#pragma once
#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "io/febio/febio_rules.h"
#include "src/model/joint_model.h"

namespace dea::febio {

/// A condition, load, joint or material; a parameter of one; a part of one.
struct Component {
  std::string tag;   ///< "rigid_load"; of a parameter its name: "value"
  std::string type;  ///< FEBio's word: "rigid_force"; of a parameter what gives its values: "", "const", "math", "map"
  std::string name;
  std::string text;               ///< of a parameter: its value as in a file, "1,2,3"; of a map or expression any text
  std::optional<std::string> lc;  ///< of a parameter: the id of the load controller that scales it, as in a file
  std::vector<Component> parts;   ///< parameters and parts, in order; a parameter that is absent has FEBio's default
  Origin origin;                  ///< {0, 0}: in no file

  const std::string& type_or_tag() const { return type.empty() ? tag : type; }
};

/// A model while it is filled, and where its remarks are. Controllers are stored by their ids, 0 or -1 for none, until
/// resolve_controllers.
struct Draft {
  JointModel model;
  RemarkIndex ignored_index, assumed_index, unsupported_index;
  std::vector<std::size_t> old_fixes;  ///< of model.rigid_fixed: as files before 4.0 fix (hold_from_the_start)
  std::set<std::string, std::less<>> ambiguous_materials;  ///< names of several materials
};

// -- faults and remarks ------------------------------------------------------------------------------

/// Throws InputError at this place.
[[noreturn]] void fail(const Draft& draft, Origin origin, const std::string& fault);
/// Harmless: listed once with a count.
void ignore(Draft& draft, Origin origin, const std::string& what);
/// What the file says and FEBio takes otherwise: listed once with a count.
void note(Draft& draft, Origin origin, const std::string& what);
/// FEBio's default where the file says nothing, if a user may have forgotten it: listed once with a count.
/// "rigid spring without <k>: 1, as in FEBio".
void assume(Draft& draft, Origin origin, std::string_view owner, std::string_view tag, std::string_view value);
/// The same, if the component has no such part.
void assume_unless_given(Draft& draft, const Component& component, std::string_view tag, std::string_view value);
/// Changes the mechanics and cannot be taken into account: listed once with a count. `advice`: what to do about it;
/// empty: take it out.
void unsupported(Draft& draft, Origin origin, const std::string& what, const Sentence& advice = {});

// -- values from text: `name` is how a fault calls it -------------------------------------------------

double to_number(const Draft& draft, Origin origin, std::string_view name, std::string_view text);
int to_whole_number(const Draft& draft, Origin origin, std::string_view name, std::string_view text);
/// 0 or 1: FEBio reads the word "true" as 0; rather a fault than to follow it or to guess.
bool to_flag(const Draft& draft, Origin origin, std::string_view name, std::string_view text);
Vector3d to_vector(const Draft& draft, Origin origin, std::string_view name, std::string_view text);
/// The id of a load controller.
int to_controller(const Draft& draft, Origin origin, std::string_view name, std::string_view lc);
/// The position of a word in `words`; FEBio also takes the position itself. -1: none of them.
int place_of_word(std::string_view word, std::initializer_list<const char*> words);
/// The same, or a fault that lists them: "<rigid_load> with dof "Q", expected one of x, y, z". `tag`: the element's.
int need_place_of_word(const Draft& draft, Origin origin, std::string_view tag, std::string_view word,
                       std::initializer_list<const char*> words);
/// Index of the rigid material with this id or name. A text that is a number is an id first.
int need_rigid(const Draft& draft, Origin origin, std::string_view id_or_name);
/// Index of the material with this id, -1: none, or the text is no number.
int material_of_id(const Draft& draft, std::string_view id);
/// Index of the material of this name, -1: none; a fault if several have it.
int find_material(const Draft& draft, Origin origin, std::string_view name);

// -- parts of a component ----------------------------------------------------------------------------

/// The first part of this name; null: there is none.
const Component* find(const Component& component, std::string_view tag);
double number_of(const Draft& draft, const Component& component, std::string_view tag, double fallback);
bool flag_of(const Draft& draft, const Component& component, std::string_view tag, bool fallback = false);
/// A constant vector. One that follows a load controller is unsupported.
Vector3d vector_of(Draft& draft, const Component& component, std::string_view tag, const Vector3d& fallback);
std::string text_of(const Component& component, std::string_view tag);
/// The id of a parameter's load controller, 0: none.
int controller_of(const Draft& draft, const Component& parameter);
/// A parameter with its load controller; the second: 0 if there is none of this name.
Scaled scaled(const Draft& draft, const Component& parameter);
Scaled scaled_of(const Draft& draft, const Component& component, std::string_view tag);
/// The rigid material that a part names.
int body_of(const Draft& draft, const Component& component, std::string_view tag = "rb");

// -- load controllers --------------------------------------------------------------------------------

/// Interpolation, way to extend and points from the parts `interpolate`, `extend` and `points`.
void read_curve(const Draft& draft, const Component& component, LoadController& curve);
/// A word of FEBio's, or its place; what is none is told in `unsupported` of the curve.
void set_interpolate(LoadController& curve, std::string_view word);
void set_extend(LoadController& curve, std::string_view word);
/// An expression in t; one with variables of its own, which are numbers of FEBio's model, is told in `unsupported`.
void set_expression(LoadController& curve, std::string_view math, bool own_variables);
/// "t,v" as the next point.
void add_point(const Draft& draft, Origin origin, std::string_view text, LoadController& curve);
/// Index of the load controller with this id; -1 for 0 and -1. A fault at `origin` if there is none.
int need_controller(const JointModel& model, int id, Origin origin);
/// Ids of load controllers become indices, once all have been read.
void resolve_controllers(JointModel& model);

}  // namespace dea::febio
