// io/xplt/read_xplt.cpp – FEBio's plot file into plain structs.
//
// Files come from programs that were killed, disks that were full and copies that broke off, so no length
// and no index is believed before it is checked, and nothing is allocated that the file does not fill.
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <system_error>
#include <type_traits>

#include "io/files/free_memory.h"
#include "io/files/system.h"
#include "io/xplt/xplt.h"
#include "io/xplt/xplt_format.h"
#include "src/base/error.h"
#include "src/base/names.h"

namespace dea {

using namespace xplt;

namespace {

constexpr double kXpltMemory = 2;  // times the file: its bytes and its values

// --------------------------------------------------------------------------------------------- chunks

// A run of bytes with its place in the file, for errors.
struct Source {
  const std::string* name = nullptr;
  const std::string* bytes = nullptr;
  bool swapped = false;                           // written on a big-endian machine
  std::uint32_t version = kNewestVersion;         // of the plot file
  std::size_t* passed_over = nullptr;             // counts unknown chunks
  std::optional<std::size_t> unpacked_from = {};  // the bytes were compressed; offset of their zlib stream
};

bool is_newer(const Source& source) { return source.version > kNewestVersion; }

[[noreturn]] void fail(const Source& source, std::size_t at, const std::string& fault) {
  const std::string place = source.unpacked_from
                                ? fmt::format("byte {} of the data compressed at byte {}", at, *source.unpacked_from)
                                : fmt::format("byte {}", at);
  const std::string newer = is_newer(source) ? fmt::format(" (plot file version {:#x}, dea knows up to {:#x})",
                                                           source.version, kNewestVersion)
                                             : "";
  throw InputError(fmt::format("{}: {}: {}{}", *source.name, place, fault, newer));
}

// Part of a source. As a branch it is read with next_chunk, as a leaf with the functions below.
struct Chunk {
  const Source* source = nullptr;
  std::uint32_t id = 0;
  std::size_t begin = 0, end = 0;  // payload
  std::size_t size() const { return end - begin; }
};

// A fault in what a chunk holds, or in what it is.
[[noreturn]] void fail(const Chunk& chunk, const std::string& fault) { fail(*chunk.source, chunk.begin, fault); }
[[noreturn]] void fail_header(const Chunk& chunk, const std::string& fault) {
  fail(*chunk.source, chunk.begin - 8, fault);
}

std::uint32_t u32_at(const Source& source, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>((*source.bytes)[at + i]));
  };
  const std::uint32_t value = byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24;
  if (!source.swapped) return value;
  return value << 24 | (value & 0xFF00) << 8 | (value >> 8 & 0xFF00) | value >> 24;
}
int int_at(const Source& source, std::size_t at) { return static_cast<int>(u32_at(source, at)); }
float float_at(const Source& source, std::size_t at) { return float_of(u32_at(source, at)); }

// The child of a branch that starts at `at`, and `at` moved behind it.
bool next_chunk(const Chunk& branch, std::size_t& at, Chunk& child) {
  if (at == branch.end) return false;
  if (branch.end - at < 8) fail(*branch.source, at, "chunk header cut off");
  child.source = branch.source;
  child.id = u32_at(*branch.source, at);
  const std::size_t size = u32_at(*branch.source, at + 4);
  if (size > branch.end - at - 8) {
    fail(*branch.source, at,
         fmt::format("chunk {:08x} has {} bytes, but {} are left", child.id, size, branch.end - at - 8));
  }
  child.begin = at + 8;
  child.end = at = at + 8 + size;
  return true;
}

// Calls read(child) for each child.
template <class Read>
void for_each_child(const Chunk& branch, Read read) {
  std::size_t at = branch.begin;
  Chunk child;
  while (next_chunk(branch, at, child)) read(child);
}

// A newer file may have chunks that came later than this reader: they are passed over. In another file they are damage.
void pass_over_unknown(const Chunk& chunk, const char* where) {
  if (!is_newer(*chunk.source)) fail_header(chunk, fmt::format("unknown chunk {:08x} in {}", chunk.id, where));
  if (chunk.source->passed_over != nullptr) ++*chunk.source->passed_over;
}

void require_size(const Chunk& leaf, std::size_t size) {
  if (leaf.size() != size) {
    fail_header(leaf, fmt::format("chunk {:08x} has {} bytes, expected {}", leaf.id, leaf.size(), size));
  }
}

