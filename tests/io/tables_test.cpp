// Tables of loads and motion from files: columns by name, units, OpenSim's headers, and what is refused.
#include <fmt/format.h>
#include "io/tables/read_tables.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <optional>

#include "io/feb/read_feb.h"
#include "io/settings/settings_xml.h"
#include "io/tables/table.h"
#include "src/base/error.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"
#include "src/base/rotations.h"
#include "src/model/settings_table.h"
#include "src/run/analysis.h"
#include "src/run/recognise.h"
#include "src/run/states.h"

#include "tests/io/text_file.h"

namespace dea::tables_test {

using test::file;

Settings loads_of(const std::string& path, const std::string& units = "", const std::string& model_units = "") {
  JointModel model;
  model.units = model_units;
  Settings settings;
  settings.loads.file = path;
  settings.loads.body = "femur";
  settings.loads.units = units;
  read_tables(model, settings);
  return settings;
}

std::string refusal(const std::string& path) {
  try {
    loads_of(path);
  } catch (const InputError& e) {
    return std::string(e.what()).substr(path.size());
  }
  return "";
}

TEST(Tables, CsvInTheModelsUnits) {
  for (const char* text : {"time,fx,fy,fz\n0,1,2,3\n0.5,4,5,6\n",
                           "\xef\xbb\xbf"
                           "Time [s];Fx [N];Fy;Fz\r\n0;1;2;3\r\n0.5;4;5;6\r\n",
                           "# gait\n\ntime\tForce_X\tforce_y\tforce_z\n0\t1\t2\t3\n0.5\t4\t5\t6"}) {
    const LoadTable loads = loads_of(file("loads.csv", text)).loads;
    ASSERT_EQ(loads.time, (std::vector<double>{0, 0.5})) << text;
    EXPECT_EQ(loads.load[1].head<3>(), Eigen::Vector3d(4, 5, 6)) << text;
    EXPECT_EQ(loads.load[1].tail<3>(), Eigen::Vector3d::Zero()) << text;
  }
}

TEST(Tables, ATableOfOneRowIsToldAsOne) {
  const std::string one = file("one.csv", "time,fx,fy,fz\n1,1,2,3\n"),
                    two = file("two.csv", "fx,fy,fz\n1,2,3\n4,5,6\n");
  EXPECT_NE(loads_of(one).loads.words.find(": 1 row, time 1, columns fx, fy, fz"), std::string::npos);
  EXPECT_NE(loads_of(two).loads.words.find(": 2 rows, numbered 1 to 2, columns"), std::string::npos);
}

TEST(Tables, InMemoryAsFromAFile) {
  const std::string path = file("memory.csv", "time,fx,fy,fz\n0,1,2,3\n0.5,4,5,6\n");
  Settings settings;
  settings.loads.file = "table of loads";  // no such file
  settings.loads.body = "femur";
  read_tables(
      {}, settings,
      {{"table of loads", make_table("table of loads", {"time", " fx", "fy", "fz"}, {{0, 1, 2, 3}, {0.5, 4, 5, 6}})}});
  const LoadTable expected = loads_of(path).loads;
  EXPECT_EQ(settings.loads.time, expected.time);
  EXPECT_EQ(settings.loads.load, expected.load);
  const auto refused = [](const std::vector<std::string>& names, const std::vector<std::vector<double>>& rows) {
    try {
      make_table("table", names, rows);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused({"fx", "FX"}, {{1, 2}}), "table: found two columns named \"FX\", expected different names");
  EXPECT_EQ(refused({"fx"}, {{1}, {std::nan("")}}),
            "table:2: column \"fx\": found nan, expected a number of at most 1e30");
  EXPECT_EQ(refused({"fx"}, {{1, 2}}), "table:1: found 2 values, expected 1: one for each name");
  EXPECT_EQ(refused({"fx"}, {}), "table: found no row, expected at least one below the names of the columns");
}

// 2 N and 3 N m in a model of mm and N: 2 and 3000; in SI: 2 and 3.
TEST(Tables, OpenSimIsInNewtonsAndMetres) {
  const std::string path = file("gait.sto",
                                "JointReaction\nversion=1\nnRows=1\nnColumns=7\ninDegrees=no\nendheader\n"
                                "time\thip_fx\thip_fy\thip_fz\thip_mx\thip_my\thip_mz\n0\t0\t2\t0\t3\t0\t0\n");
  EXPECT_NEAR(loads_of(path, "", "mm-N-s").loads.load[0][1], 2, 1e-12);
  EXPECT_NEAR(loads_of(path, "", "mm-N-s").loads.load[0][3], 3000, 1e-9);
  EXPECT_NEAR(loads_of(path, "", "SI").loads.load[0][3], 3, 1e-12);
  EXPECT_NEAR(loads_of(path, "N-m").loads.load[0][3], 3000, 1e-9);  // nobody names the model's: mm and N, and said
  EXPECT_NE(loads_of(path, "N-m").loads.words.find("taken as in mm-N-s"), std::string::npos);
  EXPECT_NE(refusal(path).find("the model names no units"), std::string::npos);
}

// In metres moments in N m would come out a thousand times too large.
TEST(Tables, AModelTooSmallForMillimetresThatNamesNoUnitsIsRefused) {
  const std::string plain = file("plain.csv", "fx,fy,fz,mx,my,mz\n0,0,2,3,0,0\n"),
                    named = file("named.csv", "fx,fy,fz,mx [Nmm],my [Nmm],mz [Nmm]\n0,0,2,3,0,0\n"),
                    forces = file("forces.csv", "fx,fy,fz\n0,0,2\n"), motion = file("moves.csv", "tx,ty,tz\n0,0,2\n");
  const auto found = [&](double size, const std::string& loads, const std::string& units, const char* model_units,
                         const std::string& moves = "") {
    JointModel model;
    model.units = model_units;
    model.nodes = {Vector3d::Zero(), Vector3d(size, 0, 0)};
    Settings settings;
    settings.loads.file = loads;
    settings.motion.file = moves;
    (loads.empty() ? settings.motion.body : settings.loads.body) = "femur";
    (loads.empty() ? settings.motion.units : settings.loads.units) = units;
    try {
      read_tables(model, settings);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(found(0.03, plain, "N-m", "").find("it is too small for that, 0.03 across"), std::string::npos);
  EXPECT_NE(found(0.03, named, "", "").find("too small for that"), std::string::npos);
  EXPECT_NE(found(0.03, "", "deg-mm", "", motion).find("too small for that"), std::string::npos);
  EXPECT_EQ(found(30, plain, "N-m", ""), "");
  EXPECT_EQ(found(0.03, plain, "", ""), "");  // as they are
  EXPECT_EQ(found(0.03, plain, "N-m", "SI"), "");
  EXPECT_EQ(found(0.03, forces, "N-m", ""), "");  // N either way
  EXPECT_EQ(found(0.03, "", "", "", motion), "");
  JointModel model;
  model.nodes = {Vector3d::Zero(), Vector3d(0.03, 0, 0)};
  Settings thickness;
  thickness.thickness_from["layer"].file = file("thick.csv", "node,thickness [mm]\n1,2\n");
  EXPECT_THROW(read_tables(model, thickness), InputError);
  model.nodes[1] *= 1000;
  model.node_ids = {1, 2};
  EXPECT_NO_THROW(read_tables(model, thickness));
}

TEST(Tables, PercentOfBodyWeight) {
  Settings settings;
  settings.loads.file = file("bw.csv", "cycle,fx,fy,fz\n0,100,0,250\n");
  settings.loads.body = "femur";
  settings.loads.body_weight = 800;
  read_tables({}, settings);
  EXPECT_EQ(settings.loads.load[0].head<3>(), Eigen::Vector3d(800, 0, 2000));
}

TEST(Tables, MotionByAnglesAndByVectors) {
  Settings settings;
  settings.motion.file = file("pose.csv", "tx,ty,tz,rx,ry,rz\n1,2,3,0,0,90\n1,2,3,90,0,90\n");
  settings.motion.body = "femur";
  settings.motion.rotation = "xyz";
  settings.motion.units = "deg-cm";
  JointModel model;
  model.units = "mm-N-s";
  read_tables(model, settings);
  EXPECT_LT((settings.motion.motion[0].head<3>() - Eigen::Vector3d(10, 20, 30)).norm(), 1e-12);
  EXPECT_LT((settings.motion.motion[0].tail<3>() - Eigen::Vector3d(0, 0, kPi / 2)).norm(), 1e-12);
  // 90 degrees about x, then about the z that has turned: 120 degrees about (1, -1, 1)
  const Eigen::Vector3d w = settings.motion.motion[1].tail<3>();
  EXPECT_LT((w - 2 * kPi / 3 * Eigen::Vector3d(1, -1, 1).normalized()).norm(), 1e-12);
  EXPECT_EQ(settings.motion.time, (std::vector<double>{1, 2}));  // numbered: no column of times
}

// Columns are angles about x, y, z; the sequence says in which order they are taken.
TEST(Tables, AnglesAreAboutTheAxesTheyAreNamedFor) {
  JointModel model;
  model.units = "mm-N-s";
  Settings settings;
  settings.motion.file = file("pose.csv", "tx,ty,tz,rx,ry,rz\n0,0,0,10,0,0\n0,0,0,90,0,90\n");
  settings.motion.body = "femur";
  settings.motion.rotation = "zxy";
  settings.motion.units = "deg-mm";
  read_tables(model, settings);
  EXPECT_LT((settings.motion.motion[0].tail<3>() - Eigen::Vector3d(kPi / 18, 0, 0)).norm(), 1e-12);
  // 90 degrees about z, then about the x that has turned: 120 degrees about (1, 1, 1)
  const Eigen::Vector3d w = settings.motion.motion[1].tail<3>();
  EXPECT_LT((w - 2 * kPi / 3 * Eigen::Vector3d(1, 1, 1).normalized()).norm(), 1e-12);
  for (const char* word : {"zxz", "xx", "abc", "zxyz"})
    EXPECT_THROW(find_setting_option("motion-rotation")->set(settings, "", word), BadValue) << word;
}

// ---- rows of 4x4 matrices ------------------------------------------------------------------------------------------

Eigen::Isometry3d pose(double degrees, const Eigen::Vector3d& axis, const Eigen::Vector3d& place) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(degrees * kPi / 180, axis.normalized()).toRotationMatrix();
  T.translation() = place;
  return T;
}

using Poses = std::vector<Eigen::Isometry3d>;

/// As OpenSim-JAM writes them: a line per time, the matrices of all bodies in it row by row; times 1, 2, 3, ...
std::string jam_text(const std::vector<std::pair<std::string, Poses>>& bodies, int said_rows) {
  std::string text =
      fmt::format("nColumns={}\nnRows={}\nDataType=double\nversion=3\nOpenSimVersion=4.3\nendheader\ntime",
                  1 + 16 * bodies.size(), said_rows);
  for (const auto& [name, poses] : bodies)
    for (int k = 0; k < 16; ++k) text += fmt::format("\t{}_T{}{}", name, k / 4 + 1, k % 4 + 1);
  for (std::size_t r = 0; r < bodies[0].second.size(); ++r) {
    text += fmt::format("\n{}", r + 1);
    for (const auto& [name, poses] : bodies)
      for (int k = 0; k < 16; ++k) text += fmt::format("\t{:.16g}", poses[r].matrix()(k / 4, k % 4));
  }
  return text + "\n";
}

/// In a model of mm.
MotionTable matrices_of(const std::string& path, const std::string& columns, const std::string& start = "",
                        const std::string& units = "", const std::string& rotation = "") {
  JointModel model;
  model.units = "mm-N-s";
  Settings settings;
  settings.motion.file = path;
  settings.motion.body = "femur";
  settings.motion.columns = columns;
  settings.motion.start = start;
  settings.motion.units = units;
  settings.motion.rotation = rotation;
  read_tables(model, settings);
  return settings.motion;
}

void expect_move(const MotionTable& motion, std::size_t row, const Eigen::Isometry3d& expected) {
  const Eigen::Matrix<double, 6, 1>& values = motion.motion.at(row);
  EXPECT_LT((values.head<3>() - expected.translation()).norm(), 1e-9) << row;
  EXPECT_LT((rotation(values.tail<3>()) - expected.linear()).norm(), 1e-12) << row;
}

const Eigen::Vector3d kX(1, 0, 0), kZ(0, 0, 1);

// By 30 and by 170 degrees about z, in metres: the model's mm.
TEST(Matrices, OfABodyAreWhereItIs) {
  const Poses femur = {pose(30, kZ, {0.1, 0.2, -0.3}), pose(170, kZ, {0, 0, 0.001})};
  const std::string path = file("jam.sto", jam_text({{"femur_r", femur}, {"tibia_r", femur}}, 2));
  const MotionTable motion = matrices_of(path, "femur_r_T");
  EXPECT_EQ(motion.time, (std::vector<double>{1, 2}));
  EXPECT_TRUE(motion.turns && motion.about_origin);
  EXPECT_LT((motion.motion[0].tail<3>() - kPi / 6 * kZ).norm(), 1e-12);
  expect_move(motion, 0, pose(30, kZ, {100, 200, -300}));
  expect_move(motion, 1, pose(170, kZ, {0, 0, 1}));
  EXPECT_EQ(motion.words.substr(path.size()),
            ": 2 rows, time 1 to 2, matrices femur_r_T in m, the model in mm-N-s (the model has the body in its own "
            "frame)");
}

// The tibia turned by 90 degrees about z and set off; the femur on it turned by 20, then 50 about the tibia's x and 2
// mm along its z: that is what the tibia sees, wherever it is itself.
TEST(Matrices, OfABodyRelativeToAnotherOne) {
  const Poses seen = {pose(20, kX, {0, 0, 0.002}), pose(50, kX, {0, 0.001, 0.002})},
              tibia = {pose(90, kZ, {1, 0, 0}), pose(-35, {1, 2, 3}, {0.4, 0.5, 0.6})},
              femur = {tibia[0] * seen[0], tibia[1] * seen[1]};
  const std::string path = file("jam.sto", jam_text({{"tibia", tibia}, {"femur", femur}}, 2));
  const auto millimetres = [](Eigen::Isometry3d T) {
    T.translation() *= 1000;
    return T;
  };
  const MotionTable own = matrices_of(path, "femur_T,tibia_T");
  EXPECT_NE(own.words.find("matrices femur_T relative to tibia_T in m"), std::string::npos) << own.words;
  for (std::size_t r = 0; r < 2; ++r) expect_move(own, r, millimetres(seen[r]));

  // the model as row 1 has it, in the tibia's axes: from 20 to 50 degrees about x, through the point of z = 2
  const MotionTable row = matrices_of(path, "femur_T,tibia_T", "1");
  expect_move(row, 0, Eigen::Isometry3d::Identity());
  expect_move(row, 1, millimetres(seen[1] * seen[0].inverse()));
  EXPECT_LT((row.motion[1].tail<3>() - kPi / 6 * kX).norm(), 1e-12);

  // as row 1 has both in the table's axes: there the tibia's x is y
  const MotionTable ground = matrices_of(path, "femur_T,tibia_T", "1,ground");
  expect_move(ground, 0, Eigen::Isometry3d::Identity());
  EXPECT_LT((ground.motion[1].tail<3>() - kPi / 6 * Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
  expect_move(ground, 1, millimetres(tibia[0] * seen[1] * seen[0].inverse() * tibia[0].inverse()));

  // of the femur alone, as a row has it
  expect_move(matrices_of(path, "femur_T", "2"), 0, millimetres(femur[0] * femur[1].inverse()));
  EXPECT_NE(row.words.find("(the model has the body as the row at time 1, in the other body's frame)"),
            std::string::npos);
  EXPECT_NE(ground.words.find("(the model has both bodies as the row at time 1, in the table's axes)"),
            std::string::npos);
}

// What nobody says the unit of is questioned below a hundredth of the joint's size: 0.5 mm of one of 60 mm. Of two
// matrices that of one relative to the other counts: (0.03, 0.04, 0) of bodies that lie a metre away.
TEST(Matrices, ThatMayBeInMetresAreQuestioned) {
  const auto table = [](const char* name, const std::vector<std::pair<std::string, Poses>>& bodies) {
    const std::string text = jam_text(bodies, 1);
    return file(name, text.substr(text.find("time")));  // as CSV: no units of OpenSim's
  };
  const Eigen::Isometry3d tibia = pose(40, kX, {0.2, 0.9, 0.1});
  const std::string alone = table("alone.csv", {{"femur", {pose(10, kZ, {0, 0.3, 0.4})}}}),
                    both = table("both.csv", {{"femur", {tibia * pose(5, kZ, {0.03, 0.04, 0})}}, {"tibia", {tibia}}}),
                    still = table("still.csv", {{"femur", {pose(10, kZ, {0, 0, 0})}}});
  EXPECT_NEAR(matrices_of(alone, "femur_T").farthest, 0.5, 1e-12);
  EXPECT_NEAR(matrices_of(both, "femur_T,tibia_T").farthest, 0.05, 1e-12);
  EXPECT_EQ(matrices_of(alone, "femur_T", "", "mm").farthest, 0);
  EXPECT_EQ(matrices_of(still, "femur_T").farthest, 0);
  EXPECT_EQ(matrices_of(file("o.sto", jam_text({{"femur", {pose(10, kZ, {0, 0, 1e-4})}}}, 1)), "femur_T").farthest, 0);
  const MotionTable motion = matrices_of(alone, "femur_T");
  EXPECT_EQ(matrices_in_doubt(motion, 60), "translations of at most 0.5 mm beside surfaces that are 60 mm large");
  EXPECT_EQ(matrices_in_doubt(motion, 49), "");
  EXPECT_EQ(motion.doubt, "");  // of a model without nodes

  JointModel model;
  model.units = "SI";  // in m: these are its own
  model.nodes = {Vector3d::Zero(), Vector3d(60, 0, 0)};
  Settings settings;
  settings.motion.file = alone;
  settings.motion.body = "femur";
  read_tables(model, settings);
  EXPECT_EQ(settings.motion.doubt, "");
  model.units = "mm-N-s";
  read_tables(model, settings);
  EXPECT_EQ(settings.motion.doubt, "translations of at most 0.5 mm beside surfaces that are 60 mm large");
}

// 3 rows against nRows 2, as in JAM's files; fewer than it counts: cut off.
TEST(Matrices, RowsBeyondThoseThatAHeaderCountsAreReadAndTold) {
  const Poses femur(3, pose(10, kZ, {0, 0, 0}));
  const MotionTable motion = matrices_of(file("jam.sto", jam_text({{"femur", femur}}, 2)), "");  // the only matrix
  EXPECT_EQ(motion.time.size(), 3);
  EXPECT_NE(motion.words.find(": 3 rows (its header counts 2: all are read), time 1 to 3"), std::string::npos);
  EXPECT_EQ(matrices_of(file("jam.sto", jam_text({{"femur", femur}}, 3)), "").words.find("header"), std::string::npos);
  EXPECT_THROW(matrices_of(file("jam.sto", jam_text({{"femur", femur}}, 4)), ""), InputError);
}

// Columns in any order, other ones between, capitals or not, and a unit in the name.
TEST(Matrices, ColumnsStandInAnyOrder) {
  const Eigen::Isometry3d T = pose(40, {1, -2, 0.5}, {7, 8, 9});
  std::string names = "force", row = "5";
  for (int k = 15; k >= 0; --k) {
    names += fmt::format(",FEMUR_t{}{}{}", k / 4 + 1, k % 4 + 1, k == 3 ? " [cm]" : "");
    row += fmt::format(",{:.16g}", T.matrix()(k / 4, k % 4));
  }
  const std::string path = file("t.csv", names + "\n" + row + "\n");
  for (const char* units : {"cm", "deg-cm"})
    expect_move(matrices_of(path, "femur_T", "", units), 0, pose(40, {1, -2, 0.5}, {70, 80, 90}));
  EXPECT_THROW(matrices_of(path, "femur_T", "", "mm"), InputError);  // its name says cm
}

TEST(Matrices, WhatIsNoPoseIsRefusedInOneLine) {
  const auto refused = [](const std::function<void(Eigen::Matrix4d&)>& damage, const std::string& columns = "",
                          const std::string& start = "", const std::string& units = "",
                          const std::string& rotation = "", const char* header = "femur") {
    Poses poses(2, pose(30, kZ, {0.1, 0, 0}));
    damage(poses[1].matrix());
    const std::string path = file("jam.sto", jam_text({{header, poses}}, 2));
    try {
      matrices_of(path, columns, start, units, rotation);
    } catch (const std::runtime_error& e) {
      const std::string text = e.what();
      return text.starts_with(path)
                 ? text.substr(path.size())
                 : text.substr(0, text.find(path)) + "JAM" + text.substr(text.find(path) + path.size());
    }
    return std::string();
  };
  const auto nothing = [](Eigen::Matrix4d&) {};
  EXPECT_EQ(refused(nothing), "");
  EXPECT_EQ(refused([](Eigen::Matrix4d& m) { m(0, 0) += 4e-4; }), "");  // four digits
  EXPECT_EQ(refused([](Eigen::Matrix4d& m) { m.col(2) *= 1.01; }),
            ":9: columns femur_T13, femur_T23, femur_T33: found a length of 1.01, expected 1, as in every rotation");
  EXPECT_EQ(
      refused([](Eigen::Matrix4d& m) { m.col(1) = m.col(0); }),
      ":9: columns femur_T11, femur_T21, femur_T31 and columns femur_T12, femur_T22, femur_T32: found axes with a "
      "cosine of 1, expected 0: axes of a rotation stand at right angles");
  EXPECT_EQ(
      refused([](Eigen::Matrix4d& m) { m.col(2) *= -1; }),
      ":9: columns femur_T11 to femur_T33: found a mirror image, expected a rotation: its determinant is 1, not -1");
  EXPECT_EQ(refused([](Eigen::Matrix4d& m) { m.transposeInPlace(); }),
            ":9: column \"femur_T41\": found 0.1, expected 0: the last row of a matrix is 0 0 0 1, and its last column "
            "has the place");
  EXPECT_EQ(
      refused([](Eigen::Matrix4d& m) { m(3, 3) = 0; }),
      ":9: column \"femur_T44\": found 0, expected 1: the last row of a matrix is 0 0 0 1, and its last column has "
      "the place");
  EXPECT_EQ(
      refused(nothing, "femur"),
      "motion-columns = femur: JAM has no columns femur11 to femur44 (did you mean \"femur_T\"?); its 4x4 matrices "
      "are \"femur_T\"");
  EXPECT_EQ(refused(nothing, "femur_T,tibia_T").find("motion-columns = femur_T,tibia_T: JAM has no columns tibia_T11"),
            0);
  EXPECT_EQ(refused(nothing, "femur_T", "3"),
            "motion-start = 3: JAM has no row at this time; its 2 rows are at times 1 "
            "to 2");
  EXPECT_NE(refused(nothing, "femur_T", "", "inch").find("this is no unit of a matrix that is known"),
            std::string::npos);
  EXPECT_NE(refused(nothing, "femur_T", "", "", "xyz").find("which say how the body turns; leave it out"),
            std::string::npos);

  // a column that is missing, two bodies of which none is named
  const Poses one = {pose(1, kX, {0, 0, 0})};
  std::string text = jam_text({{"femur", one}, {"tibia", one}}, 1);
  text.replace(text.find("femur_T24"), 9, "femur_X24");
  const auto fault = [&](const std::string& columns) {
    try {
      matrices_of(file("jam.sto", text), columns);
    } catch (const std::runtime_error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(fault("femur_T").find("has no column femur_T24; its 4x4 matrices are \"tibia_T\""), std::string::npos)
      << fault("femur_T");
  text = jam_text({{"femur", one}, {"tibia", one}}, 1);
  EXPECT_NE(fault("").find("found 2 matrices in each row, \"femur_T\", \"tibia_T\"; name the body's with"),
            std::string::npos)
      << fault("");
  for (const char* word : {"own", "1,femur", "1,2", "", "ground"}) {
    Settings settings;
    EXPECT_THROW(find_setting_option("motion-start")->set(settings, "", word), BadValue) << word;
  }
}

// The same motion by angles about the origin and by matrices presses the same.
TEST(Matrices, PressAsTheSameMotionByAngles) {
  const Eigen::Isometry3d T = Eigen::Translation3d(0.1, -0.05, -0.3) * Eigen::AngleAxisd(0.02, kZ) *
                              Eigen::AngleAxisd(0.01, kX) * Eigen::AngleAxisd(-0.015, Eigen::Vector3d(0, 1, 0));
  const auto solved = [&](MotionTable motion) {
    JointModel model = read_feb(DEA_SAMPLES_DIR "/sphere_on_flat/sphere_on_flat.feb");
    Settings settings;
    settings.motion = std::move(motion);
    settings.motion.body = "sphere";
    settings.law = Law::Linear;
    settings.skip_steps = true;
    settings.rotate_about["sphere"] = {TurnPoint::Kind::Point, Eigen::Vector3d::Zero()};
    read_tables(model, settings);
    AnalysisOptions options;
    options.times = row_states(model, settings, parse_states(""), "--states").times;
    return analyse(recognise(std::move(model), settings), options).states.back();
  };
  MotionTable angles, matrices;
  angles.file = file("a.csv", "tx,ty,tz,rx,ry,rz\n0.1,-0.05,-0.3,0.01,-0.015,0.02\n");
  angles.rotation = "zxy";
  angles.units = "rad-mm";
  std::string names, row;
  for (int k = 0; k < 16; ++k) {
    names += fmt::format("{}B_T{}{}", k > 0 ? "," : "", k / 4 + 1, k % 4 + 1);
    row += fmt::format("{}{:.17g}", k > 0 ? "," : "", T.matrix()(k / 4, k % 4));
  }
  matrices.file = file("m.csv", names + "\n" + row + "\n");
  const StateResult a = solved(angles), m = solved(matrices);
  const auto force = [](const StateResult& state) { return state.equilibrium.contact_on_target[0].head<3>(); };
  EXPECT_GT(force(a).norm(), 1.0);
  EXPECT_LT((force(a) - force(m)).norm(), 1e-9 * force(a).norm());  // rounding alone
  for (std::size_t b = 0; b < a.equilibrium.poses.size(); ++b) {
    EXPECT_LT((a.equilibrium.poses[b].center - m.equilibrium.poses[b].center).norm(), 1e-12);
    EXPECT_LT((a.equilibrium.poses[b].rotation - m.equilibrium.poses[b].rotation).norm(), 1e-12);
  }
}

TEST(Tables, DegreesMayBeWrittenWithSpaces) {
  for (const char* line : {"inDegrees=yes", "inDegrees = yes", "InDegrees =Yes"}) {
    Settings settings;
    settings.motion.file =
        file("p.mot", std::string(line) + "\nendheader\ntime\ttx\tty\ttz\trx\try\trz\n0\t0\t0\t0\t90\t0\t0\n");
    settings.motion.body = "femur";
    settings.motion.rotation = "xyz";
    JointModel model;
    model.units = "mm-N-s";
    read_tables(model, settings);
    EXPECT_NEAR(settings.motion.motion[0][3], kPi / 2, 1e-12) << line;
  }
}

TEST(Tables, SettingsOfATableWithoutItAreRefused) {
  const auto refused = [](const char* option, const char* value) {
    Settings settings;
    find_setting_option(option)->set(settings, "", value);
    EXPECT_THROW(read_tables({}, settings), UsageError) << option;
  };
  for (const char* option :
       {"load-body", "load-columns", "load-units", "load-frame", "motion-body", "motion-columns", "motion-units"})
    refused(option, "a");
  refused("load-frame", "1,0,0/0,1,0/0,0,1");
  refused("body-weight", "800");
  refused("motion-rotation", "xyz");
  refused("motion-start", "1");
}

TEST(Tables, MomentsInPercentOfBodyWeightSayTheirLength) {
  Settings settings;
  settings.loads.file = file("bw.csv", "cycle,fx,fy,fz,mx,my,mz\n0,100,0,250,1,0,0\n");
  settings.loads.body = "femur";
  settings.loads.body_weight = 800;
  read_tables({}, settings);
  EXPECT_EQ(settings.loads.load[0][3], 8.0);
  EXPECT_NE(settings.loads.words.find("moments times the model's length"), std::string::npos);
}

TEST(Tables, AWeightThatMayBeInKilogramsIsQuestioned) {
  const auto words = [](double weight, const char* units) {
    JointModel model;
    model.units = units;
    Settings settings;
    settings.loads.file = file("bw.csv", "cycle,fx,fy,fz\n0,100,0,250\n");
    settings.loads.body = "femur";
    settings.loads.body_weight = weight;
    read_tables(model, settings);
    EXPECT_EQ(settings.loads.load[0][2], 2.5 * weight);             // taken as it is all the same
    EXPECT_EQ(settings.loads.words.find("kg"), std::string::npos);  // goes into papers
    return settings.loads.doubt;
  };
  EXPECT_EQ(words(80, "mm-N-s"), "80 kg would be 784.8 N");
  EXPECT_EQ(words(80, ""), "80 kg would be 784.8 N");
  EXPECT_EQ(words(785, "mm-N-s"), "");
  EXPECT_EQ(words(80, "mm-kg-s"), "");  // forces in mN: not a weight in kg
}

// What a column's name says in brackets is what it is taken in, or it is refused.
TEST(Tables, UnitsInNamesOfColumnsMustBeThoseTaken) {
  const auto with = [](const std::string& names, const std::string& units, const std::string& model_units) {
    std::string row = "0";
    for (char c : names) row += c == ',' ? ",1" : "";
    try {
      loads_of(file("u.csv", "time," + names + "\n" + row + ",1\n"), units, model_units);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(with("fx [N],fy [N],fz [N]", "", "mm-N-s"), "");
  EXPECT_EQ(with("fx [N],fy [N],fz [N]", "", ""), "");  // the model's are taken for mm and N then
  EXPECT_NE(loads_of(file("u.csv", "fx [N],fy [N],fz [N]\n1,1,1\n"), "", "").loads.words.find("taken as in mm-N-s"),
            std::string::npos);
  EXPECT_EQ(loads_of(file("u.csv", "fx,fy,fz\n1,1,1\n"), "", "").loads.words.find("taken as in"), std::string::npos);
  EXPECT_NE(with("fx [N],fy [N],fz [kN]", "", "").find("column \"fz [kN]\" is taken in N,"), std::string::npos);
  EXPECT_NE(with("fx [N],fy [N],fz [N],mx [Nm],my [Nm],mz [Nm]", "", "").find("\"mx [Nm]\" is taken in N mm,"),
            std::string::npos);
  for (const char* unit : {"lbf", "N/kg", "xBW", "kgf"}) {
    SCOPED_TRACE(unit);
    EXPECT_NE(with(fmt::format("fx [{0}],fy [{0}],fz [{0}]", unit), "", "mm-N-s").find(" is taken in N, and its name"),
              std::string::npos);
  }
  EXPECT_EQ(with("fx [left],fy [left],fz [left]", "", "mm-N-s"), "");  // no unit
  EXPECT_EQ(with("fx,fy,fz,mx [mm N],my [mm N],mz [mm N]", "", "mm-N-s"), "");
  for (const char* moment : {"N\u00b7m", "N\u22c5m", "N*m", "N-m"})
    EXPECT_NE(with(fmt::format("fx,fy,fz,mx [{0}],my [{0}],mz [{0}]", moment), "", "mm-N-s"), "") << moment;
  EXPECT_NE(with("fx (hip) [kN],fy (hip) [kN],fz (hip) [kN]", "", "mm-N-s"), "");
  EXPECT_NE(with("fx,fy,fz,mx [Nm],my [Nm],mz [Nm]", "", "").find("taken as in mm-N-s: name its own with "),
            std::string::npos);
  EXPECT_EQ(with("fx [kN],fy [kN],fz [kN]", "kN-m", "mm-N-s"), "");
  EXPECT_EQ(with("fx (N),fy (N),fz (N),mx (N mm),my (N mm),mz (N mm)", "", "mm-N-s"), "");
  EXPECT_NE(with("fx [kN],fy [kN],fz [kN]", "", "mm-N-s").find("column \"fx [kN]\" is taken in N,"), std::string::npos);
  EXPECT_NE(with("fx [%BW],fy [%BW],fz [%BW]", "", "mm-N-s"), "");
  EXPECT_NE(with("fx [%BW],fy [%BW],fz [%BW]", "", ""), "");
  EXPECT_NE(with("fx [N],fy [N],fz [N],mx [N m],my [N m],mz [N m]", "", "mm-N-s"), "");
  EXPECT_EQ(with("fx [N],fy [N],fz [N],mx [N m],my [N m],mz [N m]", "N-m", "mm-N-s"), "");

  Settings settings;
  settings.motion.file = file("m.csv", "tx [mm],ty [mm],tz [mm],rx [rad],ry [rad],rz [rad]\n0,0,0,0,0,0.1\n");
  settings.motion.body = "femur";
  settings.motion.rotation = "xyz";
  settings.motion.units = "deg-mm";
  EXPECT_THROW(read_tables({}, settings), InputError);
  settings.motion.units = "rad-mm";
  EXPECT_NO_THROW(read_tables({}, settings));
  settings.motion.file = file("m.csv", "tx [mm],ty [mm],tz [mm],rx_rad,ry_rad,rz_rad\n0,0,0,0,0,0.1\n");
  EXPECT_THROW(read_tables({}, settings), UsageError) << "a rotation is asked for, and not found";
  settings.motion.rotation.clear();
  settings.motion.units.clear();
  EXPECT_NO_THROW(read_tables({}, settings));
  settings.motion.file = file("m.csv", "tx [m],ty [m],tz [m]\n0,0,0\n");
  EXPECT_THROW(read_tables({}, settings), InputError);

  settings.motion.rotation = "xyz";
  const auto header = [&](const std::string& says, const std::string& units) {
    settings.motion.file = file("m.mot", says + "endheader\ntime\ttx\tty\ttz\trx\try\trz\n0\t0\t0\t0\t0\t0\t1\n");
    settings.motion.units = units;
    read_tables({}, settings);
  };
  EXPECT_THROW(header("inDegrees=yes\n", "rad-m"), UsageError);
  EXPECT_THROW(header("inDegrees=no\n", "deg-m"), UsageError);
  EXPECT_NO_THROW(header("inDegrees=yes\n", "deg-m"));
  EXPECT_NO_THROW(header("", "deg-m"));
}

/// Why these tables of a model in mm and N are refused, as the command line says it; empty: they are not.
std::string fault_in_words(Settings& settings) {
  JointModel model;
  model.units = "mm-N-s";
  try {
    read_tables(model, settings);
  } catch (const InputError& e) {
    return line(e.fault, command_line_wording());
  }
  return "";
}

// What a file is counted in says what to do about it.
TEST(Tables, ColumnsPerWeightOrMassSayWhatToDo) {
  const auto remedy = [](const std::string& names, std::optional<double> weight = {}) {
    Settings settings;
    std::string row = "0";
    for (char c : names) row += c == ',' ? ",1" : "";
    settings.loads.file = file("per.csv", "time," + names + "\n" + row + ",1\n");
    settings.loads.body = "femur";
    settings.loads.body_weight = weight;
    const std::string text = fault_in_words(settings);
    return text.empty() ? text : text.substr(text.find("otherwise; ") + 11);
  };
  const auto force = [](const char* unit) { return fmt::format("fx [{0}],fy [{0}],fz [{0}]", unit); };
  const auto moment = [](const char* unit) { return fmt::format("fx,fy,fz,mx [{0}],my [{0}],mz [{0}]", unit); };
  const std::string hundredfold =
                        "multiply the column by 100, name it in %BW, and give the body weight with --body-weight N",
                    mass = "multiply the column by the body's mass in kg, and take the \"/kg\" out of its name";
  for (const char* unit : {"%BW", "% BW", "%"})
    EXPECT_EQ(remedy(force(unit)), "give the body weight with --body-weight N: the columns are percent of it then");
  EXPECT_EQ(remedy(moment("%BW m")), "give the body weight with --body-weight N: the columns are percent of it then");
  for (const char* unit : {"BW", "xBW", "x BW"}) {
    EXPECT_EQ(remedy(force(unit)), hundredfold);
    EXPECT_EQ(remedy(force(unit), 800.0), hundredfold);
  }
  EXPECT_EQ(remedy(force("N/kg")), mass);
  EXPECT_EQ(remedy(force("N/kg"), 800.0), mass + "; leave --body-weight out");
  EXPECT_EQ(remedy(moment("Nm/kg")), mass);
  EXPECT_EQ(
      remedy(moment("%BW*Ht")),
      "multiply the column by the body's height, name it as a moment in % of body weight times a length, and give "
      "the weight with --body-weight N");
  EXPECT_NE(remedy(force("kN")).find("--load-units FORCE-LENGTH"), std::string::npos);
  EXPECT_NE(remedy(force("N"), 800.0).find("percent of it: leave that out"), std::string::npos);
  EXPECT_EQ(remedy(force("%BW"), 800.0), "");
}

// The column of times is read, whatever its name.
TEST(Tables, TheColumnOfTimesIsNotToldAsUnread) {
  const auto words = [](const char* names, const char* rest = "0,1,2,3\n") {
    return loads_of(file("t.csv", fmt::format("{},fx,fy,fz\n", names) + rest)).loads.words;
  };
  for (const char* time : {"time", "t", "cycle [%]", "gait cycle", "percent"})
    EXPECT_EQ(words(time).find("not read"), std::string::npos) << time;
  EXPECT_NE(words("cycle [%],speed", "0,1,1,2,3\n").find("; no moments: speed is not read from it"), std::string::npos);
}

TEST(Tables, DegreesThatAreSaidToBeRadiansAreRefused) {
  const auto read = [](const std::string& rows, const std::string& units, const char* rotation,
                       const char* name = "turn.csv", const std::string& head = "") {
    Settings settings;
    settings.motion.file = file(name, head + "time\ttx\tty\ttz\trx\try\trz\n" + rows);
    settings.motion.body = "femur";
    settings.motion.rotation = rotation;
    settings.motion.units = units;
    const std::string text = fault_in_words(settings);
    return text.empty() ? text : text.substr(settings.motion.file.size());
  };
  const std::string rows = "0\t0\t0\t0\t0\t0\t0.5\n1\t0\t0\t0\t0\t-25\t0\n";
  for (const char* rotation : {"zxy", "vector"})
    EXPECT_EQ(
        read(rows, "rad-mm", rotation),
        ":3: column \"ry\": found -25 in radians, more than a whole turn; if these are degrees, say --motion-units "
        "deg-mm; else take whole turns out");
  EXPECT_EQ(read(rows, "deg-mm", "zxy"), "");
  EXPECT_EQ(read("0\t9\t9\t9\t0\t6.2832\t-6.2832\n", "rad-mm", "zxy"), "");  // translations are none
  EXPECT_EQ(
      read(rows, "", "zxy", "turn.mot", "inDegrees=no\nendheader\n"),
      ":5: column \"ry\": found -25 in radians, more than a whole turn; if these are degrees, correct the header to "
      "inDegrees=yes and say --motion-units deg-m");
}

TEST(Tables, OneLoadsColumnsAndWholeFiles) {
  const std::string names = "time,hip_fx,hip_fy,hip_fz,knee_mx,knee_my,knee_mz\n0,1,2,3,4,5,6\n";
  EXPECT_NE(refusal(file("a.csv", names)).find("the force is that of hip, the moment that of knee"), std::string::npos);
  EXPECT_NE(
      refusal(file("a.sto", "nRows=5\nendheader\ntime\tfx\tfy\tfz\n0\t1\t2\t3\n")).find("found 1 row, expected the 5"),
      std::string::npos);
  const Settings s = loads_of(file("p.csv", "time,fx,fy,fz,px,py,pz\n0,1,2,3,4,5,6\n"));
  EXPECT_NE(s.loads.words.find("where the force acts (px, py, pz) is not read from it"), std::string::npos);
  const std::string moments = "time,hip_fx,hip_fy,hip_fz,moment_hip_x,moment_hip_y,moment_hip_z\n0,1,2,3,4,5,6\n";
  EXPECT_NE(loads_of(file("q.csv", moments))
                .loads.words.find("no moments: moment_hip_x, moment_hip_y, moment_hip_z are not read from it"),
            std::string::npos);
  Settings moved;
  moved.motion.body = "femur";
  moved.motion.file = file("m.csv", "time,tx,ty,tz,rotation_hip_x,rotation_hip_y,rotation_hip_z\n0,1,2,3,4,5,6\n");
  read_tables({}, moved);
  EXPECT_NE(
      moved.motion.words.find("no rotations: rotation_hip_x, rotation_hip_y, rotation_hip_z are not read from it"),
      std::string::npos);
  Settings twice;
  twice.loads.file = file("a.csv", "time,fx,fy,fz\n0,1,2,3\n");
  twice.loads.body = "femur";
  twice.loads.columns = "fx,fx,fz";
  EXPECT_THROW(read_tables({}, twice), UsageError);
}

TEST(Tables, RefusedWithTheirLine) {
  EXPECT_EQ(refusal(file("a.csv", "time,fx,fy,fz\n0,1,2\n")),
            ":2: found 3 values, expected 4: one for each name in the line of names");
  EXPECT_EQ(refusal(file("a.csv", "time,fx,fy,fz\n0,1,2,much\n")),
            ":2: column \"fz\": found \"much\", expected a number with a decimal point, at most 1e30");
  EXPECT_EQ(refusal(file("a.csv", "time,fx,fy,fz\n0,1,2,nan\n")),
            ":2: column \"fz\": found \"nan\", expected a number with a decimal point, at most 1e30");
  EXPECT_EQ(refusal(file("a.csv", "time,fx,fy,fz\n1,1,2,3\n1,1,2,3\n")),
            ":3: found time 1 after 1, expected times that rise from row to row");
  EXPECT_EQ(refusal(file("a.csv", "0,1,2,3\n")), ":1: found numbers, expected the names of the columns");
  EXPECT_EQ(refusal(file("a.csv", "time,fx,fy,fz\n")),
            ":1: found no row, expected at least one below the names of the columns");
  EXPECT_EQ(refusal(file("a.csv", "")), ": found no line, expected the names of the columns and rows");
  EXPECT_EQ(refusal(file("a.csv", "time,fx,fx\n")), ":1: found two columns named \"fx\", expected different names");
  EXPECT_NE(
      refusal(file("a.csv", "time,a_fx,b_fx,fy,fz\n0,1,2,3,4\n")).find("found 2 columns that may be the force's x"),
      std::string::npos);
  EXPECT_NE(refusal(file("a.sto", "time\tfx\n0\t1\n")).find("found no line \"endheader\""), std::string::npos);
  EXPECT_EQ(refusal(file("a.csv", "time,,fy,fz\n0,1,2,3\n")),
            ":1: found a column without a name, expected a name for each");
  EXPECT_EQ(refusal("nowhere.csv"), ": found no readable file, expected a table");
}

/// What is wrong with a file of thickness per node, without its name; its values else.
std::string thickness_refusal(const std::string& path, NodeThickness* read = nullptr) {
  Settings settings;
  settings.thickness_from["s"].file = path;
  try {
    read_thickness({}, settings);
  } catch (const InputError& e) {
    return std::string(e.what()).substr(path.size());
  }
  if (read != nullptr) *read = settings.thickness_from["s"];
  return "";
}

TEST(Tables, ThicknessPerNode) {
  NodeThickness read;
  const std::string path = file("t.csv", "x,Thickness [mm],NODE\n0,1.5,7\n0,0,12\n9,1.5,7\n");  // one line twice
  EXPECT_EQ(thickness_refusal(path, &read), "");
  EXPECT_EQ(read.at_node, (std::map<int, double>{{7, 1.5}, {12, 0.0}}));
  EXPECT_EQ(read.file, path);
}

TEST(Tables, ThicknessPerNodeInAnotherUnitIsRefused) {
  EXPECT_NE(thickness_refusal(file("t.csv", "node,thickness [cm]\n7,0.2\n")).find("its name says otherwise"),
            std::string::npos);
  EXPECT_EQ(thickness_refusal(file("t.csv", "node,thickness [mm]\n7,2\n")), "");
  EXPECT_EQ(thickness_refusal(file("t.csv", "node,thickness\n7,2\n")), "");
}

TEST(Tables, ThicknessPerNodeRefusedWithItsLine) {
  const auto refusal_of = [](const char* text) { return thickness_refusal(file("t.csv", text)); };
  EXPECT_EQ(refusal_of("node,thickness\n7,-1\n"), ":2: found thickness -1, expected a number >= 0");
  EXPECT_EQ(refusal_of("node,thickness\n7,nan\n"),
            ":2: column \"thickness\": found \"nan\", expected a number with a decimal point, at most 1e30");
  EXPECT_EQ(refusal_of("node,thickness\n7,1\n8,1\n7,2\n"),
            ":4: found thickness 2 of node 7, and 1 in line 2, expected one for each node");
  for (const char* node : {"7.5", "0", "-3", "1e12"})
    EXPECT_NE(refusal_of((std::string("node,thickness\n") + node + ",1\n").c_str())
                  .find("expected a whole number > 0: the node's number in the model"),
              std::string::npos)
        << node;
  EXPECT_EQ(refusal_of("id,thickness\n7,1\n"),
            ": found no column \"node\" among \"id\", \"thickness\"; name the columns node and thickness in the first "
            "line");
  EXPECT_EQ(refusal_of("node\n7\n"),
            ": found no column \"thickness\" among \"node\"; name the columns node and thickness in the first line");
  EXPECT_EQ(thickness_refusal("nowhere.csv"), ": found no readable file, expected a table");
}

}  // namespace dea::tables_test
