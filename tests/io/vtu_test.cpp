// Files for ParaView and CSV per facet: VTK's node order on unit cells, and the numbers of a run beside its plot file.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "io/vtu/write_vtu.h"
#include "io/xplt/xplt.h"
#include "src/base/numbers.h"
#include "src/model/element_faces.h"
#include "tests/program.h"

namespace dea::vtu_test {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Points = std::vector<Vector3d>;
using Lists = std::vector<std::vector<int>>;

// ---- node order

/// A point as the mean of corners; a corner named twice counts twice, which puts a point at a third of an edge.
Vector3d mean(const Points& corners, const std::vector<int>& list) {
  Vector3d sum = Vector3d::Zero();
  for (int i : list) sum += corners[at(i)];
  return sum / static_cast<double>(list.size());
}

/// A cell on paper: corners, then nodes at means of corners.
struct Cell {
  const char* name;
  int element_type;  ///< of the plot file
  ElementShape shape;
  int vtk_type;
  double measure;      ///< volume, or area of a shell
  Points corners;      ///< FEBio's order
  Lists febio_others;  ///< FEBio's further nodes: means of FEBio's corners
  Lists vtk_others;    ///< VTK's further nodes: means of VTK's corners
  Lists vtk_faces;     ///< VTK's corners of each face, normal out of the cell; shells: itself
};

const Points kHex = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
const Points kWedge = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
const Points kTet = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const Points kPyramid = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}};
const Points kTri = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
const Points kQuad = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

// VTK's documentation of vtkHexahedron, vtkWedge, vtkTetra, vtkPyramid and their quadratic kin.
const Lists kHexFaces = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}};
const Lists kWedgeFaces = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}};
const Lists kTetFaces = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 2, 1}};
const Lists kPyramidFaces = {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
const Lists kHexEdges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                         {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
const Lists kWedgeEdges = {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}};
const Lists kTetEdges = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
const Lists kPyramidEdges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}};
const Lists kTriEdges = {{0, 1}, {1, 2}, {2, 0}};
const Lists kQuadEdges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};