std::uint32_t read_u32(const Chunk& leaf) {
  require_size(leaf, 4);
  return u32_at(*leaf.source, leaf.begin);
}
int read_int(const Chunk& leaf) { return static_cast<int>(read_u32(leaf)); }
float read_float(const Chunk& leaf) { return float_of(read_u32(leaf)); }

int read_count(const Chunk& leaf) {
  const int count = read_int(leaf);
  if (count < 0) fail(leaf, fmt::format("negative count {}", count));
  return count;
}

std::vector<float> read_floats(const Chunk& leaf) {
  if (leaf.size() % 4 != 0) fail(leaf, fmt::format("{} bytes are no sequence of floats", leaf.size()));
  std::vector<float> values(leaf.size() / 4);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = float_at(*leaf.source, leaf.begin + 4 * i);
  return values;
}

std::string text_at(const Source& source, std::size_t at, std::size_t size) {
  const std::string text = source.bytes->substr(at, size);
  return text.substr(0, text.find('\0'));
}

std::string read_prefixed_name(const Chunk& leaf) {
  if (leaf.size() < 4) fail(leaf, "name without a length");
  const std::uint32_t length = u32_at(*leaf.source, leaf.begin);
  if (length != leaf.size() - 4) {
    fail(leaf, fmt::format("name of {} bytes in a chunk of {}", length, leaf.size()));
  }
  return text_at(*leaf.source, leaf.begin + 4, length);
}

// What follows the terminating zero is whatever FEBio had in memory.
std::string read_fixed_name(const Chunk& leaf) {
  require_size(leaf, kFixedName);
  return text_at(*leaf.source, leaf.begin, kFixedName);
}

void read_into(const Chunk& leaf, int& number) { number = read_int(leaf); }
void read_into(const Chunk& leaf, std::string& name) { name = read_prefixed_name(leaf); }
template <std::size_t N>
void read_into(const Chunk& leaf, std::array<float, N>& values) {
  require_size(leaf, 4 * N);
  for (std::size_t i = 0; i < N; ++i) values[i] = float_at(*leaf.source, leaf.begin + 4 * i);
}

// Reads a leaf of this id; false: it is another.
template <class Value>
bool take(const Chunk& leaf, std::uint32_t id, Value& value) {
  if (leaf.id != id) return false;
  read_into(leaf, value);
  return true;
}

// ----------------------------------------------------------------------------------------------- root

void read_header(const Chunk& header, Source& source, XpltFile& file) {
  bool has_version = false;
  for_each_child(header, [&](const Chunk& child) {
    if (take(child, kSoftware, file.software) || take(child, kUnits, file.units)) return;
    switch (child.id) {
      case kVersionTag:
        file.version = read_u32(child);
        has_version = true;
        if (file.version < kOldestVersion || file.version > kLastVersion)
          fail(child, fmt::format("plot file version {:#x}, need {:#x} to {:#x}{}", file.version, kOldestVersion,
                                  kLastVersion, file.version < kOldestVersion ? " (written by FEBio 1 or 2?)" : ""));
        source.version = file.version;
        break;
      case kCompression:
        file.compressed = read_int(child) != 0;
        break;
      case kAuthor:
      case kNodeCountV1:
      case kMaxFacetV1:
        break;
      default:
        pass_over_unknown(child, "the header");
    }
  });
  if (!has_version) fail(header, "no version");
}

XpltVariable read_item(const Chunk& item) {
  XpltVariable variable;
  bool has_type = false, has_name = false;
  for_each_child(item, [&](const Chunk& child) {
    switch (child.id) {
      case kItemType: {
        const std::uint32_t type = read_u32(child);
        if (type > 7) fail(child, fmt::format("variable of type {}, need 0 to 7", type));
        variable.type = static_cast<XpltType>(type);
        has_type = true;
        break;
      }
      case kItemFormat: {
        const std::uint32_t format = read_u32(child);
        if (format > 3) fail(child, fmt::format("variable of format {}, need 0 to 3", format));
        variable.format = static_cast<XpltFormat>(format);
        break;
      }
      case kItemArraySize:
        variable.array_size = read_count(child);
        if (variable.array_size > std::numeric_limits<int>::max() / 3) {
          fail(child, fmt::format("array of {} values", variable.array_size));
        }
        break;
      case kItemArrayName:
        variable.array_names.push_back(read_fixed_name(child));
        break;
      case kItemName:
        variable.name = read_fixed_name(child);
        has_name = true;
        break;
      case kItemUnits:
        variable.units = read_fixed_name(child);
        break;
      default:
        pass_over_unknown(child, "a variable's description");
    }
  });
  if (!has_type || !has_name) fail(item, "variable without type or name");
  return variable;
}

