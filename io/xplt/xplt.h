// io/xplt/xplt.h – FEBio's binary plot file as plain structs: write it, read it.
// Format: docs/formats.md. Version 0x35. All numbers in the file are 4-byte integers and floats.
#pragma once
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "io/files/output.h"
#include "src/model/joint_model.h"

namespace dea {

/// A float of the file and its bytes as a number.
inline float float_of(std::uint32_t bits) {
  float number;
  std::memcpy(&number, &bits, sizeof(number));
  return number;
}
inline std::uint32_t bits_of(float number) {
  std::uint32_t bits;
  std::memcpy(&bits, &number, sizeof(bits));
  return bits;
}

enum class XpltType { Float = 0, Vec3 = 1, Mat3s = 2, Mat3d = 3, Tens4s = 4, Mat3 = 5, Array = 6, ArrayVec3 = 7 };
enum class XpltFormat { Node = 0, Item = 1, Mult = 2, Region = 3 };
enum class XpltGroup { Global, Nodal, Domain, Surface, Edge };

/// One entry of the dictionary: what a variable is.
struct XpltVariable {
  XpltGroup group = XpltGroup::Nodal;
  XpltType type = XpltType::Float;
  XpltFormat format = XpltFormat::Node;
  std::string name = {};
  std::string units = {};  ///< FEBio's dimension code, only used when XpltFile::units is given
  int array_size = 0;
  std::vector<std::string> array_names = {};
  bool operator==(const XpltVariable&) const = default;
};

struct XpltDomain {
  int element_type = 0;  ///< code of the file format (0 hex8, 1 penta6, ...)
  int part = 1;          ///< 1-based position in XpltMesh::parts
  std::string name;      ///< may be empty
  std::vector<int> element_ids;
  std::vector<int> nodes;  ///< zero-based node indices, as many per element as the type has
  bool operator==(const XpltDomain&) const = default;
};

/// A surface, a facet set or an edge (its facets are lines). Facet i: nodes[begin[i]] .. nodes[begin[i + 1]].
struct XpltFacets {
  std::string name;
  std::vector<int> begin = {0};
  std::vector<int> nodes;  ///< zero-based
  int max_nodes = 4;       ///< slots per facet in face records and MULT data
  int size() const { return static_cast<int>(begin.size()) - 1; }
  bool operator==(const XpltFacets&) const = default;
};

struct XpltSet {
  std::string name;
  std::vector<int> items;  ///< node set: zero-based node indices; element set: element ids
  int size() const { return static_cast<int>(items.size()); }
  bool operator==(const XpltSet&) const = default;
};

/// A rigid body's axes or a connector, with its time curves. A point object, or a line between two points.
struct XpltObject {
  std::string name;
  bool line = false;
  int tag = 1;  ///< point: 1 rigid body, 2 joint, ...; line: 1 spring, ...
  std::array<float, 3> position = {0, 0, 0};
  std::array<float, 4> rotation = {0, 0, 0, 1};         ///< quaternion x y z w
  std::array<float, 6> line_ends = {0, 0, 0, 0, 0, 0};  ///< line objects only
  std::vector<XpltVariable> data;                       ///< type and name only
  bool operator==(const XpltObject&) const = default;
};

struct XpltObjectState {
  std::array<float, 3> position = {0, 0, 0};
  std::array<float, 4> rotation = {0, 0, 0, 1};
  std::array<float, 3> point = {0, 0, 0};               ///< point objects only
  std::array<float, 6> line_ends = {0, 0, 0, 0, 0, 0};  ///< line objects only
  std::vector<std::vector<float>> data;                 ///< one per item of XpltObject::data; an empty one is left out
  bool operator==(const XpltObjectState&) const = default;
};

struct XpltMesh {
  std::vector<int> node_ids;
  std::vector<float> coordinates;  ///< 3 per node, reference position
  std::vector<XpltDomain> domains;
  std::vector<XpltFacets> surfaces;
  std::vector<XpltFacets> edges;
  std::vector<XpltSet> node_sets;
  std::vector<XpltSet> element_sets;
  std::vector<XpltFacets> facet_sets;
  std::vector<std::string> parts;
  std::vector<XpltObject> objects;  ///< of the first mesh only; they hold for all states
  bool operator==(const XpltMesh&) const = default;
};

/// Values of one variable on one region: domain, surface or edge (1-based), 0 for nodal and global variables.
struct XpltRegion {
  int region = 0;
  std::vector<float> values;
  bool operator==(const XpltRegion&) const = default;
};

/// Statuses of a state, as FEBio writes them; 1: the first after a new mesh; 2: one that ends no time step.
inline constexpr int kStatusConverged = 0, kStatusNotConverged = 2;

struct XpltState {
  float time = 0;
  int status = kStatusConverged;
  std::vector<std::uint32_t> element_flags;        ///< one per element in file order; empty: section left out
  std::vector<std::vector<XpltRegion>> variables;  ///< one per dictionary entry, in the dictionary's order
  std::vector<XpltObjectState> objects;            ///< one per object of the first mesh, or empty
  int mesh = 0;                                    ///< index into XpltFile::meshes
  bool operator==(const XpltState&) const = default;
};

struct XpltFile {
  std::uint32_t version = 0x35;
  bool compressed = false;
  std::string software;
  std::string units;                    ///< empty: none
  std::vector<XpltVariable> variables;  ///< ordered by group: global, nodal, domain, surface, edge
  std::vector<XpltMesh> meshes;         ///< almost always one
  std::vector<XpltState> states;
  bool truncated = false;       ///< read_xplt: the last state was cut off and left out
  std::size_t passed_over = 0;  ///< read_xplt: parts of a newer file that are unknown
  bool operator==(const XpltFile&) const = default;
};

/// By its software: did dea write it?
bool written_by_dea(const XpltFile& file);

/// Number of floats of one value of this variable.
int floats_per_value(const XpltVariable& variable);
/// Number of nodes of an element-type code; 0: unknown code.
int xplt_nodes_per_element(int element_type);
/// The file format's code of an element shape.
int xplt_element_type(ElementShape shape);
/// The same backwards; nothing: an unknown code, or tri10.
std::optional<ElementShape> xplt_element_shape(int element_type);
/// Number of elements of a domain, and of all of a mesh.
int xplt_elements(const XpltDomain& domain);
std::size_t element_count(const XpltMesh& mesh);

/// Index in file.variables of the variable with this name in this group, -1 if none.
int find_variable(const XpltFile& file, XpltGroup group, const std::string& name);

/// Number of floats that the variable has on this region (as in XpltRegion) of the mesh; -1: no such region.
std::int64_t floats_in_region(const XpltMesh& mesh, const XpltVariable& variable, int region);

/// The file's bytes. Throws std::logic_error when sizes of `file` do not fit together (our fault), so that
/// no file a reader would run past its end is ever written; also on NaN or infinite values. Names longer
/// than the 63 bytes the format holds are cut. Throws WriteError when a mesh or a state has 2 GiB or more.
std::string xplt_bytes(const XpltFile& file);

/// Writes to a temporary file beside `path`, then renames: no half-written file is left behind, and an
/// older result stays until the new one is complete. Devices and pipes are written directly. Throws WriteError.
void write_xplt(const std::string& path, const XpltFile& file);

/// A plot file that is written state by state, so that memory holds one at a time. States wait on disk (Spool) until
/// finish brings all to `path` as write_xplt does: whoever ends before leaves nothing behind, killed or not.
class XpltWriter {
 public:
  /// `head`: header, dictionary and one mesh; its states are left out. Throws as write_xplt.
  XpltWriter(std::string path, XpltFile head);
  void add(const XpltState& state);
  void finish();

 private:
  std::string path_, bytes_;  ///< bytes: all before the states
  XpltFile head_;
  Spool states_;
};

/// Does the file come from a newer FEBio than this reader knows?
bool is_newer(const XpltFile& file);

/// Reads a plot file of version 0x30 to 0x35, compressed or not; of a newer one, to 0x3f, all but what is new. A
/// truncated last state is dropped and flagged. Throws InputError: not a plot file, older version, inconsistent chunk
/// sizes, ...
XpltFile read_xplt(const std::string& path);

/// What a plot file is of: header, dictionary, meshes, and of each state its time; its values may be missing. Quick: it
/// passes over the states, unless the file is compressed, has several meshes or is cut off. Throws as read_xplt does.
XpltFile read_xplt_outline(const std::string& path);

/// The same from bytes in memory; `name` stands for the path in errors.
XpltFile xplt_from_bytes(const std::string& bytes, const std::string& name);

}  // namespace dea