Lists joined(Lists a, const Lists& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Two nodes at the thirds of each edge, the first beside the edge's first corner.
Lists thirds(const Lists& edges) {
  Lists out;
  for (const auto& e : edges) {
    out.push_back({e[0], e[0], e[1]});
    out.push_back({e[0], e[1], e[1]});
  }
  return out;
}

/// FEBio's order from its shape functions: where each is 1.
std::vector<Cell> cells() {
  using E = ElementShape;
  const Lists hex_middle = {{0, 6}};
  // FEBio's face centres of a hex27: -y, +x, +y, -x, -z, +z
  const Lists febio_hex27 = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7},
                             {0, 1, 2, 3}, {4, 5, 6, 7}, {0, 6}};
  const Lists febio_tri10 = {{0, 0, 1}, {0, 1, 1}, {1, 1, 2}, {1, 2, 2}, {0, 0, 2}, {0, 2, 2}, {0, 1, 2}};
  const Lists febio_tet20 = {{0, 0, 1}, {0, 1, 1}, {1, 1, 2}, {1, 2, 2}, {0, 0, 2}, {0, 2, 2}, {0, 0, 3}, {0, 3, 3},
                             {1, 1, 3}, {1, 3, 3}, {2, 2, 3}, {2, 3, 3}, {0, 1, 3}, {1, 2, 3}, {0, 2, 3}, {0, 1, 2}};
  const Lists febio_tet15 = joined(kTetEdges, {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {0, 2, 3}, {0, 1, 2, 3}});
  return {
      {"hex8", 0, E::Hex8, 12, 1.0, kHex, {}, {}, kHexFaces},
      {"hex20", 6, E::Hex20, 25, 1.0, kHex, kHexEdges, kHexEdges, kHexFaces},
      {"hex27", 9, E::Hex27, 29, 1.0, kHex, joined(kHexEdges, febio_hex27),
       joined(joined(kHexEdges, kHexFaces), hex_middle), kHexFaces},
      {"penta6", 1, E::Penta6, 13, 0.5, kWedge, {}, {}, kWedgeFaces},
      {"penta15", 13, E::Penta15, 26, 0.5, kWedge, kWedgeEdges, kWedgeEdges, kWedgeFaces},
      {"tet4", 2, E::Tet4, 10, 1.0 / 6, kTet, {}, {}, kTetFaces},
      {"tet5", 17, E::Tet5, 10, 1.0 / 6, kTet, {{0, 1, 2, 3}}, {}, kTetFaces},
      {"tet10", 7, E::Tet10, 24, 1.0 / 6, kTet, kTetEdges, kTetEdges, kTetFaces},
      {"tet15", 8, E::Tet15, 24, 1.0 / 6, kTet, febio_tet15, kTetEdges, kTetFaces},
      {"tet20", 14, E::Tet20, 71, 1.0 / 6, kTet, febio_tet20,
       joined(thirds(kTetEdges), {{0, 1, 3}, {1, 2, 3}, {0, 2, 3}, {0, 1, 2}}), kTetFaces},
      {"pyra5", 16, E::Pyra5, 14, 1.0 / 3, kPyramid, {}, {}, kPyramidFaces},
      {"pyra13", 18, E::Pyra13, 27, 1.0 / 3, kPyramid, kPyramidEdges, kPyramidEdges, kPyramidFaces},
      {"tri3", 4, E::Tri3, 5, 0.5, kTri, {}, {}, {{0, 1, 2}}},
      {"tri6", 10, E::Tri6, 22, 0.5, kTri, kTriEdges, kTriEdges, {{0, 1, 2}}},
      {"tri10", 15, E::Tri3, 69, 0.5, kTri, febio_tri10, joined(thirds(kTriEdges), {{0, 1, 2}}), {{0, 1, 2}}},
      {"quad4", 3, E::Quad4, 9, 1.0, kQuad, {}, {}, {{0, 1, 2, 3}}},
      {"quad8", 11, E::Quad8, 23, 1.0, kQuad, kQuadEdges, kQuadEdges, {{0, 1, 2, 3}}},
      {"quad9",
       12,
       E::Quad9,
       28,
       1.0,
       kQuad,
       joined(kQuadEdges, {{0, 1, 2, 3}}),
       joined(kQuadEdges, {{0, 1, 2, 3}}),
       {{0, 1, 2, 3}}},
      {"line2", 5, E::Line2, 3, 0.0, {{0, 0, 0}, {1, 0, 0}}, {}, {}, {}},
      {"line3", 19, E::Line3, 21, 0.0, {{0, 0, 0}, {1, 0, 0}}, {{0, 1}}, {{0, 1}}, {}},
  };
}

/// Vector area of a polygon, and the volume between it and the origin.
Vector3d vector_area(const Points& x, const std::vector<int>& face) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t k = 2; k < face.size(); ++k)
    sum += 0.5 * (x[at(face[k - 1])] - x[at(face[0])]).cross(x[at(face[k])] - x[at(face[0])]);
  return sum;
}

TEST(Vtu, CellsHaveVtksTypeAndNodeOrder) {
  for (const Cell& c : cells()) {
    SCOPED_TRACE(c.name);
    if (std::string(c.name) != "tri10") {
      EXPECT_EQ(xplt_element_type(c.shape), c.element_type);
    }
    Points febio = c.corners;
    for (const auto& list : c.febio_others) febio.push_back(mean(c.corners, list));
    ASSERT_EQ(static_cast<int>(febio.size()), xplt_nodes_per_element(c.element_type));
    const VtkCell& cell = vtk_cell(c.element_type);
    EXPECT_EQ(cell.type, c.vtk_type);
    ASSERT_EQ(cell.order.size(), c.corners.size() + c.vtk_others.size());
    Points vtk;
    for (int k : cell.order) vtk.push_back(febio.at(at(k)));
    for (std::size_t k = 0; k < c.vtk_others.size(); ++k)
      EXPECT_LT((vtk[c.corners.size() + k] - mean(vtk, c.vtk_others[k])).norm(), 1e-15)
          << "node " << c.corners.size() + k;
    if (is_line(c.shape)) {
      EXPECT_EQ(vtk[0], c.corners[0]);
    } else if (is_shell(c.shape)) {
      EXPECT_LT((vector_area(vtk, c.vtk_faces[0]) - Vector3d(0, 0, c.measure)).norm(), 1e-15);
    } else {  // divergence of x / 3
      double volume = 0.0;
      for (const auto& face : c.vtk_faces) volume += vtk[at(face[0])].dot(vector_area(vtk, face)) / 3.0;
      EXPECT_NEAR(volume, c.measure, 1e-15);
      for (const auto& face : c.vtk_faces) {
        Vector3d middle = Vector3d::Zero();
        for (const Vector3d& x : c.corners) middle += x / static_cast<double>(c.corners.size());
        EXPECT_GT((vtk[at(face[0])] - middle).dot(vector_area(vtk, face)), 0.0);  // outward
      }
    }
  }
  EXPECT_THROW(vtk_cell(20), std::logic_error);
  EXPECT_THROW(vtk_cell(-1), std::logic_error);
}