void read_dictionary(const Chunk& dictionary, XpltFile& file) {
  std::vector<XpltVariable> groups[kGroups];  // the file may have them in any order
  for_each_child(dictionary, [&](const Chunk& child) {
    const auto* found = std::find(kGroupItems, kGroupItems + kGroups, child.id);
    if (found == kGroupItems + kGroups) return pass_over_unknown(child, "the dictionary");
    const auto group = static_cast<int>(found - kGroupItems);
    for_each_child(child, [&](const Chunk& item) {
      if (item.id != kItem) return pass_over_unknown(item, "the dictionary");
      XpltVariable variable = read_item(item);
      variable.group = static_cast<XpltGroup>(group);
      groups[group].push_back(std::move(variable));
    });
  });
  for (const std::vector<XpltVariable>& group : groups) {
    file.variables.insert(file.variables.end(), group.begin(), group.end());
  }
}

void read_root(const Chunk& root, Source& source, XpltFile& file) {
  bool has_header = false;
  for_each_child(root, [&](const Chunk& child) {
    if (child.id == kHeader && !has_header) {
      read_header(child, source, file);
      has_header = true;
    } else if (child.id == kDictionary && has_header) {
      read_dictionary(child, file);
    } else {
      pass_over_unknown(child, "the root");
    }
  });
  if (!has_header) fail(root, "no header");
}

// ----------------------------------------------------------------------------------------------- mesh

void read_nodes(const Chunk& nodes, std::uint32_t version, XpltMesh& mesh) {
  int count = -1, dimension = 3;
  for_each_child(nodes, [&](const Chunk& child) {
    if (child.id == kNodeHeader) {
      for_each_child(child, [&](const Chunk& entry) {
        if (entry.id == kNodeCount) count = read_count(entry);
        take(entry, kNodeDimension, dimension);
      });
      if (dimension != 3) fail(child, fmt::format("nodes with {} coordinates, need 3", dimension));
    } else if (child.id == kNodeCoordinates) {
      if (count < 0) fail(child, "coordinates before the number of nodes");
      require_size(child, 16 * static_cast<std::size_t>(count));
      for (std::size_t at = child.begin; at < child.end; at += 16) {
        // Before version 0x33 the number here was not the node's id.
        mesh.node_ids.push_back(version < 0x33 ? static_cast<int>(mesh.node_ids.size()) + 1
                                               : int_at(*child.source, at));
        for (std::size_t k = 1; k <= 3; ++k) {
          mesh.coordinates.push_back(float_at(*child.source, at + 4 * k));
          if (!std::isfinite(mesh.coordinates.back()))
            fail(child, fmt::format("node {} has a coordinate that is no finite number", mesh.node_ids.size()));
        }
      }
    } else {
      pass_over_unknown(child, "the nodes");
    }
  });
}

XpltDomain read_domain(const Chunk& chunk) {
  XpltDomain domain;
  int count = -1;
  std::size_t n = 0;
  for_each_child(chunk, [&](const Chunk& child) {
    if (child.id == kDomainHeader) {
      if (!domain.element_ids.empty()) fail(child, "description of a domain after its elements");
      for_each_child(child, [&](const Chunk& entry) {
        if (take(entry, kDomainPart, domain.part) || take(entry, kDomainName, domain.name)) return;
        if (take(entry, kDomainType, domain.element_type)) {
          n = static_cast<std::size_t>(xplt_nodes_per_element(domain.element_type));
          if (n == 0) fail(entry, fmt::format("unknown element type {}", domain.element_type));
        } else if (entry.id == kDomainElements) {
          count = read_count(entry);
        } else {
          pass_over_unknown(entry, "a domain");
        }
      });
    } else if (child.id == kElementList) {
      if (n == 0) fail(child, "elements before their type");
      for_each_child(child, [&](const Chunk& element) {
        if (element.id != kElement) return pass_over_unknown(element, "a list of elements");
        require_size(element, 4 * (n + 1));
        domain.element_ids.push_back(int_at(*element.source, element.begin));
        for (std::size_t k = 1; k <= n; ++k) {
          domain.nodes.push_back(int_at(*element.source, element.begin + 4 * k));
        }
      });
    } else {
      pass_over_unknown(child, "a domain");
    }
  });
  if (count != xplt_elements(domain)) {
    fail(chunk, fmt::format("domain of {} elements, {} expected", xplt_elements(domain), count));
  }
  return domain;
}

