#include "io/xplt/xplt.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#if defined(__unix__) || defined(__APPLE__)
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#endif

#include "src/base/error.h"

namespace dea::xplt_test {

namespace fs = std::filesystem;

// ------------------------------------------------------------------------------ the worked example by hand

// One unit cube pressed on its top: the smallest file with all that matters.
XpltFile cube() {
  XpltFile file;
  file.software = "dea";
  file.variables = {XpltVariable{XpltGroup::Nodal, XpltType::Vec3, XpltFormat::Node, "displacement"},
                    XpltVariable{XpltGroup::Surface, XpltType::Float, XpltFormat::Item, "contact pressure"}};

  XpltMesh mesh;
  mesh.node_ids = {1, 2, 3, 4, 5, 6, 7, 8};
  mesh.coordinates = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
  XpltDomain cartilage;
  cartilage.name = "cart";
  cartilage.element_ids = {1};
  cartilage.nodes = {0, 1, 2, 3, 4, 5, 6, 7};
  mesh.domains = {cartilage};
  XpltFacets top;
  top.name = "top";
  top.begin = {0, 4};
  top.nodes = {4, 5, 6, 7};
  mesh.surfaces = {top};
  mesh.parts = {"cart"};
  file.meshes = {mesh};

  XpltState state;
  state.time = 1;
  state.element_flags = {1};
  std::vector<float> u(24, 0.0f);
  for (std::size_t node = 4; node < 8; ++node) u[3 * node + 2] = -0.1f;
  state.variables = {{{0, u}}, {{1, {0.5f}}}};
  file.states = {state};
  return file;
}

struct Writer {
  bool swapped = false;
  std::string bytes;
  void u32(std::uint32_t n) {
    for (int i = 0; i < 4; ++i) bytes += static_cast<char>(n >> 8 * (swapped ? 3 - i : i) & 0xFF);
  }
  void f32(float f) { u32(std::bit_cast<std::uint32_t>(f)); }
  void text(const std::string& s, std::size_t size) { bytes += s + std::string(size - s.size(), '\0'); }
  // A row of the listing: where the chunk must start, its id and the size of its payload.
  void chunk(std::size_t offset, std::uint32_t id, std::uint32_t size) {
    EXPECT_EQ(bytes.size(), offset);
    u32(id);
    u32(size);
  }
};

// Offsets, ids and sizes typed from the description of the format, nothing shared with the writer.
std::string cube_bytes(bool swapped = false) {
  Writer w;
  w.swapped = swapped;
  w.u32(0x00464542);
  w.chunk(4, 0x01000000, 303);
  w.chunk(12, 0x01010000, 39);
  w.chunk(20, 0x01010001, 4), w.u32(0x35);
  w.chunk(32, 0x01010004, 4), w.u32(0);
  w.chunk(44, 0x01010006, 7), w.u32(3), w.text("dea", 3);
  w.chunk(59, 0x01020000, 248);
  w.chunk(67, 0x01023000, 116);
  w.chunk(75, 0x01020001, 108);
  w.chunk(83, 0x01020002, 4), w.u32(1);
  w.chunk(95, 0x01020003, 4), w.u32(0);
  w.chunk(107, 0x01020005, 4), w.u32(0);
  w.chunk(119, 0x01020004, 64), w.text("displacement", 64);
  w.chunk(191, 0x01025000, 116);
  w.chunk(199, 0x01020001, 108);
  w.chunk(207, 0x01020002, 4), w.u32(0);
  w.chunk(219, 0x01020003, 4), w.u32(1);
  w.chunk(231, 0x01020005, 4), w.u32(0);
  w.chunk(243, 0x01020004, 64), w.text("contact pressure", 64);

  w.chunk(315, 0x01040000, 519);
  w.chunk(323, 0x01041000, 168);
  w.chunk(331, 0x01041100, 24);
  w.chunk(339, 0x01041101, 4), w.u32(8);
  w.chunk(351, 0x01041102, 4), w.u32(3);
  w.chunk(363, 0x01041200, 128);
  const float corners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  for (std::uint32_t i = 0; i < 8; ++i) {
    w.u32(i + 1);
    for (const float x : corners[i]) w.f32(x);
  }
  w.chunk(499, 0x01042000, 120);
  w.chunk(507, 0x01042100, 112);
  w.chunk(515, 0x01042101, 52);
  w.chunk(523, 0x01042102, 4), w.u32(0);
  w.chunk(535, 0x01042103, 4), w.u32(1);
  w.chunk(547, 0x01032104, 4), w.u32(1);
  w.chunk(559, 0x01032105, 8), w.u32(4), w.text("cart", 4);
  w.chunk(575, 0x01042200, 44);
  w.chunk(583, 0x01042201, 36), w.u32(1);
  for (std::uint32_t i = 0; i < 8; ++i) w.u32(i);
  w.chunk(627, 0x01043000, 107);
  w.chunk(635, 0x01043100, 99);
  w.chunk(643, 0x01043101, 51);
  w.chunk(651, 0x01043102, 4), w.u32(1);
  w.chunk(663, 0x01043103, 4), w.u32(1);
  w.chunk(675, 0x01043104, 7), w.u32(3), w.text("top", 3);
  w.chunk(690, 0x01043105, 4), w.u32(4);
  w.chunk(702, 0x01043200, 32);
  w.chunk(710, 0x01043201, 24);
  for (const std::uint32_t n : {1u, 4u, 4u, 5u, 6u, 7u}) w.u32(n);
  w.chunk(742, 0x01045000, 92);
  w.chunk(750, 0x01045100, 84);
  w.chunk(758, 0x01045101, 4), w.u32(1);
  w.chunk(770, 0x01045102, 64), w.text("cart", 64);

  w.chunk(842, 0x02000000, 248);
  w.chunk(850, 0x02010000, 24);
  w.chunk(858, 0x02010002, 4), w.u32(0x3F800000);
  w.chunk(870, 0x02010003, 4), w.u32(0);
  w.chunk(882, 0x02030000, 12);
  w.chunk(890, 0x02030001, 4), w.u32(1);
  w.chunk(902, 0x02020000, 188);
  w.chunk(910, 0x02020300, 132);
  w.chunk(918, 0x02020001, 124);
  w.chunk(926, 0x02020002, 4), w.u32(1);
  w.chunk(938, 0x02020003, 104);
  w.chunk(946, 0, 96);
  for (int i = 0; i < 24; ++i) w.u32(i >= 12 && i % 3 == 2 ? 0xBDCCCCCD : 0);
  w.chunk(1050, 0x02020500, 40);
  w.chunk(1058, 0x02020001, 32);
  w.chunk(1066, 0x02020002, 4), w.u32(1);
  w.chunk(1078, 0x02020003, 12);
  w.chunk(1086, 1, 4), w.u32(0x3F000000);
  EXPECT_EQ(w.bytes.size(), 1098u);
  return w.bytes;
}

// Everything the format has: all groups, formats and sections, two meshes, three states.
XpltFile everything() {
  XpltFile file = cube();
  file.units = "mm-N-s";
  file.variables.clear();
  const auto declare = [&](XpltGroup group, XpltType type, XpltFormat format, const std::string& name, int array = 0) {
    file.variables.push_back(XpltVariable{group, type, format, name});
    file.variables.back().array_size = array;
  };
  declare(XpltGroup::Global, XpltType::Float, XpltFormat::Region, "iterations");
  declare(XpltGroup::Global, XpltType::Array, XpltFormat::Region, "residuals", 2);
  declare(XpltGroup::Nodal, XpltType::Vec3, XpltFormat::Node, "displacement");
  declare(XpltGroup::Domain, XpltType::Mat3s, XpltFormat::Item, "stress");
  declare(XpltGroup::Domain, XpltType::Mat3d, XpltFormat::Mult, "principal");
  declare(XpltGroup::Domain, XpltType::Mat3, XpltFormat::Node, "gradient");
  declare(XpltGroup::Domain, XpltType::Tens4s, XpltFormat::Region, "elasticity");
  declare(XpltGroup::Domain, XpltType::ArrayVec3, XpltFormat::Item, "fibres", 2);
  declare(XpltGroup::Surface, XpltType::Float, XpltFormat::Item, "contact pressure");
  declare(XpltGroup::Surface, XpltType::Vec3, XpltFormat::Mult, "nodal traction");
  declare(XpltGroup::Surface, XpltType::Vec3, XpltFormat::Region, "contact force");
  declare(XpltGroup::Surface, XpltType::Float, XpltFormat::Mult, "thickness");
  declare(XpltGroup::Edge, XpltType::Float, XpltFormat::Mult, "line load");
  file.variables[1].array_names = {"force", "moment"};
  file.variables[8].units = "P";

  XpltMesh& mesh = file.meshes[0];
  mesh.node_ids.push_back(17);
  mesh.coordinates.insert(mesh.coordinates.end(), {0.5f, 0.5f, 2.0f});
  XpltDomain shells;  // no name, as FEBio writes them
  shells.element_type = 4;
  shells.part = 2;
  shells.element_ids = {7, 9};
  shells.nodes = {4, 5, 8, 5, 6, 8};
  mesh.domains.push_back(shells);
  mesh.parts.push_back("bone");
  XpltFacets roof;
  roof.name = "roof";
  roof.begin = {0, 3, 7};
  roof.nodes = {4, 5, 8, 4, 5, 6, 7};
  roof.max_nodes = 4;
  mesh.surfaces.push_back(roof);
  XpltFacets none;
  none.name = "none";
  mesh.surfaces.push_back(none);
  mesh.facet_sets = mesh.surfaces;
  for (XpltFacets& facets : mesh.facet_sets) facets.max_nodes = 10;
  XpltFacets rim;
  rim.name = "rim";
  rim.begin = {0, 2, 4};
  rim.nodes = {4, 5, 5, 6};
  rim.max_nodes = 3;
  mesh.edges = {rim};
  mesh.node_sets = {{"base", {0, 1, 2, 3}}, {"nobody", {}}};
  mesh.element_sets = {{"cart", {1}}, {"bone", {7, 9}}};
  XpltObject femur;
  femur.name = "femur";
  femur.position = {1, 2, 3};
  XpltVariable force;
  force.type = XpltType::Vec3;
  force.name = "Force";
  XpltVariable length;
  length.name = "Length";
  femur.data = {force, length};
  XpltObject ligament;
  ligament.name = "ligament";
  ligament.line = true;
  ligament.line_ends = {0, 0, 0, 1, 1, 1};
  ligament.data = {length};
  mesh.objects = {femur, ligament, femur};

  XpltMesh second = mesh;
  second.objects.clear();
  second.surfaces[1].begin = {0, 3};
  second.surfaces[1].nodes.resize(3);
  file.meshes.push_back(second);

  file.states.clear();
  for (int s = 0; s < 3; ++s) {
    XpltState state;
    state.time = static_cast<float>(s);
    state.status = s;
    state.mesh = s == 2 ? 1 : 0;
    if (s != 1) state.element_flags = {1, 1, 0};
    const XpltMesh& current = file.meshes[static_cast<std::size_t>(state.mesh)];
    float next = 0.25f;
    for (const XpltVariable& variable : file.variables) {
      std::vector<XpltRegion> regions;
      for (int region = 0; region <= 3; ++region) {
        const std::int64_t size = floats_in_region(current, variable, region);
        if (size <= 0 || (s == 1 && region == 2)) continue;  // some regions without data
        regions.push_back({region, {}});
        for (std::int64_t i = 0; i < size; ++i) regions.back().values.push_back(next += 0.5f);
      }
      state.variables.push_back(regions);
    }
    for (const XpltObject& object : file.meshes[0].objects) {
      XpltObjectState o;
      o.position = {next, 1, 2};
      if (object.line) o.line_ends = {1, 2, 3, 4, 5, next};
      for (const XpltVariable& item : object.data) {
        o.data.emplace_back(static_cast<std::size_t>(floats_per_value(item)), next);
      }
      state.objects.push_back(o);
    }
    file.states.push_back(state);
  }
  return file;
}

XpltFile compressed(XpltFile file) {
  file.compressed = true;
  return file;
}

XpltFile again(const XpltFile& file) { return xplt_from_bytes(xplt_bytes(file), "again.xplt"); }

// what() of the InputError that reading these bytes gives.
std::string fault(const std::string& bytes) {
  try {
    xplt_from_bytes(bytes, "hip.xplt");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no fault";
}

// A directory of its own that vanishes with the test.
struct Folder {
  fs::path path;
  Folder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path = fs::path(testing::TempDir()) /
           (std::string("dea_xplt_") + test->name() + std::to_string(std::random_device{}()));
    fs::create_directories(path);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  std::string operator/(const std::string& name) const { return (path / name).string(); }
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(path), fs::directory_iterator()); }
};