TEST(Vtu, FacetsAreTheCellsOfTheirShells) {
  const std::map<int, int> types = {{3, 5}, {4, 9}, {6, 22}, {7, 34}, {8, 23}, {9, 28}, {10, 69}};
  for (const auto& [nodes, type] : types) {
    EXPECT_EQ(vtk_facet(nodes).type, type);
    EXPECT_EQ(static_cast<int>(vtk_facet(nodes).order.size()), nodes);
  }
  EXPECT_THROW(vtk_facet(5), std::logic_error);
}

// ---- reading what was written

std::string from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  unsigned word = 0;
  int bits = 0;
  for (char c : text) {
    if (c == '=') break;
    const std::size_t digit = digits.find(c);
    if (digit == std::string::npos) throw std::runtime_error("no base64");
    word = word << 6 | static_cast<unsigned>(digit);
    bits += 6;
    if (bits >= 8) out += static_cast<char>(word >> (bits -= 8) & 255u);
  }
  return out;
}

/// A .vtu file that has been read: arrays as numbers, by section and name.
struct Grid {
  int points = -1, cells = -1;
  std::map<std::string, std::vector<double>> arrays;  ///< "PointData/displacement"
  std::map<std::string, int> components;
  std::map<std::string, std::vector<std::string>> texts;
};

template <typename T>
std::vector<double> numbers(const std::string& bytes) {
  std::uint64_t size = 0;
  if (bytes.size() < sizeof size) throw std::runtime_error("no header");
  std::memcpy(&size, bytes.data(), sizeof size);
  if (bytes.size() != size + sizeof size || size % sizeof(T) != 0) throw std::runtime_error("header and data differ");
  std::vector<T> values(size / sizeof(T));
  if (size > 0) std::memcpy(values.data(), bytes.data() + sizeof size, size);
  return {values.begin(), values.end()};
}

void read_arrays(const tinyxml2::XMLElement* section, Grid& grid) {
  for (const auto* a = section->FirstChildElement(); a; a = a->NextSiblingElement()) {
    const std::string key = std::string(section->Name()) + "/" + a->Attribute("Name"), type = a->Attribute("type");
    if (type == "String") {
      std::istringstream words(a->GetText());
      std::vector<std::string> texts(1);
      for (int code; words >> code;) {
        if (code == 0)
          texts.emplace_back();
        else
          texts.back() += static_cast<char>(code);
      }
      texts.pop_back();
      ASSERT_EQ(static_cast<int>(texts.size()), a->IntAttribute("NumberOfTuples"));
      grid.texts[key] = texts;
      continue;
    }
    ASSERT_STREQ(a->Attribute("format"), "binary");
    const std::string bytes = from_base64(a->GetText());
    const std::map<std::string, std::vector<double> (*)(const std::string&)> readers = {
        {"Float32", numbers<float>},
        {"Float64", numbers<double>},
        {"Int32", numbers<std::int32_t>},
        {"Int64", numbers<std::int64_t>},
        {"UInt8", numbers<std::uint8_t>}};
    ASSERT_TRUE(readers.count(type)) << type;
    grid.arrays[key] = readers.at(type)(bytes);
    grid.components[key] = a->IntAttribute("NumberOfComponents");
    const int tuples = static_cast<int>(grid.arrays[key].size()) / grid.components[key];
    if (std::string(section->Name()) == "FieldData") {
      ASSERT_EQ(tuples, a->IntAttribute("NumberOfTuples")) << key;
    }
    if (std::string(section->Name()) == "PointData" || std::string(section->Name()) == "Points") {
      ASSERT_EQ(tuples, grid.points) << key;
    }
    if (std::string(section->Name()) == "CellData") {
      ASSERT_EQ(tuples, grid.cells) << key;
    }
    for (double x : grid.arrays[key]) ASSERT_TRUE(std::isfinite(x)) << key;
  }
}