// Size, name and, of surfaces, slots per facet. `what`: how faults call it.
template <class List>
void read_list_header(const Chunk& header, const ListIds& ids, const char* what, List& list, int& count) {
  for_each_child(header, [&](const Chunk& entry) {
    if (entry.id == ids.id || take(entry, ids.name, list.name)) return;  // the position counts, not the id
    if (entry.id == ids.count) {
      count = read_count(entry);
    } else if constexpr (std::is_same_v<List, XpltFacets>) {
      if (entry.id != ids.max_nodes) return pass_over_unknown(entry, what);
      list.max_nodes = read_count(entry);
    } else {
      pass_over_unknown(entry, what);
    }
  });
}

XpltFacets read_facets(const Chunk& chunk, const ListIds& ids) {
  XpltFacets facets;
  int count = 0;
  for_each_child(chunk, [&](const Chunk& child) {
    if (child.id == ids.header) {
      if (facets.size() > 0) fail(child, "description of a surface after its facets");
      read_list_header(child, ids, "a surface", facets, count);
    } else if (child.id == ids.list) {
      for_each_child(child, [&](const Chunk& facet) {
        if (facet.id != ids.facet) return pass_over_unknown(facet, "a list of facets");
        require_size(facet, 4 * (static_cast<std::size_t>(facets.max_nodes) + 2));
        const int n = int_at(*facet.source, facet.begin + 4);  // before it: the facet's number
        if (n < 1 || n > facets.max_nodes) {
          fail(facet, fmt::format("facet of {} nodes, need 1 to {}", n, facets.max_nodes));
        }
        for (int k = 0; k < n; ++k) {
          facets.nodes.push_back(int_at(*facet.source, facet.begin + 8 + 4 * static_cast<std::size_t>(k)));
        }
        facets.begin.push_back(static_cast<int>(facets.nodes.size()));
      });
    } else {
      pass_over_unknown(child, "a surface");
    }
  });
  if (count != facets.size()) fail(chunk, fmt::format("surface of {} facets, {} expected", facets.size(), count));
  return facets;
}

XpltSet read_set(const Chunk& chunk, const ListIds& ids) {
  XpltSet set;
  int count = 0;
  for_each_child(chunk, [&](const Chunk& child) {
    if (child.id == ids.header) {
      read_list_header(child, ids, "a set", set, count);
    } else if (child.id == ids.list) {
      require_size(child, 4 * static_cast<std::size_t>(count));
      for (std::size_t at = child.begin; at < child.end; at += 4) set.items.push_back(int_at(*child.source, at));
    } else {
      pass_over_unknown(child, "a set");
    }
  });
  if (count != set.size()) fail(chunk, fmt::format("set of {} items, {} expected", set.size(), count));
  return set;
}

std::string read_part(const Chunk& chunk) {
  std::string name;
  for_each_child(chunk, [&](const Chunk& child) {
    if (child.id == kPartName) name = read_fixed_name(child);
  });
  return name;
}

XpltObject read_object(const Chunk& chunk) {
  XpltObject object;
  object.line = chunk.id == kLineObject;
  for_each_child(chunk, [&](const Chunk& child) {
    if (take(child, kObjectName, object.name) || take(child, kObjectTag, object.tag) ||
        take(child, kObjectPosition, object.position) || take(child, kObjectRotation, object.rotation) ||
        take(child, kLineEnds, object.line_ends) || child.id != kObjectData)
      return;  // or the id: objects are numbered in the order of the file
    const XpltVariable item = read_item(child);
    object.data.push_back({XpltGroup::Nodal, item.type, XpltFormat::Node, item.name});
  });
  return object;
}

void check_indices(const Chunk& chunk, const std::vector<int>& nodes, std::size_t count, const char* what) {
  for (const int node : nodes) {
    if (node < 0 || static_cast<std::size_t>(node) >= count) {
      fail(chunk, fmt::format("{}: node index {}, but the mesh has {} nodes", what, node, count));
    }
  }
}