std::string content(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

std::string write_fault(const std::string& path) {
  try {
    write_xplt(path, cube());
  } catch (const WriteError& error) {
    return error.what();
  }
  return "no fault";
}

// ------------------------------------------------------------------------------------------------ bytes

TEST(XpltBytes, WorkedExample) {
  const std::string expected = cube_bytes();
  const std::string bytes = xplt_bytes(cube());
  ASSERT_EQ(bytes.size(), 1098u);
  for (std::size_t i = 0; i < bytes.size(); ++i) ASSERT_EQ(bytes[i], expected[i]) << "at byte " << i;

  const unsigned char first[44] = {0x42, 0x45, 0x46, 0x00, 0x00, 0x00, 0x00, 0x01, 0x2f, 0x01, 0x00,
                                   0x00, 0x00, 0x00, 0x01, 0x01, 0x27, 0x00, 0x00, 0x00, 0x01, 0x00,
                                   0x01, 0x01, 0x04, 0x00, 0x00, 0x00, 0x35, 0x00, 0x00, 0x00, 0x04,
                                   0x00, 0x01, 0x01, 0x04, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00};
  for (std::size_t i = 0; i < 44; ++i) EXPECT_EQ(static_cast<unsigned char>(bytes[i]), first[i]) << i;
}

TEST(XpltBytes, RootAndFirstMeshAreNeverCompressed) {
  const std::string plain = xplt_bytes(cube());
  const std::string packed = xplt_bytes(compressed(cube()));
  std::string root_and_mesh = plain.substr(0, 842);
  root_and_mesh[40] = 1;  // the flag
  EXPECT_EQ(packed.substr(0, 842), root_and_mesh);
  EXPECT_EQ(static_cast<unsigned char>(packed[842]), 0x78);  // zlib, window 15
  EXPECT_LT(packed.size(), plain.size());
}

TEST(XpltBytes, NamesAreCutToWhatTheFormatHolds) {
  XpltFile file = cube();
  const std::string a62(62, 'a');
  file.variables[1].name = a62 + "bc";                          // 64 bytes
  file.meshes[0].surfaces[0].name = a62 + "\xc3\xa4";           // a two-byte character across the end
  file.meshes[0].parts[0] = std::string(61, 'a') + "\xc3\xa4";  // 63 bytes: just fits
  file.meshes[0].domains[0].name = std::string(200, 'd');
  file.software = std::string(61, 's') + "\xf0\x9f\xa6\xb4";  // four bytes
  const XpltFile read = again(file);
  EXPECT_EQ(read.variables[1].name, a62 + "b");
  EXPECT_EQ(read.meshes[0].surfaces[0].name, a62);
  EXPECT_EQ(read.meshes[0].parts[0], file.meshes[0].parts[0]);
  EXPECT_EQ(read.meshes[0].domains[0].name, std::string(63, 'd'));
  EXPECT_EQ(read.software, std::string(61, 's'));
}

TEST(XpltBytes, SizesThatDoNotFitAreOurFault) {
  const std::vector<std::function<void(XpltFile&)>> mistakes = {
      [](XpltFile& f) { f.version = 0x36; },
      [](XpltFile& f) { f.meshes.clear(); },
      [](XpltFile& f) { std::swap(f.variables[0], f.variables[1]); },  // order of groups
      [](XpltFile& f) { f.variables[1].name = "displacement"; },       // twice
      [](XpltFile& f) { f.variables[1].name = "p=displacement"; },     // shown under the same name
      [](XpltFile& f) { f.variables[1].name.clear(); },
      [](XpltFile& f) { f.variables[0].type = XpltType::Mat3d; },
      [](XpltFile& f) { f.variables[1].type = XpltType::Array; },  // without a size
      [](XpltFile& f) { f.variables[1].format = XpltFormat::Node, f.states[0].variables[1].clear(); },
      [](XpltFile& f) { f.variables[1].type = XpltType::Mat3, f.variables[1].format = XpltFormat::Mult; },
      [](XpltFile& f) { f.meshes[0].coordinates.pop_back(); },
      [](XpltFile& f) { f.meshes[0].domains.clear(); },
      [](XpltFile& f) { f.meshes[0].domains[0].element_ids.push_back(2); },
      [](XpltFile& f) { f.meshes[0].domains[0].element_type = 15; },
      [](XpltFile& f) { f.meshes[0].domains[0].element_type = 20; },
      [](XpltFile& f) { f.meshes[0].domains[0].part = 2; },
      [](XpltFile& f) { f.meshes[0].domains[0].part = 0; },
      [](XpltFile& f) { f.meshes[0].domains[0].nodes[3] = 8; },
      [](XpltFile& f) { f.meshes[0].surfaces[0].nodes[3] = -1; },
      [](XpltFile& f) {
        f.meshes[0].surfaces[0].begin = {0, 3};
      },
      [](XpltFile& f) {
        f.meshes[0].surfaces[0].begin = {0, 5, 4};
      },
      [](XpltFile& f) { f.meshes[0].surfaces[0].begin.clear(); },
      [](XpltFile& f) { f.meshes[0].surfaces[0].max_nodes = 3; },
      [](XpltFile& f) { f.meshes[0].surfaces[0].max_nodes = 11; },
      [](XpltFile& f) {
        f.meshes[0].node_sets = {{"set", {8}}};
      },
      [](XpltFile& f) {
        f.meshes[0].element_sets = {{"set", {2}}};
      },  // no such element
      [](XpltFile& f) { f.states[0].mesh = 1; },
      [](XpltFile& f) { f.states[0].mesh = -1; },
      [](XpltFile& f) { f.states[0].element_flags.push_back(1); },
      [](XpltFile& f) { f.states[0].variables.pop_back(); },
      [](XpltFile& f) { f.states[0].variables[0][0].values.pop_back(); },
      [](XpltFile& f) { f.states[0].variables[0][0].region = 1; },
      [](XpltFile& f) { f.states[0].variables[1][0].values.push_back(0); },
      [](XpltFile& f) { f.states[0].variables[1][0].region = 2; },
      [](XpltFile& f) {
        f.states[0].variables[1].push_back({1, {0.5f}});
      },  // twice
      [](XpltFile& f) { f.states[0].objects.resize(1); },
  };
  EXPECT_NO_THROW(xplt_bytes(cube()));
  for (std::size_t i = 0; i < mistakes.size(); ++i) {
    XpltFile file = cube();
    mistakes[i](file);
    EXPECT_THROW(xplt_bytes(file), std::logic_error) << "mistake " << i;
  }

  XpltFile file = everything();
  file.meshes[1].objects = file.meshes[0].objects;
  EXPECT_THROW(xplt_bytes(file), std::logic_error);
  file = everything();
  file.states[0].mesh = 1;  // the mesh of a later state comes before
  EXPECT_THROW(xplt_bytes(file), std::logic_error);
  file = everything();
  file.states[0].objects[0].data[0].pop_back();
  EXPECT_THROW(xplt_bytes(file), std::logic_error);
}

/// What is no number is our fault; what is too large for the file's single precision is the model's.
void refused(const XpltFile& file, float bad) {
  if (std::isnan(bad))
    EXPECT_THROW(xplt_bytes(file), std::logic_error);
  else
    EXPECT_THROW(xplt_bytes(file), InputError);
}

TEST(XpltBytes, NoNumberIsInfinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    XpltFile file = cube();
    file.states[0].variables[1][0].values[0] = bad;
    refused(file, bad);
    file = cube();
    file.states[0].time = bad;
    EXPECT_THROW(xplt_bytes(file), std::logic_error);
    file = cube();
    file.meshes[0].coordinates[5] = bad;
    refused(file, bad);
    file = everything();
    file.states[1].objects[1].line_ends[3] = bad;
    refused(file, bad);
  }
}