Grid grid_from(const std::string& text) {
  Grid grid;
  tinyxml2::XMLDocument document;
  EXPECT_EQ(document.Parse(text.data(), text.size()), tinyxml2::XML_SUCCESS);
  const auto* root = document.RootElement();
  if (root == nullptr) return grid;
  EXPECT_STREQ(root->Name(), "VTKFile");
  EXPECT_STREQ(root->Attribute("type"), "UnstructuredGrid");
  EXPECT_STREQ(root->Attribute("header_type"), "UInt64");
  const auto* content = root->FirstChildElement("UnstructuredGrid");
  const auto* piece = content->FirstChildElement("Piece");
  grid.points = piece->IntAttribute("NumberOfPoints", -1);
  grid.cells = piece->IntAttribute("NumberOfCells", -1);
  read_arrays(content->FirstChildElement("FieldData"), grid);
  for (const char* section : {"Points", "Cells", "PointData", "CellData"})
    read_arrays(piece->FirstChildElement(section), grid);
  EXPECT_EQ(static_cast<int>(grid.arrays["Cells/offsets"].size()), grid.cells);
  EXPECT_EQ(static_cast<int>(grid.arrays["Cells/types"].size()), grid.cells);
  if (grid.cells > 0) {
    EXPECT_EQ(grid.arrays["Cells/offsets"].back(), static_cast<double>(grid.arrays["Cells/connectivity"].size()));
  }
  for (double p : grid.arrays["Cells/connectivity"]) EXPECT_TRUE(p >= 0 && p < grid.points);
  return grid;
}

std::vector<double> doubles(const std::vector<float>& values) { return {values.begin(), values.end()}; }

/// Two triangles that share an edge, one of them alone in the second surface with other values; a wedge under them.
XpltFile small_file() {
  XpltFile file;
  file.variables = {XpltVariable{XpltGroup::Nodal, XpltType::Vec3, XpltFormat::Node, "displacement"},
                    XpltVariable{XpltGroup::Surface, XpltType::Float, XpltFormat::Item, "contact <\"&> pressure"},
                    XpltVariable{XpltGroup::Surface, XpltType::Float, XpltFormat::Mult, "nodal"},
                    XpltVariable{XpltGroup::Surface, XpltType::Vec3, XpltFormat::Region, "contact force"}};
  XpltMesh mesh;
  mesh.node_ids = {1, 2, 3, 4, 5, 60, 7};
  for (const auto& x :
       {std::array<float, 3>{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}})
    mesh.coordinates.insert(mesh.coordinates.end(), x.begin(), x.end());
  mesh.parts = {"b\xC3\xB6ne", ""};
  XpltDomain domain;
  domain.element_type = 1;
  domain.part = 1;
  domain.element_ids = {17};
  domain.nodes = {0, 1, 2, 3, 4, 5};
  mesh.domains = {domain};
  XpltFacets unused{"unused", {0, 3}, {0, 2, 1}, 3}, two{"two", {0, 3, 6}, {3, 4, 5, 4, 6, 5}, 4},
      one{"one & only", {0, 3}, {3, 4, 5}, 3};
  mesh.surfaces = {unused, two, one};
  file.meshes = {mesh};
  XpltState state;
  state.time = 0.05f;
  state.element_flags = {1};
  std::vector<float> moved(21);
  std::iota(moved.begin(), moved.end(), 0.5f);
  state.variables = {{{0, moved}},
                     {{2, {1.5f, 2.5f}}, {3, {9.0f}}},
                     {{2, {10, 11, 12, 0, 11, 13, 12, 0}}, {3, {20, 21, 22}}},
                     {{2, {1, 2, 3}}}};
  file.states = {state};
  return file;
}

