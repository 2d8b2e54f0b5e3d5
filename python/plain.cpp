#include "python/plain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/files/encoded_text.h"
#include "io/vtu/write_vtu.h"
#include "io/xplt/xplt.h"
#include "src/base/numbers.h"

namespace dea::python {

std::vector<double> numbers_of(const py::object& given, const char* place) {
  const auto array = DoubleArray::ensure(given);
  if (!array) PyErr_Clear();
  if (!array || array.ndim() != 1)
    throw UsageError(Fault{
        .place = place, .found = "found no numbers of one dimension,", .expected = "expected a list or an array"});
  return {array.data(), array.data() + array.size()};
}

py::str text(const std::string& words) { return py::str(utf8(words)); }

py::list texts(const std::vector<std::string>& lines) {
  py::list all;
  for (const std::string& line : lines) all.append(text(line));
  return all;
}

py::object plain(const Json& json) {
  switch (json.type()) {
    case Json::value_t::boolean:
      return py::bool_(json.get<bool>());
    case Json::value_t::number_integer:
    case Json::value_t::number_unsigned:
      return py::int_(json.get<std::int64_t>());
    case Json::value_t::number_float:
      return py::float_(json.get<double>());
    case Json::value_t::string:
      return text(json.get_ref<const std::string&>());
    case Json::value_t::array: {
      py::list all;
      for (const Json& item : json) all.append(plain(item));
      return all;
    }
    case Json::value_t::object: {
      py::dict all;
      for (const auto& item : json.items()) all[text(item.key())] = plain(item.value());
      return all;
    }
    default:
      return py::none();
  }
}

py::array view_of(const py::dtype& type, std::size_t rows, std::size_t columns, const void* data, const Owner& owner) {
  const py::capsule base(new Owner(owner), [](void* kept) { delete static_cast<Owner*>(kept); });
  std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(rows)};
  if (columns > 0) shape.push_back(static_cast<py::ssize_t>(columns));
  py::array array(type, shape, data, base);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

py::array vector3(const Vector3d& v) { return py::array_t<double>(3, v.data()); }

py::tuple force_and_moment(const Vector6& both) {
  return py::make_tuple(vector3(both.head<3>()), vector3(both.tail<3>()));
}

py::array matrix6(const Eigen::Matrix<double, 6, 6>& m) {
  py::array_t<double> array({6, 6});
  auto to = array.mutable_unchecked<2>();
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < 6; ++k) to(i, k) = m(i, k);
  return array;
}

py::array matrix_of(const Pose& pose, const Vector3d& center) {
  py::array_t<double> array({4, 4});
  auto to = array.mutable_unchecked<2>();
  const Vector3d shift = pose.center - pose.rotation * center;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k) to(i, k) = i == 3 ? (k == 3 ? 1.0 : 0.0) : k == 3 ? shift(i) : pose.rotation(i, k);
  return array;
}

Pose pose_of(const py::handle& matrix, const Vector3d& center, const std::string& where) {
  constexpr double kTyped = 1e-6;  // digits that a rotation may be given with
  const auto refuse = [&](const std::string& found) {
    throw UsageError(Fault{.place = where,
                           .found = "found " + found + ",",
                           .expected = "expected a 4 x 4 array: a rotation, a translation, and 0 0 0 1 below"});
  };
  const auto array = DoubleArray::ensure(matrix);
  if (!array) {
    PyErr_Clear();
    refuse("no array of numbers");
  }
  if (array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4) {
    std::string shape;
    for (py::ssize_t d = 0; d < array.ndim(); ++d) shape += fmt::format("{}{}", d ? " x " : "", array.shape(d));
    refuse("an array of shape " + (shape.empty() ? "()" : shape));
  }
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> m(array.data());
  if (!m.allFinite()) refuse("a number that is not finite");
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) refuse("another last row");
  Pose pose;
  pose.rotation = m.topLeftCorner<3, 3>();
  if ((pose.rotation.transpose() * pose.rotation - Eigen::Matrix3d::Identity()).norm() > kTyped ||
      pose.rotation.determinant() < 0)
    refuse("upper left 3 x 3 numbers that are no rotation");
  pose.center = pose.rotation * center + m.topRightCorner<3, 1>();
  return pose;
}

py::object headline_tuple(const Headline& h) {
  return py::module_::import("febiodea._tables").attr("Headline")(h.p99, h.mean, h.area, h.peak, h.above);
}

py::array padded(const std::vector<int>& begin, const std::vector<int>& nodes) {
  int most = 0;
  for (std::size_t f = 0; f + 1 < begin.size(); ++f) most = std::max(most, begin[f + 1] - begin[f]);
  py::array_t<int> array({static_cast<py::ssize_t>(begin.size()) - 1, static_cast<py::ssize_t>(most)});
  auto to = array.mutable_unchecked<2>();
  for (py::ssize_t f = 0; f < array.shape(0); ++f) {
    const int first = begin[at(f)], count = begin[at(f) + 1] - first;
    for (int k = 0; k < most; ++k) to(f, k) = k < count ? nodes[at(first + k)] : -1;
  }
  return array;
}

namespace {

void append_cell(VtkCells& to, const VtkCell& cell, const int* nodes) {
  to.types.push_back(static_cast<std::uint8_t>(cell.type));
  to.cells.push_back(static_cast<std::int64_t>(cell.order.size()));
  for (const int k : cell.order) to.cells.push_back(nodes[k]);
}

}  // namespace

void append_cells(VtkCells& to, int element_type, const std::vector<int>& nodes) {
  const VtkCell& cell = vtk_cell(element_type);
  const std::size_t each = at(xplt_nodes_per_element(element_type));
  for (std::size_t first = 0; first + each <= nodes.size(); first += each) append_cell(to, cell, &nodes[first]);
}

void append_facets(VtkCells& to, const std::vector<int>& begin, const std::vector<int>& nodes) {
  for (std::size_t f = 0; f + 1 < begin.size(); ++f)
    if (begin[f + 1] > begin[f]) append_cell(to, vtk_facet(begin[f + 1] - begin[f]), &nodes[at(begin[f])]);
}

}  // namespace dea::python
