// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim.splats() and the discs that it returns.
#include "splats.h"

#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "arrays.h"
#include "options.h"
#include "work.h"

namespace pcl_slim::python {

namespace {

constexpr const char* kSplatsDoc =
    R"doc(splats(points, colors=None, normals=None, *, max_splats=None, target_error=None, geo=.2, color=.1,
       min_points=4, max_depth=20, initial=0, colors_from='mean', radius='density', remove_noise=True,
       estimate_normals=16, paper=False, viewpoint=None, sensors=None, threads=0, progress=None) -> Splats

Thins a coloured scan to discs that cover its surface without holes, as pcl_color_splat_sampling
does. points and normals as for pcl_slim.fit, colors (n, 3). max_splats: the best picture by at most
so many; target_error: the mean colour difference to reach [Delta E]; without either, cells are
divided where unit normals deviate by geo or colours by color [CIELAB / 100]. colors_from: 'mean',
'gradient' or 'own'. radius: 'density', 'neighbours' or 'corner'. The others are the program's.)doc";

constexpr const char* kClassDoc =
    R"doc(Coloured discs that cover a surface, columns of equal length.

positions (n, 3) float64 in the coordinates of the points, normals (n, 3) float32, radius (n,)
float32, colors (n, 3) uint8, confidence (n,) float32: the number of points behind a disc, kept (n,)
uint32: the row of the point that stands for it.)doc";

SplatParams readParams(Keywords& keywords) {
  constexpr auto kMany = std::int64_t{1000000000000000000};
  SplatParams p;
  p.max_splats = static_cast<std::uint64_t>(keywords.takeInteger("max_splats", 0, kMany, 0));
  p.target_error = keywords.takeNumber("target_error", 0, 1e6, 0);
  p.geometric_error = keywords.takeNumber("geo", 0, 1e6, p.geometric_error);
  p.color_error = keywords.takeNumber("color", 0, 1e6, p.color_error);
  p.min_points =
      static_cast<std::uint32_t>(keywords.takeInteger("min_points", 0, 0xffffffff, p.min_points));
  p.max_depth = static_cast<int>(keywords.takeInteger("max_depth", 0, 1000000, p.max_depth));
  p.initial_resolution =
      static_cast<int>(keywords.takeInteger("initial", 0, RootGrid::kMaxResolution, 0));
  p.remove_noise = keywords.takeSwitch("remove_noise", true);
  p.normal_neighbors =
      static_cast<int>(keywords.takeInteger("estimate_normals", 3, 10000, p.normal_neighbors));
  p.paper_mode = keywords.takeSwitch("paper", false);
  const std::string color = keywords.takeWord("colors_from", {"mean", "gradient", "own"}, "mean");
  p.color = color == "gradient" ? SplatColor::kGradient
            : color == "own"    ? SplatColor::kOwn
                                : SplatColor::kMean;
  const std::string radius =
      keywords.takeWord("radius", {"density", "neighbours", "corner"}, "density");
  p.radius = radius == "neighbours" ? RadiusRule::kNeighbors
             : radius == "corner"   ? RadiusRule::kCorner
                                    : RadiusRule::kDensity;
  p.threads = keywords.takeThreads();
  if (p.max_splats > 0 && p.target_error > 0)
    raiseValue("max_splats and target_error exclude each other: give one");
  return p;
}

SplatsPointer sample(const py::object& points, const py::object& colors, const py::object& normals,
                     const py::kwargs& given) {
  struct State {
    Scan scan;
    SplatParams params;
    SplatsPointer splats = std::make_shared<Splats>();
  };
  Keywords keywords("splats", given);
  auto state = std::make_shared<State>();
  state->params = readParams(keywords);
  ScanArguments arguments{points, normals, colors};
  FitParams sensor;
  keywords.takeScan(arguments, sensor);
  state->params.viewpoint = sensor.viewpoint;
  const py::object progress = keywords.take("progress");
  keywords.finish();
  if (Error error = state->params.validate()) raise(error);
  state->scan = readScan(arguments);
  run(progress, state, [s = state.get()](Work& work) {
    return sampleSplats(s->scan.view(), s->scan.colors(), s->params, s->splats->set,
                        &s->splats->statistics, work.progress());
  });
  return state->splats;
}

py::ssize_t sizeOf(const Splats& splats) {
  return static_cast<py::ssize_t>(splats.set.size());
}

py::array_t<double> positionsOf(const Splats& splats) {
  const SplatSet& s = splats.set;
  auto array = newArray<double>({sizeOf(splats), 3});
  double* to = array.mutable_data();
  for (std::size_t i = 0; i < s.size(); ++i) {
    *to++ = s.origin[0] + static_cast<double>(s.x[i]);
    *to++ = s.origin[1] + static_cast<double>(s.y[i]);
    *to++ = s.origin[2] + static_cast<double>(s.z[i]);
  }
  return array;
}

py::array_t<float> normalsOf(const Splats& splats) {
  const SplatSet& s = splats.set;
  auto array = newArray<float>({sizeOf(splats), 3});
  float* to = array.mutable_data();
  for (std::size_t i = 0; i < s.size(); ++i) {
    *to++ = s.nx[i];
    *to++ = s.ny[i];
    *to++ = s.nz[i];
  }
  return array;
}

py::array_t<std::uint8_t> colorsOf(const Splats& splats) {
  auto array = newArray<std::uint8_t>({sizeOf(splats), 3});
  std::uint8_t* to = array.mutable_data();
  for (const std::uint32_t rgb : splats.set.rgb) {
    for (const int shift : {16, 8, 0}) *to++ = static_cast<std::uint8_t>(rgb >> shift & 255u);
  }
  return array;
}

template <typename T>
py::array columnOf(const SplatsPointer& splats, const std::vector<T>& values) {
  return viewOf(splats, values.data(), {sizeOf(*splats)});
}

std::string describe(const Splats& splats) {
  return "<pcl_slim.Splats: " + std::to_string(splats.set.size()) + " discs of " +
         std::to_string(splats.statistics.points) + " points" +
         (splats.set.hasColors() ? ", coloured>" : ">");
}

}  // namespace

void bindSplats(py::module_& m, py::class_<Splats, SplatsPointer>& type) {
  type.doc() = kClassDoc;
  type.def("__len__", [](const Splats& s) { return s.set.size(); })
      .def("__repr__", &describe)
      .def_property_readonly("positions", &positionsOf, "Centres, (n, 3) float64.")
      .def_property_readonly("normals", &normalsOf, "Unit normals, (n, 3) float32.")
      .def_property_readonly("colors", &colorsOf, "Red, green, blue, (n, 3) uint8.")
      .def_property_readonly(
          "radius", [](const SplatsPointer& s) { return columnOf(s, s->set.radius); },
          "Radii [unit of the points], (n,) float32.")
      .def_property_readonly(
          "confidence", [](const SplatsPointer& s) { return columnOf(s, s->set.confidence); },
          "Number of points behind each disc, (n,) float32.")
      .def_property_readonly(
          "kept", [](const SplatsPointer& s) { return columnOf(s, s->set.kept); },
          "Row of the point that stands for each disc, (n,) uint32.");
  m.def("splats", &sample, py::arg("points"), py::arg("colors") = py::none(),
        py::arg("normals") = py::none(), kSplatsDoc);
}

}  // namespace pcl_slim::python
