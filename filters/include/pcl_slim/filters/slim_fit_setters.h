// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <tuple>

#include "pcl_slim/fit/fit_parameters.h"

namespace pcl_slim {

#define PCL_SLIM_PARAMETER(Value, Name, member) \
  void set##Name(Value value) {                 \
    setParameter(params_, &member, value);      \
  }                                             \
  Value get##Name() const {                     \
    return getParameter(params_, &member);      \
  }

/** \brief A setter and a getter for each parameter that SLIMFitBase has in params() only.
 *
 * FitParams documents each and its default; 0 unsets a parameter where FitParams has an optional.
 */
class SLIMFitSetters {
 public:
  PCL_SLIM_PARAMETER(double, NoiseFactor, NoiseFactor::factor)
  PCL_SLIM_PARAMETER(double, CoverRadius, FitParams::cover_radius)
  PCL_SLIM_PARAMETER(double, CoverThreshold, FitParams::cover_threshold)
  PCL_SLIM_PARAMETER(double, LeastRadius, FitParams::least_radius)
  PCL_SLIM_PARAMETER(bool, SharpFeatures, FitParams::sharp_features)
  PCL_SLIM_PARAMETER(bool, KeepOutliers, FitParams::keep_outliers)
  PCL_SLIM_PARAMETER(bool, Robust, FitParams::robust)
  PCL_SLIM_PARAMETER(bool, Sides, FitParams::sides)
  PCL_SLIM_PARAMETER(bool, NormalsAsData, FitParams::normals_as_data)
  PCL_SLIM_PARAMETER(double, NormalError, FitParams::normal_error)
  PCL_SLIM_PARAMETER(bool, Trimming, FitParams::trim)
  PCL_SLIM_PARAMETER(double, HoleSize, FitParams::hole_size)
  PCL_SLIM_PARAMETER(bool, Orientation, FitParams::orient)
  PCL_SLIM_PARAMETER(bool, PaperMode, FitParams::paper_mode)

  // Noise: of these the last one set counts, and unsets those that it excludes.

  /** \brief Number of points that share an error: FitParams::noise_correlation; 0 (default):
   * measured. */
  void setNoiseCorrelation(double points) {
    if (points != 0) params_.sensor_noise.reset();
    setParameter(params_, &FitParams::noise_correlation, points);
  }
  double getNoiseCorrelation() const {
    return getParameter(params_, &FitParams::noise_correlation);
  }

  /** \brief Variance of the noise, as a share of the squared box diagonal: FitParams::lambda; 0
   * (default): measured. */
  void setNoiseLevel(double lambda) { setNoiseBy(&FitParams::lambda, lambda); }
  double getNoiseLevel() const { return getParameter(params_, &FitParams::lambda); }
  /** \brief RMS error of the points, in the cloud's units: FitParams::noise; 0 (default): measured.
   */
  void setNoise(double sigma) { setNoiseBy(&FitParams::noise, sigma); }
  double getNoise() const { return getParameter(params_, &FitParams::noise); }
  /** \brief Whether the noise is measured along the scan, not once for all of it:
   * FitParams::local_noise; not set (default): decided by the data. True excludes a noise model and
   * a sensor's noise. */
  void setLocalNoise(std::optional<bool> local) {
    if (local.value_or(false)) params_.noise_model.reset();
    if (local.value_or(false)) params_.sensor_noise.reset();
    params_.local_noise = local;
  }
  std::optional<bool> getLocalNoise() const { return params_.local_noise; }
  /** \brief RMS error a + b z + c z^2 along the ray at distance z from the sensor:
   * FitParams::noise_model. */
  void setNoiseModel(double a, double b, double c) {
    params_.lambda.reset();
    params_.noise.reset();
    if (params_.local_noise.value_or(false)) params_.local_noise.reset();
    params_.sensor_noise.reset();
    params_.noise_model = {a, b, c};
  }
  /** \brief \return whether a model is set, and then writes it. */
  bool getNoiseModel(double& a, double& b, double& c) const {
    if (params_.noise_model) std::tie(a, b, c) = std::tuple_cat(*params_.noise_model);
    return params_.noise_model.has_value();
  }
  /** \brief Returns to a measured noise. */
  void clearNoiseModel() { params_.noise_model.reset(); }

  /** \brief The noise of the sensor, as an earlier frame showed it: FitParams::sensor_noise. It is
   * used where the cloud agrees with it, else the noise is measured. */
  void setSensorNoise(const SensorNoise& noise) {
    params_.lambda.reset();
    params_.noise.reset();
    params_.noise_model.reset();
    params_.noise_correlation.reset();
    if (params_.local_noise.value_or(false)) params_.local_noise.reset();
    params_.sensor_noise = noise;
  }
  /** \brief The noise set or, with setKeepSensorNoise(), that of the last run; none: the next run
   * measures it. */
  const std::optional<SensorNoise>& getSensorNoise() const { return params_.sensor_noise; }
  /** \brief Returns to a measured noise. */
  void clearSensorNoise() { params_.sensor_noise.reset(); }
  /** \brief Whether each run keeps the noise of the sensor for the next one, for the frames of one
   * sensor (default false): getSensorNoise() returns it after a run. It is measured in the first
   * run, and again where a cloud does not agree with it. */
  void setKeepSensorNoise(bool keep) { params_.keep_sensor_noise = keep; }
  bool getKeepSensorNoise() const { return params_.keep_sensor_noise; }

 private:
  /** \brief Sets noise or lambda; a value unsets the other, the noise model and the sensor's noise.
   */
  void setNoiseBy(std::optional<double> FitParams::*member, double value) {
    if (value != 0) {
      params_.lambda.reset();
      params_.noise.reset();
      params_.noise_model.reset();
      params_.sensor_noise.reset();
    }
    setParameter(params_, member, value);
  }

 protected:
  SLIMFitSetters() = default;
  ~SLIMFitSetters() = default;

  FitParams params_;
};

#undef PCL_SLIM_PARAMETER

}  // namespace pcl_slim
