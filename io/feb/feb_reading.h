// io/feb/feb_reading.h – what is known while a .feb file is read, and the parts every version shares.
//
// A version of the format is a `Rules`: what its sections mean. To add a version, list its rules in read_feb.cpp.
#pragma once
#include <fmt/format.h>

#include <array>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "io/feb/feb_xml.h"
#include "io/febio/component.h"
#include "io/febio/interpret.h"
#include "io/febio/known_words.h"
#include "src/base/names.h"
#include "src/model/joint_model.h"

namespace dea::feb {

struct Reading;
struct Rules;
using SectionReader = void (*)(Reading&, const XMLElement& section);

/// What reads the elements of one tag.
struct TagReader {
  const char* tag;
  SectionReader read;
};

/// Ids of nodes or elements, in file order. Costs nothing while they increase, as FEBio writes them.
class IdTable {
 public:
  bool add(int id);        ///< false: there already
  int find(int id) const;  ///< index in file order; -1: unknown
  int size() const { return static_cast<int>(ids_.size()); }
  int largest() const { return largest_; }
  std::vector<int> take() { return std::move(ids_); }

 private:
  std::vector<int> ids_;
  int largest_ = 0;
  std::unordered_map<int, int> index_;  ///< only used once an id does not increase
};

struct SurfacePair {
  int primary = -1, secondary = -1;  ///< index of a surface
};

/// A run of consecutive nodes: a named `Nodes` section.
struct NodeRange {
  std::string name;
  int begin = 0, end = 0;
};

struct Control {
  std::string name;
  double time_steps = 10, step_size = 0.1;
  std::optional<double> final_time;
  int dtmax_controller = 0;  ///< id, 0: none
  Origin dtmax_origin;
  Origin origin;
};

/// Springs whose force is a load curve, resolved when all is read.
struct FunctionUse {
  int springs = -1;  ///< index into JointModel::discrete_springs
  int id = 0;
  double scale = 1.0;
};

/// (domain, element in it).
struct ElementPlace {
  int domain = 0;
  int index = 0;
};

/// A part of a mesh that is used by instances of it (2.5). The element lives in `documents` or in the model's own file.
struct Part {
  const XMLElement* element = nullptr;
  int file = 0;
};

/// While an instance of a part is read: its names, numbers and position.
struct Instance {
  std::string prefix;  ///< of all names
  IdTable nodes;       ///< by the part's own ids
  int first_node = 0;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Vector3d scale = Vector3d::Ones(), translation = Vector3d::Zero();  ///< x = turn (scale * X) + translation
  std::map<std::string, std::string, std::less<>> materials;          ///< of Elements, in place of the part's
};

/// Values on a surface, a `SurfaceData`: used if a contact of type dea names it, and only then its faults matter.
struct SurfaceMap {
  std::string name;
  int surface = -1;            ///< index of a surface; -1: see `fault`
  std::vector<double> values;  ///< one per entry of Surface::nodes
  std::string what;            ///< how `ignored` calls it
  std::string fault;           ///< not empty: why it cannot be used
  Origin origin, fault_origin;
  bool used = false;
};

/// A layer of a contact of type dea whose thickness is a map, resolved when all is read.
struct MapUse {
  int contact = -1, side = 0;
  std::string name;
  Origin origin;
};

struct Reading : febio::Draft {
  const Rules* rules = nullptr;  ///< of the file being read
  int file = 0;                  ///< index into model.files

  std::vector<std::string> open_files;  ///< canonical paths, from the model to the include being read
  std::string main_folder;
  int files_read = 0;

