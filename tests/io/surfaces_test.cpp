// Surfaces from files: one shape in every format, and what is refused.
#include "io/surfaces/read_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <cstring>

#include "io/files/encoded_text.h"
#include "src/base/error.h"

#include "tests/io/text_file.h"

namespace dea::surfaces_test {

using test::file;

/// Bytes of a number, least first or most first.
template <class Number>
std::string bytes(Number value, bool big_endian) {
  std::string text(sizeof value, '\0');
  std::memcpy(text.data(), &value, sizeof value);
  if (big_endian) std::reverse(text.begin(), text.end());
  return text;
}

/// Volume by the divergence theorem: of the corner below 1 * 2 * 3 / 6 = 1, whatever order the points have.
double volume(const TriangleSurface& s) {
  double sum = 0;
  for (const auto& t : s.triangles) {
    const auto x = [&](std::size_t k) { return s.points[static_cast<std::size_t>(t[k])]; };
    sum += x(0).dot(x(1).cross(x(2))) / 6;
  }
  return sum;
}

/// The corner of a box: points (0,0,0), (1,0,0), (0,2,0), (0,0,3), four triangles outwards.
constexpr float kPoints[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
constexpr int kTriangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

std::string stl_binary() {
  std::string text(80, 's');
  text += bytes<std::uint32_t>(4, false);
  for (const auto& t : kTriangles) {
    text += std::string(12, '\0');
    for (const int p : t)
      for (const float x : kPoints[p]) text += bytes(x, false);
    text += std::string(2, '\0');
  }
  return text;
}

std::string stl_text() {
  std::string text = "solid corner\n";
  for (const auto& t : kTriangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int p : t)
      text += "vertex " + std::to_string(kPoints[p][0]) + " " + std::to_string(kPoints[p][1]) + " " +
              std::to_string(kPoints[p][2]) + "\n";
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid corner\n";
}

std::string ply(const std::string& format) {
  std::string text = "ply\nformat " + format +
                     " 1.0\ncomment a corner\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                     "property uchar red\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
  const bool big = format == "binary_big_endian", binary = format != "ascii";
  for (const auto& p : kPoints) {
    for (const float x : p) text += binary ? bytes(x, big) : std::to_string(x) + " ";
    text += binary ? std::string(1, '\7') : "7\n";
  }
  for (const auto& t : kTriangles) {
    text += binary ? std::string(1, '\3') : "3 ";
    for (const int p : t) text += binary ? bytes<std::int32_t>(p, big) : std::to_string(p) + " ";
    if (!binary) text += "\n";
  }
  return text;
}

std::string vtk(bool binary, bool version_5) {
  std::string text = std::string("# vtk DataFile Version ") + (version_5 ? "5.1" : "3.0") + "\ncorner\n" +
                     (binary ? "BINARY" : "ASCII") + "\nDATASET POLYDATA\nPOINTS 4 float\n";
  for (const auto& p : kPoints)
    for (const float x : p) text += binary ? bytes(x, true) : std::to_string(x) + " ";
  text += version_5 ? "\nPOLYGONS 5 12\nOFFSETS vtktypeint64\n" : "\nPOLYGONS 4 16\n";
  if (version_5) {
    for (std::int64_t i = 0; i <= 12; i += 3) text += binary ? bytes(i, true) : std::to_string(i) + " ";
    text += "\nCONNECTIVITY vtktypeint64\n";
  }
  for (const auto& t : kTriangles) {
    if (!version_5) text += binary ? bytes<std::int32_t>(3, true) : "3 ";
    for (const int p : t)
      text += !binary     ? std::to_string(p) + " "
              : version_5 ? bytes<std::int64_t>(p, true)
                          : bytes<std::int32_t>(p, true);
  }
  return text + "\n";
}

constexpr const char* kObj =
    "# corner\nv 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nvn 0 0 1\nf 1//1 3//1 2//1\nf 1 2 4\nf 1/1/1 4 3\nf -3 -2 -1\n";
constexpr const char* kVtp =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"4\" NumberOfPolys=\"4\">\n"
    "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 2 0 0 0 "
    "3</DataArray></Points>\n"
    "<Polys><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 2 1 0 1 3 0 3 2 1 2 3</DataArray>\n"
    "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">3 6 9 "
    "12</DataArray></Polys></Piece></PolyData></VTKFile>\n";

/// As VTK 9.1 wrote it: blocks packed by zlib, as base64 within the XML.
constexpr const char* kVtpOfVtk = R"(<?xml version="1.0"?>
<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian" header_type="UInt32" compressor="vtkZLibDataCompressor">
  <PolyData>
    <Piece NumberOfPoints="4" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="4">
      <Points>
        <DataArray type="Float32" Name="Points" NumberOfComponents="3" format="binary" RangeMin="0" RangeMax="3">
          AQAAAACAAAAwAAAAFAAAAA==eF5jYEAGDfYMqMABjesAAB5PAYA=
          <InformationKey name="L2_NORM_RANGE" location="vtkDataArray" length="2">
            <Value index="0">
              0
            </Value>
          </InformationKey>
        </DataArray>
      </Points>
      <Verts>
        <DataArray type="Int64" Name="connectivity" format="binary" RangeMin="1e+299" RangeMax="-1e+299">
          AAAAAACAAAAAAAAA
        </DataArray>
      </Verts>
      <Polys>
        <DataArray type="Int64" Name="connectivity" format="binary" RangeMin="0" RangeMax="3">
          AQAAAACAAABgAAAAHgAAAA==eF5jYIAAJijNyIAKYHxmNHEYH10fjA+TBwADUAAT
        </DataArray>
        <DataArray type="Int64" Name="offsets" format="binary" RangeMin="3" RangeMax="12">
          AQAAAACAAAAgAAAAEwAAAA==eF5jZoAANijNCaV5oDQAAgAAHw==
        </DataArray>
      </Polys>
    </Piece>
  </PolyData>
</VTKFile>
)";

struct VtpKind {
  bool appended = false, raw = false, packed = false, big = false, long_counts = false;
  std::size_t block = 40;  // bytes: several blocks, the last one shorter
};

/// A VTP file with its numbers as bytes, as VTK's file format describes them.
std::string vtp(const VtpKind& kind) {
  std::string points, corners, ends, appended;
  for (const auto& p : kPoints)
    for (const float x : p) points += bytes<double>(x, kind.big);
  for (const auto& t : kTriangles)
    for (const int p : t) corners += bytes<std::int32_t>(p, kind.big);
  for (std::uint64_t i = 3; i <= 12; i += 3) ends += bytes(i, kind.big);
  const auto count = [&](std::size_t n) {
    return kind.long_counts ? bytes<std::uint64_t>(n, kind.big)
                            : bytes<std::uint32_t>(static_cast<std::uint32_t>(n), kind.big);
  };
  const auto text = [&](const std::string& all) { return kind.appended && kind.raw ? all : base64(all); };
  const auto coded = [&](const std::string& all) {
    if (!kind.packed) return text(count(all.size()) + all);
    const std::size_t blocks = (all.size() + kind.block - 1) / kind.block;
    std::string counts = count(blocks) + count(kind.block) + count(all.size() % kind.block), packed;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::string one = packed_bytes(all.substr(b * kind.block, kind.block));
      counts += count(one.size());
      packed += one;
    }
    return text(counts) + text(packed);
  };
  const auto array = [&](const char* type, const char* name, const std::string& all) {
    std::string words = std::string("<DataArray type=\"") + type + "\" Name=\"" + name + "\" format=\"";
    if (!kind.appended) return words + "binary\">\n  " + coded(all) + "\n</DataArray>";
    words += "appended\" offset=\"" + std::to_string(appended.size()) + "\"/>";
    appended += coded(all);
    return words;
  };
  // one after the other into the appended bytes, whatever the compiler's order; the points' several blocks are the last
  const std::string ends_array = array("UInt64", "offsets", ends);
  const std::string corners_array = array("Int32", "connectivity", corners);
  const std::string arrays =
      "<Points>" + array("Float64", "Points", points) + "</Points><Polys>" + corners_array + ends_array + "</Polys>";
  return std::string("<VTKFile type=\"PolyData\" byte_order=\"") + (kind.big ? "BigEndian" : "LittleEndian") +
         "\" header_type=\"" + (kind.long_counts ? "UInt64" : "UInt32") + "\"" +
         (kind.packed ? " compressor=\"vtkZLibDataCompressor\"" : "") + ">\n<PolyData><Piece>" + arrays +
         "</Piece></PolyData>" +
         (kind.appended ? std::string("\n<AppendedData encoding=\"") + (kind.raw ? "raw" : "base64") + "\">\n   _" +
                              appended + "\n</AppendedData>"
                        : "") +
         "\n</VTKFile>\n";
}