// ---------------------------------------------------------------------------------------------- reading

TEST(XpltRead, WhatWasWritten) {
  EXPECT_EQ(again(cube()), cube());
  EXPECT_EQ(again(compressed(cube())), compressed(cube()));
  EXPECT_EQ(again(everything()), everything());
  EXPECT_EQ(again(compressed(everything())), compressed(everything()));
}

TEST(XpltRead, ByteSwapped) { EXPECT_EQ(xplt_from_bytes(cube_bytes(true), "swapped.xplt"), cube()); }

TEST(XpltRead, NodeIdsAreRealFromVersion33) {
  XpltFile file = cube();
  file.meshes[0].node_ids = {11, 12, 13, 14, 15, 16, 17, 18};
  for (const std::uint32_t version : {0x30u, 0x31u, 0x32u, 0x33u, 0x34u, 0x35u}) {
    file.version = version;
    EXPECT_EQ(again(file).meshes[0].node_ids[0], version < 0x33 ? 1 : 11);
  }
}

TEST(XpltRead, FixedNamesEndAtTheirZero) {  // FEBio leaves old memory behind it
  std::string bytes = cube_bytes();
  bytes[127 + 12 + 1] = 'x';
  EXPECT_EQ(xplt_from_bytes(bytes, "").variables[0].name, "displacement");
}

