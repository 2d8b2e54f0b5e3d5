// io/xplt/write_xplt.cpp – check the plot file, lay it out, bring it to disk.
//
// The viewers' reader copies by sizes it computes itself and indexes without looking: one wrong length and it
// crashes or shows noise. So everything it relies on is checked here before the first byte is written.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>

#include "io/files/encoded_text.h"
#include "io/files/output.h"
#include "io/xplt/xplt.h"
#include "io/xplt/xplt_format.h"
#include "src/base/error.h"
#include "src/base/numbers.h"

namespace dea {

using namespace xplt;

namespace {

// ---------------------------------------------------------------------------------------------- names

bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

// What the format can hold of a name: ends at a zero byte, at most 63 bytes, no half UTF-8 character.
std::string_view stored_name(std::string_view name) {
  name = name.substr(0, name.find('\0'));
  if (name.size() <= kLongestName) return name;
  std::size_t end = kLongestName;
  while (end > 0 && continues_character(name[end])) --end;
  return name.substr(0, end);
}

// The viewers read "long name=alias" and show, and look up, the alias.
std::string_view shown_name(std::string_view name) {
  name = stored_name(name);
  const std::size_t equals = name.find('=');
  return equals == std::string_view::npos ? name : name.substr(equals + 1);
}

// --------------------------------------------------------------------------------------------- checks

void require(bool fits, const char* what) {
  if (!fits) throw std::logic_error(fmt::format("plot file: {}", what));
}

template <class Numbers>
void require_finite(const Numbers& numbers, const char* what) {
  for (const float number : numbers) {
    if (std::isinf(number))
      throw InputError(
          fmt::format("a plot file cannot hold the {} of this model, which is beyond 3e38: check the "
                      "model's numbers, its settings and their units",
                      what));
    if (!std::isfinite(number)) throw std::logic_error(fmt::format("plot file: {}: not a finite number", what));
  }
}

// Not so: combinations that the viewers refuse, crash on, show wrongly or read with other sizes than FEBio
// writes. Found with FEBio Studio's reader: nodal values of a surface all become the value of its first node.
bool viewers_can_read(const XpltVariable& v) {
  const bool array = v.type == XpltType::Array || v.type == XpltType::ArrayVec3;
  switch (v.group) {
    case XpltGroup::Global:
      return v.type != XpltType::ArrayVec3;
    case XpltGroup::Nodal:
      return v.type != XpltType::Mat3d && v.type != XpltType::ArrayVec3;
    case XpltGroup::Domain:
      if (v.name == "shell thickness") return v.type == XpltType::Float && v.format == XpltFormat::Mult;
      if (v.type == XpltType::ArrayVec3) return v.format == XpltFormat::Item;
      return !array || v.format == XpltFormat::Node || v.format == XpltFormat::Item;
    case XpltGroup::Surface:
      if (v.format == XpltFormat::Node) return false;
      if (v.format == XpltFormat::Mult) return v.type == XpltType::Float || v.type == XpltType::Vec3;
      return !array || (v.type == XpltType::Array && v.format == XpltFormat::Item);
    case XpltGroup::Edge:
      return !array;
  }
  return false;
}

void check_dictionary(const std::vector<XpltVariable>& variables) {
  std::set<std::string_view> names;
  XpltGroup group = XpltGroup::Global;
  for (const XpltVariable& variable : variables) {
    require(variable.group >= group, "variables are not ordered by group");
    group = variable.group;
    require(!shown_name(variable.name).empty(), "variable without a name");
    require(names.insert(shown_name(variable.name)).second, "two variables of one name");
    require(viewers_can_read(variable), "type and format of a variable do not go together");
    if (variable.type == XpltType::Array || variable.type == XpltType::ArrayVec3) {
      require(variable.array_size >= 1 && variable.array_size <= std::numeric_limits<int>::max() / 3,
              "array size of a variable");
    }
    require(
        variable.array_names.empty() || variable.array_names.size() == static_cast<std::size_t>(variable.array_size),
        "names of an array's components");
  }
}

void check_indices(const std::vector<int>& nodes, std::size_t count, const char* what) {
  for (const int node : nodes) require(node >= 0 && static_cast<std::size_t>(node) < count, what);
}

void check_facets(const XpltFacets& facets, std::size_t nodes, bool lines) {
  require(!facets.begin.empty() && facets.begin.front() == 0 &&
              static_cast<std::size_t>(facets.begin.back()) == facets.nodes.size(),
          "facets and their nodes");
  require(facets.max_nodes <= kLargestFacet, "more slots per facet than the viewers have room for");
  for (std::size_t i = 0; i + 1 < facets.begin.size(); ++i) {
    const int n = facets.begin[i + 1] - facets.begin[i];
    require(lines ? n == 2 || n == 3 : n == 3 || n == 4 || (n >= 6 && n <= 9), "number of nodes of a facet");
    require(n <= facets.max_nodes, "facet with more nodes than max_nodes");
  }
  check_indices(facets.nodes, nodes, "node of a facet");
}

void check_mesh(const XpltMesh& mesh) {
  const std::size_t nodes = mesh.node_ids.size();
  require(mesh.coordinates.size() == 3 * nodes, "node ids and coordinates");
  require_finite(mesh.coordinates, "coordinates");
  require(!mesh.domains.empty(), "mesh without elements");
  std::set<int> element_ids;
  for (const XpltDomain& domain : mesh.domains) {
    require(xplt_element_shape(domain.element_type).has_value(), "element type");
    const int n = xplt_nodes_per_element(domain.element_type);
    require(!domain.element_ids.empty(), "domain without elements");
    require(domain.nodes.size() == domain.element_ids.size() * static_cast<std::size_t>(n),
            "element ids and nodes of a domain");
    require(domain.part >= 1 && static_cast<std::size_t>(domain.part) <= mesh.parts.size(), "part of a domain");
    check_indices(domain.nodes, nodes, "node of an element");
    if (!mesh.element_sets.empty()) element_ids.insert(domain.element_ids.begin(), domain.element_ids.end());
  }
  for (const XpltFacets& surface : mesh.surfaces) check_facets(surface, nodes, false);
  for (const XpltFacets& edge : mesh.edges) check_facets(edge, nodes, true);
  for (const XpltFacets& facets : mesh.facet_sets) check_facets(facets, nodes, false);
  for (const XpltSet& set : mesh.node_sets) check_indices(set.items, nodes, "node of a node set");
  for (const XpltSet& set : mesh.element_sets) {
    for (const int id : set.items) require(element_ids.count(id) == 1, "element of an element set");
  }
  for (const XpltObject& object : mesh.objects) {
    require_finite(object.position, "position of an object");
    require_finite(object.rotation, "rotation of an object");
    require_finite(object.line_ends, "ends of a line");
    for (const XpltVariable& item : object.data) {
      require(item.type == XpltType::Float || item.type == XpltType::Vec3, "type of an object's data");
    }
  }
}

void check_state(const XpltFile& file, const XpltState& state) {
  const XpltMesh& mesh = file.meshes[static_cast<std::size_t>(state.mesh)];
  require(std::isfinite(state.time), "time: not a finite number");
  require(state.element_flags.empty() || state.element_flags.size() == element_count(mesh), "element flags");

  require(state.variables.size() == file.variables.size(), "data for each variable of the dictionary");
  for (std::size_t i = 0; i < file.variables.size(); ++i) {
    const XpltVariable& variable = file.variables[i];
    std::set<int> regions;
    for (const XpltRegion& region : state.variables[i]) {
      const std::int64_t floats = floats_in_region(mesh, variable, region.region);
      if (floats < 0 || static_cast<std::size_t>(floats) != region.values.size()) {
        throw std::logic_error(fmt::format("plot file: {}, region {}: {} values, need {}", variable.name, region.region,
                                           region.values.size(), floats));
      }
      require(regions.insert(region.region).second, "two sets of values for one region");
      require_finite(region.values, variable.name.c_str());
      constexpr int kLine3 = 19;  // the viewers know its nodes, but not its nodal data
      require(variable.group != XpltGroup::Domain || variable.format == XpltFormat::Item ||
                  variable.format == XpltFormat::Region ||
                  mesh.domains[static_cast<std::size_t>(region.region) - 1].element_type != kLine3,
              "data at the nodes of line3 elements");
    }
  }

  const std::vector<XpltObject>& objects = file.meshes.front().objects;
  require(state.objects.empty() || state.objects.size() == objects.size(), "state of each object");
  for (std::size_t i = 0; i < state.objects.size(); ++i) {
    const XpltObjectState& object = state.objects[i];
    require_finite(object.position, "position of an object");
    require_finite(object.rotation, "rotation of an object");
    require_finite(object.point, "point of an object");
    require_finite(object.line_ends, "ends of a line");
    require(object.data.size() == objects[i].data.size(), "data of an object");
    for (std::size_t j = 0; j < object.data.size(); ++j) {
      require(object.data[j].empty() ||
                  object.data[j].size() == static_cast<std::size_t>(floats_per_value(objects[i].data[j])),
              "data of an object");
      require_finite(object.data[j], "data of an object");
    }
  }
}

void check(const XpltFile& file) {
  require(file.version >= kOldestVersion && file.version <= kNewestVersion, "version");
  check_dictionary(file.variables);
  require(!file.meshes.empty(), "no mesh");
  for (const XpltMesh& mesh : file.meshes) check_mesh(mesh);
  for (std::size_t i = 1; i < file.meshes.size(); ++i) {
    require(file.meshes[i].objects.empty(), "objects in another mesh than the first");
  }
  int mesh = 0;
  for (const XpltState& state : file.states) {
    require(state.mesh >= mesh && static_cast<std::size_t>(state.mesh) < file.meshes.size(), "mesh of a state");
    mesh = state.mesh;
    check_state(file, state);
  }
}

// --------------------------------------------------------------------------------------------- chunks

void put(std::string& bytes, std::uint32_t number) {
  const char little_endian[4] = {static_cast<char>(number), static_cast<char>(number >> 8),
                                 static_cast<char>(number >> 16), static_cast<char>(number >> 24)};
  bytes.append(little_endian, 4);
}
void put(std::string& bytes, int number) { put(bytes, static_cast<std::uint32_t>(number)); }
void put(std::string& bytes, float number) { put(bytes, bits_of(number)); }

// A chunk of what is put into `bytes` while it lives. Its size is known only at its end, so it leaves a gap before.
class OpenChunk {
 public:
  OpenChunk(std::string& bytes, std::uint32_t id) : bytes_(bytes) {
    put(bytes, id);
    put(bytes, 0);
    start_ = bytes.size();
  }
  ~OpenChunk() {
    std::string size;
    put(size, static_cast<std::uint32_t>(bytes_.size() - start_));
    std::copy(size.begin(), size.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(start_ - 4));
  }
  OpenChunk(const OpenChunk&) = delete;
  OpenChunk& operator=(const OpenChunk&) = delete;

