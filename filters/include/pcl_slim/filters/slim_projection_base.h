// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/types.h>

#include <string>

#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/given_surface.h"
#include "pcl_slim/filters/slim_fit_base.h"
#include "pcl_slim/query/cloud_projection.h"

namespace pcl_slim {

/** \brief What SLIMProjectionSmoother, SLIMCurvatureEstimation and SLIMColorizer have in common:
 * every parameter of a fit, a surface to use in its place, and the results for the points. A given
 * surface that supports less than a tenth of the points is refused as another object's. */
class PCL_SLIM_EXPORT SLIMProjectionBase : public SLIMFitBase, public GivenSurface {
 public:
  // Results --------------------------------------------------------------------------------------

  /** \brief How many points the last run moved, and how far. getStatistics() describes its fit. */
  const CloudProjectionStatistics& getProjectionStatistics() const { return projection_; }
  /** \brief Root mean square of the moved points' displacements, cloud units. */
  double getRMSDisplacement() const { return projection_.rms_displacement; }
  /** \brief Largest displacement, cloud units. */
  double getMaxDisplacement() const { return projection_.max_displacement; }
  /** \brief Indices, in the input cloud, of finite points that no surfel supports. */
  const pcl::Indices& getUnsupported() const { return unsupported_; }
  /** \brief Indices, in the input cloud, of points that were moved to places beyond the surface's
   * borders: it has none there to be drawn. Needs trim maps: those of a given surface, or
   * setTrimming(). No point is dropped for it. */
  const pcl::Indices& getOutside() const { return outside_; }

 protected:
  /** \brief Points move alike with trim maps and without: none are made unless requested.
   * \param[in] keeps_points points that are no surface stay as they are: a warning, no error. */
  explicit SLIMProjectionBase(bool keeps_points = false) : keeps_points_(keeps_points) {
    params_.trim = false;
  }
  ~SLIMProjectionBase() = default;

  /** \brief Whether the last run, a smoothing, found no surface in the points and left all as they
   * are; getWarning() says why. */
  bool foundNoSurface() const { return no_surface_; }
  /** \brief Forgets the last run. */
  void clearResults();

  /** \brief Fits, unless a surface is given, and projects.
   * \param[in] points what to project; \param[in] fitted what to fit to, the same object if it is
   * the same cloud; \param[in] fit parameters, those of the setters but for what a class adds;
   * \param[in] colors of the fitted points, which a fitted surface gets, or none. */
  bool project(const CloudView& points, const CloudView& fitted, FitParams fit,
               const ProjectionParams& requested, CloudProjection& projection,
               const ColorView& colors = {});

  /** \brief Projects other points onto the surface of the last run. */
  bool projectMore(const CloudView& points, const ProjectionParams& requested,
                   CloudProjection& projection);

 private:
  Error fitAndProject(const CloudView& points, const ScanView& fitted, bool same,
                      const FitParams& fit, const ProjectionParams& requested,
                      CloudProjection& projection);
  Result<CloudProjection> projectOnFit(const CloudView& points, const ScanView& fitted, bool same,
                                       const FitParams& fit, const ProjectionParams& requested);

  bool keeps_points_;
  bool no_surface_ = false;
  CloudProjectionStatistics projection_;
  pcl::Indices unsupported_, outside_;
};

}  // namespace pcl_slim
