// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief What the fit of one tile takes from the whole cloud, so that no tile measures it for
 * itself. */
struct CloudTraits {
  double lambda = 0;        ///< noise variance, squared local lengths
  double dependence = 1;    ///< points that a fit counts as one because they share their errors
  float min_dot = 0;        ///< cosine from which on two normals belong together
  double normal_error = 0;  ///< > 0: normals are data too, this many radians off
  /** \brief How the noise varies inside a tile. */
  enum class Profile : unsigned char { kNone, kMeasured, kField } profile = Profile::kNone;
  double spacing =
      0;  ///< of the median point's neighbours (medianSpacing()), which decides on outliers
  std::uint64_t noise_neighbors = 0;  ///< points of the patches that a profile is measured on
};

/** \brief How a cloud's traits are measured on some of its points. */
struct TraitsSample {
  std::size_t windows = 1;   ///< separate parts of the cloud that the sample consists of
  std::size_t thinning = 1;  ///< one of this many points is in the sample
};

/** \brief The traits, and whether they can be believed. */
struct MeasuredTraits {
  CloudTraits traits;
  FitStatistics statistics;  ///< what was measured of noise and normals, of the sample
  bool noise_fills = false;  ///< noise fills even the widest patches that the sample has room for
};

/** \brief Measures what tiles share on a sample of the cloud, in the cloud's frame.
 *
 * The estimator is that of fitSurface(); its patches contain at most an eighth of a window's
 * points.
 * \return an error where normals are to be data and there are none. O(sample).
 */
PCL_SLIM_EXPORT Result<MeasuredTraits> measureTraits(const PointStore& sample,
                                                     const FitParams& params,
                                                     const TraitsSample& how);

/** \brief Radii of the levels of balls in a frame: radius(k) = first * ratio^(k - 1), local
 * lengths. */
struct PCL_SLIM_EXPORT LevelRadii {
  double first = 0, ratio = 1;
  int last =
      1;  ///< finest level that points, units and FitParams::least_radius allow to start with

  /** \brief Radius of the balls of this level, local length. */
  double radius(int level) const;
  /** \brief Widest reach of a ball of this level, and of its leaf, from the point it is about. */
  double reach(int level) const;
};

/** \brief The radii that a fit with these parameters searches in a frame. */
PCL_SLIM_EXPORT LevelRadii levelRadii(const StoreFrame& frame, const FitParams& params);

/** \brief One tile of a cloud. */
struct TileJob {
  std::uint64_t first_key = 0, end_key = 0;  ///< Morton codes of its core: half open
  int first_level = 1;
  CloudTraits traits;
};

/** \brief Names the first parameter that a fit by tiles cannot honour. */
PCL_SLIM_EXPORT Error checkTileParams(const FitParams& params);

/** \brief Fits the surfels of one tile: the points of its core are centres, the others of its store
 * are only seen.
 *
 * The store is in the cloud's frame and contains all points within LevelRadii::reach(first_level)
 * of the core. Surfels get trim maps but no common side (orientSurfels()) and no links. A tile
 * without a leaf gives an empty surface and no error. Same bytes for any number of threads.
 */
PCL_SLIM_EXPORT Error fitTile(PointStore store, const FitParams& params, const TileJob& job,
                              SLIMSurface& surface, FitStatistics* statistics = nullptr,
                              Progress* progress = nullptr);

/** \brief Levels above those that the tiles of a cloud begin with. */
struct CoarseJob {
  int last_level = 1;
  CloudTraits traits;
  std::uint64_t thinning = 1;  ///< one of this many points is in the sample
};

/** \brief Fits the surfels that a level of detail draws in place of those of tiles: levels from the
 * first that a fit in memory would begin with to a last one, none of the surfels a leaf.
 *
 * \param[in] sample of all of the cloud, in the cloud's frame. Surfels get trim maps but no common
 * side and no links. Same bytes for any number of threads. O(sample * levels). \return an error for
 * cancellation. */
PCL_SLIM_EXPORT Error fitCoarseLevels(const PointStore& sample, const FitParams& params,
                                      const CoarseJob& job, SLIMSurface& surface,
                                      Progress* progress = nullptr);

/** \brief Gives the surfels of all tiles together a common side, as a fit without normals does; a
 * frame with a sensor turns them there. O(leaves log leaves). */
PCL_SLIM_EXPORT void orientSurfels(const StoreFrame& frame, const FitParams& params,
                                   SLIMSurface& surface);

}  // namespace pcl_slim