TEST(Surfaces, VtpInBytesOfEveryKind) {
  EXPECT_EQ(volume(read_surface(file("vtk.vtp", kVtpOfVtk))), 1.0);
  for (int i = 0; i < 32; ++i) {
    const VtpKind kind = {.appended = (i & 1) != 0,
                          .raw = (i & 2) != 0,
                          .packed = (i & 4) != 0,
                          .big = (i & 8) != 0,
                          .long_counts = (i & 16) != 0};
    const TriangleSurface s = read_surface(file("kind.vtp", vtp(kind)));
    ASSERT_EQ(s.triangles.size(), 4U) << i;
    EXPECT_EQ(volume(s), 1.0) << i;
  }
  EXPECT_EQ(volume(read_surface(file("even.vtp", vtp({.packed = true, .block = 48})))), 1.0);  // no shorter last block
}

TEST(Surfaces, DamagedVtpIsRefused) {
  const auto fault = [](const std::string& text) {
    try {
      read_surface(file("damaged.vtp", text));
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const auto with = [](std::string text, const std::string& old, const std::string& now) {
    return text.replace(text.find(old), old.size(), now);
  };
  const std::string own = kVtpOfVtk, raw = vtp({.appended = true, .raw = true, .packed = true});
  const std::pair<std::string, const char*> cases[] = {
      {with(own, "AQAAAACAAAAwAAAAFAAAAA==eF5j", "AQAAAACAAAAwAAAAFAAAAA==eF5k"),
       ":6: found bytes that zlib cannot unpack"},
      {with(own, "AQAAAACAAAAwAAAAFAAAAA==", "AQAAAACAAAAwAAAA/////w=="), ":6: found a block longer than the file"},
      {with(own, "AQAAAACAAAAwAAAAFAAAAA==", "AQAAAACAAAD/////FAAAAA=="), ":6: found bytes that zlib cannot unpack"},
      {with(own, "AQAAAACAAAAwAAAAFAAAAA==", "////////////////////////"), ":6: found 4294967295 blocks"},
      {with(own, "AQAAAACAAAAwAAAAFAAAAA==", "AQAA!ACAAAAwAAAAFAAAAA=="), ":6: found text that is no base64"},
      {with(own, "AQAAAACAAAAwAAAAFAAAAA==eF5jYEAGDfYMqMABjesAAB5PAYA=", "AQ"), ":6: found the end of its bytes"},
      {with(own, "vtkZLibDataCompressor", "vtkLZ4DataCompressor"),
       ":2: found the compressor \"vtkLZ4DataCompressor\", expected vtkZLibDataCompressor or none: save the surface as "
       "STL"},
      {with(own, "Float32", "Int8"), ":6: found the type \"Int8\", expected Float32 or Float64"},
      {with(own, "Int64\" Name=\"offsets", "Int16\" Name=\"offsets"), "found the type \"Int16\", expected Int32"},
      {with(own, "format=\"binary\"", "format=\"bytes\""),
       ":6: found format=\"bytes\", expected ascii, binary or appended"},
      {with(raw, "offset=\"0\"", "offset=\"99999\""), "found an offset outside the appended data"},
      {with(raw, "offset=\"0\"", ""), "found an offset outside the appended data"},
      {raw.substr(0, raw.find("   _")), "found appended data without \"_\""},
      {raw.substr(0, raw.find("\n</AppendedData>") - 5),
       "found blocks longer than the file, expected less: it is cut off"},
      {with(own, "Float32", "Float64"), "found a corner at point 2"},
  };
  for (const auto& [text, expected] : cases)
    EXPECT_NE(fault(text).find(expected), std::string::npos) << expected << "\n" << fault(text);
  // whatever is cut off or changed: a surface or a fault, never anything else
  for (const VtpKind& kind :
       {VtpKind{.appended = true, .raw = true, .packed = true}, VtpKind{.packed = true}, VtpKind{}}) {
    const std::string whole = vtp(kind);
    for (std::size_t i = 0; i < whole.size(); i += 7) {
      fault(whole.substr(0, i));
      std::string changed = whole;
      changed[i] = static_cast<char>(changed[i] ^ 0x41);
      fault(changed);
    }
  }
}

TEST(Surfaces, LinesMayEndAsOnOldMacs) {
  for (const char* end : {"\r", "\r\n"}) {
    for (const auto& [name, text] :
         {std::pair<const char*, std::string>{"mac.stl", stl_text()}, {"mac.obj", kObj}, {"mac.ply", ply("ascii")}}) {
      std::string changed;
      for (const char c : text) changed += c == '\n' ? std::string(end) : std::string(1, c);
      EXPECT_EQ(volume(read_surface(file(name, changed))), 1.0) << name;
    }
    try {
      read_surface(file("line.obj", std::string("v 0 0 0") + end + "v 1 zero 0" + end));
      ADD_FAILURE();
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("line.obj:2:"), std::string::npos) << e.what();
    }
  }
}

TEST(Surfaces, OneShapeInEveryFormat) {
  const std::pair<const char*, std::string> files[] = {{"a.stl", stl_binary()},
                                                       {"b.stl", stl_text()},
                                                       {"c.obj", kObj},
                                                       {"d.ply", ply("ascii")},
                                                       {"e.ply", ply("binary_little_endian")},
                                                       {"f.ply", ply("binary_big_endian")},
                                                       {"g.vtk", vtk(false, false)},
                                                       {"h.vtk", vtk(true, false)},
                                                       {"i.vtk", vtk(false, true)},
                                                       {"j.vtk", vtk(true, true)},
                                                       {"k.vtp", kVtp}};
  for (const auto& [name, text] : files) {
    const TriangleSurface s = read_surface(file(name, text));
    ASSERT_EQ(s.triangles.size(), 4U) << name;
    EXPECT_EQ(volume(s), 1.0) << name;  // whole numbers: exact
  }
}

TEST(Surfaces, PolygonsAreCutIntoTriangles) {
  const TriangleSurface s = read_surface(file("square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"));
  ASSERT_EQ(s.triangles.size(), 2U);
  EXPECT_EQ(s.triangles[1], (std::array<int, 3>{0, 2, 3}));
}

TEST(Surfaces, WhatIsNoSurfaceIsRefusedWithItsPlace) {
  const std::string cut = stl_binary().substr(0, 200);
  const std::tuple<const char*, std::string, const char*> cases[] = {
      {"empty.stl", "", ": found an empty file"},
      {"text.stl", "Dear colleague,\nplease find attached\n", ": found no surface that is known, expected STL, OBJ"},
      {"cut.stl", cut, ": found 200 bytes, expected 284 for the 4 triangles"},
      {"cut_text.stl", stl_text().substr(0, 150), "found the end of the file"},
      {"letter.obj", "v 0 0 0\nv 1 zero 0\n", ":2: found another line, expected \"v x y z\""},
      {"far.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
       "found a corner at point 8 (counted from 0), expected one of the 3 points"},
      {"none.obj", "v 0 0 0\n", ": found no triangle"},
      {"nan.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\nnan\n",
       ":6: found \"nan\", expected a number"},
      {"many.ply", "ply\nformat ascii 1.0\nelement vertex 999999999\nproperty float x\nend_header\n1\n",
       "found a count of 999999999 elements"},
      {"type.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n1\n",
       ":4: found the type \"quad\", expected one of PLY's"},
      {"format.ply", "ply\nformat binary 1.0\n",
       ":2: found the format \"binary\", expected ascii, binary_little_endian"},
      {"property.ply", "ply\nformat ascii 1.0\nproperty float x\n",
       ":3: found a property, expected an element before it"},
      {"head.ply", "ply\nformat ascii 1.0\n", "found the end of the file, expected \"end_header\""},
      {"half.ply",
       "ply\nformat ascii 1.0\nelement face 1\nproperty list float int vertex_indices\nend_header\n2.5 0 1 2\n",
       ":6: found 2.5, expected a whole number"},
      {"two.ply", "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n2 0 1\n",
       ":6: found a polygon of 2 corners, expected three or more"},
      {"corner.obj", "v 0 0 0\nf a b c\n", ":2: found another line, expected \"f 1 2 3\" with numbers of points"},
      {"words.vtk", "# vtk DataFile Version 3.0\nx\nTEXT\n", ":3: found \"TEXT\", expected ASCII or BINARY"},
      {"long.vtk", "# vtk DataFile Version 3.0\nx\n\x1b" + std::string(100, 'T'),
       ":3: found \"\\x1bTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTTT...TTTTTTTTTTTTTTTTTTTT\", "
       "expected ASCII or BINARY"},
      {"type.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 1 half\n",
       ":5: found the type \"half\", expected float, double, int or vtktypeint64"},
      {"count.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS three float\n",
       ":5: found \"three\", expected a whole number (the number of points)"},
      {"strips.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nTRIANGLE_STRIPS 1 4\n",
       ":5: found \"TRIANGLE_STRIPS\", expected POINTS and POLYGONS"},
      {"offsets.vtk",
       "# vtk DataFile Version 5.1\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOLYGONS 2 "
       "3\nOFFSETS "
       "vtktypeint64\n0 9\nCONNECTIVITY vtktypeint64\n0 1 2\n",
       "found the offset 9, expected offsets that grow to 3"},
      {"connectivity.vtk",
       "# vtk DataFile Version 5.1\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOLYGONS 2 "
       "3\nOFFSETS "
       "vtktypeint64\n0 3\nCORNERS vtktypeint64\n0 1 2\n",
       "found another word, expected \"CONNECTIVITY\""},
      {"broken.vtp", "<VTKFile><PolyData>", "found no XML, expected a VTP file"},
      {"other.vtp", "<VTKFile><ImageData/></VTKFile>", ": found XML without <VTKFile> and <PolyData>"},
      {"binary.vtp", std::string(kVtp).replace(std::string(kVtp).find("ascii"), 5, "binary"),
       ":3: found more bytes named than there are, expected fewer"},
      {"none.vtp", std::string(kVtp).replace(std::string(kVtp).find("offsets"), 7, "ends"),
       ":4: found no <DataArray> of offsets, expected one"},
      {"offsets.vtp", std::string(kVtp).replace(std::string(kVtp).find("3 6 9"), 5, "3 2 9"),
       "found the offset 2, expected offsets that grow to 12"},
      {"far.stl",
       "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1e16 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
       "endsolid\n",
       ": found a coordinate of point 2 that is no number of use"},
      {"grid.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\n", ":4: found another data set"},
      {"bytes.vtp", "<VTKFile><PolyData/><AppendedData/></VTKFile>", ": found appended data without \"_\" before them"},
  };
  for (const auto& [name, text, expected] : cases) {
    const std::string path = file(name, text);
    try {
      read_surface(path);
      ADD_FAILURE() << name << " was read";
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(expected), std::string::npos) << name << ": " << e.what();
      EXPECT_EQ(std::string(e.what()).rfind(path, 0), 0U) << e.what();
    }
  }
  EXPECT_THROW(read_surface("no such file.stl"), InputError);
}

/// A coordinate of infinity as bytes.
TEST(Surfaces, BytesThatAreNoNumberAreRefused) {
  std::string text = stl_binary();
  text.replace(96, 4, bytes(std::numeric_limits<float>::infinity(), false));
  EXPECT_THROW(read_surface(file("infinite.stl", text)), InputError);
}

}  // namespace dea::surfaces_test