void check_mesh(const Chunk& chunk, const XpltMesh& mesh) {
  const std::size_t nodes = mesh.node_ids.size();
  for (std::size_t i = 0; i < mesh.domains.size(); ++i) {
    check_indices(chunk, mesh.domains[i].nodes, nodes, "domain");
    const int part = mesh.domains[i].part;
    if (part < 1 || static_cast<std::size_t>(part) > mesh.parts.size()) {
      fail(chunk, fmt::format("domain {} is of part {}, but there are {} parts", i + 1, part, mesh.parts.size()));
    }
  }
  for (const XpltFacets& facets : mesh.surfaces) check_indices(chunk, facets.nodes, nodes, "surface");
  for (const XpltFacets& facets : mesh.edges) check_indices(chunk, facets.nodes, nodes, "edge");
  for (const XpltFacets& facets : mesh.facet_sets) check_indices(chunk, facets.nodes, nodes, "facet set");
  for (const XpltSet& set : mesh.node_sets) check_indices(chunk, set.items, nodes, "node set");
  if (mesh.element_sets.empty()) return;
  std::set<int> elements;
  for (const XpltDomain& domain : mesh.domains) elements.insert(domain.element_ids.begin(), domain.element_ids.end());
  for (const XpltSet& set : mesh.element_sets) {
    for (const int id : set.items)
      if (elements.count(id) == 0)
        fail(chunk, fmt::format("element set \"{}\": element {}, but no element has this id", set.name, id));
  }
}

XpltMesh read_mesh(const Chunk& chunk, std::uint32_t version) {
  XpltMesh mesh;
  const auto read_all = [](const Chunk& section, std::uint32_t id, auto read) {
    for_each_child(section, [&](const Chunk& child) {
      if (child.id != id) return pass_over_unknown(child, "the mesh");
      read(child);
    });
  };
  for_each_child(chunk, [&](const Chunk& section) {  // others: sections that came later than this reader
    const auto read_lists = [&](const ListIds& ids, auto& all, auto read) {
      if (section.id == ids.section)
        read_all(section, ids.one, [&](const Chunk& child) { all.push_back(read(child, ids)); });
    };
    read_lists(kSurfaceIds, mesh.surfaces, read_facets);
    read_lists(kEdgeIds, mesh.edges, read_facets);
    read_lists(kFacetSetIds, mesh.facet_sets, read_facets);
    read_lists(kNodeSetIds, mesh.node_sets, read_set);
    read_lists(kElementSetIds, mesh.element_sets, read_set);
    if (section.id == kNodes) read_nodes(section, version, mesh);
    if (section.id == kDomains)
      read_all(section, kDomain, [&](const Chunk& child) { mesh.domains.push_back(read_domain(child)); });
    if (section.id == kParts)
      read_all(section, kPart, [&](const Chunk& child) { mesh.parts.push_back(read_part(child)); });
    if (section.id == kObjects)
      for_each_child(section, [&](const Chunk& child) {
        if (child.id == kPointObject || child.id == kLineObject) mesh.objects.push_back(read_object(child));
      });
  });
  check_mesh(chunk, mesh);
  return mesh;
}

// ---------------------------------------------------------------------------------------------- state

void read_data(const Chunk& section, const XpltFile& file, XpltGroup group, XpltState& state) {
  const XpltMesh& mesh = file.meshes.back();
  std::vector<std::size_t> in_group;
  for (std::size_t i = 0; i < file.variables.size(); ++i) {
    if (file.variables[i].group == group) in_group.push_back(i);
  }
  std::set<std::size_t> done;
  for_each_child(section, [&](const Chunk& child) {
    if (child.id != kStateVariable) return pass_over_unknown(child, "a state");
    std::optional<std::size_t> index;
    for_each_child(child, [&](const Chunk& entry) {
      if (entry.id == kStateVariableId) {
        const std::uint32_t number = read_u32(entry);  // counts within the group
        if (number < 1 || number > in_group.size()) {
          fail(entry, fmt::format("variable {} of a group of {}", number, in_group.size()));
        }
        index = in_group[number - 1];
        if (!done.insert(*index).second) fail(entry, fmt::format("variable {} twice in one state", number));
      } else if (entry.id == kStateVariableData) {
        if (!index) fail(entry, "data before the number of its variable");
        const XpltVariable& variable = file.variables[*index];
        std::vector<XpltRegion>& regions = state.variables[*index];
        for_each_child(entry, [&](const Chunk& data) {
          const int region = static_cast<int>(data.id);
          const std::int64_t floats = floats_in_region(mesh, variable, region);
          if (floats < 0) {
            fail_header(data, fmt::format("{}: no region {} in the mesh", in_quotes(variable.name), data.id));
          }
          if (data.size() != 4 * static_cast<std::size_t>(floats)) {
            fail_header(data, fmt::format("{}, region {}: {} bytes, expected {}", in_quotes(variable.name), region,
                                          data.size(), 4 * floats));
          }
          for (const XpltRegion& other : regions) {
            if (other.region == region) {
              fail(data, fmt::format("{}: region {} twice", in_quotes(variable.name), region));
            }
          }
          regions.push_back({region, read_floats(data)});
        });
      } else {
        pass_over_unknown(entry, "a variable's data");
      }
    });
  });
}