  IdTable nodes, elements;
  std::vector<int> first_element;            ///< per domain: index of its first element in `elements`
  std::vector<ElementPlace> element_places;  ///< 1.2 only, where domains are mixed: by index in `elements`
  std::map<std::string, Part, std::less<>> parts;
  Instance* instance = nullptr;                         ///< being read; null: none
  int copied = 0;                                       ///< nodes and elements of all instances so far
  std::vector<std::unique_ptr<XMLDocument>> documents;  ///< other files that parts are in
  std::vector<NodeRange> node_ranges;
  std::map<std::string, int, std::less<>> surface_index, node_set_index, element_set_index, discrete_set_index,
      material_index;
  std::map<std::string, std::vector<int>, std::less<>> domain_index;  ///< by name; 2.5 may repeat a name
  std::map<std::string, std::vector<std::string>, std::less<>> part_lists;
  std::map<std::string, std::vector<int>, std::less<>> edges;  ///< nodes of an Edge
  std::set<std::string> ambiguous_node_sets;                   ///< names with two different node lists
  std::size_t set_entries = 0;                                 ///< nodes and elements listed by sets so far
  std::map<std::string, SurfacePair, std::less<>> surface_pairs;
  std::set<std::string> connector_names;                                    ///< read so far, of any kind
  std::map<std::string, std::vector<std::size_t>, std::less<>> moments_of;  ///< a joint's entries of rigid_loads
  std::vector<febio::DiscreteMaterial> discrete_materials;
  std::vector<SurfaceMap> surface_maps;
  std::vector<MapUse> map_uses;
  std::vector<FunctionUse> function_uses;