TEST(Vtu, MeshOfASmallFile) {
  const XpltFile file = small_file();
  Grid grid = grid_from(mesh_vtu(file, 0));
  EXPECT_EQ(grid.points, 7);
  EXPECT_EQ(grid.cells, 1);
  EXPECT_EQ(grid.arrays["Points/Points"], doubles(file.meshes[0].coordinates));
  EXPECT_EQ(grid.arrays["PointData/displacement"], doubles(file.states[0].variables[0][0].values));
  EXPECT_EQ(grid.components["PointData/displacement"], 3);
  EXPECT_EQ(grid.arrays["PointData/node id"], (std::vector<double>{1, 2, 3, 4, 5, 60, 7}));
  EXPECT_EQ(grid.arrays["Cells/connectivity"], (std::vector<double>{0, 2, 1, 3, 5, 4}));
  EXPECT_EQ(grid.arrays["Cells/types"], std::vector<double>{13});
  EXPECT_EQ(grid.arrays["CellData/element id"], std::vector<double>{17});
  EXPECT_EQ(grid.arrays["CellData/part"], std::vector<double>{1});
  EXPECT_EQ(grid.texts["FieldData/part names"], (std::vector<std::string>{"b\xC3\xB6ne", ""}));
  EXPECT_EQ(grid.arrays["FieldData/TimeValue"], std::vector<double>{0.05});  // not 0.0500000007
}