void read_object_states(const Chunk& section, const std::vector<XpltObject>& objects, XpltState& state) {
  std::vector<std::size_t> points, lines;
  for (std::size_t i = 0; i < objects.size(); ++i) (objects[i].line ? lines : points).push_back(i);
  state.objects.resize(objects.size());
  std::vector<char> done(objects.size(), 0);
  for_each_child(section, [&](const Chunk& child) {
    if (child.id != kPointObject && child.id != kLineObject) return pass_over_unknown(child, "the states of objects");
    const std::vector<std::size_t>& kind = child.id == kLineObject ? lines : points;
    std::optional<std::size_t> index;
    for_each_child(child, [&](const Chunk& entry) {
      if (entry.id == kObjectId) {
        const std::uint32_t number = read_u32(entry);
        if (number < 1 || number > kind.size()) {
          fail(entry, fmt::format("state of object {} of {}", number, kind.size()));
        }
        index = kind[number - 1];
        if (done[*index]++ != 0) fail(entry, fmt::format("two states of object {}", number));
        state.objects[*index].data.resize(objects[*index].data.size());
        return;
      }
      if (!index) fail(entry, "state of an object before its number");
      XpltObjectState& object = state.objects[*index];
      if (take(entry, kObjectPosition, object.position) || take(entry, kObjectRotation, object.rotation) ||
          take(entry, kPointCoordinate, object.point) || take(entry, kLineEnds, object.line_ends) ||
          entry.id != kObjectData)
        return;
      for_each_child(entry, [&](const Chunk& item) {
        if (item.id >= object.data.size()) {
          fail(item, fmt::format("data item {} of an object with {}", item.id, object.data.size()));
        }
        const XpltVariable& description = objects[*index].data[item.id];
        require_size(item, 4 * static_cast<std::size_t>(floats_per_value(description)));
        object.data[item.id] = read_floats(item);
      });
    });
    if (!index) fail(child, "state of an object without its number");
  });
  if (std::find(done.begin(), done.end(), 0) != done.end()) fail(section, "not every object has a state");
}

XpltState read_state(const Chunk& chunk, const XpltFile& file) {
  const std::size_t elements = element_count(file.meshes.back());
  XpltState state;
  state.mesh = static_cast<int>(file.meshes.size()) - 1;
  state.variables.resize(file.variables.size());
  bool has_time = false;
  for_each_child(chunk, [&](const Chunk& child) {
    switch (child.id) {
      case kStateHeader:
        for_each_child(child, [&](const Chunk& entry) {
          if (entry.id == kStateTime) {
            state.time = read_float(entry);
            has_time = true;
          }
          take(entry, kStateStatus, state.status);
        });
        break;
      case kMeshState:
        for_each_child(child, [&](const Chunk& entry) {
          if (entry.id != kElementFlags) return;
          require_size(entry, 4 * elements);
          state.element_flags.clear();
          for (std::size_t at = entry.begin; at < entry.end; at += 4)
            state.element_flags.push_back(u32_at(*entry.source, at));
        });
        break;
      case kStateData: {
        std::set<std::uint32_t> done;
        for_each_child(child, [&](const Chunk& section) {
          const auto* found = std::find(kGroupData, kGroupData + kGroups, section.id);
          if (found == kGroupData + kGroups) return pass_over_unknown(section, "a state");
          if (!done.insert(section.id).second) fail_header(section, "data of one kind twice in one state");
          read_data(section, file, static_cast<XpltGroup>(found - kGroupData), state);
        });
        break;
      }
      case kObjectStates:
        read_object_states(child, file.meshes.front().objects, state);
        break;
      default:
        pass_over_unknown(child, "a state");
    }
  });
  if (!has_time) fail(chunk, "state without a time");
  return state;
}

// ----------------------------------------------------------------------------------------------- file

