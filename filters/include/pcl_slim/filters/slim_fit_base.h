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
 * One setter and getter for each parameter; 0 means that it is not set where FitParams has an
 * optional. No setter changes another parameter, but of the five that set how fine the surface is
 * (penalty, MDL threshold, target error, surfels, noise factor) the last one set counts. Values are
 * checked when fit() runs. FitParams documents each and its default.
 */
class PCL_SLIM_EXPORT SLIMFitBase : public ControlledRun {
 public:
  // Parameters -----------------------------------------------------------------------------------

  /** \brief All parameters together. */
  void setParams(const FitParams& params) { params_ = params; }
  const FitParams& getParams() const { return params_; }

  /** \brief Degree of the local polynomials, 1..4; 0 (default): 4, or 2 with sharp features. */
  void setPolynomialOrder(int order) { params_.degree = unlessZero(order); }
  int getPolynomialOrder() const { return params_.degree.value_or(0); }

  /** \brief Weight kappa > 0 of the price of a coefficient; larger is smoother. 0 (default): 3, or
   * 1 with sharp features. */
  void setPenalty(double penalty) { setSize(PenaltyWeight{penalty}, penalty != 0); }
  double getPenalty() const {
    const auto* rule = std::get_if<PenaltyWeight>(&params_.size);
    return rule ? rule->kappa.value_or(0) : 0;
  }

  /** \brief The paper's T_MDL in place of the penalty; 0 goes back (default). */
  void setMDLThreshold(double t_mdl) { setSize(MDLThreshold{t_mdl}, t_mdl != 0); }
  double getMDLThreshold() const { return sizeOr0(&MDLThreshold::t); }

  /** \brief RMS residual to reach, as a share of the bounding box's diagonal, by solving for the
   * penalty; 0 is off (default). */
  void setTargetError(double error) { setSize(TargetError{error}, error != 0); }
  double getTargetError() const { return sizeOr0(&TargetError::rms); }

  /** \brief Most leaves allowed, by solving for the penalty; 0 is off (default). */
  void setMaxSurfels(std::uint64_t count) { setSize(MaxSurfels{count}, count != 0); }
  std::uint64_t getMaxSurfels() const { return sizeOr0(&MaxSurfels::leaves); }

  /** \brief Fits as if the noise variance were this multiple of what it is, so that residuals may
   * be larger and the penalty weighs more: what a target error or a number of surfels solves for. 0
   * is off (default). */
  void setNoiseFactor(double factor) { setSize(NoiseFactor{factor}, factor != 0); }
  double getNoiseFactor() const { return sizeOr0(&NoiseFactor::factor); }

  /** \brief Noise variance as a share of the squared diagonal; 0 estimates it (default). */
  void setNoiseLevel(double lambda) { params_.lambda = unlessZero(lambda); }
  double getNoiseLevel() const { return params_.lambda.value_or(0); }

  /** \brief alpha in (0, 1]: leaves cover the points within alpha r (1: compact); 0, the default:
   * 2/3, and .55 for leaves of a large effective count. */
  void setCoverRadius(double alpha) { params_.cover_radius = unlessZero(alpha); }
  double getCoverRadius() const { return params_.cover_radius.value_or(0); }

  /** \brief gamma > 0: a point is covered from this sum of weights on (default 0.1). */
  void setCoverThreshold(double gamma) { params_.cover_threshold = gamma; }
  double getCoverThreshold() const { return params_.cover_threshold; }

  /** \brief Least radius of the balls, in the cloud's units: no finer detail is kept; 0, the
   * default, is no bound. The rims of sharp edges become as wide. */
  void setLeastRadius(double radius) { params_.least_radius = unlessZero(radius); }
  double getLeastRadius() const { return params_.least_radius.value_or(0); }

  /** \brief Keeps sharp edges (default off); without normals it has no effect, with a warning. */
  void setSharpFeatures(bool sharp) { params_.sharp_features = sharp; }
  bool getSharpFeatures() const { return params_.sharp_features; }

  /** \brief Fits points that are far from all others, too (default off: findOutliers() finds them,
   * and they are not fitted). */
  void setKeepOutliers(bool keep) { params_.keep_outliers = keep; }
  bool getKeepOutliers() const { return params_.keep_outliers; }

  /** \brief Reweights residuals against outliers (default off). */
  void setRobust(bool robust) { params_.robust = robust; }
  bool getRobust() const { return params_.robust; }

  /** \brief Measures noise along the cloud (true) or once for all of it (false). Unset (default),
   * it is measured along the cloud where neighbouring points share their errors, and where some
   * parts are noisier, so that a fit would take their noise for detail. */
  void setLocalNoise(std::optional<bool> local) { params_.local_noise = local; }
  std::optional<bool> getLocalNoise() const { return params_.local_noise; }
  /** \brief Without normals and viewpoint: gives points a side each before the fit where balls
   * would contain both sides of thin parts; on unless set. */
  void setSides(bool sides) { params_.sides = sides; }
  bool getSides() const { return params_.sides; }

