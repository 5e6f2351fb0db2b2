// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Gives every surfel of a surface the colour of the points in its ball: a polynomial over
 * its (u, v) plane (surfel_color.h), fitted by least squares with the blend's weights to the points
 * near its own polynomial.
 *
 * \param[in] store the points that the surface was fitted to \param[in] cloud what the store was
 * built of
 * \param[in] colors one for each point of the cloud; without any the surface gets none
 * \return an error where surface and store differ in their units. O(points in the balls), at most
 * 4096 of a ball; the same for any number of threads. */
PCL_SLIM_EXPORT Error fitColors(const PointStore& store, const CloudView& cloud,
                                const ColorView& colors, int threads, SLIMSurface& surface);

/** \brief What paintColors() did. */
struct PaintStatistics {
  std::uint64_t points = 0;   ///< of the cloud that are near the surface
  std::uint64_t leaves = 0;   ///< of the surface ...
  std::uint64_t painted = 0;  ///< ... and those that got colours of these points
  /// most normals of the cloud oppose the surface's: they were not used
  bool normals_opposed = false;
};

/** \brief Gives a surface the colours of another registered cloud, as a photogrammetric one, in
 * place of those of the points that it was fitted to.
 *
 * Each point within half a radius of a leaf's polynomial is moved onto the nearest one; then
 * colours are fitted as fitColors() does. Where the surface is oriented, points keep to the side
 * of that leaf: of leaves that face a point's own normal, if the cloud has normals and most of
 * them face as the surface does, else of all. Leaves that are smaller than the spacing of the
 * points get the colour of those around. Other surfels without points keep their colours, or are
 * grey (128) if the surface had none.
 * \param[in] cloud in the surface's world coordinates, or a part of it; points elsewhere are left
 * out
 * \param[in] colors one for each point of the cloud
 * \return what was painted, or an error, with the surface as it was: of the cloud, without colours
 * or surfels, or where no point is near the surface. O(points log points + points in the balls);
 * the same for any number of threads. */
PCL_SLIM_EXPORT Result<PaintStatistics> paintColors(const CloudView& cloud, const ColorView& colors,
                                                    int threads, SLIMSurface& surface);

}  // namespace pcl_slim