// What was read can be written, in dea compare -o: an element set holds elements that are there.
TEST(XpltRead, ElementSetOfNoElement) {
  XpltFile file = cube();
  file.meshes[0].domains[0].element_ids = {0x01020304};
  file.meshes[0].element_sets = {{"set", {0x01020304}}};
  std::string bytes = xplt_bytes(file);
  const std::size_t in_set = bytes.rfind("\x04\x03\x02\x01");  // behind the domain's
  ASSERT_NE(in_set, std::string::npos);
  bytes[in_set] = 5;
  const std::string found = fault(bytes);
  EXPECT_NE(found.find("element set \"set\": element 16909061, but no element has this id"), std::string::npos)
      << found;
}

// The bytes of the cube with `removed` bytes at `at` replaced, and the sizes of the chunks around put right.
std::string spliced(std::size_t at, std::size_t removed, const std::string& inserted,
                    const std::vector<std::size_t>& around) {
  std::string bytes = cube_bytes();
  for (const std::size_t chunk : around) {
    std::uint32_t size = 0;
    for (std::size_t i = 0; i < 4; ++i)
      size |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[chunk + 4 + i])) << 8 * i;
    Writer w;
    w.u32(size + static_cast<std::uint32_t>(inserted.size()) - static_cast<std::uint32_t>(removed));
    bytes.replace(chunk + 4, 4, w.bytes);
  }
  return bytes.replace(at, removed, inserted);
}

std::string of_version(std::string bytes, char version) {
  bytes[28] = version;
  return bytes;
}

// Files of newer FEBios have domains without a name, or with an empty one.
TEST(XpltRead, DomainsWithoutAName) {
  XpltFile nameless = cube();
  nameless.meshes[0].domains[0].name = "";
  const std::vector<std::size_t> around = {315, 499, 507, 515};
  EXPECT_EQ(xplt_from_bytes(spliced(559, 16, "", around), ""), nameless);
  Writer empty;
  for (const std::uint32_t word : {0x01032105u, 4u, 0u}) empty.u32(word);
  EXPECT_EQ(xplt_from_bytes(spliced(559, 16, empty.bytes, around), ""), nameless);
}

// What came after this reader is passed over wherever it stands: the end of each branch of the cube, and of the file.
TEST(XpltRead, NewerFilesAreReadAsFarAsTheyAreKnown) {
  XpltFile newer = cube();
  newer.version = 0x36;
  EXPECT_EQ(xplt_from_bytes(of_version(cube_bytes(), 0x36), ""), newer);
  EXPECT_TRUE(is_newer(newer));
  EXPECT_FALSE(is_newer(cube()));
  Writer unknown;
  for (const std::uint32_t word : {0x0F0F0F0Fu, 4u, 7u}) unknown.u32(word);
  const std::vector<std::vector<std::size_t>> branches = {{},
                                                          {4},
                                                          {4, 12},
                                                          {4, 59},
                                                          {4, 59, 67},
                                                          {4, 59, 67, 75},
                                                          {315},
                                                          {315, 323},
                                                          {315, 323, 331},
                                                          {315, 499},
                                                          {315, 499, 507},
                                                          {315, 499, 507, 515},
                                                          {315, 499, 507, 575},
                                                          {315, 627},
                                                          {315, 627, 635},
                                                          {315, 627, 635, 643},
                                                          {315, 627, 635, 702},
                                                          {315, 742},
                                                          {315, 742, 750},
                                                          {842},
                                                          {842, 850},
                                                          {842, 882},
                                                          {842, 902},
                                                          {842, 902, 910},
                                                          {842, 902, 910, 918}};
  int refused = 0;
  std::size_t passed_over = 0;
  for (const std::vector<std::size_t>& around : branches) {
    std::size_t end = cube_bytes().size();
    if (!around.empty()) {
      const std::string bytes = cube_bytes();
      end = around.back() + 8;
      for (std::size_t i = 0; i < 4; ++i)
        end += static_cast<std::size_t>(static_cast<unsigned char>(bytes[around.back() + 4 + i])) << 8 * i;
    }
    const std::string bytes = spliced(end, 0, unknown.bytes, around);
    XpltFile found = xplt_from_bytes(of_version(bytes, 0x36), "");
    passed_over += found.passed_over;
    found.passed_over = 0;
    EXPECT_EQ(found, newer) << end;
    refused += fault(bytes) != "no fault";
  }
  EXPECT_EQ(refused, 20);  // a file of a version that is known: damage, but where FEBio's own readers pass it over
  EXPECT_EQ(passed_over, 20u);
  const std::string wrong = of_version(spliced(531, 1, "\x63", {}), 0x36);
  EXPECT_EQ(fault(wrong), "hip.xplt: byte 531: unknown element type 99 (plot file version 0x36, dea knows up to 0x35)");
}

