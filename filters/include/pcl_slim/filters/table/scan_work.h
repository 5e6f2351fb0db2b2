// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/filters/io/scan_table.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/query/cloud_projection.h"
#include "pcl_slim/splat/splat_sampling.h"

// A scan in a table, from points to results, for programs whose clouds come as messages of any fields.

namespace pcl_slim {

/** \brief What is done with a scan that is fitted and projected onto its surface. */
struct PCL_SLIM_EXPORT ScanWorkParams {
  /** \brief A fit whose surface nobody sees has no trim maps. */
  ScanWorkParams() { fit.trim = false; }

  FitParams fit;
  bool use_normals = true;  ///< the points' own
  bool normals = true;      ///< add normal_x normal_y normal_z and PCL's curvature
  bool curvatures = false;  ///< add k1 k2 mean_curvature gaussian_curvature
};

/** \brief Points that were worked on. */
struct ScanWorkResult {
  PointTable points;     ///< with every field that they had
  bool is_dense = true;  ///< no value of coordinates and of added fields is NaN or infinite
  FitStatistics fit;
  CloudProjectionStatistics projection;
  std::string warning;  ///< why the points are no surface, or empty
};

/** \brief Fits a surface to a scan and moves its points onto it: pcl_slim_smooth.
 *
 * Points that are no surface, and scans none of whose points are finite, are not moved.
 * \return an error of the parameters or cancellation. O(points); the same for any number of
 * threads. */
PCL_SLIM_EXPORT Result<ScanWorkResult> smoothScan(const ScanTable& scan,
                                                  const ScanWorkParams& params,
                                                  Progress* progress = nullptr);

/** \brief The same, but no point moves: pcl_slim_curvature's normals. */
PCL_SLIM_EXPORT Result<ScanWorkResult> normalsOfScan(const ScanTable& scan,
                                                     const ScanWorkParams& params,
                                                     Progress* progress = nullptr);

/** \brief The discs that cover a scan, with the fields of toPointFile(SplatSet) in the scan's own
 * coordinates, which are floats: pcl_color_splat_sampling. None for a scan without finite points.
 * \param[in] use_normals the points' own. \param[out] statistics may be null.
 * \return an error of the parameters, or cancellation. O(points log points). */
PCL_SLIM_EXPORT Result<PointTable> splatsOfScan(const ScanTable& scan, const SplatParams& params,
                                                bool use_normals = true,
                                                SplatStatistics* statistics = nullptr,
                                                Progress* progress = nullptr);

}  // namespace pcl_slim