TEST(Vtu, SurfacesThatShareNodesKeepTheirOwnValues) {
  const XpltFile file = small_file();
  Grid grid = grid_from(surfaces_vtu(file, 0));
  EXPECT_EQ(grid.points, 7);  // 4 and 3
  EXPECT_EQ(grid.cells, 3);
  EXPECT_EQ(grid.arrays["PointData/node id"], (std::vector<double>{4, 5, 60, 7, 4, 5, 60}));
  EXPECT_EQ(grid.arrays["Cells/connectivity"], (std::vector<double>{0, 1, 2, 1, 3, 2, 4, 5, 6}));
  EXPECT_EQ(grid.arrays["CellData/surface"], (std::vector<double>{2, 2, 3}));
  EXPECT_EQ(grid.arrays["CellData/facet"], (std::vector<double>{1, 2, 1}));
  EXPECT_EQ(grid.arrays["CellData/contact <\"&> pressure"], (std::vector<double>{1.5, 2.5, 9}));
  EXPECT_EQ(grid.arrays["PointData/nodal"], (std::vector<double>{10, 11, 12, 13, 20, 21, 22}));
  EXPECT_EQ(grid.arrays["FieldData/contact force"], (std::vector<double>{1, 2, 3, 0, 0, 0}));
  EXPECT_EQ(grid.texts["FieldData/surface names"], (std::vector<std::string>{"two", "one & only"}));
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string fault_of(const std::string& folder, const XpltFile& file) {
  try {
    write_vtu(folder, file);
  } catch (const std::exception& e) {
    return e.what();
  }
  return "nothing thrown";
}

using Names = std::vector<std::string>;

TEST(Vtu, AFaultLeavesTheOlderFiles) {
  const test::TemporaryFolder folder;
  const std::string target = (folder.path / "vtu").string();
  write_vtu(target, small_file());
  EXPECT_EQ(names_in(target), (Names{"mesh_0000.vtu", "results.pvd", "surfaces_0000.vtu"}));
  const std::string older = test::file_text(target + "/mesh_0000.vtu");

  XpltFile other = small_file();
  other.states[0].time = 2.0f;
  fs::remove(target + "/surfaces_0000.vtu");
  fs::create_directory(target + "/surfaces_0000.vtu");
  EXPECT_EQ(fault_of(target, other), target + "/surfaces_0000.vtu: is a folder");
  EXPECT_EQ(names_in(target), (Names{"mesh_0000.vtu", "results.pvd", "surfaces_0000.vtu"}));
  EXPECT_EQ(test::file_text(target + "/mesh_0000.vtu"), older);
  fs::remove(target + "/surfaces_0000.vtu");
  write_vtu(target, other);
  EXPECT_NE(test::file_text(target + "/mesh_0000.vtu"), older);

  EXPECT_EQ(fault_of((folder.path / "no" / "vtu").string(), other),
            (folder.path / "no" / "vtu").string() + ": No such file or directory");
}

// ---- the program

/// Rows of a CSV without quotes, by column.
std::vector<std::map<std::string, std::string>> rows(const std::string& text) {
  std::istringstream lines(text);
  std::vector<std::map<std::string, std::string>> out;
  Names header;
  for (std::string line; std::getline(lines, line);) {
    Names words(1);
    for (char c : line) {
      if (c == ',')
        words.emplace_back();
      else
        words.back() += c;
    }
    if (header.empty()) {
      header = words;
      continue;
    }
    EXPECT_EQ(words.size(), header.size());
    std::map<std::string, std::string> row;
    for (std::size_t k = 0; k < header.size() && k < words.size(); ++k) row[header[k]] = words[k];
    out.push_back(row);
  }
  return out;
}

const char* kModel = DEA_SAMPLES_DIR "/knee/knee.feb";

TEST(VtuRun, NumbersAreThoseOfThePlotFileAndTheJson) {
  const test::TemporaryFolder folder;
  const auto f = test::run_program(folder.path,
                                   {DEA_PROGRAM, "run", kModel, "-o", "r.xplt", "--vtu", "new/", "--json", "r.json",
                                    "--facets-csv", "f.csv", "-q", "--law", "linear"},
                                   60);
  ASSERT_LE(f.code, 1) << f.err;
  EXPECT_EQ(f.err, "");
  const XpltFile plot = read_xplt((folder.path / "r.xplt").string());
  const Json json = Json::parse(test::file_text(folder.path / "r.json"));
  ASSERT_GE(plot.states.size(), 2u);
  EXPECT_EQ(names_in(folder.path / "new").size(), 2 * plot.states.size() + 1);  // no temporary file
  const auto table = rows(test::file_text(folder.path / "f.csv"));

  tinyxml2::XMLDocument pvd;
  ASSERT_EQ(pvd.LoadFile((folder.path / "new" / "results.pvd").c_str()), tinyxml2::XML_SUCCESS);
  const auto* set = pvd.RootElement()->FirstChildElement("Collection")->FirstChildElement("DataSet");
  const XpltMesh& mesh = plot.meshes[0];
  std::size_t elements = 0;
  for (const XpltDomain& d : mesh.domains) elements += d.element_ids.size();
  std::size_t row = 0;
  bool pressed = false;
  for (std::size_t i = 0; i < plot.states.size(); ++i) {
    const XpltState& state = plot.states[i];
    Names parts;
    for (int k = 0; k < 2; ++k, set = set->NextSiblingElement()) {
      ASSERT_NE(set, nullptr);
      EXPECT_EQ(static_cast<float>(set->DoubleAttribute("timestep")), state.time);
      EXPECT_EQ(set->IntAttribute("part"), k);
      parts.push_back(test::file_text(folder.path / "new" / set->Attribute("file")));
    }
    Grid solid = grid_from(parts[0]), surface = grid_from(parts[1]);
    EXPECT_EQ(solid.points, static_cast<int>(mesh.node_ids.size()));
    EXPECT_EQ(solid.cells, static_cast<int>(elements));
    EXPECT_EQ(solid.arrays["PointData/displacement"], doubles(state.variables[0][0].values));

    std::map<std::string, std::vector<double>> expected;  // in the order of the surfaces
    std::vector<int> shown;
    for (std::size_t v = 0; v < plot.variables.size(); ++v) {
      if (plot.variables[v].group != XpltGroup::Surface) continue;
      std::map<int, std::vector<float>> ordered;
      for (const XpltRegion& region : state.variables[v]) ordered[region.region] = region.values;
      shown.clear();
      for (const auto& [region, values] : ordered) {
        shown.push_back(region);
        if (plot.variables[v].format == XpltFormat::Mult) continue;
        auto& all = expected[plot.variables[v].name];
        all.insert(all.end(), values.begin(), values.end());
      }
    }
    int facets = 0;
    for (int region : shown) facets += mesh.surfaces[at(region - 1)].size();
    EXPECT_EQ(surface.cells, facets);
    for (const char* name : {"contact pressure", "contact gap", "joint space", "overlap", "spring strain"})
      EXPECT_EQ(surface.arrays[std::string("CellData/") + name], expected[name]) << name;
    for (const char* name : {"contact force", "contact area"})
      EXPECT_EQ(surface.arrays[std::string("FieldData/") + name], expected[name]) << name;

    // every slot of every facet finds its value at its point
    for (const char* name : {"nodal contact pressure", "cartilage thickness"}) {
      const std::vector<double>& found = surface.arrays[std::string("PointData/") + name];
      const auto v = static_cast<std::size_t>(find_variable(plot, XpltGroup::Surface, name));
      std::size_t corner = 0;
      for (int region : shown) {
        const XpltFacets& list = mesh.surfaces[at(region - 1)];
        const auto values = std::find_if(state.variables[v].begin(), state.variables[v].end(),
                                         [region = region](const XpltRegion& r) { return r.region == region; });
        for (int k = 0; k < list.size(); ++k)
          for (int n = list.begin[at(k)]; n < list.begin[at(k) + 1]; ++n, ++corner) {
            const auto point = static_cast<std::size_t>(surface.arrays["Cells/connectivity"][corner]);
            ASSERT_EQ(found[point], values->values[at(k * list.max_nodes + n - list.begin[at(k)])]);
            ASSERT_EQ(surface.arrays["PointData/node id"][point], mesh.node_ids[at(list.nodes[at(n)])]);
          }
      }
    }

    // CSV: two sides of every contact, in the JSON's order; sums and peaks are those of the JSON
    const Json& results = json["states"][i];
    for (const Json& contact : results["contacts"]) {
      double source_peak = 0.0;
      for (int side = 0; side < 2; ++side) {
        ASSERT_LT(row, table.size());
        const std::string name = table[row].at("surface"), body = table[row].at("body");
        const auto found = std::find_if(mesh.surfaces.begin(), mesh.surfaces.end(),
                                        [&](const XpltFacets& s) { return s.name == name; });
        ASSERT_NE(found, mesh.surfaces.end()) << name;
        const int region = static_cast<int>(found - mesh.surfaces.begin()) + 1;
        const bool alone = 2 * results["contacts"].size() == shown.size();  // no surface in two contacts
        const auto pressures =
            state.variables[static_cast<std::size_t>(find_variable(plot, XpltGroup::Surface, "contact pressure"))];
        const auto shown_pressure = std::find_if(pressures.begin(), pressures.end(),
                                                 [region](const XpltRegion& r) { return r.region == region; });
        ASSERT_NE(shown_pressure, pressures.end());
        double peak = 0.0, area = 0.0;
        for (int k = 0; k < found->size(); ++k, ++row) {
          ASSERT_LT(row, table.size());
          const auto& r = table[row];
          ASSERT_EQ(r.at("contact"), contact["name"].get<std::string>());
          ASSERT_EQ(r.at("surface"), name);
          ASSERT_EQ(std::stod(r.at("time")), results["time"].get<double>());
          ASSERT_EQ(r.at("outcome"), results["outcome"].get<std::string>());
          ASSERT_EQ(std::stoi(r.at("facet")), k + 1);
          const double p = std::stod(r.at("pressure")), a = std::stod(r.at("area"));
          ASSERT_GT(a, 0.0);
          if (alone) {
            ASSERT_EQ(static_cast<float>(p), shown_pressure->values[at(k)]);
          }
          peak = std::max(peak, p);
          if (p > 0) area += a;
          for (const char* column : {"thickness", "joint_space", "overlap", "strain", "x", "reference_z"})
            ASSERT_TRUE(std::isfinite(std::stod(r.at(column)))) << column;
        }
        if (body == contact["source"].get<std::string>()) {
          source_peak = peak;
          EXPECT_NEAR(area, contact["facet_contact_area"].get<double>(), 1e-9 * area + 1e-12);
        }
      }
      if (contact["facet_peak_pressure"].is_number() && contact["facet_peak_pressure"] > 0.0) {
        pressed = true;
        EXPECT_EQ(source_peak, contact["facet_peak_pressure"].get<double>());
      }
    }
  }
  EXPECT_EQ(set, nullptr);
  EXPECT_EQ(row, table.size());
  EXPECT_TRUE(pressed);
}

/// Pressure times area at the moved centroids is the contact's force and its centre of pressure.
TEST(VtuRun, FacetsCsvCarriesTheForce) {
  const test::TemporaryFolder folder;
  const auto f =
      test::run_program(folder.path,
                        {DEA_PROGRAM, "run", DEA_SAMPLES_DIR "/sphere_on_flat/sphere_on_flat.feb", "--json", "r.json",
                         "-o", "r.xplt", "--facets-csv", "-", "--states", "last", "--law", "linear"},
                        60);
  ASSERT_EQ(f.code, 0) << f.err;
  const Json json = Json::parse(test::file_text(folder.path / "r.json"));
  const Json& contact = json["states"][0]["contacts"][0];
  double force = 0.0;
  Vector3d moment = Vector3d::Zero();
  for (const auto& r : rows(f.out)) {  // nothing but CSV
    if (r.at("body") != contact["source"].get<std::string>()) continue;
    const double load = std::stod(r.at("pressure")) * std::stod(r.at("area"));
    force += load;
    moment += load * Vector3d(std::stod(r.at("x")), std::stod(r.at("y")), std::stod(r.at("z")));
    const double strain = std::stod(r.at("strain")), overlap = std::stod(r.at("overlap"));
    if (overlap > 0) {
      EXPECT_GT(strain, 0.0);
    }
  }
  const auto vector = [](const Json& j) {
    return Vector3d(j[0].get<double>(), j[1].get<double>(), j[2].get<double>());
  };
  const double whole = vector(contact["force"]).norm();
  ASSERT_GT(force, 0.0);
  EXPECT_NEAR(force, whole, 0.02 * whole);  // normals of the pressed cap turn by a few degrees
  EXPECT_LT((moment / force - vector(contact["center_of_pressure"])).norm(), 0.05);
}

TEST(VtuRun, SettingsFileNamesThemToo) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "s.xml") << "<febiodea_settings version=\"1\"><vtu>p</vtu><facets-csv>f.csv</facets-csv>"
                                          "<states>last</states><law>linear</law></febiodea_settings>";
  const auto f =
      test::run_program(folder.path, {DEA_PROGRAM, "run", kModel, "-o", "r.xplt", "-q", "--settings", "s.xml"}, 60);
  ASSERT_LE(f.code, 1) << f.err;
  EXPECT_EQ(names_in(folder.path), (Names{"f.csv", "p", "r.xplt", "s.xml"}));
  EXPECT_EQ(names_in(folder.path / "p"), (Names{"mesh_0000.vtu", "results.pvd", "surfaces_0000.vtu"}));
}