TEST(XpltRead, FaultsNamePlaceAndReason) {
  const std::string good = cube_bytes();
  const auto with = [&](std::size_t at, unsigned char byte) {
    std::string bytes = good;
    bytes[at] = static_cast<char>(byte);
    return bytes;
  };
  EXPECT_EQ(fault(""), "hip.xplt: byte 0: not an FEBio plot file (too short)");
  EXPECT_EQ(fault("<?xml version"), "hip.xplt: byte 0: not an FEBio plot file");
  EXPECT_EQ(
      fault("<?xml version=\"1.0\"?>\n<febio_spec version=\"4.0\">"),
      "hip.xplt: this is a FEBio model, not a plot file: \"dea run hip.xplt\" writes hip.xplt_dea.xplt, take that");
  EXPECT_EQ(fault(with(28, 0x05)),
            "hip.xplt: byte 28: plot file version 0x5, need 0x30 to 0x3f (written by FEBio 1 or 2?)");
  EXPECT_EQ(fault(with(28, 0x40)), "hip.xplt: byte 28: plot file version 0x40, need 0x30 to 0x3f");
  EXPECT_EQ(fault(with(40, 1)), "hip.xplt: byte 842: damaged compressed data");
  EXPECT_EQ(fault(with(87, 5)), "hip.xplt: byte 83: chunk 01020002 has 5 bytes, expected 4");
  EXPECT_EQ(fault(with(91, 8)), "hip.xplt: byte 91: variable of type 8, need 0 to 7");
  EXPECT_EQ(fault(with(347, 9)), "hip.xplt: byte 363: chunk 01041200 has 128 bytes, expected 144");
  std::string infinite =
      with(377, 0x80);  // the first coordinate, 0 until now; a plot file with it could not be written
  infinite[378] = 0x7f;
  EXPECT_EQ(fault(infinite), "hip.xplt: byte 371: node 1 has a coordinate that is no finite number");
  EXPECT_EQ(fault(with(531, 99)), "hip.xplt: byte 531: unknown element type 99");
  EXPECT_EQ(fault(with(543, 2)), "hip.xplt: byte 323: domain 1 is of part 2, but there are 1 parts");
  EXPECT_EQ(fault(with(555, 2)), "hip.xplt: byte 515: domain of 1 elements, 2 expected");
  EXPECT_EQ(fault(with(595, 8)), "hip.xplt: byte 323: domain: node index 8, but the mesh has 8 nodes");
  EXPECT_EQ(fault(with(722, 5)), "hip.xplt: byte 718: facet of 5 nodes, need 1 to 4");
  EXPECT_EQ(fault(with(845, 3)), "hip.xplt: byte 842: chunk 03000000 where a state or a mesh is expected");
  EXPECT_EQ(fault(with(934, 2)), "hip.xplt: byte 934: variable 2 of a group of 1");
  EXPECT_EQ(fault(with(1086, 2)), "hip.xplt: byte 1086: \"contact pressure\": no region 2 in the mesh");
  EXPECT_EQ(fault(good.substr(0, 200)), "hip.xplt: byte 4: the file ends in its root");
  EXPECT_EQ(fault(good.substr(0, 800)), "hip.xplt: byte 315: the file ends before or in its mesh");

  std::string bytes = xplt_bytes(compressed(cube()));
  XpltFile wrong = cube();
  wrong.variables[1].type = XpltType::Vec3;
  wrong.states[0].variables[1][0].values.resize(3);
  bytes.replace(842, std::string::npos, xplt_bytes(compressed(wrong)).substr(842));
  EXPECT_EQ(fault(bytes),
            "hip.xplt: byte 244 of the data compressed at byte 842: "
            "\"contact pressure\", region 1: 12 bytes, expected 4");

  Folder folder;
  const auto file_fault = [](const std::string& path) {
    try {
      read_xplt(path);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no fault");
  };
  EXPECT_EQ(file_fault(folder / "none.xplt"), folder / "none.xplt: no such file: check the path");
  EXPECT_EQ(file_fault(folder.path.string()), folder.path.string() + ": Is a directory");
}

// A file cut anywhere: an error while root and mesh are not complete; after that all complete states, flagged
// unless the cut falls exactly between two chunks, where nothing shows that more was to come.
TEST(XpltRead, CutAtEveryByte) {
  XpltFile file = cube();
  file.states.push_back(file.states[0]);
  file.states[1].time = 2;
  for (const bool pack : {false, true}) {
    file.compressed = pack;
    const std::string bytes = xplt_bytes(file);
    XpltFile one = file;
    one.states.pop_back();
    const std::size_t end_of_first = xplt_bytes(one).size();
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const std::string cut = bytes.substr(0, size);
      if (size < 842) {
        EXPECT_THROW(xplt_from_bytes(cut, "cut.xplt"), InputError) << size;
        continue;
      }
      const XpltFile read = xplt_from_bytes(cut, "cut.xplt");
      EXPECT_EQ(read.truncated, size != 842 && size != end_of_first) << size;
      ASSERT_EQ(read.states.size(), size < end_of_first ? 0u : 1u) << size;
      EXPECT_TRUE(read.states.empty() || read.states[0] == file.states[0]) << size;
    }
  }
}

