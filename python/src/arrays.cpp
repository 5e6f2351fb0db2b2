// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "work.h"

namespace pcl_slim::python {

namespace {

constexpr std::size_t kMostPoints = std::numeric_limits<std::uint32_t>::max() - 1u;

std::string textOf(const py::handle& object) {
  return py::str(object).cast<std::string>();
}

std::string quoted(const char* name, const std::string& what) {
  return std::string(name) + " " + what;
}

/** Anything as an array; lists of whole numbers become doubles. */
py::array asArray(const py::object& given, const char* name) {
  if (given.is_none()) raiseValue(quoted(name, "is None: pass an array of shape (n, 3)"));
  const py::module_ numpy = py::module_::import("numpy");
  try {
    // Where a mask hides a value there is none.
    if (py::hasattr(given, "mask") && py::hasattr(given, "filled"))
      return given.attr("filled")(std::numeric_limits<double>::quiet_NaN());
    py::array array = numpy.attr("asarray")(given);
    const bool list = py::isinstance<py::list>(given) || py::isinstance<py::tuple>(given);
    if (list && (array.dtype().kind() == 'i' || array.dtype().kind() == 'u'))
      array = array.attr("astype")("float64");
    return array;
  } catch (const py::error_already_set& error) {
    if (error.matches(PyExc_MemoryError) || error.matches(PyExc_KeyboardInterrupt)) throw;
    raiseValue(
        quoted(name, "cannot be read as an array of numbers: pass an array of shape (n, 3)"));
  }
}

/** The fields x, y and z of a structured array: in place where they are three floats or doubles in a
 * row, else a copy. */
py::array fieldsOf(const py::array& array, const char* name) {
  const py::object fields = array.dtype().attr("fields");
  std::array<py::dtype, 3> types;
  std::array<py::ssize_t, 3> offsets{};
  for (std::size_t a = 0; a < 3; ++a) {
    const char* axis = a == 0 ? "x" : a == 1 ? "y" : "z";
    if (!fields.contains(axis))
      raiseValue(quoted(name, std::string("is a structured array without a field ") + axis +
                                  ": pass an array of shape (n, 3)"));
    const py::tuple field = fields[axis];
    types[a] = field[0].cast<py::dtype>();
    if (std::strchr("fiu", types[a].kind()) == nullptr || types[a].kind() == '\0')
      raiseValue(quoted(name, std::string("has a field ") + axis + " of the type " +
                                  textOf(types[a]) + ": pass numbers"));
    offsets[a] = field[1].cast<py::ssize_t>();
  }
  if (array.ndim() != 1)
    raiseValue(quoted(name, "is a structured array of several dimensions: pass array.ravel()"));
  const py::ssize_t item = types[0].itemsize();
  const bool in_place = types[0].kind() == 'f' && types[1].equal(types[0]) &&
                        types[2].equal(types[0]) && offsets[1] == offsets[0] + item &&
                        offsets[2] == offsets[0] + 2 * item;
  if (in_place) {
    const auto* first = static_cast<const unsigned char*>(array.data()) + offsets[0];
    return py::array(types[0], {array.shape(0), py::ssize_t{3}}, {array.strides(0), item}, first,
                     array);
  }
  const py::module_ numpy = py::module_::import("numpy");
  return numpy.attr("stack")(py::make_tuple(array["x"], array["y"], array["z"]),
                             py::arg("axis") = 1, py::arg("dtype") = "float64");
}

/** Raises for anything that is not (n, 3) of float32 or float64. */
void checkRows(const py::array& array, const char* name) {
  const char kind = array.dtype().kind();
  const auto item = array.dtype().itemsize();
  if (kind != 'f' || (item != 4 && item != 8)) {
    const std::string type = textOf(array.dtype());
    raiseValue(kind == 'c' || kind == 'O' || kind == 'S' || kind == 'U' || kind == 'M' ||
                       kind == 'm'
                   ? quoted(name, "has the type " + type +
                                      ", which has no coordinates: pass float32 or float64")
                   : quoted(name, "has the type " + type +
                                      ": pass float32 or float64, as .astype('float64') makes it"));
  }
  if (array.ndim() == 1 && array.size() == 0) return;
  if (array.ndim() == 2 && array.shape(1) == 3) return;
  const std::string shape = textOf(array.attr("shape"));
  raiseValue(quoted(name, "has the shape " + shape + ": pass (n, 3), a row for each point" +
                              (array.ndim() == 2 && array.shape(1) > 3 ? ", as by [:, :3]" : "")));
}

}  // namespace

Rows readRows(const py::object& given, const char* name) {
  py::array array = asArray(given, name);
  if (!array.dtype().attr("names").is_none()) array = fieldsOf(array, name);
  checkRows(array, name);
  Rows rows;
  if (array.ndim() == 1) {
    rows.array = array;
    return rows;
  }
  if (static_cast<std::size_t>(array.shape(0)) > kMostPoints)
    raiseValue(quoted(name, "has more than 4,294,967,294 rows: pass a part of them"));
  const auto item = array.dtype().itemsize();
  // A row is read as three numbers at consecutive addresses, with others behind it.
  const bool native = array.dtype().attr("isnative").cast<bool>();
  const bool aligned = array.attr("flags").attr("aligned").cast<bool>();
  const bool rows_apart = array.shape(0) == 1 || (array.strides(0) >= 3 * item);
  if (!native || !aligned || array.strides(1) != item || !rows_apart ||
      array.strides(0) % item != 0) {
    const py::module_ numpy = py::module_::import("numpy");
    array = numpy.attr("array")(array, py::arg("dtype") = item == 4 ? "float32" : "float64",
                                py::arg("order") = "C", py::arg("copy") = true,
                                py::arg("subok") = false);
  }
  rows.scalar = item == 4 ? CloudView::Scalar::kFloat : CloudView::Scalar::kDouble;
  rows.size = static_cast<std::size_t>(array.shape(0));
  rows.stride = static_cast<std::size_t>(rows.size > 1 ? array.strides(0) : 3 * item);
  rows.array = std::move(array);
  return rows;
}

namespace {

/** Normals are floats to the modules. */
Rows readNormals(const py::object& given) {
  Rows rows = readRows(given, "normals");
  if (rows.isFloat() || rows.size == 0) return rows;
  return readRows(rows.array.attr("astype")("float32"), "normals");
}

/** White of colours that are no bytes, as the programs have it: 1 of fractions up to that, 255 of
 * values up to that, else 65535 or the largest. */
double whiteOf(double largest, bool fractions) {
  if (fractions && largest <= 1.0) return 1.0;
  return largest <= 255.0 ? 255.0 : std::max(largest, 65535.0);
}

std::vector<std::uint8_t> readColors(const py::object& given) {
  const py::array array = asArray(given, "colors");
  const char kind = array.dtype().kind();
  if (kind != 'u' && kind != 'i' && kind != 'f')
    raiseValue("colors has the type " + textOf(array.dtype()) +
               ": pass uint8, or numbers from 0 to 1 or to 65535");
  if (array.ndim() != 2 || (array.shape(1) != 3 && array.shape(1) != 4))
    raiseValue("colors has the shape " + textOf(array.attr("shape")) +
               ": pass (n, 3), red, green and blue of each point");
  const auto size = static_cast<std::size_t>(array.shape(0));
  std::vector<std::uint8_t> bgr(3 * size);
  if (kind == 'u' && array.itemsize() == 1) {
    const auto bytes = py::array_t<std::uint8_t>(array);
    const auto at = bytes.unchecked<2>();
    for (std::size_t i = 0; i < bgr.size(); ++i)
      bgr[i] = at(static_cast<py::ssize_t>(i / 3), static_cast<py::ssize_t>(2 - i % 3));
    return bgr;
  }
  const auto numbers = py::array_t<double>(array);
  const auto at = numbers.unchecked<2>();
  double largest = 0;
  for (std::size_t i = 0; i < bgr.size(); ++i) {
    const double value = at(static_cast<py::ssize_t>(i / 3), static_cast<py::ssize_t>(i % 3));
    if (std::isfinite(value)) largest = std::max(largest, value);
  }
  const double white = whiteOf(largest, kind == 'f');
  for (std::size_t i = 0; i < bgr.size(); ++i) {
    const double share =
        at(static_cast<py::ssize_t>(i / 3), static_cast<py::ssize_t>(2 - i % 3)) / white;
    if (share > 0) bgr[i] = static_cast<std::uint8_t>(std::lround(255 * std::min(share, 1.0)));
  }
  return bgr;
}

std::vector<std::uint32_t> readFrames(const py::object& given) {
  const py::array array = asArray(given, "frames");
  const char kind = array.dtype().kind();
  if ((kind != 'u' && kind != 'i' && kind != 'f') || array.ndim() != 1)
    raiseValue("frames has the shape " + textOf(array.attr("shape")) + " and the type " +
               textOf(array.dtype()) + ": pass (n,), the number of each point's frame");
  const auto numbers = py::array_t<double>(array);
  std::vector<std::uint32_t> frames(static_cast<std::size_t>(numbers.size()));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double value = numbers.at(static_cast<py::ssize_t>(i));
    if (!(value >= 0 && value < 4294967295.0) || value != std::floor(value))
      raiseValue("frames has a number that is no whole one from 0 on: number the frames 0, 1, 2");
    frames[i] = static_cast<std::uint32_t>(value);
  }
  return frames;
}

void checkLength(std::size_t found, std::size_t wanted, const char* name) {
  if (found == wanted) return;
  raiseValue("points has " + std::to_string(wanted) + " rows and " + name + " " +
             std::to_string(found) + ": pass one for each point");
}

}  // namespace