// The bytes of the zlib stream that starts at `at`; `at` moves behind it. Nothing if the file ends first.
std::optional<std::string> unpack(const Source& file, std::size_t& at) {
  z_stream stream = {};
  if (inflateInit(&stream) != Z_OK) fail(file, at, "not enough memory to unpack");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  const std::size_t start = at;
  std::string result;
  std::string buffer(1 << 16, '\0');
  int code = Z_OK;
  bool too_long = false, asked = false;
  while (code == Z_OK && !too_long && (at < file.bytes->size() || stream.avail_out == 0)) {
    // avail_in is 32 bits wide; the file may be longer.
    const auto portion = static_cast<uInt>(std::min<std::size_t>(file.bytes->size() - at, 1 << 20));
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(file.bytes->data() + at));
    stream.avail_in = portion;
    stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
    stream.avail_out = static_cast<uInt>(buffer.size());
    code = inflate(&stream, Z_NO_FLUSH);
    at += portion - stream.avail_in;
    result.append(buffer, 0, buffer.size() - stream.avail_out);
    // The chunk states its own size: a stream that runs on is damage, or made to fill the memory.
    if (result.size() >= 8) {
      Source unpacked = file;
      unpacked.bytes = &result;
      const std::uint32_t size = u32_at(unpacked, 4);
      if (!asked) need_memory(*file.name, kXpltMemory * size);
      asked = true;
      too_long = result.size() - 8 > size;
    }
  }
  if (too_long) fail(file, start, "compressed chunk longer than it says");
  if (code == Z_STREAM_END) return result;
  if (code == Z_OK || code == Z_BUF_ERROR) return std::nullopt;
  fail(file, start, "damaged compressed data");
}

// The chunk at `at` of an uncompressed part of the file; nothing if the file ends first.
std::optional<Chunk> top_chunk(const Source& file, std::size_t& at) {
  const std::size_t left = file.bytes->size() - at;
  if (left < 8) return std::nullopt;
  const std::size_t size = u32_at(file, at + 4);
  if (size > left - 8) return std::nullopt;
  const Chunk chunk{&file, u32_at(file, at), at + 8, at + 8 + size};
  at += 8 + size;
  return chunk;
}

// A mesh or a state, after the first mesh.
void read_mesh_or_state(const Chunk& chunk, XpltFile& file) {
  if (chunk.id == kState) {
    file.states.push_back(read_state(chunk, file));
  } else if (chunk.id == kMesh) {
    XpltMesh mesh = read_mesh(chunk, file.version);
    if (!mesh.objects.empty()) fail(chunk, "objects in another mesh than the first");
    file.meshes.push_back(std::move(mesh));
  } else {
    if (!is_newer(*chunk.source))
      fail_header(chunk, fmt::format("chunk {:08x} where a state or a mesh is expected", chunk.id));
    pass_over_unknown(chunk, "the file");
  }
}

std::string bytes_of_file(const std::string& path) {
  const auto fail_reading = [&](int error) {
    if (error == ENOENT || error == ENOTDIR) throw InputError(path + ": no such file: check the path");
    throw InputError(fmt::format("{}: {}", path, reason_of(error != 0 ? error : EIO)));
  };
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) fail_reading(EISDIR);
  if (!may_read(path)) fail_reading(errno);
  std::optional<std::string> bytes = whole_file(path, kXpltMemory);
  if (!bytes) fail_reading(EIO);
  return std::move(*bytes);
}

// The wrong one of a pair is named easily: of a model, what makes a plot file of it.
void refuse_model(const std::string& bytes, const std::string& name) {
  constexpr std::size_t kStart = 1 << 16;  // comments come before the root
  if (bytes.substr(0, kStart).find("<febio_spec") == std::string::npos) return;
  std::filesystem::path plot = name;
  if (plot.extension() == ".feb") plot.replace_extension();
  plot += "_dea.xplt";
  throw InputError(fmt::format("{}: this is a FEBio model, not a plot file: \"dea run {}\" writes {}, take that", name,
                               name, plot.string()));
}

}  // namespace

