// SPDX-License-Identifier: BSD-3-Clause
// NumPy arrays as the modules read them, and what they give back as arrays.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"

namespace pcl_slim::python {

namespace py = pybind11;

/** \brief Three numbers a row, in memory that the array owns. */
struct Rows {
  py::array array;
  CloudView::Scalar scalar = CloudView::Scalar::kDouble;
  std::size_t size = 0;
  std::size_t stride = 0;  ///< bytes from one row to the next, at least those of a row

  const void* data() const { return array.data(); }
  bool isFloat() const { return scalar == CloudView::Scalar::kFloat; }
};

/** \brief Reads an array of shape (n, 3) of float32 or float64, or a structured one with fields x, y
 * and z. In C order or with any positive stride between rows nothing is copied; other layouts are
 * copied once. Raises ValueError for another shape or type. \param[in] name for the sentence */
Rows readRows(const py::object& given, const char* name);

/** \brief A scan as the functions of this package take it. */
struct Scan {
  Rows points;
  std::optional<Rows> normals, sensors;
  std::vector<std::uint8_t> bgr;             ///< colours, or none
  std::vector<std::uint32_t> frame_numbers;  ///< or none

  std::size_t size() const { return points.size; }
  CloudView view() const;
  ColorView colors() const;
};

/** \brief What a scan is made of; None: not given. */
struct ScanArguments {
  py::object points, normals = py::none(), colors = py::none(), sensors = py::none(),
                     frames = py::none();
};

/** \brief Reads all of it; raises for lengths that differ and for clouds without points. */
Scan readScan(const ScanArguments& given);

/** \brief Three finite numbers, or nothing of None. */
std::optional<std::array<double, 3>> readPlace(const py::object& given, const char* name);

/** \brief A path of str or os.PathLike. */
std::string readPath(const py::object& given);

/** \brief A new array, C order. */
template <typename T>
py::array_t<T> newArray(std::vector<py::ssize_t> shape) {
  return py::array_t<T>(std::move(shape));
}

/** \brief A column of a shared object as an array that keeps the object alive; nothing is copied.
 * Open3D takes no read-only arrays: what is written changes the object. */
template <typename T, typename Owner>
py::array_t<T> viewOf(const std::shared_ptr<Owner>& owner, const T* data,
                      std::vector<py::ssize_t> shape, bool writable = true) {
  using Kept = std::shared_ptr<Owner>;
  const py::capsule keep(new Kept(owner), [](void* kept) { delete static_cast<Kept*>(kept); });
  py::array_t<T> array(std::move(shape), data, keep);
  if (!writable) array.attr("setflags")(py::arg("write") = false);
  return array;
}

/** \brief A column of a vector as an array of its own memory. */
template <typename T>
py::array ownedArray(std::vector<T> values, std::vector<py::ssize_t> shape) {
  auto owner = std::make_shared<const std::vector<T>>(std::move(values));
  return viewOf(owner, owner->data(), std::move(shape));
}

/** \brief A namedtuple type of this package with these fields, separated by blanks. It is never
 * released: objects of its type may outlive the module. */
py::handle namedTuple(py::module_& m, const char* name, const char* fields, const char* doc);

}  // namespace pcl_slim::python
