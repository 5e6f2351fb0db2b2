// SPDX-License-Identifier: BSD-3-Clause
// SensorNoise: the noise of a sensor, measured on one frame and used for the next ones.
#include "sensor_noise.h"

#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "options.h"
#include "work.h"

namespace pcl_slim::python {

namespace {

constexpr const char* kDoc = R"doc(SensorNoise()

The noise of a sensor, for the frames of one sensor: pass the same object with every frame,
smooth(points, viewpoint=(0, 0, 0), sensor_noise=noise). The first frame measures it; a later frame
uses it where its residuals agree with it, which takes a few milliseconds, and measures it anew where
they do not.

json       what is known as a JSON text, None before the first frame; SensorNoise.from_json reads it
check      of the last frame: 'measured', 'agrees', 'differs' or 'not_seen' (too few patches, or
           merged frames); None before the first one
ratio      residual of the last frame over that of the noise kept; None where none was compared)doc";

py::object checkOf(const KeptNoise& kept) {
  const NoiseStatistics last = kept.last();
  switch (last.sensor_check) {
    case SensorCheck::kAgrees: return py::str("agrees");
    case SensorCheck::kDiffers: return py::str("differs");
    case SensorCheck::kNotSeen: return py::str("not_seen");
    default: return last.patches > 0 ? py::object(py::str("measured")) : py::object(py::none());
  }
}

py::object ratioOf(const KeptNoise& kept) {
  const double ratio = kept.last().sensor_ratio;
  return ratio > 0 ? py::object(py::float_(ratio)) : py::object(py::none());
}

py::object jsonOf(const KeptNoise& kept) {
  const std::optional<SensorNoise> noise = kept.noise();
  return noise ? py::object(py::str(toJson(*noise))) : py::object(py::none());
}

KeptNoisePointer fromJson(const std::string& text) {
  Result<SensorNoise> noise = sensorNoiseFromJson(text, "the text");
  if (!noise) raise(noise.error());
  return std::make_shared<KeptNoise>(*noise);
}

}  // namespace

KeptNoisePointer takeSensorNoise(const py::object& value, FitParams& params) {
  if (value.is_none()) return nullptr;
  if (!py::isinstance<KeptNoise>(value))
    raiseValue("sensor_noise is no SensorNoise: pass a pcl_slim.SensorNoise()");
  KeptNoisePointer kept = value.cast<KeptNoisePointer>();
  params.keep_sensor_noise = true;
  params.sensor_noise = kept->noise();
  return kept;
}

void bindSensorNoise(py::module_& m) {
  py::class_<KeptNoise, KeptNoisePointer>(m, "SensorNoise", kDoc)
      .def(py::init<>())
      .def_static("from_json", &fromJson, py::arg("text"),
                  "Reads a JSON text, as of SensorNoise.json or a file of -save_noise.")
      .def_property_readonly("json", &jsonOf, "What is known, a JSON text; None before a frame.")
      .def_property_readonly("check", &checkOf,
                             "'measured', 'agrees', 'differs' or 'not_seen', of the last frame.")
      .def_property_readonly("ratio", &ratioOf,
                             "Residual of the last frame over that of the noise kept, or None.");
}

}  // namespace pcl_slim::python