  Control top_control;            ///< of the model; the first step starts from it
  std::vector<Control> controls;  ///< one per step
  int step = -1;                  ///< the step a section belongs to
  Control& control() { return step < 0 ? top_control : controls[at(step)]; }
};

// -- places and faults -----------------------------------------------------------------------------

Origin origin_of(const Reading& reading, const XMLElement& element);
[[noreturn]] void fail(const Reading& reading, const XMLElement& element, const std::string& fault);
/// Harmless: listed once with a count.
void ignore(Reading& reading, const XMLElement& element, const std::string& what);
/// Changes the mechanics and cannot be taken into account: listed once with a count.
/// `advice`: what to do about it; empty: take it out.
void unsupported(Reading& reading, const XMLElement& element, const std::string& what, const Sentence& advice = {});
/// A type word that DEA does not take.
void unsupported_word(Reading& reading, const XMLElement& element, const std::string& what, febio::WordOf place,
                      const std::string& word);
/// The element by the reader of its tag; false: there is none.
bool read_child(Reading& reading, const XMLElement& element, std::span<const TagReader> readers);
/// Each child of a section by the reader of its tag; children of no tag in the table by `others`, or as unsupported,
/// with the tags that are expected.
void read_children(Reading& reading, const XMLElement& section, std::span<const TagReader> readers,
                   SectionReader others = nullptr);
/// Each child of a section by one reader.
template <SectionReader Read>
void read_each(Reading& reading, const XMLElement& section) {
  read_children(reading, section, {}, Read);
}
/// A child that does not change the joint: ignored.
void pass_over(Reading& reading, const XMLElement& child);
/// " (did you mean "hip"?); the model has "hip", "knee"" for a name that is not among the keys of `index`.
template <class Index>
std::string those_there(const std::string& name, const Index& index) {
  std::vector<std::string> names;
  for (const auto& entry : index) names.push_back(entry.first);
  return did_you_mean(name, names) + "; the model has " + name_list(names, name);
}

/// The attribute, or a fault naming it.
std::string need_attribute(const Reading& reading, const XMLElement& element, const char* name);
/// The entry of `index` with this name, or a fault. `what`: what names it, "surface ="; `kind`: what is meant,
/// "Surface".
template <class Index>
auto need_entry(const Reading& reading, const XMLElement& element, const std::string& what, const std::string& name,
                const char* kind, const Index& index) {
  const auto entry = index.find(name);
  if (entry == index.end())
    fail(reading, element,
         fmt::format("{} {}, expected the name of a {}{}", what, quote(name), kind, those_there(name, index)));
  return entry->second;
}
/// The same of what an attribute names, which must be there.
template <class Index>
auto need_named(const Reading& reading, const XMLElement& element, const char* attribute_name, const char* kind,
                const Index& index) {
  return need_entry(reading, element, fmt::format("{} =", attribute_name),
                    need_attribute(reading, element, attribute_name), kind, index);
}
/// Adds an entry, whose name must be new; `what`: what it is, "surface". The entry.
template <class Index>
auto& add_named(const Reading& reading, const XMLElement& element, Index& index, const std::string& name,
                typename Index::mapped_type value, const char* what) {
  const auto [place, is_new] = index.emplace(name, std::move(value));
  if (!is_new) fail(reading, element, fmt::format("{} {} exists twice: rename one", what, quote(name)));
  return place->second;
}

// -- values ----------------------------------------------------------------------------------------

double read_double(const Reading& reading, const XMLElement& element);
int read_int(const Reading& reading, const XMLElement& element);
Vector3d read_vector(const Reading& reading, const XMLElement& element);
/// Refuses an attribute that may be meant for one that changes what the element says: LC, typ. FEBio passes over it.
void check_attributes(const Reading& reading, const XMLElement& element);
/// The id of the element's `lc`, 0: none.
int read_lc(const Reading& reading, const XMLElement& element);
/// A number with an optional `lc`; its `controller` holds the id (0: none) until all is read.
Scaled read_scaled(const Reading& reading, const XMLElement& element);
/// An element with its children, as it stands; without lists of nodes and facets (`node`, `surface`), which may be long
/// and are read by themselves. A curve's `points` may have any name.
febio::Component component_of(const Reading& reading, const XMLElement& element);
/// The same, its parameters compared with FEBio's.
febio::Component checked(Reading& reading, febio::Place place, const XMLElement& element);
/// The steps of what is read now.
febio::Steps steps_of(const Reading& reading);
/// The text of a child; "": there is none.
std::string child_text(const XMLElement& parent, const char* name);
/// Two node ids "n1,n2" as indices.
std::array<int, 2> read_node_pair(const Reading& reading, const XMLElement& element, const std::string& what);

// -- references ------------------------------------------------------------------------------------

/// Index of the node with this id, within an instance by the part's ids; -1: none.
int find_node(const Reading& reading, int id);
/// A name as it is called in the model: within an instance with its prefix.
std::string full_name(const Reading& reading, const std::string& name);
/// Index of the node with this id, or a fault.
int need_node(const Reading& reading, const XMLElement& element, int id);
/// Index of the node that a `<node id="">` names, or a fault.
int need_listed_node(const Reading& reading, const XMLElement& element);
/// Nodes of a node set, of a named Nodes section or of an implicit set ("@surface:NAME").
std::vector<int> need_node_set(Reading& reading, const XMLElement& element, const std::string& name);
/// A rigid material by id or name, or a fault.
int need_rigid(const Reading& reading, const XMLElement& element, const std::string& id_or_name);
/// Place of the element with this id; nothing: none.
std::optional<ElementPlace> find_element(const Reading& reading, int id);
/// Nodes of `node_set` (`set` in older files), or listed as children.
std::vector<int> nodes_of(Reading& reading, const XMLElement& element);

// -- shared sections -------------------------------------------------------------------------------

void read_mesh(Reading& reading, const XMLElement& section);  // Geometry or Mesh
void read_nodes(Reading& reading, const XMLElement& section);
void read_elements(Reading& reading, const XMLElement& section);
void read_node_set(Reading& reading, const XMLElement& section);
/// The facets of a surface, under that name; those of other surfaces it lists too. Its index.
int read_surface(Reading& reading, const XMLElement& section, const std::string& name, bool element_faces = false);
/// A surface under its own name, within an instance with the instance's prefix.
void read_named_surface(Reading& reading, const XMLElement& section);
/// The shape of a type of element, or a fault.
ElementShape need_shape(const Reading& reading, const XMLElement& element, const std::string& type);
/// Appends an element's nodes; `what` makes its name for a message.
void append_element(const Reading& reading, const XMLElement& element, const std::string& type, int id, Domain& domain);
/// A positive whole number.
int read_id(const Reading& reading, const XMLElement& element, const char* name = "id");
/// Shell thickness of one element or set of elements, in Geometry.
void read_element_data(Reading& reading, const XMLElement& element);
// feb_parts.cpp: parts of a mesh and their instances.
void read_part(Reading& reading, const XMLElement& element);
void read_instance(Reading& reading, const XMLElement& element);
/// The part of this name in the file that the element's `from` names.
const Part& find_part_in_file(Reading& reading, const XMLElement& element, const std::string& name);
void read_mesh_domains(Reading& reading, const XMLElement& section);
void read_mesh_data(Reading& reading, const XMLElement& element);
/// Thickness maps of contacts of type dea; the other maps are ignored. When every section has been read.
void resolve_surface_maps(Reading& reading);
void read_materials(Reading& reading, const XMLElement& section);
void read_discrete(Reading& reading, const XMLElement& section);
void read_contact(Reading& reading, const XMLElement& element);  ///< one of the section's, as those below
void read_rigid(Reading& reading, const XMLElement& element);    ///< 3.0 and later
void read_load(Reading& reading, const XMLElement& element);
void read_initial(Reading& reading, const XMLElement& element);
void read_constraint(Reading& reading, const XMLElement& element);
void read_load_data(Reading& reading, const XMLElement& element);
void read_control(Reading& reading, const XMLElement& section);
/// Springs of this material between the pairs of a discrete set.
void add_springs(Reading& reading, const XMLElement& element, const febio::DiscreteMaterial& material, int set);
/// When every section has been read: springs whose force is a load curve.
void resolve_functions(Reading& reading);

// -- the versions ------------------------------------------------------------------------------------

/// The readers of a section's children, as in read_children.
struct SectionRules {
  std::span<const TagReader> readers = {};
  SectionReader others = nullptr;
};
/// What differs between the versions. What a version does not say is as in the latest.
struct Rules {
  const char* version;
  /// 2.5 and before: the k of nested uncoupled materials is added to the top-level k, each `<Step>` is one step
  /// (otherwise `<Step>` has `<step>` children), Elements may repeat a name, and there is no section Rigid.
  bool up_to_25 = false;
  bool unique_materials = true;    ///< no two materials of one name
  SectionReader mesh = read_mesh;  ///< Geometry or Mesh
  SectionRules boundary;
  SectionRules contact = {.others = read_contact};
  SectionRules constraints = {.others = read_constraint};
  SectionRules loads = {.others = read_load};
  SectionReader discrete = read_discrete;
};
extern const Rules kRules12;
extern const Rules kRules20;
extern const Rules kRules25;
extern const Rules kRules30;
extern const Rules kRules40;

// -- shared conditions, used by the rules of the versions -------------------------------------------

/// Which nodes a condition is on, what it is called and where it stands: those of its node set or listed inside.
febio::OnNodes on_nodes(Reading& reading, const XMLElement& element);
febio::OnNodes on_nodes(const Reading& reading, const XMLElement& element, std::vector<int> nodes);
/// Displaces the element's nodes by a child's number.
void prescribe_nodes(Reading& reading, const XMLElement& element, std::string_view dof, const char* value);
/// Nodes of the element's `node_set` move with a body.
void rigid_nodes(Reading& reading, const XMLElement& element, const std::string& body);
/// Any rigid connector of any version; false: not one.
bool rigid_connector(Reading& reading, const febio::Component& component);
void read_axial_force(Reading& reading, const XMLElement& element);
/// A contact of known kind between two surfaces.
void add_contact(Reading& reading, const XMLElement& element, int primary, int secondary);

/// Load controllers by id, steps and must points: when every section has been read.
void complete_model(Reading& reading);

/// The place of a name in one of the indices; -1: it is not there.
int find_name(const std::map<std::string, int, std::less<>>& index, const std::string& name);

}  // namespace dea::feb