// Damage anywhere gives an error or a file that is consistent in itself; the sanitizers watch the rest.
void read_damaged(const std::string& bytes) {
  try {
    const XpltFile file = xplt_from_bytes(bytes, "damaged.xplt");
    for (const XpltState& state : file.states) {
      const XpltMesh& mesh = file.meshes.at(static_cast<std::size_t>(state.mesh));
      ASSERT_EQ(state.variables.size(), file.variables.size());
      for (std::size_t i = 0; i < file.variables.size(); ++i) {
        for (const XpltRegion& region : state.variables[i]) {
          ASSERT_EQ(static_cast<std::int64_t>(region.values.size()),
                    floats_in_region(mesh, file.variables[i], region.region));
        }
      }
    }
  } catch (const InputError& error) {
    ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

TEST(XpltRead, EveryByteDamaged) {
  for (const XpltFile& file : {cube(), compressed(cube()), everything(), compressed(everything())}) {
    const std::string bytes = xplt_bytes(file);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const unsigned masks[] = {0x01, 0x80, 0xFF};
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(static_cast<unsigned char>(damaged[i]) ^ masks[i % 3]);
      read_damaged(damaged);
    }
  }
}

TEST(XpltRead, RandomDamage) {
  const std::string plain = xplt_bytes(everything());
  const std::string packed = xplt_bytes(compressed(everything()));
  EXPECT_TRUE(rc::check([&](bool pack) {
    std::string bytes = pack ? packed : plain;
    const int changes = *rc::gen::inRange(1, 6);
    for (int i = 0; i < changes; ++i) {
      const auto at = *rc::gen::inRange<std::size_t>(0, bytes.size());
      switch (*rc::gen::inRange(0, 3)) {
        case 0:
          bytes[at] = *rc::gen::arbitrary<char>();
          break;
        case 1:
          bytes.erase(at, *rc::gen::inRange<std::size_t>(1, 40));
          break;
        default:
          bytes.insert(at, bytes.substr(*rc::gen::inRange<std::size_t>(0, bytes.size()), 12));
          break;
      }
      if (bytes.empty()) break;
    }
    read_damaged(bytes);
    RC_ASSERT(!testing::Test::HasFatalFailure());
  }));
}

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(size, '\0');
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                     static_cast<uLong>(bytes.size())),
            Z_OK);
  out.resize(size);
  return out;
}

// A compressed state may not unpack to more than it says: here 2 MB behind a chunk of 8 bytes.
TEST(XpltRead, CompressedStateThatNeverEnds) {
  Writer state;
  state.u32(0x02000000);
  state.u32(8);
  state.bytes.resize(2'000'000, '\0');
  const std::string start = xplt_bytes(compressed(cube())).substr(0, 842);
  EXPECT_EQ(fault(start + deflated(state.bytes)), "hip.xplt: byte 842: compressed chunk longer than it says");
}

// Nor to more than the memory holds: here a state says that it has 4 GB, and the process may have 1 MB.
TEST(XpltRead, CompressedStateLargerThanTheMemory) {
  Writer state;
  state.u32(0x02000000);
  state.u32(0xFFFFFFF0);
  const std::string start = xplt_bytes(compressed(cube())).substr(0, 842);
  ::setenv("SLURM_MEM_PER_NODE", "1", 1);
  const std::string found = fault(start + deflated(state.bytes));
  ::unsetenv("SLURM_MEM_PER_NODE");
  EXPECT_EQ(found,
            "hip.xplt: to read it needs about 8.6 GB of memory, and 0 GB are free: take a smaller file, or a "
            "machine with more memory");
}

// ----------------------------------------------------------------------------------------- random files

std::string random_name() {
  std::string name = *rc::gen::container<std::string>(rc::gen::inRange<char>('a', 'z'));
  return name.substr(0, 63);
}

std::vector<float> random_floats(std::int64_t size) {
  return *rc::gen::container<std::vector<float>>(
      static_cast<std::size_t>(size),
      rc::gen::map(rc::gen::inRange(-1000, 1000), [](int i) { return static_cast<float>(i) / 8; }));
}

XpltFacets random_facets(int nodes) {
  XpltFacets facets;
  facets.name = random_name();
  facets.max_nodes = *rc::gen::element(9, 10);
  const int count = *rc::gen::inRange(0, 4);
  for (int i = 0; i < count; ++i) {
    const int n = *rc::gen::element(3, 4, 6, 7, 8, 9);
    for (int k = 0; k < n; ++k) facets.nodes.push_back(*rc::gen::inRange(0, nodes));
    facets.begin.push_back(static_cast<int>(facets.nodes.size()));
  }
  return facets;
}

XpltMesh random_mesh() {
  XpltMesh mesh;
  const int nodes = *rc::gen::inRange(1, 12);
  mesh.node_ids = *rc::gen::container<std::vector<int>>(static_cast<std::size_t>(nodes), rc::gen::arbitrary<int>());
  mesh.coordinates = random_floats(3 * nodes);
  mesh.parts.resize(static_cast<std::size_t>(*rc::gen::inRange(1, 4)));
  for (std::string& part : mesh.parts) part = random_name();
  const int domains = *rc::gen::inRange(1, 4);
  for (int d = 0; d < domains; ++d) {
    XpltDomain domain;
    domain.name = random_name();
    domain.element_type = *rc::gen::element(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 16, 17, 18);
    domain.part = *rc::gen::inRange(1, static_cast<int>(mesh.parts.size()) + 1);
    const int elements = *rc::gen::inRange(1, 4);
    for (int e = 0; e < elements; ++e) {
      domain.element_ids.push_back(*rc::gen::inRange(1, 1000));
      const int n = xplt_nodes_per_element(domain.element_type);
      for (int k = 0; k < n; ++k) domain.nodes.push_back(*rc::gen::inRange(0, nodes));
    }
    mesh.domains.push_back(domain);
    mesh.element_sets.push_back({domain.name, domain.element_ids});
  }
  const int surfaces = *rc::gen::inRange(0, 3);
  for (int s = 0; s < surfaces; ++s) mesh.surfaces.push_back(random_facets(nodes));
  mesh.facet_sets = mesh.surfaces;
  return mesh;
}

XpltFile random_file() {
  XpltFile file;
  file.compressed = *rc::gen::arbitrary<bool>();
  file.software = random_name();
  file.units = random_name();
  const auto meshes = *rc::gen::inRange(1, 3);
  for (int m = 0; m < meshes; ++m) file.meshes.push_back(random_mesh());
  int number = 0;
  for (const XpltGroup group : {XpltGroup::Global, XpltGroup::Nodal, XpltGroup::Domain, XpltGroup::Surface}) {
    const int count = *rc::gen::inRange(0, 3);
    for (int i = 0; i < count; ++i) {
      XpltVariable v;
      v.group = group;
      v.type = *rc::gen::element(XpltType::Float, XpltType::Vec3);
      v.format = *rc::gen::element(XpltFormat::Item, XpltFormat::Mult, XpltFormat::Region);
      if (group == XpltGroup::Domain && *rc::gen::arbitrary<bool>()) v.format = XpltFormat::Node;
      v.name = fmt::format("v{}", number++);
      if (!file.units.empty()) v.units = random_name();
      file.variables.push_back(v);
    }
  }
  const int states = *rc::gen::inRange(0, 4);
  for (int s = 0; s < states; ++s) {
    XpltState state;
    state.time = static_cast<float>(s);
    state.mesh = std::min(s, meshes - 1);
    const XpltMesh& mesh = file.meshes[static_cast<std::size_t>(state.mesh)];
    for (const XpltVariable& v : file.variables) {
      state.variables.emplace_back();
      for (int region = 0; region < 5; ++region) {
        const std::int64_t size = floats_in_region(mesh, v, region);
        // An empty surface has no values to store, so they do not come back.
        if (size > 0 && *rc::gen::arbitrary<bool>()) state.variables.back().push_back({region, random_floats(size)});
      }
    }
    file.states.push_back(state);
  }
  return file;
}

