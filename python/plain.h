// python/plain.h – values of ours as plain ones of Python: texts, JSON, arrays, poses.
//
// An array is a look at memory of ours, which it keeps alive, and cannot be written to; what is worked out for the
// question is an array of its own.
#pragma once
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "src/equilibrium/load_case.h"
#include "src/geometry/pose.h"
#include "src/model/joint_model.h"
#include "src/results/headline.h"
#include "views/data/json.h"

namespace dea::python {

namespace py = pybind11;

/// Whatever holds the memory.
using Owner = std::shared_ptr<const void>;

/// An array of Python, copied to doubles where it is not of them.
using DoubleArray = py::array_t<double, py::array::c_style | py::array::forcecast>;
/// Numbers of an array or sequence of one dimension. Throws UsageError: it is none, with `place` for its place.
std::vector<double> numbers_of(const py::object& given, const char* place);

/// Bytes that are no UTF-8 become U+FFFD.
py::str text(const std::string& words);
py::list texts(const std::vector<std::string>& lines);
/// null becomes None.
py::object plain(const Json& json);

/// Of `rows` times `columns` numbers (columns 0: one dimension).
py::array view_of(const py::dtype& type, std::size_t rows, std::size_t columns, const void* data, const Owner& owner);

template <class Number>
requires std::is_arithmetic_v<Number> py::array view_of(const std::vector<Number>& values, const Owner& owner) {
  // a flag of ours is a char of 0 or 1
  const py::dtype type = std::is_same_v<Number, char> ? py::dtype("?") : py::dtype::of<Number>();
  return view_of(type, values.size(), 0, values.data(), owner);
}
template <class Number, std::size_t columns>
py::array view_of(const std::vector<std::array<Number, columns>>& values, const Owner& owner) {
  return view_of(py::dtype::of<Number>(), values.size(), columns, values.data(), owner);
}
inline py::array view_of(const std::vector<Vector3d>& values, const Owner& owner) {
  static_assert(sizeof(Vector3d) == 3 * sizeof(double));
  return view_of(py::dtype::of<double>(), values.size(), 3, values.data(), owner);
}

/// The array itself keeps what is given.
template <class Values>
py::array kept(Values values) {
  const auto owner = std::make_shared<const Values>(std::move(values));
  return view_of(*owner, owner);
}

py::array vector3(const Vector3d& v);
py::tuple force_and_moment(const Vector6& both);
py::array matrix6(const Eigen::Matrix<double, 6, 6>& m);

/// 4 x 4, x = R X + t: the identity leaves a body where the file has it. `center`: reference centre of mass.
py::array matrix_of(const Pose& pose, const Vector3d& center);
/// Throws UsageError, with `where` for its place: not 4 x 4, no rotation, not finite.
Pose pose_of(const py::handle& matrix, const Vector3d& center, const std::string& where);

/// febiodea.Headline
py::object headline_tuple(const Headline& headline);

/// A value of ours as a plain one of Python; others go there as they are.
inline py::str plain_value(const std::string& value) { return text(value); }
inline py::list plain_value(const std::vector<std::string>& value) { return texts(value); }
inline py::object plain_value(const Json& value) { return plain(value); }
inline py::array plain_value(const Vector3d& value) { return vector3(value); }
inline py::object plain_value(const Headline& value) { return headline_tuple(value); }
template <class Value>
Value plain_value(Value value) {
  return value;
}

/// A class of Python whose values can be read and not be set.
template <class T, class... Holder>
class Class : public py::class_<T, Holder...> {
 public:
  using Base = py::class_<T, Holder...>;
  using Base::Base;

  /// `get`: of a T, or of what holds it where memory is looked into.
  template <class Get>
  Class& value(const char* name, const char* help, Get get) {
    if constexpr (std::is_invocable_v<Get, const T&>)
      Base::def_property_readonly(
          name, [get](const T& of) { return plain_value(std::invoke(get, of)); }, help);
    else
      Base::def_property_readonly(name, get, help);
    return *this;
  }

  template <class... Arguments>
  Class& def(Arguments&&... arguments) {
    Base::def(std::forward<Arguments>(arguments)...);
    return *this;
  }
};

/// `make` of 0, 1, ... as a list.
template <class Make>
py::list list_of(std::size_t count, const Make& make) {
  py::list all;
  for (std::size_t i = 0; i < count; ++i) all.append(make(i));
  return all;
}

/// Facets or cells with different numbers of nodes as rows, filled up with -1.
py::array padded(const std::vector<int>& begin, const std::vector<int>& nodes);

/// One after the other as VTK has them: number of nodes, nodes in VTK's order; and the type of each.
struct VtkCells {
  std::vector<std::int64_t> cells;
  std::vector<std::uint8_t> types;
};
/// `element_type`: code of the plot file's format. Appended to `to`.
void append_cells(VtkCells& to, int element_type, const std::vector<int>& nodes);
void append_facets(VtkCells& to, const std::vector<int>& begin, const std::vector<int>& nodes);

}  // namespace dea::python
