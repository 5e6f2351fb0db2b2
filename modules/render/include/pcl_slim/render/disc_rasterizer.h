// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/splat/splat_set.h"

namespace pcl_slim {

/** \brief Parameters of renderDiscs. */
struct PCL_SLIM_EXPORT DiscRenderParams {
  /** true: discs that overlap are blended, and none is narrower than a pixel. false: each pixel
   * shows the nearest disc as it is. */
  bool filtered = true;
  double depth_tolerance = 0.5;  ///< discs blend up to this many radii behind the first, [0, 100]
  VisibleSides sides = VisibleSides::kAuto;  ///< kAuto: both, as splats may be unoriented
  double near_plane = 0.0;                   ///< smallest depth shown, world units, >= 0
  bool skip = true;                          ///< leave out work that cannot change the result
  int threads = 0;                           ///< 0: all cores; never changes the result

  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

/** \brief What a frame of discs evaluated and what it left out. */
struct PCL_SLIM_EXPORT DiscRenderStatistics {
  std::uint64_t discs = 0;            ///< discs given
  std::uint64_t outside_frustum = 0;  ///< discs that no ray meets
  std::uint64_t back_facing = 0;      ///< discs turned away, where only fronts are drawn
  std::uint64_t tile_entries = 0;     ///< (disc, tile) pairs
  std::uint64_t rays_first = 0;       ///< (disc, ray) pairs intersected to find the first
  std::uint64_t rays_blend = 0;       ///< the same to blend
  std::uint64_t blended = 0;          ///< of these, pairs that counted
  std::uint64_t covered_pixels = 0;

  DiscRenderStatistics& operator+=(const DiscRenderStatistics& other);
};

/** \brief Renders coloured discs into a G-buffer: a visibility pass, then a blended pass.
 *
 * Rays are intersected with each disc's plane, so perspective is exact. Pass 1 finds the first
 * disc of each ray. Pass 2 sums, over the discs not farther behind it than depth_tolerance times
 * their mean radius and a pixel (measured across the surface, not along a slanting ray), depth,
 * normal and colour with the weight (1 - s^2)^2 and divides by the sum of weights: surface
 * splatting with normalisation per pixel (Zwicker et al. 2001). s is the distance from the centre
 * in radii or, where that is less, the ray's own distance from the centre over half a pixel's
 * diagonal: a screen filter (Botsch et al. 2005) by which no disc falls between the pixels.
 * Colours are blended as they are coded, and with a gradient follow it to the disc's rim.
 *
 * Local units are the world's, origin splats.origin. surfel is the first disc, radius its
 * radius, weight the sum of weights. Normals face the viewer unless only fronts are drawn. The
 * buffer is the same for any number of threads, and with skipping on or off.
 * Cost: O(discs + sum of visible discs' pixels).
 * \return an error for columns of unequal length, values that are not finite, or a bad camera or
 * parameter; the buffer is then empty.
 */
PCL_SLIM_EXPORT Error renderDiscs(const SplatSet& splats, const Camera& camera,
                                  const DiscRenderParams& params, GBuffer& buffer,
                                  DiscRenderStatistics* statistics = nullptr);

/** \brief The discs whose centres are in all of some half spaces, in their order. O(discs). */
PCL_SLIM_EXPORT SplatSet splatsWithin(const SplatSet& splats, const std::vector<HalfSpace>& cuts);

/** \brief Names the first defect of a set of discs: columns of unequal length, a value that is not
 * finite, a negative radius. O(discs). */
PCL_SLIM_EXPORT Error validateDiscs(const SplatSet& splats);

}  // namespace pcl_slim
