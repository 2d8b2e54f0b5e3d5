// io/feb/feb_reading.h – what is known while a .feb file is read, and the parts every version shares.
//
// A version of the format is a `Rules`: what its sections mean. To add a version, add one file with its
// rules and list it in read_feb.cpp.
#pragma once
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "feb_xml.h"
#include "joint_model.h"

namespace dea::feb {

struct Reading;
using SectionReader = void (*)(Reading&, const XMLElement& section);

/// What differs between the versions.
struct Rules {
  const char* version;
  bool nested_k_adds;  ///< the k of nested uncoupled materials is added to the top-level k
  SectionReader boundary;
  SectionReader rigid;  ///< the Rigid section; null: the version has none
  SectionReader constraints;
};
extern const Rules kRules25;
extern const Rules kRules30;
extern const Rules kRules40;

/// Ids of nodes or elements, in file order. Costs nothing while they increase, as FEBio writes them.
class IdTable {
 public:
  bool add(int id);        ///< false: there already
  int find(int id) const;  ///< index in file order; -1: unknown
  int size() const { return static_cast<int>(ids_.size()); }
  std::vector<int> take() { return std::move(ids_); }

 private:
  std::vector<int> ids_;
  std::unordered_map<int, int> index_;  ///< only used once an id does not increase
};

struct SurfacePair {
  int primary = -1, secondary = -1;  ///< index of a surface
  std::string unsupported;           ///< a surface we cannot build, if any
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

struct DiscreteMaterial {
  std::string type;
  double stiffness = 1.0;
  std::string unsupported;
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

struct Reading {
  JointModel model;
  const Rules* rules = nullptr;  ///< of the file being read
  int file = 0;                  ///< index into model.files

  std::vector<std::string> open_files;  ///< canonical paths, from the model to the include being read
  std::string main_folder;
  int files_read = 0;

  IdTable nodes, elements;
  std::vector<int> first_element;  ///< per domain: index of its first element in `elements`
  std::vector<NodeRange> node_ranges;
  std::map<std::string, int, std::less<>> surface_index, node_set_index, element_set_index, discrete_set_index,
      material_index;
  std::map<std::string, std::vector<int>, std::less<>> domain_index;  ///< by name; 2.5 may repeat a name
  std::map<std::string, std::vector<std::string>, std::less<>> part_lists;
  std::map<std::string, std::vector<int>, std::less<>> edges;  ///< nodes of an Edge
  std::set<std::string> ambiguous_node_sets;                   ///< names with two different node lists
  std::size_t set_entries = 0;                                 ///< nodes and elements listed by sets so far
  std::map<std::string, SurfacePair, std::less<>> surface_pairs;
  std::vector<DiscreteMaterial> discrete_materials;
  std::vector<SurfaceMap> surface_maps;
  std::vector<MapUse> map_uses;

  Control top_control;            ///< of the model; the first step starts from it
  std::vector<Control> controls;  ///< one per step
  int step = -1;                  ///< the step a section belongs to
  Control& control() { return step < 0 ? top_control : controls[static_cast<std::size_t>(step)]; }

  febio::RemarkIndex ignored_index, unsupported_index;
};

// -- places and faults -----------------------------------------------------------------------------

Origin origin_of(const Reading& reading, const XMLElement& element);
[[noreturn]] void fail(const Reading& reading, const XMLElement& element, const std::string& fault);
/// Harmless: listed once with a count.
void ignore(Reading& reading, const XMLElement& element, const std::string& what);
void ignore(Reading& reading, Origin origin, const std::string& what);
/// Changes the mechanics and cannot be taken into account: listed once with a count.
void unsupported(Reading& reading, const XMLElement& element, const std::string& what);

// -- values ----------------------------------------------------------------------------------------

/// The attribute, or a fault naming it.
std::string need_attribute(const Reading& reading, const XMLElement& element, const char* name);
double read_double(const Reading& reading, const XMLElement& element);
int read_int(const Reading& reading, const XMLElement& element);
bool read_bool(const Reading& reading, const XMLElement& element);
Vector3d read_vector(const Reading& reading, const XMLElement& element);
/// The id of the element's `lc`, 0: none.
int read_lc(const Reading& reading, const XMLElement& element);
/// A number with an optional `lc`; its `controller` holds the id (0: none) until all is read.
Scaled read_scaled(const Reading& reading, const XMLElement& element);
/// The position of the element's word in `words`; FEBio also takes the position itself. -1: none of them.
int read_word(const XMLElement& element, std::initializer_list<const char*> words);
/// Child elements by name; `fallback` if there is none.
double child_double(const Reading& reading, const XMLElement& parent, const char* name, double fallback);
bool child_bool(const Reading& reading, const XMLElement& parent, const char* name, bool fallback);
std::string child_text(const XMLElement& parent, const char* name);

// -- references ------------------------------------------------------------------------------------

/// Index of the node with this id, or a fault.
int need_node(const Reading& reading, const XMLElement& element, int id);
/// Nodes of a node set, of a named Nodes section or of an implicit set ("@surface:NAME").
std::vector<int> need_node_set(Reading& reading, const XMLElement& element, const std::string& name);
/// A rigid material by id or name, or a fault.
int need_rigid(const Reading& reading, const XMLElement& element, const std::string& id_or_name);

// -- shared sections -------------------------------------------------------------------------------

void read_mesh(Reading& reading, const XMLElement& section);  // Geometry or Mesh
void read_mesh_domains(Reading& reading, const XMLElement& section);
void read_mesh_data(Reading& reading, const XMLElement& section);
/// Thickness maps of contacts of type dea; the other maps are ignored. When every section has been read.
void resolve_surface_maps(Reading& reading);
void read_materials(Reading& reading, const XMLElement& section);
void read_contact(Reading& reading, const XMLElement& section);
void read_discrete(Reading& reading, const XMLElement& section);
void read_loads(Reading& reading, const XMLElement& section);
void read_initial(Reading& reading, const XMLElement& section);
void read_constraints(Reading& reading, const XMLElement& section);
void read_control(Reading& reading, const XMLElement& section);
void read_load_data(Reading& reading, const XMLElement& section);

// -- shared conditions, used by the rules of the versions -------------------------------------------

/// Holds nodes in the listed dofs ("x,y,z" or "xyz"); others than displacements are ignored.
void fix_nodes(Reading& reading, const XMLElement& element, std::string_view dofs);
/// A prescribed nodal dof: zero is a fixed node, anything else is unsupported.
void prescribe_nodes(Reading& reading, const XMLElement& element, std::string_view dof, const XMLElement* value);
/// Nodes of the element's `node_set` move with a body.
void rigid_nodes(Reading& reading, const XMLElement& element, const std::string& body);
/// rigid_bc, rigid_load, rigid_ic of 4.0; false: not one of them.
bool rigid_condition(Reading& reading, const XMLElement& element, const std::string& type);
/// Any rigid connector of any version; false: not one.
bool rigid_connector(Reading& reading, const XMLElement& element, const std::string& type);
/// Position of a dof name in `names`, or the number itself; a fault otherwise.
int read_dof(const Reading& reading, const XMLElement& element, std::string_view word,
             std::initializer_list<const char*> names);
/// True if the loads of the element are numbers and all zero.
bool is_zero_load(const XMLElement& element);

/// Load controllers by id, steps and must points: when every section has been read.
void finish(Reading& reading);

}  // namespace dea::feb
