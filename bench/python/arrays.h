// SPDX-License-Identifier: BSD-3-Clause
/// Conversions between numpy arrays and the types of the libraries. Arrays that are views of an object keep
/// it alive and are read-only; results that are computed move into their array. Neither copies.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/timestamp.h"
#include "core/geometry/pose.h"
#include "core/types/trajectory.h"

namespace stillpoint::python {

namespace py = pybind11;

/// Arrays as arguments: numbers are converted, other memory layouts are copied.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Integers =
    py::array_t<std::int64_t, py::array::c_style>;  // floating-point numbers are no indices or stamps
using Shape = std::vector<py::ssize_t>;

/// "(4, 3)"
inline std::string shape_text(const py::array& array) {
  return py::str(py::tuple(py::cast(Shape(array.shape(), array.shape() + array.ndim())))).cast<std::string>();
}

/// @param name of the argument, for the message
/// @param expected -1 for any size
/// @throws InputError for an array of another shape
inline void require_shape(const py::array& array, const std::string& name, const Shape& expected) {
  bool equal = array.ndim() == static_cast<py::ssize_t>(expected.size());
  for (std::size_t i = 0; equal && i < expected.size(); ++i)
    equal = expected[i] < 0 || array.shape(static_cast<py::ssize_t>(i)) == expected[i];
  if (equal) return;
  std::string text;
  for (const py::ssize_t size : expected)
    text += (text.empty() ? "" : ", ") + (size < 0 ? std::string("n") : std::to_string(size));
  throw InputError(name, "has the shape " + shape_text(array) + "; expected (" + text + ")");
}

/// A rigid transform.
/// @param name of the argument, for the message
/// @throws InputError for an array of another shape, or whose upper left part is no rotation
inline Pose rigid_of(const Doubles& T, const std::string& name) {
  require_shape(T, name, {4, 4});
  const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(T.data());
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  if (!matrix.allFinite() || !R.isUnitary(1e-3) || R.determinant() < 0.0)
    throw InputError(name, "is no rigid transform; its upper left part is not a rotation");
  return Pose::from_matrix(matrix);
}

/// A read-only view of memory that belongs to `owner`.
template <class Value>
py::array view(const Value* data, const Shape& shape, const Shape& strides, const py::handle& owner) {
  py::array array(py::dtype::of<Value>(), shape, strides, data, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// A member of each element of a list that belongs to `owner`: `width` values from `first` on, [n] or [n,
/// width].
template <class Element, class Value>
py::array column(std::span<const Element> elements, const Value* first, int width, const py::handle& owner) {
  const auto count = static_cast<py::ssize_t>(elements.size());
  constexpr auto kStride = static_cast<py::ssize_t>(sizeof(Element));
  if (width == 1) return view(first, {count}, {kStride}, owner);
  return view(first, {count, width}, {kStride, static_cast<py::ssize_t>(sizeof(Value))}, owner);
}

/// The values, whose memory moves into the array.
template <class Value>
py::array_t<Value> array_of(std::vector<Value>&& values) {
  auto owned = std::make_unique<std::vector<Value>>(std::move(values));
  const Value* const data = owned->data();
  const auto size = static_cast<py::ssize_t>(owned->size());
  const py::capsule owner(owned.release(), [](void* list) { delete static_cast<std::vector<Value>*>(list); });
  return py::array_t<Value>(size, data, owner);
}

/// As `array_of`, [n, columns].
template <class Value>
py::array table_of(std::vector<Value>&& values, int columns) {
  return array_of(std::move(values)).reshape({-1, columns});
}

inline std::span<const double> span_of(const Doubles& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

/// Stamps [ns].
/// @param times_ns integers or datetime64 of any unit: an array, a list, or a series of pandas
/// @param name of the argument, for the message
/// @throws InputError for anything else, no time (NaT), or stamps beyond int64
inline std::vector<Timestamp> stamps_of(const py::object& times_ns, const std::string& name) {
  py::array array = py::array::ensure(times_ns);
  if (!array) throw InputError(name, "is no array");
  require_shape(array, name, {-1});
  const char kind = array.dtype().kind();
  if (kind == 'M') array = array.attr("astype")("datetime64[ns]").attr("view")("int64").cast<py::array>();
  if (kind != 'i' && kind != 'u' && kind != 'M') {
    throw InputError(name, std::string("is no array of integers or times but of dtype \"") + kind +
                               "\"; stamps are int64 nanoseconds, see Trajectory.from_seconds");
  }
  const auto values = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>(array);
  std::vector<Timestamp> stamps(static_cast<std::size_t>(values.size()));
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    stamps[i].ns = values.data()[i];
    const bool is_none = kind == 'M' && stamps[i].ns == std::numeric_limits<std::int64_t>::min();
    if (is_none || (kind == 'u' && stamps[i].ns < 0))
      throw InputError(name + "[" + std::to_string(i) + "]",
                       is_none ? "is no time (NaT)" : "exceeds the range of int64 nanoseconds");
  }
  return stamps;
}

/// The stamps [ns], [n].
inline py::array_t<std::int64_t> stamp_array(std::span<const Timestamp> stamps) {
  py::array_t<std::int64_t> array(static_cast<py::ssize_t>(stamps.size()));
  for (std::size_t i = 0; i < stamps.size(); ++i) array.mutable_data()[i] = stamps[i].ns;
  return array;
}

/// (x, y, z, w)
inline py::array quaternion_array(const Eigen::Quaterniond& q) {
  return array_of(std::vector<double>{q.x(), q.y(), q.z(), q.w()});
}

inline py::array vector_array(const Eigen::Vector3d& v) {
  return array_of(std::vector<double>{v.x(), v.y(), v.z()});
}

/// A matrix of fixed size, row by row.
template <class Matrix>
py::array matrix_array(const Matrix& matrix) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(matrix.size()));
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) values.push_back(matrix(row, column));
  return table_of(std::move(values), static_cast<int>(matrix.cols()));
}

/// The rotation of (x, y, z, w).
/// @throws InputError unless its norm is within 0.1 of 1
inline Eigen::Quaterniond quaternion_of(const Doubles& xyzw, const std::string& name) {
  require_shape(xyzw, name, {4});
  const Eigen::Quaterniond q(xyzw.at(3), xyzw.at(0), xyzw.at(1), xyzw.at(2));
  if (!(std::abs(q.norm() - 1.0) <= 0.1))
    throw InputError(name, "has norm " + std::to_string(q.norm()) + ", expected 1; the order is x, y, z, w");
  return q.normalized();
}

inline Eigen::Vector3d vector_of(const Doubles& xyz, const std::string& name) {
  require_shape(xyz, name, {3});
  return {xyz.at(0), xyz.at(1), xyz.at(2)};
}

}  // namespace stillpoint::python