  /** \brief Number of neighbouring points that share one error, as the pixels of a depth camera do.
   * 0 (default): estimated from the data; 1: independent errors. */
  void setNoiseCorrelation(double points) { params_.noise_correlation = unlessZero(points); }
  double getNoiseCorrelation() const { return params_.noise_correlation.value_or(0); }

  /** \brief RMS error a + b z + c z^2 along the ray from the viewpoint at distance z, in the
   * cloud's units, in place of noise measured on the points. Needs setViewPoint(),
   * setSensorPositions() or a cloud with a sensor position. */
  void setNoiseModel(double a, double b, double c);
  /** \brief \return whether a model is set, and then writes it. */
  bool getNoiseModel(double& a, double& b, double& c) const;
  void clearNoiseModel() { params_.noise_model.reset(); }

  /** \brief Fits positions and normals together, each weighted by its error (default off: normals
   * give sides and directions). For normals measured independently of the points, as by photometric
   * stereo or a simulation; those computed from the points contain no new information. */
  void setNormalsAsData(bool data) { params_.normals_as_data = data; }
  bool getNormalsAsData() const { return params_.normals_as_data; }

  /** \brief RMS error of normals used as data, in (0, pi/2] radians. 0 (default) measures it, and
   * leaves normals that follow the points' own noise aside (FitStatistics::normals_follow_points).
   */
  void setNormalError(double radians) { params_.normal_error = unlessZero(radians); }
  double getNormalError() const { return params_.normal_error.value_or(0); }

  /** \brief Makes trim maps: drawn, the surface ends where its data end, and has their holes
   * (default on for SLIMFit, off for classes that move points only). */
  void setTrimming(bool trim) { params_.trim = trim; }
  bool getTrimming() const { return params_.trim; }

  /** \brief Diameter of the smallest hole that trimming keeps, in spacings of the points, 2 to 50
   * (default 4); smaller ones are closed. */
  void setHoleSize(double spacings) { params_.hole_size = spacings; }
  double getHoleSize() const { return params_.hole_size; }

  /** \brief Without normals: gives the surface one consistent side (default on). */
  void setOrientation(bool orient) { params_.orient = orient; }
  bool getOrientation() const { return params_.orient; }

  /** \brief The point, in the cloud's coordinates, that normals face: those of the output when the
   * cloud has none, and estimated ones. Not set: they face the sensors of the points or of the
   * cloud, where these are known; else the leaves' graph decides. */
  void setViewPoint(double x, double y, double z);
  /** \brief \return whether a viewpoint is set, and then writes it. */
  bool getViewPoint(double& x, double& y, double& z) const;
  void clearViewPoint() { params_.viewpoint.reset(); }
  /** \brief The same as setViewPoint(): one sensor position for all points. */
  void setSensorPosition(double x, double y, double z) { setViewPoint(x, y, z); }

  /** \brief Where each point of the input cloud was seen from, in the cloud's coordinates, as a
   * lidar on a car or in a hand records it. Without normals, each leaf faces the sensors of its
   * points, and the noise model uses each point's own beam; the graph of leaves is not searched.
   * Points of one position are a frame unless setFrameNumbers() says which are. One for each point,
   * not for each index; points that are NaN may have any. Not set (default, or an empty vector):
   * fields vp_x vp_y vp_z of the point type if they are not all zero. Together with a viewpoint the
   * run fails. 24 bytes a point here, and 12 while a fit runs. */
  void setSensorPositions(std::vector<Eigen::Vector3d> positions) {
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

  /** \brief The choices of Ohtake, Belyaev, Alexa 2005 throughout (default off). */
  void setPaperMode(bool paper) { params_.paper_mode = paper; }
  bool getPaperMode() const { return params_.paper_mode; }

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
  bool run(const ScanView& scan, const FitParams& params, SLIMSurface& surface);

  FitParams params_;
  SensorPositions sensors_;
  FrameNumbers frames_;
  FitStatistics statistics_;
  std::vector<std::int32_t> outliers_;
  PointStoreStatistics input_statistics_;

 private:
  template <typename Rule>
  void setSize(const Rule& rule, bool given) {
    if (given)
      params_.size = rule;
    else if (std::holds_alternative<Rule>(params_.size))
      params_.size = {};
  }

  template <typename Rule, typename Number>
  Number sizeOr0(Number Rule::*value) const {
    const auto* rule = std::get_if<Rule>(&params_.size);
    return rule ? rule->*value : Number{0};
  }
};

}  // namespace pcl_slim