TEST(XpltRead, RandomFilesComeBack) {
  EXPECT_TRUE(rc::check([] {
    const XpltFile file = random_file();
    RC_ASSERT(again(file) == file);
  }));
}

// ------------------------------------------------------------------------------------------------- disk

TEST(XpltWrite, ReplacesTheOldFile) {
  Folder folder;
  const std::string path = folder / "joint.xplt";
  std::ofstream(path) << "old";
  write_xplt(path, cube());
  EXPECT_EQ(content(path), cube_bytes());
  EXPECT_EQ(read_xplt(path), cube());
  EXPECT_EQ(folder.files(), 1);  // no temporary file left
}

TEST(XpltWrite, FailureNamesPathAndReason) {
  Folder folder;
  EXPECT_EQ(write_fault(folder / "none/joint.xplt"), folder / "none/joint.xplt: No such file or directory");
  fs::create_directory(folder.path / "joint.xplt");
  EXPECT_EQ(write_fault(folder / "joint.xplt"), folder / "joint.xplt: Is a directory");
  std::ofstream(folder / "file") << "text";
  EXPECT_EQ(write_fault(folder / "file/joint.xplt"), folder / "file/joint.xplt: Not a directory");
  EXPECT_EQ(folder.files(), 2);
}

TEST(XpltWrite, AFaultOfOursLeavesTheOldFile) {
  Folder folder;
  const std::string path = folder / "joint.xplt";
  std::ofstream(path) << "old";
  XpltFile file = cube();
  file.states[0].variables[1][0].values.clear();
  EXPECT_THROW(write_xplt(path, file), std::logic_error);
  EXPECT_EQ(content(path), "old");
  EXPECT_EQ(folder.files(), 1);
}

#if defined(__unix__) || defined(__APPLE__)
TEST(XpltWrite, ForbiddenFolder) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  Folder folder;
  fs::permissions(folder.path, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(write_fault(folder / "joint.xplt"), folder / "joint.xplt: Permission denied");
  fs::permissions(folder.path, fs::perms::owner_all);
}

TEST(XpltWrite, LongestFileName) {
  Folder folder;
  const std::string path = folder / (std::string(250, 'j') + ".xplt");
  write_xplt(path, cube());
  EXPECT_EQ(read_xplt(path), cube());
}

TEST(XpltWrite, KeepsLinks) {
  Folder folder;
  std::ofstream(folder / "real.xplt") << "old";
  fs::create_symlink("real.xplt", folder.path / "link.xplt");
  write_xplt(folder / "link.xplt", cube());
  EXPECT_TRUE(fs::is_symlink(folder.path / "link.xplt"));
  EXPECT_EQ(content(folder / "real.xplt"), cube_bytes());
}

