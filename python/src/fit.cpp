// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim.fit().
#include <pybind11/stl.h>

#include <utility>

#include "arrays.h"
#include "options.h"
#include "pcl_slim/scan/scan.h"
#include "surface.h"
#include "work.h"

namespace pcl_slim::python {

namespace {

constexpr const char* kFitDoc =
    R"doc(fit(points, normals=None, colors=None, *, viewpoint=None, sensors=None, frames=None, noise=None,
    degree=None, penalty=None, target_error=None, threads=0, progress=None, **options) -> Surface

Fits a SLIM surface to a scan. The defaults need no tuning, and are those of pcl_slim_fit.

points      (n, 3) float32 or float64, any unit; or a structured array with fields x, y, z. Rows with
            NaN or infinity are left out. C order, or any stride between rows: nothing is copied
normals     (n, 3), any length; they give the side, and one of length 0 counts as missing
colors      (n, 3) red, green, blue: uint8, or numbers from 0 to 1, 255 or 65535
viewpoint   (x, y, z) that the surface faces, where there are no normals
sensors     (n, 3) float32 or float64: where each point was seen from
frames      (n,) whole numbers: the frame of each point of several that were merged
noise       RMS error of the points, in their unit; None: estimated
degree      of the polynomials, 1 to 4; None: 4, with sharp 2
penalty     price of a coefficient; None: 3; larger is smoother
target_error  RMS residual to reach, share of the box diagonal, in place of penalty
sensor_noise  SensorNoise() shared by the frames of one sensor: measured once, checked by each later one
threads     0: all cores; never changes the result
progress    called with the share done (float) and the stage (str), about 20 times a second

Further options have the meaning of the program's: t_mdl, target_distance, max_surfels, noise_factor,
least_radius, sharp, outliers, robust, local_noise, sides, correlation, noise_model, normals_as_data,
normal_error, paper, compact, lambda_, seed, trim, hole.

Raises ValueError for input and options that cannot be used, NoSurfaceError (a RuntimeError) for
points that are nowhere a surface.)doc";

SurfacePointer fit(const py::object& points, const py::object& normals, const py::object& colors,
                   const py::kwargs& given) {
  struct State {
    Scan scan;
    FitParams params;
    FittedScan fitted;
    KeptNoisePointer sensor_noise;
  };
  Keywords keywords("fit", given);
  auto state = std::make_shared<State>();
  ScanArguments arguments{points, normals, colors};
  state->params = keywords.takeFit(FitUse::kSurface);
  state->sensor_noise = keywords.sensorNoise();
  keywords.takeScan(arguments, state->params);
  const py::object progress = keywords.take("progress");
  keywords.finish();
  if (Error error = state->params.validate()) raise(error);
  state->scan = readScan(arguments);
  run(progress, state, [s = state.get()](Work& work) {
    Error error =
        fitScan({s->scan.view(), s->scan.colors()}, s->params, s->fitted, work.progress());
    if (!error && s->sensor_noise) s->sensor_noise->take(s->fitted.statistics.noise);
    return error;
  });
  auto surface = std::make_shared<Surface>(std::move(state->fitted.surface));
  describeFit(state->fitted.store, state->params, state->fitted.statistics, *surface);
  return surface;
}

}  // namespace

void bindFit(py::module_& m) {
  m.def("fit", &fit, py::arg("points"), py::arg("normals") = py::none(),
        py::arg("colors") = py::none(), kFitDoc);
}

}  // namespace pcl_slim::python
