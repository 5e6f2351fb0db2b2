// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/features/crest_lines.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/query/cloud_projection.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief A scan owned by someone else: points with what is known of them, and their colours. */
struct ScanView {
  CloudView points;
  ColorView colors;  ///< one for each of the points, or none
};

/** \brief A scan's points and the surface fitted to them. */
struct FittedScan {
  PointStore store;  ///< with the sides that the fit gave to points without normals
  SLIMSurface surface;
  FitStatistics statistics;
  double color_seconds = 0;  ///< wall time of fitting colours [s]
};

/** \brief Fits a surface to a scan and gives it the scan's colours, if there are any.
 *
 * \param[out] fitted complete after success. After ErrorCode::kNoSurface the surface is empty, and
 * store and statistics are complete, for callers that keep points that are no surface.
 * \return an error of the parameters, of the points, or of fitSurface(). O(points); the same for
 * any number of threads. */
PCL_SLIM_EXPORT Error fitScan(const ScanView& scan, const FitParams& params, FittedScan& fitted,
                              Progress* progress = nullptr);

/** \brief The same for a scan whose store is built already. \param[in,out] fitted contains it. */
PCL_SLIM_EXPORT Error fitStoredScan(const ScanView& scan, const FitParams& params,
                                    FittedScan& fitted, Progress* progress = nullptr);

/** \brief Where the surface that a scan is projected onto comes from. */
enum class SurfaceOrigin : unsigned char {
  kFitted,  ///< a fit to this scan
  kGiven    ///< another run: it is refused where it supports less than a tenth of the points
};

/** \brief Projects a scan's points onto a surface; see CloudProjection::make().
 *
 * \param[in] fit gives threads, viewpoint and sharp features; \param[in] requested the rest.
 * \param[in] store of these points if there is one; null: it is built. */
PCL_SLIM_EXPORT Result<CloudProjection> projectScan(const CloudView& points,
                                                    const SLIMSurface& surface,
                                                    SurfaceOrigin origin, const FitParams& fit,
                                                    const ProjectionParams& requested,
                                                    Progress* progress = nullptr,
                                                    const PointStore* store = nullptr);

/** \brief Projects stored points with what traceCrestLines() needs. */
PCL_SLIM_EXPORT Error projectForLines(const PointStore& store, const SLIMSurface& surface,
                                      SurfaceOrigin origin, const FitParams& fit,
                                      Projection& projection, Progress* progress = nullptr);

/** \brief The crest lines of a scan. */
struct TracedScan {
  FittedScan fitted;  ///< with a given surface, the store alone
  CrestLines lines;
  CrestStatistics statistics;
};

/** \brief Fits, unless a surface is given, projects, and traces crest lines.
 *
 * \param[in] given a surface in place of a fit, or null. \param[in] crest its threads are those of
 * the fit. \param[out] traced has no lines after an error.
 * \return an error of the parameters, of the points, of fit, projection or tracing, for a surface
 * of another cloud, or cancellation. */
PCL_SLIM_EXPORT Error traceScanLines(const CloudView& points, const SLIMSurface* given,
                                     const FitParams& fit, const CrestParams& crest,
                                     TracedScan& traced, Progress* progress = nullptr);

}  // namespace pcl_slim
