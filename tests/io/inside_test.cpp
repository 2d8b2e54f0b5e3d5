// Stress and strain inside the cartilage, from outside: what the program writes, and what it makes of plot files.
#include "io/results/inside_rows.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "src/base/decompositions.h"
#include "src/model/element_shape.h"
#include "tests/program.h"

namespace dea::inside_test {

namespace fs = std::filesystem;
using Eigen::Matrix3d;
using Json = nlohmann::ordered_json;
using test::file_text;
using test::Finished;

const fs::path kSamples = DEA_SAMPLES_DIR;

class InsideFiles : public ::testing::Test {
 protected:
  Finished dea(std::vector<std::string> words) {
    words.insert(words.begin(), DEA_PROGRAM);
    return test::run_program(folder.path, words, 120);
  }
  std::string sample(const std::string& name) { return (kSamples / name).string(); }
  test::TemporaryFolder folder;
};

Matrix3d tensor(const float* v) {
  Matrix3d m;
  m << v[0], v[3], v[5], v[3], v[1], v[4], v[5], v[4], v[2];
  return m;
}

/// Corners of a unit element of this shape, mid-edge nodes between them: coordinates of its nodes.
std::vector<Vector3d> unit_nodes(ElementShape shape) {
  std::vector<Vector3d> x;
  const std::vector<Vector3d> hex = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                     {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  switch (shape) {
    case ElementShape::Hex8:
    case ElementShape::Hex20:
      x = hex;
      break;
    case ElementShape::Penta6:
      x = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
      break;
    default:
      x = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  }
  x.resize(static_cast<std::size_t>(nodes_per_element(shape)), Vector3d::Zero());
  for (const std::vector<int>& face : element_faces(shape)) {
    const std::size_t corners = face.size() > 4 ? face.size() / 2 : face.size();
    for (std::size_t k = corners; k < face.size(); ++k)
      x[static_cast<std::size_t>(face[k])] = 0.5 * (x[static_cast<std::size_t>(face[k - corners])] +
                                                    x[static_cast<std::size_t>(face[(k - corners + 1) % corners])]);
  }
  return x;
}

/// One element under a surface of its last face, moved by F; stress diag(1, 2, 5) turned.
ResultFile one_element(ElementShape shape, const Matrix3d& F, bool stored_strain) {
  ResultFile file{"one.xplt", "one", {}};
  XpltFile& x = file.xplt;
  XpltMesh mesh;
  std::vector<float> moved;
  for (const Vector3d& X : unit_nodes(shape)) {
    mesh.node_ids.push_back(static_cast<int>(mesh.node_ids.size()) + 1);
    const Vector3d u = F * X - X;
    for (int k = 0; k < 3; ++k) {
      mesh.coordinates.push_back(static_cast<float>(X[k]));
      moved.push_back(static_cast<float>(u[k]));
    }
  }
  XpltDomain domain;
  domain.element_type = xplt_element_type(shape);
  domain.element_ids = {1};
  for (std::size_t i = 0; i < mesh.node_ids.size(); ++i) domain.nodes.push_back(static_cast<int>(i));
  mesh.domains.push_back(domain);
  const std::vector<int>& face = element_faces(shape).back();
  mesh.surfaces.push_back({"top", {0, static_cast<int>(face.size())}, face, static_cast<int>(face.size())});
  mesh.parts = {"cartilage"};
  x.meshes.push_back(mesh);
  x.variables = {XpltVariable{XpltGroup::Nodal, XpltType::Vec3, XpltFormat::Node, "displacement"},
                 XpltVariable{XpltGroup::Domain, XpltType::Mat3s, XpltFormat::Item, "stress"}};
  XpltState state;
  state.variables = {{{0, moved}}, {{1, {1, 2, 5, 0, 0, 0}}}};
  if (stored_strain) {
    x.variables.push_back(XpltVariable{XpltGroup::Domain, XpltType::Mat3s, XpltFormat::Item, "Lagrange strain"});
    state.variables.push_back({{1, {0.1f, 0, -0.2f, 0, 0, 0.05f}}});
  }
  x.states.push_back(state);
  return file;
}

// Any shape moved by one F has the strain (F^T F - 1)/2, and its own volume.
TEST(InsideRows, StrainOfDisplacements) {
  Matrix3d F;
  F << 1.1, 0.2, -0.1, 0.05, 0.9, 0.3, 0.0, -0.15, 1.2;
  const Eigen::VectorXd strain = symmetric_eigenvalues(0.5 * (F.transpose() * F - Matrix3d::Identity()));
  const std::pair<ElementShape, double> shapes[] = {{ElementShape::Hex8, 1.0},
                                                    {ElementShape::Hex20, 1.0},
                                                    {ElementShape::Penta6, 0.5},
                                                    {ElementShape::Tet4, 1.0 / 6},
                                                    {ElementShape::Tet10, 1.0 / 6}};
  for (const auto& shape : shapes) {
    const ResultFile file = one_element(shape.first, F, false);
    const RowElements row = row_elements(file, 0, 0, InsideRow::Surface);
    ASSERT_EQ(row.element, std::vector<int>{0}) << element_type(shape.first).name;
    EXPECT_NEAR(row.volume[0], shape.second, 1e-6) << element_type(shape.first).name;
    const ElementMeasures m = row_measures(file, 0, row).at(0);
    EXPECT_NEAR(m[0], 2.0, 1e-6);  // (5 - 1)/2
    EXPECT_NEAR(m[1], strain[2], 1e-6) << element_type(shape.first).name;
    EXPECT_NEAR(m[2], strain[0], 1e-6) << element_type(shape.first).name;
  }
}

// A strain that the file stores is taken as it is: [[.1, 0, .05], [0, 0, 0], [.05, 0, -.2]].
TEST(InsideRows, StoredStrain) {
  const ResultFile file = one_element(ElementShape::Hex8, Matrix3d::Identity(), true);
  const ElementMeasures m = row_measures(file, 0, row_elements(file, 0, 0, InsideRow::Bone)).at(0);
  const double middle = -0.05, half = std::hypot(0.15, 0.05);
  EXPECT_NEAR(m[1], middle + half, 1e-6);
  EXPECT_NEAR(m[2], middle - half, 1e-6);
}

// No row at the bone of tetrahedra; no strain where nothing tells of it; no values without stress.
TEST(InsideRows, WhatIsNotThere) {
  const ResultFile tet = one_element(ElementShape::Tet4, Matrix3d::Identity(), false);
  EXPECT_EQ(row_elements(tet, 0, 0, InsideRow::Bone).element, std::vector<int>{-1});
  EXPECT_TRUE(row_measures(tet, 0, row_elements(tet, 0, 0, InsideRow::Bone)).empty());
  ResultFile still = one_element(ElementShape::Hex8, Matrix3d::Identity(), false);
  still.xplt.states[0].variables[0].clear();
  const ElementMeasures m = row_measures(still, 0, row_elements(still, 0, 0, InsideRow::Surface)).at(0);
  EXPECT_NEAR(m[0], 2.0, 1e-6);
  EXPECT_TRUE(std::isnan(m[1]));
  still.xplt.states[0].variables[1].clear();
  EXPECT_TRUE(row_measures(still, 0, row_elements(still, 0, 0, InsideRow::Surface)).empty());
  EXPECT_TRUE(row_field_values(still, 0, 0, "contact pressure").empty());
}

TEST(InsideRows, NotANumber) {
  ResultFile file = one_element(ElementShape::Hex8, Matrix3d::Identity(), false);
  file.xplt.states[0].variables[1][0].values[0] = std::nanf("");
  EXPECT_THROW(row_measures(file, 0, row_elements(file, 0, 0, InsideRow::Surface)), InputError);
}

TEST(InsideRows, FieldsByTheirNames) {
  const ResultFile file = one_element(ElementShape::Hex8, Matrix3d::Identity(), true);
  EXPECT_EQ(row_field_names(file).size(), 6u);
  for (const std::string& name : row_field_names(file))
    EXPECT_EQ(row_field_values(file, 0, 0, name).size(), 1u) << name;
  EXPECT_NEAR(shown_values(file, 0, 0, "max shear stress, row at the bone").at(0), 2.0, 1e-6);
}

// The plot file has FEBio's own names, types and formats, for deformable solids alone; the rest of it is as without.
TEST_F(InsideFiles, PlotFile) {
  const std::string model = sample("spheres/two_layers.feb");
  ASSERT_EQ(dea({"run", model, "-q", "--states", "last", "-o", "plain.xplt"}).code, 0);
  const Finished f = dea({"run", model, "--states", "last", "--inside", "-o", "inside.xplt"});
  ASSERT_EQ(f.code, 0) << f.err;
  const XpltFile plain = read_xplt((folder.path / "plain.xplt").string()),
                 inside = read_xplt((folder.path / "inside.xplt").string());
  EXPECT_EQ(plain.meshes, inside.meshes);
  for (std::size_t v = 0; v < plain.variables.size(); ++v) {
    const int there = find_variable(inside, plain.variables[v].group, plain.variables[v].name);
    ASSERT_GE(there, 0);
    EXPECT_EQ(plain.states[0].variables[v], inside.states[0].variables[static_cast<std::size_t>(there)]);
  }
  for (const char* name : {"stress", "Lagrange strain"}) {
    EXPECT_LT(find_variable(plain, XpltGroup::Domain, name), 0);
    const int index = find_variable(inside, XpltGroup::Domain, name);
    ASSERT_GE(index, 0);
    const XpltVariable& variable = inside.variables[static_cast<std::size_t>(index)];
    EXPECT_EQ(variable.type, XpltType::Mat3s);
    EXPECT_EQ(variable.format, XpltFormat::Item);
    EXPECT_EQ(inside.states[0].variables[static_cast<std::size_t>(index)].size(), 2u);  // two layers, no shells
  }
  EXPECT_NE(f.err.find("note: inside: contact"), std::string::npos) << f.err;
  ASSERT_EQ(dea({"run", model, "-q", "--states", "last", "--inside", "--no-xplt", "--vtu", "vtu"}).code, 0);
  const std::string mesh = file_text(folder.path / "vtu/mesh_0000.vtu"),
                    surfaces = file_text(folder.path / "vtu/surfaces_0000.vtu");
  for (const char* name : {"stress", "Lagrange strain"})
    EXPECT_NE(mesh.find("Name=\"" + std::string(name) + "\" NumberOfComponents=\"6\""), std::string::npos) << name;
  EXPECT_NE(surfaces.find("Name=\"max shear stress at the bone\""), std::string::npos);
  EXPECT_NE(f.out.find("inside the cartilage"), std::string::npos) << f.out;
}

// An element under even pressure carries it: the stress along the normal in the row at the surface is minus the facet's
// pressure, wherever that changes little.
TEST_F(InsideFiles, StressCarriesThePressure) {
  ASSERT_EQ(dea({"run", sample("spheres/one_layer.feb"), "-q", "--states", "last", "--inside", "-o", "a.xplt"}).code,
            0);
  const ResultFile file = read_result((folder.path / "a.xplt").string(), "a");
  const XpltMesh& mesh = mesh_of(file, 0);
  int surface = -1;
  for (int s = 0; s < static_cast<int>(mesh.surfaces.size()); ++s)
    if (has_springs(file, 0, s)) surface = s;
  ASSERT_GE(surface, 0);
  const std::vector<double> p = facet_values(file, 0, surface, "contact pressure");
  const ResultSurface shape = result_surface(file, 0, surface);
  const RowElements row = row_elements(file, 0, surface, InsideRow::Surface);
  const XpltRegion& stress =
      file.xplt.states[0].variables[static_cast<std::size_t>(find_variable(file.xplt, XpltGroup::Domain, "stress"))][0];
  int first = 0;
  for (int d = 0; d + 1 < stress.region; ++d) first += xplt_elements(mesh.domains[static_cast<std::size_t>(d)]);
  const double peak = *std::max_element(p.begin(), p.end());
  int looked = 0;
  for (std::size_t f = 0; f < p.size(); ++f) {
    if (!(p[f] > 0.7 * peak)) continue;
    ASSERT_GE(row.element[f], 0);
    const Vector3d n = shape.area_vectors[f].normalized();
    const double carried = -n.dot(tensor(stress.values.data() + 6 * (row.element[f] - first)) * n);
    EXPECT_NEAR(carried, p[f], 0.1 * peak);  // half way down a socket of t/R = 0.2 and beside the facet's middle
    ++looked;
  }
  EXPECT_GT(looked, 10);
}

/// Cells may stand in quotes, with commas in them.
std::vector<std::vector<std::string>> csv_rows(const fs::path& path) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream text(file_text(path));
  for (std::string line; std::getline(text, line);) {
    rows.push_back({""});
    bool quoted = false;
    for (const char c : line) {
      if (c == '"')
        quoted = !quoted;
      else if (c == ',' && !quoted)
        rows.back().emplace_back();
      else
        rows.back().back() += c;
    }
  }
  return rows;
}

// JSON and CSV have the same digits; without the setting JSON says null and CSV has no such columns.
TEST_F(InsideFiles, NumbersOfARun) {
  const std::string model = sample("plateaus/plateaus.feb");
  const std::vector<std::string> outputs = {
      "run",    model,   "-q",    "--states",           "last",  "--no-xplt",    "--json",
      "r.json", "--csv", "r.csv", "--compartments-csv", "c.csv", "--facets-csv", "f.csv"};
  std::vector<std::string> words = outputs;
  words.push_back("--inside");
  ASSERT_EQ(dea(words).code, 0);
  const Json contact = Json::parse(file_text(folder.path / "r.json"))["states"][0]["contacts"][0];
  const auto rows = csv_rows(folder.path / "r.csv");
  int found = 0;
  for (std::size_t i = 0; i < rows[0].size(); ++i) {
    for (const char* side : {"source", "target"})
      for (const char* end : {"bone", "surface"})
        for (const char* measure : {"max_shear_stress", "first_principal_strain", "third_principal_strain"})
          for (const char* number : {"peak", "p99", "mean"}) {
            if (rows[0][i] != std::string(side) + "_" + end + "_" + measure + "_" + number) continue;
            const Json& of = contact["inside"][side];
            const std::string cell = i < rows[1].size() ? rows[1][i] : "";
            EXPECT_EQ(of.is_null(), cell.empty());
            if (!of.is_null()) {
              EXPECT_EQ(of[end][measure][number].get<double>(), std::stod(cell));
            }
            ++found;
          }
  }
  EXPECT_EQ(found, 36);
  // each compartment by itself: the greater of both peaks is the whole's
  double most = 0;
  for (const Json& part : contact["compartments"])
    most = std::max(most, part["inside"]["bone"]["max_shear_stress"]["peak"].get<double>());
  const char* side = contact["inside"]["source"].is_null() ? "target" : "source";
  EXPECT_EQ(most, contact["inside"][side]["bone"]["max_shear_stress"]["peak"].get<double>());
  EXPECT_NE(file_text(folder.path / "c.csv").find(",bone_max_shear_stress_peak,"), std::string::npos);
  EXPECT_NE(file_text(folder.path / "f.csv").find(",bone_max_shear_stress,"), std::string::npos);
  ASSERT_EQ(dea(outputs).code, 0);
  EXPECT_TRUE(Json::parse(file_text(folder.path / "r.json"))["states"][0]["contacts"][0]["inside"].is_null());
  for (const char* name : {"r.csv", "c.csv", "f.csv"})
    EXPECT_EQ(file_text(folder.path / name).find("shear"), std::string::npos) << name;
}

// A file beside itself: every correlation is 1, every difference 0; beside one with twice the load it is not.
TEST_F(InsideFiles, Compared) {
  const std::string model = sample("spheres/one_layer.feb");
  ASSERT_EQ(dea({"run", model, "-q", "--states", "last", "--inside", "-o", "a.xplt"}).code, 0);
  ASSERT_EQ(dea({"run", model, "-q", "--states", "last", "--inside", "--E", "6", "-o", "b.xplt"}).code, 0);
  const Finished f = dea({"compare", "b.xplt", "a.xplt", "a.xplt", "--label", "b", "--label", "a", "--label", "ref",
                          "--json", "c.json", "--csv", "c.csv"});
  ASSERT_EQ(f.code, 0) << f.err;
  EXPECT_NE(f.out.find("row at the bone"), std::string::npos) << f.out;
  const Json rows = Json::parse(file_text(folder.path / "c.json"))["surfaces"][0]["inside"];
  ASSERT_EQ(rows.size(), 2u);
  for (const Json& row : rows) {
    EXPECT_GT(row["elements"].get<int>(), 10);
    for (const char* measure : {"max_shear_stress", "first_principal_strain", "third_principal_strain"}) {
      EXPECT_NEAR(row["differences"][1][measure]["correlation"].get<double>(), 1.0, 1e-12);
      EXPECT_EQ(row["differences"][1][measure]["percent"]["p99"].get<double>(), 0.0);
      EXPECT_LT(row["differences"][0][measure]["correlation"].get<double>(), 1.0);
      EXPECT_NE(row["differences"][0][measure]["percent"]["mean"].get<double>(), 0.0);
    }
    EXPECT_GT(row["results"][0]["first_principal_strain"]["mean"].get<double>(),
              row["results"][2]["first_principal_strain"]["mean"].get<double>());  // the softer one gives way
  }
  EXPECT_NE(file_text(folder.path / "c.csv").find(",inside_surface_third_principal_strain_correlation"),
            std::string::npos);
}

// A file without stress has no rows, and nothing is made up.
TEST_F(InsideFiles, ComparedWithout) {
  const std::string model = sample("spheres/one_layer.feb");
  ASSERT_EQ(dea({"run", model, "-q", "--states", "last", "--inside", "-o", "a.xplt"}).code, 0);
  ASSERT_EQ(dea({"run", model, "-q", "--states", "last", "-o", "b.xplt"}).code, 0);
  const Finished f = dea({"compare", "a.xplt", "b.xplt", "--json", "-"});
  ASSERT_EQ(f.code, 0) << f.err;
  EXPECT_TRUE(Json::parse(f.out)["surfaces"][0]["inside"].empty());
  EXPECT_EQ(dea({"plot", "b.xplt", "--field", "max shear stress, row at the bone"}).code, 3);
  const Finished map = dea({"plot", "a.xplt", "--field", "max shear stress, row at the bone", "-o", "a.svg"});
  EXPECT_EQ(map.code, 0) << map.err;
}

TEST_F(InsideFiles, OtherLawsAreRefusedInALine) {
  const Finished f = dea({"run", sample("spheres/one_layer.feb"), "-q", "--law", "linear", "--inside", "-o", "a.xplt"});
  EXPECT_EQ(f.code, 2);
  EXPECT_NE(f.err.find("--inside: contact "), std::string::npos) << f.err;
  EXPECT_NE(f.err.find("found law linear, expected --law layer of two terms"), std::string::npos) << f.err;
  EXPECT_EQ(std::count(f.err.begin(), f.err.end(), '\n'), 1) << f.err;
}

// A study keeps the numbers in its results, if it is asked to.
TEST_F(InsideFiles, Study) {
  fs::copy_file(sample("spheres/one_layer.feb"), folder.path / "m.feb");
  std::vector<std::string> words = {"study", "m.feb", "--vary", "E: E={8|12}", "--states", "last", "-q", "-o"};
  std::vector<std::string> with = words, without = words;
  with.insert(with.end(), {"with.db", "--inside", "--csv", "with.csv"});
  without.insert(without.end(), {"without.db", "--csv", "without.csv"});
  Finished f = dea(with);
  ASSERT_EQ(f.code, 0) << f.err;
  f = dea(without);
  ASSERT_EQ(f.code, 0) << f.err;
  EXPECT_EQ(file_text(folder.path / "without.csv").find("shear"), std::string::npos);
  const auto rows = csv_rows(folder.path / "with.csv");
  ASSERT_EQ(rows.size(), 3u);
  const auto column =
      std::find(rows[0].begin(), rows[0].end(), "source_bone_first_principal_strain_mean") - rows[0].begin();
  ASSERT_LT(static_cast<std::size_t>(column), rows[0].size());
  ASSERT_EQ(
      dea({"run", "m.feb", "--E", "12", "--states", "last", "--inside", "-q", "--no-xplt", "--json", "r.json"}).code,
      0);
  const Json inside = Json::parse(file_text(folder.path / "r.json"))["states"][0]["contacts"][0]["inside"];
  const double own = inside["source"]["bone"]["first_principal_strain"]["mean"];
  EXPECT_NEAR(std::stod(rows[2][static_cast<std::size_t>(column)]), own, 1e-6 * own);
  EXPECT_GT(std::stod(rows[1][static_cast<std::size_t>(column)]), own);
}

}  // namespace dea::inside_test
