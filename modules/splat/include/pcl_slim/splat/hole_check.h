// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/splat/splat_set.h"

namespace pcl_slim {

/** \brief How checkHoles() looks at splats. */
struct HoleCheckParams {
  std::uint64_t rays = 100000;
  double tilt = 60.0;    ///< rays are at most this far from the surface's normal [deg], in [0, 80]
  double density = 3.0;  ///< see HoleCheck::sparse, > 0
  double thickness = 0.4;  ///< see HoleCheck::rough, >= 0; infinite: cast everywhere
  std::uint64_t seed = 1;
  int threads = 0;
};

/** \brief What rays through the surface met. */
struct HoleCheck {
  std::uint64_t rays = 0;    ///< cast, where the input is dense and smooth enough
  std::uint64_t missed = 0;  ///< of these, rays that met no disc
  /** Not cast: a side of the sample's triangle was longer than density times the mean distance
   * between the point and its neighbours, or that distance 3 times what is usual in the cloud, so
   * that the points do not show whether there is a surface. */
  std::uint64_t sparse = 0;
  /** Not cast: the 24 points nearest to the sample are no sheet, as their standard deviation across
   * their plane is more than thickness times the lesser one along it. Edges, thin parts and noise
   * as large as the spacing have no normal that rays could be inclined to. */
  std::uint64_t rough = 0;
  double overlap = 0;  ///< mean number of discs a ray met

  double holes() const {
    return rays > 0 ? static_cast<double>(missed) / static_cast<double>(rays) : 0;
  }
};

/** \brief Casts rays through the surface between the points and counts the discs each one meets.
 *
 * A ray goes through a random place of a triangle of a point and two of its 8 nearest, in a random
 * direction about the normal of the plane through the 24 nearest. It meets a disc when it pierces
 * it near that place: no farther above or below than the disc's radius and two spacings. Testing
 * the points themselves would prove nothing: discs can contain every point and still leave gaps
 * between.
 *
 * \return an error for parameters out of range or splats without points. O(rays log splats). The
 * same result for any number of threads.
 */
PCL_SLIM_EXPORT Result<HoleCheck> checkHoles(const PointStore& store, const SplatSet& splats,
                                             const HoleCheckParams& params = {});

}  // namespace pcl_slim