TEST(VtuRun, RefusalsAreOneLineBeforeAnyWork) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "file") << "older";
  const std::vector<std::tuple<Names, int, std::string>> cases = {
      {{"--vtu", "-"}, 2, "dea: --vtu -: a folder cannot go to standard output, give it a name\n"},
      {{"--vtu", "file"}, 4, "dea: cannot write file: is a file, expected a folder or a new name\n"},
      {{"--vtu", "no/vtu"}, 4, "dea: cannot write no/vtu: there is no folder no\n"},
      {{"--vtu", "a", "--csv", "./a"}, 2, "dea: --vtu a: is the file of --csv too\n"},
      {{"--csv", "-", "--facets-csv", "-"}, 2, "dea: only one of --csv and --facets-csv can go to standard output\n"},
      {{"--json", "a", "--facets-csv", "a"}, 2, "dea: --facets-csv a: is the file of --json too\n"},
      {{"--json", ""}, 2, "dea run: --json: found nothing, expected a value (dea run --help lists the options)\n"},
      {{"--facets-csv", "no/f.csv"}, 4, "dea: cannot write no/f.csv: there is no folder no\n"},
  };
  for (const auto& [words, code, text] : cases) {
    Names all = {DEA_PROGRAM, "run", kModel, "-o", "r.xplt", "-q"};
    all.insert(all.end(), words.begin(), words.end());
    const auto f = test::run_program(folder.path, all, 60);
    EXPECT_EQ(f.code, code) << text;
    EXPECT_EQ(f.err, text);
    EXPECT_EQ(f.out, "");
  }
  EXPECT_EQ(names_in(folder.path), Names{"file"});
}

/// A full disk, played by a limit on the size of files: one line, nothing left, an older result whole.
TEST(VtuRun, WhatCannotBeWrittenLeavesNothing) {
  const test::TemporaryFolder folder;
  const std::string script = fmt::format(
      "ulimit -f 1000; exec '{}' run '{}' -o /dev/null -q --law linear --states last --vtu v", DEA_PROGRAM, kModel);
  const auto f = test::run_program(folder.path, {"/bin/sh", "-c", script}, 60);
  EXPECT_EQ(f.code, 4);
  EXPECT_EQ(f.err, "dea: cannot write v: File too large\n");  // 500 KiB: enough for the plot file
  EXPECT_EQ(names_in(folder.path), Names{});
}

}  // namespace dea::vtu_test
