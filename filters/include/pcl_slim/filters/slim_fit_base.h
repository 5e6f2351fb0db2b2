// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/controlled_run.h"
#include "pcl_slim/filters/slim_fit_setters.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/scan/scan.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Where each point of a cloud was seen from, in the cloud's coordinates; shared, never
 * changed. */
using SensorPositions = std::shared_ptr<const std::vector<Eigen::Vector3d>>;
/** \brief Which of several merged frames each point of a cloud is from; shared, never changed. */
using FrameNumbers = std::shared_ptr<const std::vector<std::uint32_t>>;

/** \brief Parameters and results of SLIMFit that do not depend on the point type.
 *
 * params() has all parameters, which FitParams documents with their defaults; the usual ones have a
 * setter here, the others in SLIMFitSetters. Setters take 0 for a parameter that is not set. Of
 * parameters that exclude each other the last one set counts: its setter unsets the others, and
 * their getters say so. These are the six that set how fine the surface is (penalty, MDL threshold,
 * target error, target distance, surfels, noise factor), the noise (its level, the noise, a noise
 * model, a sensor's noise; local noise and the last two; correlation and a sensor's noise), and where the cloud was seen from (viewpoint, sensor
 * positions). No other setter changes another parameter. Values are checked when fit() runs.
 */
class PCL_SLIM_EXPORT SLIMFitBase : public ControlledRun, public SLIMFitSetters {
 public:
  // Parameters -----------------------------------------------------------------------------------

  /** \brief All parameters together. */
  void setParams(const FitParams& params) { params_ = params; }
  const FitParams& getParams() const { return params_; }
  /** \brief The same, to be changed in place: `fit.params().robust = true`. */
  FitParams& params() { return params_; }

  /** \brief Degree of the local polynomials, 1..4; 0 (default): 4, or 2 with sharp features. */
  void setPolynomialOrder(int order) { setParameter(params_, &FitParams::degree, order); }
  int getPolynomialOrder() const { return getParameter(params_, &FitParams::degree); }

  /** \brief Weight kappa > 0 of the price of a coefficient; larger is smoother. 0 (default): 3, or
   * 1 with sharp features. */
  void setPenalty(double penalty) { setParameter(params_, &PenaltyWeight::kappa, penalty); }
  double getPenalty() const { return getParameter(params_, &PenaltyWeight::kappa); }

  /** \brief The paper's T_MDL in place of the penalty; 0 goes back (default). */
  void setMDLThreshold(double t_mdl) { setParameter(params_, &MDLThreshold::t, t_mdl); }
  double getMDLThreshold() const { return getParameter(params_, &MDLThreshold::t); }

  /** \brief RMS residual to reach, as a share of the bounding box's diagonal, by solving for the
   * penalty; 0 is off (default). */
  void setTargetError(double error) { setParameter(params_, &TargetError::rms, error); }
  double getTargetError() const { return getParameter(params_, &TargetError::rms); }

  /** \brief The same in the cloud's unit; 0 is off (default). */
  void setTargetDistance(double rms) { setParameter(params_, &TargetDistance::rms, rms); }
  double getTargetDistance() const { return getParameter(params_, &TargetDistance::rms); }

  /** \brief Most leaves allowed, by solving for the penalty; 0 is off (default). */
  void setMaxSurfels(std::uint64_t count) { setParameter(params_, &MaxSurfels::leaves, count); }
  std::uint64_t getMaxSurfels() const { return getParameter(params_, &MaxSurfels::leaves); }

  /** \brief The point, in the cloud's coordinates, that normals face: those of the output when the
   * cloud has none, and estimated ones. Not set: they face what findSideEvidence() finds, as the
   * sensors of the points or of the cloud; else outward. */
  void setViewPoint(double x, double y, double z);
  /** \brief \return whether a viewpoint is set, and then writes it. */
  bool getViewPoint(double& x, double& y, double& z) const;
  void clearViewPoint() { params_.viewpoint.reset(); }
  /** \brief The same as setViewPoint(): one sensor position for all points. Unsets those of
   * setSensorPositions(). */
  void setSensorPosition(double x, double y, double z) { setViewPoint(x, y, z); }

  /** \brief Where each point of the input cloud was seen from, in the cloud's coordinates, as a
   * lidar on a car or in a hand records it. Without normals, each leaf faces the sensors of its
   * points, and the noise model uses each point's own beam. Points of one position are a frame
   * unless setFrameNumbers() says which are. One for each point, not for each index; points that
   * are NaN may have any. Not set (default, or an empty vector): fields vp_x vp_y vp_z of the point
   * type if they are not all zero and no viewpoint is set. Unsets the viewpoint. 24 bytes a point
   * here, and 12 while a fit runs. */
  void setSensorPositions(std::vector<Eigen::Vector3d> positions) {
    if (!positions.empty()) params_.viewpoint.reset();
    sensors_ = std::make_shared<const std::vector<Eigen::Vector3d>>(std::move(positions));
  }
  /** \brief The positions set, or null. */
  const SensorPositions& getSensorPositions() const { return sensors_; }
  void clearSensorPositions() { sensors_.reset(); }

  /** \brief Which of several merged frames each point of the input cloud is from, any number for
   * each frame. Points of different frames share no error of a depth camera: the noise of each
   * frame is measured alone. One for each point, not for each index. Not set (default, or an empty
   * vector): points of one position of setSensorPositions() are a frame. 4 bytes a point here, and
   * 4 while a fit runs. */
  void setFrameNumbers(std::vector<std::uint32_t> numbers) {
    frames_ = std::make_shared<const std::vector<std::uint32_t>>(std::move(numbers));
  }
  /** \brief The numbers set, or null. */
  const FrameNumbers& getFrameNumbers() const { return frames_; }
  void clearFrameNumbers() { frames_.reset(); }

  /** \brief Seed of the order in which centres are tried (default 1). */
  void setSeed(std::uint64_t seed) { params_.seed = seed; }
  std::uint64_t getSeed() const { return params_.seed; }

  /** \brief Threads to use; 0 (default) means all cores. Never changes the result. */
  void setNumberOfThreads(unsigned int threads = 0) { params_.threads = static_cast<int>(threads); }
  unsigned int getNumberOfThreads() const { return static_cast<unsigned int>(params_.threads); }

  // Results --------------------------------------------------------------------------------------

  /** \brief What the last fit() did and skipped. */
  const FitStatistics& getStatistics() const { return statistics_; }
  /** \brief Indices of the points that the last fit() left out as outliers, ascending; of equal
   * points the first. */
  const std::vector<std::int32_t>& getOutliers() const { return outliers_; }
  /** \brief What the last fit() found in its input. */
  const PointStoreStatistics& getInputStatistics() const { return input_statistics_; }

 protected:
  SLIMFitBase() = default;
  ~SLIMFitBase() = default;

  /** \brief Forgets the last run. */
  void clearResults();
  /** \brief Fits, and keeps what the getters of results return. */
  Error fitAndKeep(const ScanView& scan, const FitParams& params, FittedScan& fitted);
  /** \brief The same for a class that keeps nothing but the surface. \return whether there is one;
   * getError() gives the reason if not. */
  bool run(const ScanView& scan, FitParams params, SLIMSurface& surface);

  SensorPositions sensors_;
  FrameNumbers frames_;
  FitStatistics statistics_;
  std::vector<std::int32_t> outliers_;
  PointStoreStatistics input_statistics_;
};

}  // namespace pcl_slim