CloudView Scan::view() const {
  CloudView view;
  view.xyz = points.data();
  view.xyz_stride = points.stride;
  view.scalar = points.scalar;
  view.size = points.size;
  if (normals) {
    view.normal = normals->data();
    view.normal_stride = normals->stride;
  }
  if (sensors) {
    view.sensors = sensors->data();
    view.sensors_stride = sensors->stride;
    view.sensors_scalar = sensors->scalar;
  }
  if (!frame_numbers.empty()) view.frame_numbers = frame_numbers.data();
  return view;
}

ColorView Scan::colors() const {
  return {bgr.empty() ? nullptr : bgr.data(), 3};
}

Scan readScan(const ScanArguments& given) {
  Scan scan;
  scan.points = readRows(given.points, "points");
  if (scan.size() == 0) raiseValue("points is empty: pass the scan's points");
  if (!given.normals.is_none()) {
    scan.normals = readNormals(given.normals);
    checkLength(scan.normals->size, scan.size(), "normals");
  }
  if (!given.colors.is_none()) {
    scan.bgr = readColors(given.colors);
    checkLength(scan.bgr.size() / 3, scan.size(), "colors");
  }
  if (!given.sensors.is_none()) {
    scan.sensors = readRows(given.sensors, "sensors");
    checkLength(scan.sensors->size, scan.size(), "sensors");
  }
  if (!given.frames.is_none()) {
    scan.frame_numbers = readFrames(given.frames);
    checkLength(scan.frame_numbers.size(), scan.size(), "frames");
  }
  return scan;
}

std::optional<std::array<double, 3>> readPlace(const py::object& given, const char* name) {
  if (given.is_none()) return std::nullopt;
  try {
    const auto place = given.cast<std::array<double, 3>>();
    if (std::all_of(place.begin(), place.end(), [](double x) { return std::isfinite(x); }))
      return place;
  } catch (const py::cast_error&) {
  }
  raiseValue(quoted(name, "takes three finite numbers, as (0, 0, 1.5)"));
}

std::string readPath(const py::object& given) {
  const py::module_ os = py::module_::import("os");
  try {
    return os.attr("fsencode")(given).cast<std::string>();
  } catch (const py::error_already_set&) {
    raiseValue("a path is text or an os.PathLike, as 'surface.slim'");
  }
}

py::handle namedTuple(py::module_& m, const char* name, const char* fields, const char* doc) {
  py::object type = py::module_::import("collections")
                        .attr("namedtuple")(name, fields, py::arg("module") = "pcl_slim");
  type.attr("__doc__") = doc;
  m.attr(name) = type;
  return type.release();
}

}  // namespace pcl_slim::python
