// SPDX-License-Identifier: BSD-3-Clause
// Ridges and ravines: lines() and what it returns.
#include <algorithm>
#include <string>
#include <utility>

#include "arrays.h"
#include "options.h"
#include "pcl_slim/scan/scan.h"
#include "scan_state.h"
#include "surface.h"
#include "work.h"

namespace pcl_slim::python {

namespace {

constexpr double kPeak = 3.25;  ///< peak_significance of a line over its significance

constexpr const char* kLinesDoc =
    R"doc(lines(points, normals=None, *, surface=None, type='both', significance=2.0, strength=0.0,
      length=0.3, threads=0, progress=None, **options) -> Lines

Ridges and ravines of the points' surface as polylines, as pcl_slim_lines gives them. type: 'both',
'ridges' or 'ravines'. significance: deviations of the noise that a line stands out. strength: least
integral of curvature along a line. length: least length, in radii of the surface's balls.)doc";

py::object lines(const py::object& points, const py::object& normals, const SurfacePointer& own,
                 const py::kwargs& given) {
  struct State {
    std::shared_ptr<ScanState> scan;
    CrestParams crest;
    TracedScan traced;
  };
  Keywords keywords("lines", given);
  auto state = std::make_shared<State>();
  CrestParams& crest = state->crest;
  const std::string type = keywords.takeWord("type", {"both", "ridges", "ravines"}, "both");
  crest.ridges = type != "ravines";
  crest.ravines = type != "ridges";
  crest.significance = keywords.takeNumber("significance", 0, 1e6, crest.significance);
  crest.peak_significance = kPeak * crest.significance;
  crest.min_strength = keywords.takeNumber("strength", 0, 1e6, crest.min_strength);
  crest.min_length = keywords.takeNumber("length", 0, 1e6, crest.min_length);
  state->scan = readState(points, normals, own, keywords);
  const py::object progress = keywords.take("progress");
  keywords.finish();
  run(progress, state, [s = state.get()](Work& work) {
    Error error = traceScanLines(s->scan->view(), s->scan->given.get(), s->scan->params, s->crest,
                                 s->traced, work.progress());
    if (!error && s->scan->sensor_noise)
      s->scan->sensor_noise->take(s->traced.fitted.statistics.noise);
    return error;
  });
  return py::cast(std::make_shared<CrestLines>(std::move(state->traced.lines)));
}

using Lines = std::shared_ptr<CrestLines>;

template <typename T>
py::array columnOf(const Lines& lines, const std::vector<T>& values) {
  return viewOf(lines, values.data(), {static_cast<py::ssize_t>(values.size())});
}

template <typename T>
py::array rowsOf(const Lines& lines, const std::vector<std::array<T, 3>>& values, std::size_t begin,
                 std::size_t end) {
  return viewOf(lines, values.empty() ? nullptr : values.data()[begin].data(),
                {static_cast<py::ssize_t>(end - begin), 3});
}

py::array lineAt(const Lines& lines, py::ssize_t i) {
  const auto count = static_cast<py::ssize_t>(lines->numLines());
  if (i < 0) i += count;
  if (i < 0 || i >= count)
    throw py::index_error("there is no such line: len(lines) is their number");
  const auto line = static_cast<std::size_t>(i);
  return rowsOf(lines, lines->position, lines->line_begin[line], lines->line_begin[line + 1]);
}

std::string describe(const CrestLines& lines) {
  const auto ridges = std::count(lines.type.begin(), lines.type.end(), CrestType::kRidge);
  return "<pcl_slim.Lines: " + std::to_string(ridges) + " ridges and " +
         std::to_string(lines.numLines() - static_cast<std::size_t>(ridges)) + " ravines of " +
         std::to_string(lines.numVertices()) + " vertices>";
}

/** A property that is a column; nothing is copied. */
template <typename T>
void defineColumn(py::class_<CrestLines, Lines>& type, const char* name,
                  std::vector<T> CrestLines::*member, const char* doc) {
  type.def_property_readonly(
      name, [member](const Lines& lines) { return columnOf(lines, (*lines).*member); }, doc);
}
template <typename T>
void defineColumn(py::class_<CrestLines, Lines>& type, const char* name,
                  std::vector<std::array<T, 3>> CrestLines::*member, const char* doc) {
  type.def_property_readonly(
      name,
      [member](const Lines& lines) {
        return rowsOf(lines, (*lines).*member, 0, lines->numVertices());
      },
      doc);
}

}  // namespace

void bindLines(py::module_& m, py::class_<Surface, SurfacePointer>& type) {
  using L = CrestLines;
  py::class_<L, Lines> lines_type(
      m, "Lines",
      "Ridges and ravines, the strongest first. lines[i] is line i, (m, 3) float64. Columns are "
      "one "
      "a vertex or one a line; line i has the vertices offsets[i] to offsets[i + 1].");
  lines_type.def("__len__", [](const L& lines) { return lines.numLines(); })
      .def("__getitem__", &lineAt)
      .def("__repr__", &describe)
      .def_property_readonly(
          "ravine",
          [](const Lines& lines) {
            const auto* first = reinterpret_cast<const std::uint8_t*>(lines->type.data());
            return viewOf(lines, first, {static_cast<py::ssize_t>(lines->numLines())});
          },
          "1 of ravines, 0 of ridges, (len,) uint8.");
  defineColumn(lines_type, "positions", &L::position, "Vertices, (v, 3) float64.");
  defineColumn(lines_type, "normals", &L::normal, "Unit normals of the surface, (v, 3) float32.");
  defineColumn(lines_type, "k1", &L::k1, "Greatest curvature [1/length], (v,) float32.");
  defineColumn(lines_type, "k2", &L::k2, "Least curvature [1/length], (v,) float32.");
  defineColumn(lines_type, "significance", &L::significance,
               "How far a line stands out [deviations of the noise], (v,) float32.");
  lines_type.def_property_readonly(
      "offsets",
      [](const Lines& lines) {
        return viewOf(lines, lines->line_begin.data(),
                      {static_cast<py::ssize_t>(lines->line_begin.size())}, false);
      },
      "First vertex of each line, then the number of vertices, (len + 1,) uint32, read-only.");
  defineColumn(lines_type, "closed", &L::closed, "1 of closed lines, (len,) uint8.");
  defineColumn(lines_type, "length", &L::length, "Length of each line, (len,) float64.");
  defineColumn(lines_type, "strength", &L::strength,
               "Integral of curvature along each line, no unit, (len,) float64.");
  define(m, type, "lines", &lines, kLinesDoc);
}

}  // namespace pcl_slim::python
