// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <optional>

#include "pcl_slim/fit/fit.h"
#include "pcl_slim/fit/sensor_noise.h"

namespace pcl_slim::python {

namespace py = pybind11;

/** \brief SensorNoise of Python: the noise of a sensor from one frame to the next. Threads may share
 * it. */
class KeptNoise {
 public:
  KeptNoise() = default;
  explicit KeptNoise(SensorNoise noise) : noise_(std::move(noise)) {}

  std::optional<SensorNoise> noise() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return noise_;
  }
  NoiseStatistics last() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return last_;
  }
  /** \brief Takes what a fit found. */
  void take(const NoiseStatistics& found) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (found.sensor_noise) noise_ = found.sensor_noise;
    last_ = found;
  }

 private:
  mutable std::mutex mutex_;
  std::optional<SensorNoise> noise_;
  NoiseStatistics last_;
};

using KeptNoisePointer = std::shared_ptr<KeptNoise>;

/** \brief Sets a fit's parameters from a keyword's value: a SensorNoise or None. \return it, or null */
KeptNoisePointer takeSensorNoise(const py::object& value, FitParams& params);

void bindSensorNoise(py::module_& m);

}  // namespace pcl_slim::python