 private:
  std::string& bytes_;
  std::size_t start_ = 0;
};

template <class Number>
void leaf(std::string& out, std::uint32_t id, Number number) {
  const OpenChunk chunk(out, id);
  put(out, number);
}

// An empty leaf is left out: a reader takes it for an empty branch and loses its place.
template <class Numbers>
void leaf_of_all(std::string& out, std::uint32_t id, const Numbers& numbers) {
  if (numbers.empty()) return;
  const OpenChunk chunk(out, id);
  static_assert(sizeof(numbers[0]) == 4);
  if constexpr (std::endian::native == std::endian::little)  // as `put` has it, all at once
    out.append(reinterpret_cast<const char*>(numbers.data()), 4 * numbers.size());
  else
    for (const auto number : numbers) put(out, number);
}

void prefixed_name(std::string& out, std::uint32_t id, const std::string& name) {
  const std::string_view stored = stored_name(name);
  const OpenChunk chunk(out, id);
  put(out, static_cast<int>(stored.size()));
  out += stored;
}

void fixed_name(std::string& out, std::uint32_t id, const std::string& name) {
  const std::string_view stored = stored_name(name);
  const OpenChunk chunk(out, id);
  out += stored;
  out.append(kFixedName - stored.size(), '\0');
}

// ----------------------------------------------------------------------------------------------- root

void put_item(std::string& out, std::uint32_t id, const XpltVariable& variable, bool with_units) {
  const OpenChunk item(out, id);
  leaf(out, kItemType, static_cast<int>(variable.type));
  leaf(out, kItemFormat, static_cast<int>(variable.format));
  leaf(out, kItemArraySize, variable.array_size);
  for (const std::string& name : variable.array_names) fixed_name(out, kItemArrayName, name);
  fixed_name(out, kItemName, variable.name);
  if (with_units && !variable.units.empty()) fixed_name(out, kItemUnits, variable.units);
}

void put_header(std::string& out, const XpltFile& file) {
  const OpenChunk header(out, kHeader);
  leaf(out, kVersionTag, file.version);
  leaf(out, kCompression, file.compressed ? 1 : 0);
  if (!file.software.empty()) prefixed_name(out, kSoftware, file.software);
  if (!file.units.empty()) prefixed_name(out, kUnits, file.units);
}

void put_root(std::string& out, const XpltFile& file) {
  const OpenChunk root(out, kRoot);
  put_header(out, file);
  const OpenChunk dictionary(out, kDictionary);
  for (std::size_t i = 0; i < file.variables.size();) {
    const XpltGroup group = file.variables[i].group;
    const OpenChunk items(out, kGroupItems[static_cast<int>(group)]);
    for (; i < file.variables.size() && file.variables[i].group == group; ++i)
      put_item(out, kItem, file.variables[i], !file.units.empty());
  }
}

// ----------------------------------------------------------------------------------------------- mesh

void put_nodes(std::string& out, const XpltMesh& mesh) {
  const OpenChunk nodes(out, kNodes);
  {
    const OpenChunk header(out, kNodeHeader);
    leaf(out, kNodeCount, static_cast<int>(mesh.node_ids.size()));
    leaf(out, kNodeDimension, 3);
  }
  const OpenChunk coordinates(out, kNodeCoordinates);
  for (std::size_t i = 0; i < mesh.node_ids.size(); ++i) {
    put(out, mesh.node_ids[i]);
    for (std::size_t k = 0; k < 3; ++k) put(out, mesh.coordinates[3 * i + k]);
  }
}

void put_domains(std::string& out, const XpltMesh& mesh) {
  const OpenChunk domains(out, kDomains);
  for (const XpltDomain& domain : mesh.domains) {
    const OpenChunk one(out, kDomain);
    {
      const OpenChunk header(out, kDomainHeader);
      leaf(out, kDomainType, domain.element_type);
      leaf(out, kDomainPart, domain.part);
      leaf(out, kDomainElements, xplt_elements(domain));
      if (!domain.name.empty()) prefixed_name(out, kDomainName, domain.name);
    }
    const OpenChunk list(out, kElementList);
    const std::size_t n = static_cast<std::size_t>(xplt_nodes_per_element(domain.element_type));
    for (std::size_t i = 0; i < domain.element_ids.size(); ++i) {
      const OpenChunk element(out, kElement);
      put(out, domain.element_ids[i]);
      for (std::size_t k = 0; k < n; ++k) put(out, domain.nodes[n * i + k]);
    }
  }
}

void put_items(std::string& out, const XpltFacets& facets, const ListIds& ids) {
  if (facets.size() == 0) return;
  const OpenChunk list(out, ids.list);
  for (int i = 0; i < facets.size(); ++i) {
    const int first = facets.begin[at(i)], n = facets.begin[at(i) + 1] - first;
    const OpenChunk facet(out, ids.facet);
    put(out, i + 1);
    put(out, n);
    for (int k = 0; k < facets.max_nodes; ++k) put(out, k < n ? facets.nodes[at(first + k)] : 0);
  }
}

void put_items(std::string& out, const XpltSet& set, const ListIds& ids) { leaf_of_all(out, ids.list, set.items); }

// Surfaces or sets, numbered from 1.
template <class List>
void put_lists(std::string& out, const std::vector<List>& all, const ListIds& ids) {
  if (all.empty()) return;
  const OpenChunk section(out, ids.section);
  int number = 0;
  for (const List& list : all) {
    const OpenChunk one(out, ids.one);
    {
      const OpenChunk header(out, ids.header);
      leaf(out, ids.id, ++number);
      leaf(out, ids.count, list.size());
      prefixed_name(out, ids.name, list.name);
      if constexpr (std::is_same_v<List, XpltFacets>) leaf(out, ids.max_nodes, list.max_nodes);
    }
    put_items(out, list, ids);
  }
}

void put_parts(std::string& out, const XpltMesh& mesh) {
  const OpenChunk parts(out, kParts);
  for (std::size_t i = 0; i < mesh.parts.size(); ++i) {
    const OpenChunk part(out, kPart);
    leaf(out, kPartId, static_cast<int>(i) + 1);
    fixed_name(out, kPartName, mesh.parts[i]);
  }
}

void put_objects(std::string& out, const std::vector<XpltObject>& objects) {
  if (objects.empty()) return;
  const OpenChunk section(out, kObjects);
  int numbers[2] = {};  // of points, of lines: objects are numbered from 1 within their kind
  for (const XpltObject& object : objects) {
    const OpenChunk one(out, object.line ? kLineObject : kPointObject);
    leaf(out, kObjectId, ++numbers[object.line]);
    prefixed_name(out, kObjectName, object.name);
    leaf(out, kObjectTag, object.tag);
    leaf_of_all(out, kObjectPosition, object.position);
    leaf_of_all(out, kObjectRotation, object.rotation);
    if (object.line) leaf_of_all(out, kLineEnds, object.line_ends);
    for (const XpltVariable& item : object.data)
      put_item(out, kObjectData, {XpltGroup::Global, item.type, XpltFormat::Item, item.name}, false);
  }
}

void put_mesh(std::string& out, const XpltMesh& mesh) {
  const OpenChunk chunk(out, kMesh);
  put_nodes(out, mesh);
  put_domains(out, mesh);
  put_lists(out, mesh.surfaces, kSurfaceIds);
  put_lists(out, mesh.edges, kEdgeIds);
  put_lists(out, mesh.node_sets, kNodeSetIds);
  put_lists(out, mesh.element_sets, kElementSetIds);
  put_lists(out, mesh.facet_sets, kFacetSetIds);
  put_parts(out, mesh);
  put_objects(out, mesh.objects);
}

// ---------------------------------------------------------------------------------------------- state

void put_data(std::string& out, const XpltFile& file, const XpltState& state, XpltGroup group) {
  std::optional<OpenChunk> section;
  std::uint32_t id = 0;  // counts within the group
  for (std::size_t i = 0; i < file.variables.size(); ++i) {
    if (file.variables[i].group != group) continue;
    if (!section) section.emplace(out, kGroupData[static_cast<int>(group)]);
    const OpenChunk variable(out, kStateVariable);
    leaf(out, kStateVariableId, ++id);
    const OpenChunk data(out, kStateVariableData);
    for (const XpltRegion& region : state.variables[i])
      leaf_of_all(out, static_cast<std::uint32_t>(region.region), region.values);
  }
}

void put_object_states(std::string& out, const std::vector<XpltObject>& objects, const XpltState& state) {
  if (state.objects.empty()) return;
  const OpenChunk section(out, kObjectStates);
  int numbers[2] = {};  // of points, of lines: objects are numbered from 1 within their kind
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const XpltObjectState& object = state.objects[i];
    const OpenChunk one(out, objects[i].line ? kLineObject : kPointObject);
    leaf(out, kObjectId, ++numbers[objects[i].line]);
    leaf_of_all(out, kObjectPosition, object.position);
    leaf_of_all(out, kObjectRotation, object.rotation);
    if (objects[i].line)
      leaf_of_all(out, kLineEnds, object.line_ends);
    else
      leaf_of_all(out, kPointCoordinate, object.point);
    const OpenChunk data(out, kObjectData);
    for (std::size_t j = 0; j < object.data.size(); ++j)
      leaf_of_all(out, static_cast<std::uint32_t>(j), object.data[j]);
  }
}

void put_state(std::string& out, const XpltFile& file, const XpltState& state) {
  const OpenChunk chunk(out, kState);
  {
    const OpenChunk header(out, kStateHeader);
    leaf(out, kStateTime, state.time);
    leaf(out, kStateStatus, state.status);
  }
  if (!state.element_flags.empty()) {
    const OpenChunk flags(out, kMeshState);
    leaf_of_all(out, kElementFlags, state.element_flags);
  }
  {
    const OpenChunk data(out, kStateData);
    // FEBio's order: faces before edges, as in the dictionary.
    for (int group = 0; group < kGroups; ++group) put_data(out, file, state, static_cast<XpltGroup>(group));
  }
  put_object_states(out, file.meshes.front().objects, state);
}

// The bytes of a mesh or a state, which `put` puts.
template <class Put>
std::string whole_chunk(bool compressed, const Put& put) {
  std::string bytes;
  put(bytes);
  const std::size_t size = bytes.size() - 8;
  // FEBio computes sizes in a signed int.
  if (size > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    throw WriteError(fmt::format("a mesh or state of {} bytes, a plot file holds less than 2 GiB", size));
  if (compressed) return packed_bytes(bytes);
  return bytes;
}

}  // namespace

std::string xplt_bytes(const XpltFile& file) {
  check(file);
  std::string out;
  put(out, kMagic);
  put_root(out, file);
  // From the second mesh or the first state on each chunk may be compressed; the root and the first mesh never are.
  std::size_t meshes = 0;
  const auto add_meshes = [&](std::size_t until) {
    for (; meshes < until; ++meshes)
      out +=
          whole_chunk(file.compressed && meshes > 0, [&](std::string& chunk) { put_mesh(chunk, file.meshes[meshes]); });
  };
  add_meshes(1);
  for (const XpltState& state : file.states) {
    add_meshes(static_cast<std::size_t>(state.mesh) + 1);
    out += whole_chunk(file.compressed, [&](std::string& chunk) { put_state(chunk, file, state); });
  }
  add_meshes(file.meshes.size());
  return out;
}

namespace {

// A complete file at `path`, or the one that was there. "-" is a name too.
template <class Write>
void replace_file(const std::string& path, const Write& write) {
  write_pieces(path == "-" ? "./-" : path, write);
}

// What `make` gives, whose faults are told of the file.
template <class Make>
auto of_file(const std::string& path, const Make& make) {
  try {
    return make();
  } catch (const WriteError& error) {
    throw WriteError(fmt::format("{}: {}", path, error.what()));
  }
}

}  // namespace

void write_xplt(const std::string& path, const XpltFile& file) {
  const std::string bytes = of_file(path, [&] { return xplt_bytes(file); });
  replace_file(path, [&](const auto& put) { put(bytes); });
}

XpltWriter::XpltWriter(std::string path, XpltFile head)
    : path_(std::move(path)), head_(std::move(head)), states_(path_) {
  head_.states.clear();
  require(head_.meshes.size() == 1, "state by state: one mesh");
  bytes_ = of_file(path_, [&] { return xplt_bytes(head_); });
}

void XpltWriter::add(const XpltState& state) {
  require(state.mesh == 0, "mesh of a state");
  check_state(head_, state);
  states_.add(of_file(path_, [&] {
    return whole_chunk(head_.compressed, [&](std::string& chunk) { put_state(chunk, head_, state); });
  }));
}

void XpltWriter::finish() {
  replace_file(path_, [&](const auto& put) {
    put(bytes_);
    states_.read(0, states_.size(), put);
  });
}

}  // namespace dea
