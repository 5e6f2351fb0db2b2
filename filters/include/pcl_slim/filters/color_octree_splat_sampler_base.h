// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/controlled_run.h"
#include "pcl_slim/splat/splat_sampling.h"

namespace pcl_slim {

/** \brief Parameters and results of ColorOctreeSplatSampler that do not depend on the point type.
 *
 * Of the number of splats and the target error, which exclude each other, the last one set counts:
 * its setter unsets the other. No other setter changes another parameter. Values are checked when
 * the sampler runs.
 */
class PCL_SLIM_EXPORT ColorOctreeSplatSamplerBase : public ControlledRun {
 public:
  // Parameters -----------------------------------------------------------------------------------

  /** \brief All parameters together. */
  void setParams(const SplatParams& params) { params_ = params; }
  const SplatParams& getParams() const { return params_; }

  /** \brief Cells of the initial grid along the box's longest side; 0 (default): as many as leave
   * about 50 points in a cell. Not used with setMaxSplats(), which chooses its own. */
  void setInitialResolution(int cells) { params_.initial_resolution = cells; }
  int getInitialResolution() const { return params_.initial_resolution; }

  /** \brief Standard deviation of unit normals from which a cell is divided (default 0.2, which is
   * a cap of 16 degrees about its middle). */
  void setGeometricError(double error) { params_.geometric_error = error; }
  double getGeometricError() const { return params_.geometric_error; }

  /** \brief Standard deviation of colour in CIELAB over 100 from which a cell is divided (default
   * 0.1); 1 and more: colour divides nothing. */
  void setColorError(double error) { params_.color_error = error; }
  double getColorError() const { return params_.color_error; }

  /** \brief The same in CIELAB's own units: setColorErrorDeltaE(10) is setColorError(0.1). */
  void setColorErrorDeltaE(double delta_e) { params_.color_error = delta_e / 100.0; }
  double getColorErrorDeltaE() const { return 100.0 * params_.color_error; }

  /** \brief Cells of fewer points stay whole (default 4). */
  void setMinPointsPerCell(unsigned int points) { params_.min_points = points; }
  unsigned int getMinPointsPerCell() const { return params_.min_points; }

  /** \brief Halvings of an initial cell at most (default 20); 0: the initial grid itself. */
  void setMaxDepth(int depth) { params_.max_depth = depth; }
  int getMaxDepth() const { return params_.max_depth; }

  /** \brief Most splats allowed: the best use of that many in place of tolerances; 0 is off
   * (default). */
  void setMaxSplats(std::uint64_t count) {
    if (count != 0) params_.target_error = 0;
    params_.max_splats = count;
  }
  std::uint64_t getMaxSplats() const { return params_.max_splats; }

  /** \brief Mean colour difference [Delta E] between points and their splats to reach with as few
   * splats as possible, in place of tolerances; 0 is off (default). */
  void setTargetError(double delta_e) {
    if (delta_e != 0) params_.max_splats = 0;
    params_.target_error = delta_e;
  }
  double getTargetError() const { return params_.target_error; }

  /** \brief The published method: discs to the cell's farthest corner, the kept point's own place
   * and colour, no guard against noise (default off). */
  void setPaperMode(bool paper) { params_.paper_mode = paper; }
  bool getPaperMode() const { return params_.paper_mode; }

  /** \brief Mean colour (default), mean and gradient, or the kept point's own. */
  void setSplatColor(SplatColor color) { params_.color = color; }
  SplatColor getSplatColor() const { return params_.color; }

  /** \brief How large discs become (default RadiusRule::kDensity). */
  void setRadiusRule(RadiusRule rule) { params_.radius = rule; }
  RadiusRule getRadiusRule() const { return params_.radius; }

  /** \brief Takes the measured noise of colours and normals off deviations (default on). */
  void setRemoveNoise(bool remove) { params_.remove_noise = remove; }
  bool getRemoveNoise() const { return params_.remove_noise; }

  /** \brief Neighbours behind each estimated normal, for clouds without (default 16). */
  void setNormalEstimationNeighbors(int k) { params_.normal_neighbors = k; }
  int getNormalEstimationNeighbors() const { return params_.normal_neighbors; }

  /** \brief The point that estimated normals face; not set: what is known of the cloud's sensor, as
   * for SLIMFit, or outward. */
  void setViewPoint(double x, double y, double z);
  /** \brief \return whether a viewpoint is set, and then writes it. */
  bool getViewPoint(double& x, double& y, double& z) const;
  void clearViewPoint() { params_.viewpoint.reset(); }

  /** \brief Threads to use; 0 (default) means all cores. Never changes the result. */
  void setNumberOfThreads(unsigned int threads = 0) { params_.threads = static_cast<int>(threads); }
  unsigned int getNumberOfThreads() const { return static_cast<unsigned int>(params_.threads); }

  // Results --------------------------------------------------------------------------------------

  /** \brief What the last run did and skipped. */
  const SplatStatistics& getStatistics() const { return statistics_; }

 protected:
  ColorOctreeSplatSamplerBase() = default;
  ~ColorOctreeSplatSamplerBase() = default;

  /** \brief Forgets the last run. */
  void clearResults();
  /** \brief Samples a cloud. \return false with error_ when it cannot. */
  bool run(const CloudView& cloud, const ColorView& colors, SplatSet& splats);

  SplatParams params_;
  SplatStatistics statistics_;
};

}  // namespace pcl_slim
