// SPDX-License-Identifier: BSD-3-Clause
#include "scan_state.h"

#include <string>
#include <utility>

namespace pcl_slim::python {

namespace {

constexpr double kShareOfFit = 0.8;  ///< of the time of a fit and a projection

/** Fits, unless a surface is given. */
Error fitFirst(ScanState& s, Work& work) {
  if (s.given) return {};
  work.part(0, kShareOfFit);
  Error error = fitScan({s.view(), {}}, s.params, s.fitted, work.progress());
  if (!error && s.sensor_noise) s.sensor_noise->take(s.fitted.statistics.noise);
  work.part(kShareOfFit, 1);
  return error;
}

}  // namespace

Error fitAndProject(ScanState& s, bool keep, Work& work) {
  Error error = fitFirst(s, work);
  s.no_surface = error.code == ErrorCode::kNoSurface;
  if (error && !(keep && s.no_surface)) return error;
  const auto origin = s.given ? SurfaceOrigin::kGiven : SurfaceOrigin::kFitted;
  auto made =
      projectScan(s.view(), s.surface(), origin, s.params, s.wanted, work.progress(), s.store());
  if (!made) return made.error();
  s.projection = std::move(*made);
  return {};
}

std::shared_ptr<ScanState> readState(const py::object& points, const py::object& normals,
                                     const SurfacePointer& own, Keywords& keywords) {
  auto state = std::make_shared<ScanState>();
  ScanArguments arguments{points, normals};
  state->params = keywords.takeFit(FitUse::kPoints);
  state->sensor_noise = keywords.sensorNoise();
  keywords.takeScan(arguments, state->params);
  if (own) {
    state->given = own->shared();
  } else if (const py::object given = keywords.take("surface"); !given.is_none()) {
    if (!py::isinstance<Surface>(given))
      raiseValue("surface is no Surface: pass one of pcl_slim.fit or pcl_slim.load");
    state->given = given.cast<SurfacePointer>()->shared();
  }
  if (state->given) keywords.refuseWithSurface();
  if (Error error = state->params.validate()) raise(error);
  state->scan = readScan(arguments);
  return state;
}

void define(py::module_& m, py::class_<Surface, SurfacePointer>& type, const char* name,
            ScanFunction function, const char* doc) {
  m.def(
      name,
      [function](const py::object& points, const py::object& normals, const py::kwargs& given) {
        return function(points, normals, nullptr, given);
      },
      py::arg("points"), py::arg("normals") = py::none(), doc);
  const std::string method =
      std::string("The same as pcl_slim.") + name + " with surface=self, without a fit.\n\n" + doc;
  type.def(
      name,
      [function](const SurfacePointer& self, const py::object& points, const py::object& normals,
                 const py::kwargs& given) { return function(points, normals, self, given); },
      py::arg("points"), py::arg("normals") = py::none(), method.c_str());
}

}  // namespace pcl_slim::python
