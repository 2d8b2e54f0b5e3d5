#include "io/tables/pose_matrices.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/febio/febio_text.h"
#include "io/tables/table_columns.h"
#include "src/base/error.h"
#include "src/base/names.h"
#include "src/base/numbers.h"
#include "src/base/parse.h"
#include "src/base/rotations.h"
#include "src/base/say.h"

namespace dea {

namespace {

using Eigen::Isometry3d;
using Eigen::Matrix4d;

constexpr double kRounding = 1e-3;  // of the last row

/// "11" of row and column 0.
std::string place(int row, int column) { return fmt::format("{}{}", row + 1, column + 1); }

/// By rows; -1: not there.
std::array<int, 16> matrix_columns(const NumberTable& table, const std::string& name) {
  std::array<int, 16> columns;
  for (int k = 0; k < 16; ++k) {
    const std::string wanted = lower_case(name + place(k / 4, k % 4));
    columns[at(k)] = -1;
    for (std::size_t i = 0; i < table.names.size(); ++i)
      if (bare_name(table.names[i]) == wanted) columns[at(k)] = static_cast<int>(i);
  }
  return columns;
}

bool whole(const std::array<int, 16>& columns) {
  return std::find(columns.begin(), columns.end(), -1) == columns.end();
}

Isometry3d pose_of(const NumberTable& table, const std::string& name, const std::array<int, 16>& columns, std::size_t r,
                   double length) {
  Matrix4d m;
  for (int k = 0; k < 16; ++k) m(k / 4, k % 4) = table.rows[r][at(columns[at(k)])];
  const auto refuse = [&](const std::string& found, const std::string& expected) {
    throw table_fault(table.path, table.lines[r], fmt::format("{}, expected {}", found, expected));
  };
  const auto column = [&](int i) { return fmt::format("columns {0}1{1}, {0}2{1}, {0}3{1}", name, i + 1); };
  for (int j = 0; j < 4; ++j)
    if (std::abs(m(3, j) - (j == 3)) > kRounding)
      refuse(fmt::format("column \"{}{}\": found {:g}", name, place(3, j), m(3, j)),
             fmt::format("{}: the last row of a matrix is 0 0 0 1, and its last column has the place", j == 3 ? 1 : 0));
  const Eigen::Matrix3d R = m.topLeftCorner<3, 3>();
  if (const std::optional<RotationFault> fault = rotation_fault(R)) {
    if (fault->kind == RotationFault::Kind::Length)
      refuse(fmt::format("{}: found a length of {:.6g}", column(fault->axis), fault->value), "1, as in every rotation");
    if (fault->kind == RotationFault::Kind::Angle)
      refuse(fmt::format("{} and {}: found axes with a cosine of {:.4g}", column(fault->axis), column(fault->other),
                         fault->value),
             "0: axes of a rotation stand at right angles");
    refuse(fmt::format("columns {0}11 to {0}33: found a mirror image", name),
           "a rotation: its determinant is 1, not -1");
  }
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = nearest_rotation(R);
  pose.translation() = length * m.topRightCorner<3, 1>();
  return pose;
}

}  // namespace

std::vector<std::string> matrix_names(const NumberTable& table) {
  std::vector<std::string> names;
  for (const std::string& column : table.names) {
    const std::string bare = bare_name(column);
    if (bare.size() < 3 || !bare.ends_with("11")) continue;
    const std::string name = trimmed(column).substr(0, bare.size() - 2);
    if (whole(matrix_columns(table, name))) names.push_back(name);
  }
  return names;
}

std::vector<int> place_columns(const NumberTable& table, const std::string& name, const char* setting,
                               const std::string& given) {
  const std::array<int, 16> columns = matrix_columns(table, name);
  if (whole(columns)) return {columns[3], columns[7], columns[11]};
  std::vector<std::string> missing;
  for (int k = 0; k < 16; ++k)
    if (columns[at(k)] < 0) missing.push_back(name + place(k / 4, k % 4));
  const std::vector<std::string> there = matrix_names(table);
  throw wrong_setting(setting, given,
                      say("{} has no column{} {}{};", table.path, missing.size() == 1 ? "" : "s",
                          missing.size() == 16 ? fmt::format("{} to {}", missing.front(), missing.back())
                                               : fmt::format("{}", fmt::join(missing, ", ")),
                          missing.size() == 16 ? did_you_mean(name, there) : ""),
                      there.empty() ? say("it has {}", named_columns(table, name))
                                    : say("its 4x4 matrices are {}", name_list(there, name)));
}

std::vector<Isometry3d> poses_of(const NumberTable& table, const std::string& name, double length) {
  const std::array<int, 16> columns = matrix_columns(table, name);
  std::vector<Isometry3d> poses;
  for (std::size_t r = 0; r < table.rows.size(); ++r) poses.push_back(pose_of(table, name, columns, r, length));
  return poses;
}

std::vector<Isometry3d> moves_from(const PoseStart& start, const std::vector<Isometry3d>& body,
                                   const std::vector<Isometry3d>& other) {
  const auto relative = [&](std::size_t r) { return other.empty() ? body[r] : other[r].inverse() * body[r]; };
  Isometry3d before = Isometry3d::Identity(), after = Isometry3d::Identity();
  if (start.row >= 0) {
    const std::size_t s = at(start.row);
    before = (start.in_ground ? body[s] : relative(s)).inverse();
    if (start.in_ground && !other.empty()) after = other[s];
  }
  std::vector<Isometry3d> moves;
  for (std::size_t r = 0; r < body.size(); ++r) moves.push_back(after * relative(r) * before);
  return moves;
}

}  // namespace dea