XpltFile xplt_from_bytes(const std::string& bytes, const std::string& name) {
  Source source{&name, &bytes};
  refuse_model(bytes, name);
  if (bytes.size() < 4) fail(source, 0, "not an FEBio plot file (too short)");
  source.swapped = u32_at(source, 0) != kMagic;
  if (u32_at(source, 0) != kMagic) fail(source, 0, "not an FEBio plot file");

  XpltFile file;
  source.passed_over = &file.passed_over;
  std::size_t at = 4;
  const std::optional<Chunk> root = top_chunk(source, at);
  if (!root) fail(source, at, "the file ends in its root");
  if (root->id != kRoot) fail_header(*root, fmt::format("chunk {:08x} where the root is expected", root->id));
  read_root(*root, source, file);
  const std::optional<Chunk> mesh = top_chunk(source, at);
  if (!mesh) fail(source, at, "the file ends before or in its mesh");
  if (mesh->id != kMesh) fail_header(*mesh, fmt::format("chunk {:08x} where the mesh is expected", mesh->id));
  file.meshes.push_back(read_mesh(*mesh, file.version));

  double since_asked = 0;  // many states of little can be much
  while (at < bytes.size() && !file.truncated) {
    if (file.compressed) {
      const std::size_t start = at;
      const std::optional<std::string> unpacked = unpack(source, at);
      file.truncated = !unpacked;
      if (!unpacked) break;
      since_asked += kXpltMemory * static_cast<double>(unpacked->size());
      if (since_asked > kLittleMemory) {
        need_memory(name, since_asked);
        since_asked = 0;
      }
      Source inner = source;
      inner.bytes = &*unpacked;
      inner.unpacked_from = start;
      std::size_t inner_at = 0;
      const std::optional<Chunk> chunk = top_chunk(inner, inner_at);
      if (!chunk || inner_at != unpacked->size()) {
        fail(inner, 0, fmt::format("{} bytes do not hold one chunk", unpacked->size()));
      }
      read_mesh_or_state(*chunk, file);
    } else {
      const std::size_t start = at;
      const std::optional<Chunk> chunk = top_chunk(source, at);
      file.truncated = !chunk;
      if (chunk) read_mesh_or_state(*chunk, file);
      if (chunk || bytes.size() - start < 4) continue;
      // Cut off if it begins like a chunk that may stand here; else the file is damaged.
      const std::uint32_t id = u32_at(source, start);
      if (id != kState && id != kMesh && !is_newer(source))
        fail(source, start, fmt::format("chunk {:08x} where a state or a mesh is expected", id));
    }
  }
  return file;
}

namespace {

// The time of the state whose bytes begin so; nothing: they begin otherwise than FEBio's and ours.
std::optional<float> time_at_start(const std::string& bytes, const std::string& name) {
  const Source source{&name, &bytes};
  if (bytes.size() < 8 || u32_at(source, 0) != kStateHeader) return std::nullopt;
  const std::size_t end = 8 + std::size_t{u32_at(source, 4)};
  for (std::size_t at = 8; at + 12 <= std::min(end, bytes.size()); at += 8 + std::size_t{u32_at(source, at + 4)})
    if (u32_at(source, at) == kStateTime) return float_at(source, at + 8);
  return std::nullopt;
}

// Header, mesh and times by looking at the starts of chunks; nothing: read all of it.
std::optional<XpltFile> skimmed(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!in || error) return std::nullopt;
  std::uintmax_t at = 0;
  const auto take = [&](std::uintmax_t count, std::string& bytes) {
    if (count > size - at) return false;
    bytes.resize(count);
    in.read(bytes.data(), static_cast<std::streamsize>(count));
    at += count;
    return static_cast<bool>(in);
  };
  const auto take_header = [&](std::uint32_t id, std::string& bytes) -> std::optional<std::uint32_t> {
    if (!take(8, bytes)) return std::nullopt;
    const Source source{&path, &bytes};
    return u32_at(source, 0) == id ? std::optional(u32_at(source, 4)) : std::nullopt;
  };
  std::string start, header, chunk;
  if (!take(4, start)) return std::nullopt;
  for (const std::uint32_t id : {kRoot, kMesh}) {
    const auto length = take_header(id, header);
    if (!length || !take(*length, chunk)) return std::nullopt;
    start += header + chunk;
  }
  XpltFile file = xplt_from_bytes(start, path);
  if (file.compressed) return std::nullopt;
  while (at < size) {
    const auto length = take_header(kState, header);
    constexpr std::uint32_t kEnough = 64;  // of a state, to know its time
    const std::uintmax_t behind = length ? at + *length : 0;
    if (!length || behind > size || !take(std::min(*length, kEnough), chunk)) return std::nullopt;
    const std::optional<float> time = time_at_start(chunk, path);
    if (!time) return std::nullopt;
    file.states.emplace_back().time = *time;
    at = behind;
    in.seekg(static_cast<std::streamoff>(at));
  }
  return file;
}

}  // namespace

bool is_newer(const XpltFile& file) { return file.version > kNewestVersion; }

XpltFile read_xplt_outline(const std::string& path) {
  std::optional<XpltFile> file = skimmed(path);
  return file ? std::move(*file) : read_xplt(path);
}

XpltFile read_xplt(const std::string& path) { return xplt_from_bytes(bytes_of_file(path), path); }

}  // namespace dea
