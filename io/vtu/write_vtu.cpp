#include "io/vtu/write_vtu.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "io/files/encoded_text.h"
#include "io/files/system.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/time_text.h"

namespace dea {

namespace {

namespace fs = std::filesystem;

std::vector<int> straight(int nodes) {
  std::vector<int> order;
  for (int k = 0; k < nodes; ++k) order.push_back(k);
  return order;
}

template <typename T>
constexpr const char* vtk_type() {
  if constexpr (std::is_same_v<T, float>) return "Float32";
  if constexpr (std::is_same_v<T, double>) return "Float64";
  if constexpr (std::is_same_v<T, std::int32_t>) return "Int32";
  if constexpr (std::is_same_v<T, std::int64_t>) return "Int64";
  return "UInt8";
}

constexpr const char* kByteOrder = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";

/// `field`: an array of field data says its number of tuples, those of points and cells have theirs.
template <typename T>
std::string data_array(const std::string& name, int components, const std::vector<T>& values, bool field = false) {
  const std::uint64_t size = values.size() * sizeof(T);
  std::string bytes(sizeof size + size, '\0');
  std::memcpy(bytes.data(), &size, sizeof size);
  if (size > 0) std::memcpy(bytes.data() + sizeof size, values.data(), size);
  return fmt::format(
      "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"{} format=\"binary\">{}</DataArray>\n",
      vtk_type<T>(), escaped(name), components,
      field ? fmt::format(" NumberOfTuples=\"{}\"", values.size() / at(components)) : "", base64(bytes));
}

/// Texts, as VTK has them: the codes of their bytes, each text with a zero at its end.
std::string text_array(const std::string& name, const std::vector<std::string>& texts) {
  std::string out = fmt::format("<Array type=\"String\" Name=\"{}\" NumberOfTuples=\"{}\" format=\"ascii\">\n",
                                escaped(name), texts.size());
  for (const std::string& text : texts) {
    for (char c : text) out += fmt::format("{} ", static_cast<unsigned>(static_cast<unsigned char>(c)));
    out += "0\n";
  }
  return out + "</Array>\n";
}

struct Cells {
  std::vector<std::int64_t> connectivity, offsets;
  std::vector<std::uint8_t> types;
};

/// `nodes`: of the element, in our order; `point`: the file's point of a node.
template <typename Point>
void add_cell(Cells& cells, const VtkCell& cell, const int* nodes, const Point& point) {
  for (int k : cell.order) cells.connectivity.push_back(point(nodes[k]));
  cells.offsets.push_back(static_cast<std::int64_t>(cells.connectivity.size()));
  cells.types.push_back(static_cast<std::uint8_t>(cell.type));
}

std::string document(std::size_t points, const Cells& cells, const std::string& field_data,
                     const std::string& coordinates, const std::string& point_data, const std::string& cell_data) {
  return fmt::format(
             "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{}\" "
             "header_type=\"UInt64\">\n<UnstructuredGrid>\n",
             kByteOrder) +
         "<FieldData>\n" + field_data + "</FieldData>\n" +
         fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", points, cells.types.size()) +
         "<Points>\n" + coordinates + "</Points>\n<Cells>\n" + data_array("connectivity", 1, cells.connectivity) +
         data_array("offsets", 1, cells.offsets) + data_array("types", 1, cells.types) + "</Cells>\n<PointData>\n" +
         point_data + "</PointData>\n<CellData>\n" + cell_data +
         "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

std::string time_value(const XpltState& state) {
  return data_array("TimeValue", 1, std::vector<double>{time_meant(state.time)}, true);
}

/// Values at `nodes` of the mesh.
std::vector<float> picked(const std::vector<float>& values, const std::vector<int>& nodes, int components) {
  std::vector<float> out;
  out.reserve(nodes.size() * at(components));
  for (int node : nodes)
    for (int k = 0; k < components; ++k) out.push_back(values[at(node) * at(components) + at(k)]);
  return out;
}

std::string nodal_data(const XpltFile& file, const XpltMesh& mesh, const XpltState& state,
                       const std::vector<int>& nodes) {
  std::string out;
  for (std::size_t v = 0; v < file.variables.size(); ++v) {
    const XpltVariable& variable = file.variables[v];
    if (variable.group != XpltGroup::Nodal || state.variables[v].empty()) continue;
    const int components = floats_per_value(variable);
    out += data_array(variable.name, components, picked(state.variables[v].front().values, nodes, components));
  }
  std::vector<std::int32_t> ids;
  for (int node : nodes) ids.push_back(mesh.node_ids[at(node)]);
  return out + data_array("node id", 1, ids);
}

/// The surfaces that have values, each with points of its own: two may share nodes and differ there.
struct SurfaceCells {
  Cells cells;
  std::vector<int> surfaces;     ///< indices into XpltMesh::surfaces
  std::vector<int> nodes;        ///< per point: the mesh's node
  std::vector<int> surface;      ///< per point: index into `surfaces`
  std::vector<int> facet, slot;  ///< per point: the first facet that has it, and its place there
  std::vector<std::int32_t> cell_surface, cell_facet;
};

SurfaceCells surface_cells(const XpltFile& file, const XpltMesh& mesh, const XpltState& state) {
  std::vector<char> has_values(mesh.surfaces.size(), 0);
  for (std::size_t v = 0; v < file.variables.size(); ++v) {
    if (file.variables[v].group != XpltGroup::Surface) continue;
    for (const XpltRegion& region : state.variables[v]) has_values[at(region.region - 1)] = 1;
  }
  SurfaceCells out;
  for (std::size_t s = 0; s < mesh.surfaces.size(); ++s) {
    if (!has_values[s]) continue;
    const XpltFacets& facets = mesh.surfaces[s];
    out.surfaces.push_back(static_cast<int>(s));
    std::unordered_map<int, std::int64_t> point_of;
    for (int f = 0; f < facets.size(); ++f) {
      const int begin = facets.begin[at(f)], count = facets.begin[at(f) + 1] - begin;
      for (int k = 0; k < count; ++k) {
        const int node = facets.nodes[at(begin + k)];
        if (!point_of.emplace(node, static_cast<std::int64_t>(out.nodes.size())).second) continue;
        out.nodes.push_back(node);
        out.surface.push_back(static_cast<int>(out.surfaces.size()) - 1);
        out.facet.push_back(f);
        out.slot.push_back(k);
      }
      add_cell(out.cells, vtk_facet(count), facets.nodes.data() + begin, [&](int node) { return point_of.at(node); });
      out.cell_surface.push_back(static_cast<std::int32_t>(s) + 1);
      out.cell_facet.push_back(f + 1);
    }
  }
  return out;
}

/// Values of a region in the mesh's numbering of surfaces; nullptr: it has none.
const std::vector<float>* values_of(const std::vector<XpltRegion>& regions, int surface) {
  for (const XpltRegion& region : regions)
    if (region.region == surface + 1) return &region.values;
  return nullptr;
}

/// Values of a variable on these surfaces or domains, one after the other; 0 where one has none.
std::vector<float> in_a_row(const XpltMesh& mesh, const XpltVariable& variable, const std::vector<XpltRegion>& regions,
                            const std::vector<int>& parts) {
  std::vector<float> all;
  for (int part : parts) {
    if (const std::vector<float>* values = values_of(regions, part))
      all.insert(all.end(), values->begin(), values->end());
    else
      all.resize(all.size() + at(floats_in_region(mesh, variable, part + 1)), 0.0f);
  }
  return all;
}

std::vector<float> per_point(const SurfaceCells& out, const XpltMesh& mesh, const std::vector<XpltRegion>& regions,
                             int components) {
  std::vector<float> all;
  all.reserve(out.nodes.size() * at(components));
  for (std::size_t p = 0; p < out.nodes.size(); ++p) {
    const int surface = out.surfaces[at(out.surface[p])];
    const std::vector<float>* values = values_of(regions, surface);
    const std::size_t place = at(out.facet[p]) * at(mesh.surfaces[at(surface)].max_nodes) + at(out.slot[p]);
    for (int k = 0; k < components; ++k) all.push_back(values ? (*values)[place * at(components) + at(k)] : 0.0f);
  }
  return all;
}

/// Fields with a value per element; 0 in domains without.
std::string element_data(const XpltFile& file, const XpltMesh& mesh, const XpltState& state) {
  std::string data;
  for (std::size_t v = 0; v < file.variables.size(); ++v) {
    const XpltVariable& variable = file.variables[v];
    if (variable.group != XpltGroup::Domain || variable.format != XpltFormat::Item || state.variables[v].empty())
      continue;
    data += data_array(variable.name, floats_per_value(variable),
                       in_a_row(mesh, variable, state.variables[v], straight(static_cast<int>(mesh.domains.size()))));
  }
  return data;
}

std::string file_name(const char* what, std::size_t state) { return fmt::format("{}_{:04}.vtu", what, state); }

std::string pvd(const std::vector<float>& times) {
  std::string out = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"{}\">\n<Collection>\n",
      kByteOrder);
  for (std::size_t i = 0; i < times.size(); ++i) {
    int part = 0;
    for (const char* what : {"mesh", "surfaces"})
      out += fmt::format("<DataSet timestep=\"{}\" group=\"\" part=\"{}\" name=\"{}\" file=\"{}\"/>\n",
                         time_text(times[i]), part++, what, file_name(what, i));
  }
  return out + "</Collection>\n</VTKFile>\n";
}

}  // namespace

const VtkCell& vtk_cell(int element_type) {
  // VTK's wedge has the normal of its nodes 0, 1, 2 pointing out of it, ours into it.
  static const VtkCell kCells[] = {
      {12, straight(8)},         // hex8
      {13, {0, 2, 1, 3, 5, 4}},  // penta6
      {10, straight(4)},         // tet4
      {9, straight(4)},          // quad4
      {5, straight(3)},          // tri3
      {3, straight(2)},          // line2
      {25, straight(20)},        // hex20
      {24, straight(10)},        // tet10
      {24, straight(10)},        // tet15
      {29, {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13,
            14, 15, 16, 17, 18, 19, 23, 21, 20, 22, 24, 25, 26}},  // hex27: face centres -x +x -y +y -z +z
      {22, straight(6)},                                           // tri6
      {23, straight(8)},                                           // quad8
      {28, straight(9)},                                           // quad9
      {26, {0, 2, 1, 3, 5, 4, 8, 7, 6, 11, 10, 9, 12, 14, 13}},    // penta15
      {71, {0, 1, 2, 3, 4, 5, 6, 7, 9, 8, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19}},  // tet20: edge from 2 to 0
      {69, {0, 1, 2, 3, 4, 5, 6, 8, 7, 9}},                                          // tri10: edge from 2 to 0
      {14, straight(5)},                                                             // pyra5
      {10, straight(4)},                                                             // tet5
      {27, straight(13)},                                                            // pyra13
      {21, straight(3)},                                                             // line3
  };
  if (element_type < 0 || at(element_type) >= std::size(kCells))
    throw std::logic_error(fmt::format("element type {} has no cell of VTK", element_type));
  return kCells[at(element_type)];
}

const VtkCell& vtk_facet(int nodes) {
  static const VtkCell kTri7 = {34, straight(7)};
  static constexpr int kTypes[][2] = {{3, 4}, {4, 3}, {6, 10}, {8, 11}, {9, 12}, {10, 15}};  // nodes, element type
  if (nodes == 7) return kTri7;
  for (const auto& [count, type] : kTypes)
    if (count == nodes) return vtk_cell(type);
  throw std::logic_error(fmt::format("a facet of {} nodes has no cell of VTK", nodes));
}

std::string mesh_vtu(const XpltFile& file, std::size_t index) {
  const XpltState& state = file.states.at(index);
  const XpltMesh& mesh = file.meshes.at(at(state.mesh));
  Cells cells;
  std::vector<std::int32_t> ids, parts;
  for (const XpltDomain& domain : mesh.domains) {
    const VtkCell& cell = vtk_cell(domain.element_type);
    const int nodes = xplt_nodes_per_element(domain.element_type);
    for (std::size_t e = 0; e < domain.element_ids.size(); ++e) {
      add_cell(cells, cell, domain.nodes.data() + e * at(nodes), [](int node) { return std::int64_t{node}; });
      ids.push_back(domain.element_ids[e]);
      parts.push_back(domain.part);
    }
  }
  return document(mesh.node_ids.size(), cells, time_value(state) + text_array("part names", mesh.parts),
                  data_array("Points", 3, mesh.coordinates),
                  nodal_data(file, mesh, state, straight(static_cast<int>(mesh.node_ids.size()))),
                  element_data(file, mesh, state) + data_array("element id", 1, ids) + data_array("part", 1, parts));
}

std::string surfaces_vtu(const XpltFile& file, std::size_t index) {
  const XpltState& state = file.states.at(index);
  const XpltMesh& mesh = file.meshes.at(at(state.mesh));
  const SurfaceCells out = surface_cells(file, mesh, state);
  std::vector<std::string> names;
  for (int s : out.surfaces) names.push_back(mesh.surfaces[at(s)].name);
  std::string field_data = time_value(state) + text_array("surface names", names);
  std::string point_data = nodal_data(file, mesh, state, out.nodes), cell_data;
  for (std::size_t v = 0; v < file.variables.size(); ++v) {
    const XpltVariable& variable = file.variables[v];
    if (variable.group != XpltGroup::Surface || state.variables[v].empty()) continue;
    const std::vector<XpltRegion>& regions = state.variables[v];
    const int components = floats_per_value(variable);
    if (variable.format == XpltFormat::Item)
      cell_data += data_array(variable.name, components, in_a_row(mesh, variable, regions, out.surfaces));
    else if (variable.format == XpltFormat::Mult)
      point_data += data_array(variable.name, components, per_point(out, mesh, regions, components));
    else if (variable.format == XpltFormat::Region)
      field_data += data_array(variable.name, components, in_a_row(mesh, variable, regions, out.surfaces), true);
  }
  return document(out.nodes.size(), out.cells, field_data,
                  data_array("Points", 3, picked(mesh.coordinates, out.nodes, 3)), point_data,
                  cell_data + data_array("surface", 1, out.cell_surface) + data_array("facet", 1, out.cell_facet));
}

namespace {

/// `give`: gives one of the texts, those of mesh and surfaces of each state in turn, to `put`.
void write_files(const std::string& folder, const std::vector<float>& times,
                 const std::function<void(std::size_t text, const PutPiece& put)>& give) {
  std::error_code error;
  const auto fail = [](const fs::path& path, const std::string& why) {
    throw WriteError(fmt::format("{}: {}", path.string(), why));
  };
  const fs::path target = folder;
  const bool made = fs::create_directory(target, error);  // false, without an error: it is there
  if (error) fail(target, reason_of(error));
  try {
    const fs::path own = target / fmt::format(".dea-{}.tmp", process_id());
    if (!fs::create_directory(own, error))
      fail(target, error ? reason_of(error) : fmt::format("{} is in the way", own.filename().string()));
    const Temporary temporary(own);

    std::vector<std::string> names;
    const auto add = [&](const std::string& name, const std::function<void(const PutPiece&)>& text) {
      if (fs::is_directory(target / name, error)) fail(target / name, "is a folder");
      const std::string path = (own / name).string();
      try {
        write_pieces(path, text);
      } catch (const WriteError& e) {  // the user knows no temporary folder
        const std::string why = e.what();
        fail(target / name, why.rfind(path + ": ", 0) == 0 ? why.substr(path.size() + 2) : why);
      }
      names.push_back(name);
    };
    for (std::size_t i = 0; i < times.size(); ++i) {
      add(file_name("mesh", i), [&](const PutPiece& put) { give(2 * i, put); });
      add(file_name("surfaces", i), [&](const PutPiece& put) { give(2 * i + 1, put); });
    }
    add("results.pvd", [&](const PutPiece& put) { put(pvd(times)); });
    for (const std::string& name : names) {
      const int why = replace_file((own / name).string(), (target / name).string());
      if (why != 0) fail(target / name, reason_of(why));
    }
  } catch (...) {
    if (made) fs::remove(target, error);  // only when it is empty
    throw;
  }
}

}  // namespace

void write_vtu(const std::string& folder, const XpltFile& file) {
  std::vector<float> times;
  for (const XpltState& state : file.states) times.push_back(state.time);
  write_files(folder, times, [&](std::size_t text, const PutPiece& put) {
    put(text % 2 == 0 ? mesh_vtu(file, text / 2) : surfaces_vtu(file, text / 2));
  });
}

VtuWriter::VtuWriter(std::string folder, XpltFile head)
    : folder_(std::move(folder)), head_(std::move(head)), texts_(without_slash(folder_)) {
  head_.states.clear();
}

void VtuWriter::add(XpltState state) {
  times_.push_back(state.time);
  head_.states.push_back(std::move(state));
  texts_.add(mesh_vtu(head_, 0));
  ends_.push_back(texts_.size());
  texts_.add(surfaces_vtu(head_, 0));
  ends_.push_back(texts_.size());
  head_.states.clear();
}

void VtuWriter::finish() {
  write_files(folder_, times_, [&](std::size_t text, const PutPiece& put) {
    const std::uint64_t begin = text == 0 ? 0 : ends_[text - 1];
    texts_.read(begin, ends_[text] - begin, put);
  });
}

}  // namespace dea
