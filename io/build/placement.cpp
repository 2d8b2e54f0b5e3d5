#include "io/build/placement.h"

#include <fmt/format.h>

#include <optional>

#include "io/febio/febio_text.h"
#include "io/files/free_memory.h"
#include "io/tables/table.h"
#include "src/base/error.h"
#include "src/base/parse.h"
#include "src/base/rotations.h"

namespace dea {

namespace {

constexpr const char* kForm =
    "expected 16 numbers, four rows of a 4x4 matrix, or a linear transform of Slicer (.tfm); a row of a table of poses "
    "is named FILE:ROW";

/// The rotation that the matrix is but for its digits, and how far its numbers were off.
Eigen::Matrix3d exact_rotation(const Eigen::Matrix3d& m, double& corrected) {
  if (const std::optional<RotationFault> fault = rotation_fault(m)) {
    if (fault->kind == RotationFault::Kind::Mirror)
      throw BadValue(
          "found a mirror image (left-handed axes), expected a rotation; mirror the surface where it was made");
    if (fault->kind == RotationFault::Kind::Length)
      throw BadValue(
          fmt::format("found axes {:.4g}, {:.4g} and {:.4g} long, expected 1: a pose does not scale; scale the surface "
                      "where it was made, or all of them with --scale",
                      m.col(0).norm(), m.col(1).norm(), m.col(2).norm()));
    throw BadValue(fmt::format(
        "found axes that are not at right angles (cosine {:.2g}), expected a rotation without shear", fault->value));
  }
  const Eigen::Matrix3d exact = nearest_rotation(m);
  corrected = (exact - m).cwiseAbs().maxCoeff();
  return exact;
}

/// Numbers between white space, commas, semicolons and brackets.
std::vector<double> numbers_of(const std::string& text) {
  std::string spaced = text;
  for (char& c : spaced)
    if (std::string("\t\r,;[](){}").find(c) != std::string::npos) c = ' ';
  std::vector<double> numbers;
  for (const std::string& word : split(spaced, ' '))
    if (!word.empty()) numbers.push_back(parse_number(word));
  return numbers;
}

/// What follows "Parameters:" of an ITK file.
struct ItkLine {
  std::string text;
  int line = 0;
};

FilePose read_itk(const std::string& path, const std::vector<std::string>& lines) {
  std::optional<ItkLine> kind, parameters, center;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto take = [&](const char* word, std::optional<ItkLine>& into) {
      if (!lines[i].starts_with(word)) return;
      if (into)
        throw table_fault(path, static_cast<int>(i + 1),
                          fmt::format("found a second \"{}\", expected one linear transform; harden the others", word));
      into = ItkLine{trimmed(lines[i].substr(std::string(word).size())), static_cast<int>(i + 1)};
    };
    take("Transform:", kind);
    take("Parameters:", parameters);
    take("FixedParameters:", center);
  }
  if (!kind || !parameters)
    throw table_fault(path, 0, "found no \"Transform:\" and \"Parameters:\", expected both: the file is cut off");
  if (!kind->text.starts_with("AffineTransform_") && !kind->text.starts_with("MatrixOffsetTransformBase_"))
    throw table_fault(path, kind->line,
                      fmt::format("found {}, expected AffineTransform_double_3_3: save it as a linear transform (in "
                                  "Slicer: a transform node, not a deformation)",
                                  febio::quote(kind->text)));
  const auto numbers = [&](const ItkLine& of, std::size_t count) {
    std::vector<double> found;
    try {
      found = numbers_of(of.text);
    } catch (const BadValue& why) {
      throw table_fault(path, of.line, why.what());
    }
    if (found.size() != count)
      throw table_fault(path, of.line, fmt::format("found {} numbers, expected {}", found.size(), count));
    return found;
  };
  const std::vector<double> p = numbers(*parameters, 12);
  const std::vector<double> c = center ? numbers(*center, 3) : std::vector<double>(3, 0.0);
  FilePose pose;
  pose.itk = true;
  try {
    Eigen::Matrix3d m;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) m(i, k) = p[static_cast<std::size_t>(3 * i + k)];
    pose.pose.linear() = exact_rotation(m, pose.corrected);
  } catch (const BadValue& why) {
    throw table_fault(path, parameters->line, why.what());
  }
  const Eigen::Vector3d about(c[0], c[1], c[2]);
  pose.pose.translation() = Eigen::Vector3d(p[9], p[10], p[11]) + about - pose.pose.linear() * about;
  return pose;
}

}  // namespace

FilePose pose_of(const std::vector<double>& v) {
  if (v.size() != 16) throw BadValue(fmt::format("found {} numbers, {}", v.size(), kForm));
  Eigen::Matrix4d m;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k) m(i, k) = v[static_cast<std::size_t>(4 * i + k)];
  if (!m.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), 1e-9))
    throw BadValue(fmt::format(
        "found the last row {:g} {:g} {:g} {:g}, expected 0 0 0 1: points are columns, and the translation stands in "
        "the last column",
        m(3, 0), m(3, 1), m(3, 2), m(3, 3)));
  FilePose pose;
  pose.pose.linear() = exact_rotation(m.topLeftCorner<3, 3>(), pose.corrected);
  pose.pose.translation() = m.topRightCorner<3, 1>();
  return pose;
}

FilePose read_pose(const std::string& path) {
  const std::optional<std::string> content = whole_file(path, 10);
  if (!content) throw table_fault(path, 0, "found no file that can be read, expected a pose");
  const std::vector<std::string> lines = split(*content, '\n');
  if (content->find("#Insight Transform File") != std::string::npos) return read_itk(path, lines);
  std::vector<double> numbers;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string line = trimmed(lines[i]);
    if (line.starts_with("#") || line.starts_with("%")) continue;
    try {
      for (const double x : numbers_of(line)) numbers.push_back(x);
    } catch (const BadValue&) {
      throw table_fault(path, static_cast<int>(i + 1),
                        fmt::format("found {}, {}", febio::quote(line.substr(0, 40)), kForm));
    }
    if (numbers.size() > 16)
      throw table_fault(path, static_cast<int>(i + 1), fmt::format("found more than 16 numbers, {}", kForm));
  }
  try {
    return pose_of(numbers);
  } catch (const BadValue& why) {
    throw table_fault(path, 0, why.what());
  }
}

}  // namespace dea