TEST(XpltWrite, FullDevice) {
  if (!fs::is_character_file("/dev/full")) GTEST_SKIP() << "no /dev/full";
  EXPECT_EQ(write_fault("/dev/full"), "/dev/full: No space left on device");
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

// What `act` gives where no file can have more than so many bytes.
std::string with_room_for(rlim_t bytes, const std::function<std::string()>& act) {
  struct rlimit before = {};
  getrlimit(RLIMIT_FSIZE, &before);
  struct rlimit small = before;
  small.rlim_cur = bytes;
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string result = act();
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  return result;
}

// A disk that fills up half way: nothing of the new file is left, the old one is untouched.
TEST(XpltWrite, DiskFullInTheMiddle) {
  Folder folder;
  const std::string path = folder / "joint.xplt";
  std::ofstream(path) << "old";
  EXPECT_EQ(with_room_for(500, [&] { return write_fault(path); }), path + ": File too large");
  EXPECT_EQ(content(path), "old");
  EXPECT_EQ(folder.files(), 1);
}

// The same state by state, where the disk has room for the states that wait: for what is before them, or not even that.
TEST(XpltWrite, DiskFullStateByState) {
  Folder folder;
  const std::string path = folder / "joint.xplt";
  std::ofstream(path) << "old";
  XpltFile head = cube();
  for (int i = 2; i <= 1000; ++i) head.meshes[0].parts.push_back(fmt::format("part {}", i));
  const std::size_t before_states = xplt_bytes(head).size() - xplt_bytes(cube()).size();
  ASSERT_GT(before_states, 80000u);
  const auto write = [&]() -> std::string {
    try {
      XpltWriter writer(path, head);
      for (int i = 0; i < 100; ++i) writer.add(cube().states.front());
      writer.finish();
    } catch (const WriteError& error) {
      return error.what();
    }
    return "no fault";
  };
  for (const std::size_t room : {before_states / 2, before_states + 2000}) {
    SCOPED_TRACE(room);
    EXPECT_EQ(with_room_for(room, write), path + ": File too large");
    EXPECT_TRUE(content(path) == "old");
    EXPECT_EQ(folder.files(), 1);
  }
}

// A device takes the states as a file does.
TEST(XpltWrite, DeviceStateByState) {
  if (!fs::is_character_file("/dev/full")) GTEST_SKIP() << "no /dev/full";
  XpltWriter writer("/dev/full", cube());
  writer.add(cube().states.front());
  try {
    writer.finish();
    FAIL() << "no fault";
  } catch (const WriteError& error) {
    EXPECT_STREQ(error.what(), "/dev/full: No space left on device");
  }
}
#endif

// --------------------------------------------------------------------------------------------- helpers

TEST(Xplt, ElementTypesHaveTheNodesOfTheirShapes) {
  for (int i = 0; i <= static_cast<int>(ElementShape::Line3); ++i) {
    const auto shape = static_cast<ElementShape>(i);
    EXPECT_EQ(xplt_nodes_per_element(xplt_element_type(shape)), nodes_per_element(shape)) << i;
    EXPECT_EQ(xplt_element_shape(xplt_element_type(shape)), shape) << i;
  }
  EXPECT_EQ(xplt_nodes_per_element(-1), 0);
  EXPECT_EQ(xplt_nodes_per_element(20), 0);
  EXPECT_EQ(xplt_nodes_per_element(15), 10);  // tri10, a facet
  EXPECT_EQ(xplt_element_shape(15), std::nullopt);
}

TEST(Xplt, FloatsInRegion) {
  const XpltFile file = everything();
  const XpltMesh& mesh = file.meshes[0];  // 9 nodes; a cube and two triangles; surfaces of 1, 2 and 0 facets
  XpltVariable v;
  const auto floats = [&](XpltGroup group, XpltFormat format, int region) {
    v.group = group;
    v.format = format;
    return floats_in_region(mesh, v, region);
  };
  EXPECT_EQ(floats(XpltGroup::Global, XpltFormat::Region, 0), 1);
  EXPECT_EQ(floats(XpltGroup::Nodal, XpltFormat::Node, 0), 9);
  EXPECT_EQ(floats(XpltGroup::Nodal, XpltFormat::Node, 1), -1);
  EXPECT_EQ(floats(XpltGroup::Domain, XpltFormat::Node, 2), 4);  // each node once
  EXPECT_EQ(floats(XpltGroup::Domain, XpltFormat::Item, 2), 2);
  EXPECT_EQ(floats(XpltGroup::Domain, XpltFormat::Mult, 2), 6);
  EXPECT_EQ(floats(XpltGroup::Domain, XpltFormat::Region, 2), 1);
  EXPECT_EQ(floats(XpltGroup::Domain, XpltFormat::Item, 3), -1);
  EXPECT_EQ(floats(XpltGroup::Domain, XpltFormat::Item, 0), -1);
  EXPECT_EQ(floats(XpltGroup::Surface, XpltFormat::Node, 2), 5);
  EXPECT_EQ(floats(XpltGroup::Surface, XpltFormat::Mult, 2), 8);  // the triangle has a fourth, unused slot
  EXPECT_EQ(floats(XpltGroup::Surface, XpltFormat::Item, 3), 0);
  EXPECT_EQ(floats(XpltGroup::Surface, XpltFormat::Item, 4), -1);
  EXPECT_EQ(floats(XpltGroup::Edge, XpltFormat::Mult, 1), 6);
  v.type = XpltType::ArrayVec3;
  v.array_size = 2;
  EXPECT_EQ(floats(XpltGroup::Domain, XpltFormat::Item, 2), 12);
}

TEST(Xplt, FindVariable) {
  const XpltFile file = cube();
  EXPECT_EQ(find_variable(file, XpltGroup::Nodal, "displacement"), 0);
  EXPECT_EQ(find_variable(file, XpltGroup::Surface, "contact pressure"), 1);
  EXPECT_EQ(find_variable(file, XpltGroup::Nodal, "contact pressure"), -1);
}

// --------------------------------------------------------------------------------------- FEBio's own files

std::vector<float> values(const XpltFile& file, XpltGroup group, const std::string& name, int region) {
  const int i = find_variable(file, group, name);
  if (i < 0 || file.states.empty()) return {};
  for (const XpltRegion& r : file.states.back().variables[static_cast<std::size_t>(i)]) {
    if (r.region == region) return r.values;
  }
  return {};
}

TEST(XpltReference, HipWalking) {
  const std::string path = DEA_REFERENCE_DIR "/hip_walking_febio_penalty20.xplt";
  if (!fs::exists(path)) GTEST_SKIP() << path << " is not here";
  const XpltFile file = read_xplt(path);
  EXPECT_EQ(file.version, 0x35u);
  EXPECT_FALSE(file.truncated);
  ASSERT_EQ(file.meshes.size(), 1u);
  const XpltMesh& mesh = file.meshes[0];
  EXPECT_EQ(mesh.node_ids.size(), 11220u);
  ASSERT_EQ(mesh.domains.size(), 4u);
  ASSERT_EQ(mesh.surfaces.size(), 2u);
  EXPECT_EQ(mesh.surfaces[0].name, "femoral_articulating");
  EXPECT_EQ(mesh.surfaces[1].name, "acetabular_articulating");
  EXPECT_EQ(mesh.surfaces[1].size(), 864);
  EXPECT_EQ(mesh.parts, (std::vector<std::string>{"femoral cartilage", "acetabular cartilage", "femur", "pelvis"}));
  ASSERT_EQ(mesh.objects.size(), 2u);
  EXPECT_EQ(mesh.objects[0].name, "femur");
  ASSERT_EQ(file.states.size(), 1u);
  EXPECT_EQ(file.states[0].time, 2.0f);

  // The applied joint force, the peak pressure and the bone's motion of the reference's own table. The femur
  // moves by its applied force, exactly a float; what the contact carries is so up to FEBio's tolerance.
  const std::vector<float> reaction = values(file, XpltGroup::Domain, "rigid force", 3);
  EXPECT_EQ(reaction, (std::vector<float>{432, -262, 1834}));
  const std::vector<float> position = values(file, XpltGroup::Domain, "rigid position", 3);
  ASSERT_EQ(position.size(), 3u);
  EXPECT_NEAR(position[2], 1.1816, 5e-5);
  const std::vector<float> pressure = values(file, XpltGroup::Surface, "contact pressure", 2);
  ASSERT_EQ(pressure.size(), 864u);
  EXPECT_NEAR(*std::max_element(pressure.begin(), pressure.end()), 6.47, 5e-3);
  const std::vector<float> on_pelvis = values(file, XpltGroup::Surface, "contact force", 2);
  const std::vector<float> on_femur = values(file, XpltGroup::Surface, "contact force", 1);
  ASSERT_EQ(on_pelvis.size(), 3u);
  ASSERT_EQ(on_femur.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(on_pelvis[k], reaction[k], 1e-3 * 1834);
    EXPECT_NEAR(on_femur[k], -on_pelvis[k], 1e-3 * 1834);
  }
}

// FEBio's files come back the same when written by us, and as long: they differ only in the padding that FEBio
// fills with old memory.
TEST(XpltReference, RewrittenFilesAreTheSame) {
  if (!fs::exists(DEA_REFERENCE_DIR)) GTEST_SKIP() << DEA_REFERENCE_DIR << " is not here";
  for (const fs::directory_entry& entry : fs::directory_iterator(DEA_REFERENCE_DIR)) {
    if (entry.path().extension() != ".xplt") continue;
    SCOPED_TRACE(entry.path().string());
    const XpltFile file = read_xplt(entry.path().string());
    EXPECT_FALSE(file.truncated);
    EXPECT_EQ(xplt_bytes(file).size(), fs::file_size(entry.path()));
    EXPECT_TRUE(again(file) == file);
    const XpltFile packed = compressed(file);
    EXPECT_TRUE(again(packed) == packed);
  }
}

}  // namespace dea::xplt_test
