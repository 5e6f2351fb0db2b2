// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/symmetric.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/detail/ray_surfel.h"
#include "pcl_slim/render/detail/frame_constants.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Names a half space without a direction or a place. */
Error checkHalfSpaces(const std::vector<HalfSpace>& cuts);

/** \brief Half spaces in local coordinates (local = (world - origin) / scale), unit normals. */
std::vector<HalfSpace> localHalfSpaces(std::vector<HalfSpace> cuts, const Vector3& origin,
                                       double scale);

/** \brief Depths along a ray between which it is inside all of some half spaces; near > far:
 * nowhere. */
struct RayStretch {
  double near, far;
};

/** \brief The part of a stretch of a ray inside half spaces. */
RayStretch within(const std::vector<HalfSpace>& cuts, const Ray& ray, RayStretch stretch);

/** \brief Whether a ball is completely outside of any half space. */
bool isCutAway(const std::vector<HalfSpace>& cuts, const Vector3& center, double radius);

/** \brief What a frame's parameters mean for a surface, lengths in its local units. */
struct FrameRules {
  double shrink;        ///< alpha of pass 1
  double cover_radius;  ///< alpha of the coverage measure
  double min_coverage;  ///< where it is less, the surface is not defined
  double near_plane;
  double lod;       ///< pixels; 0: none
  bool trim;        ///< heed trim maps
  bool front_only;  ///< only roots at which the gradient faces the viewer count
  bool skip;
  int threads;                  ///< at least 1
  std::vector<HalfSpace> cuts;  ///< local coordinates, unit normals

  FrameRules(const SurfaceInfo& info, const RenderParams& params);
};

constexpr int kTileSize = 32;

/** \brief A leaf (or disc) that may be seen: where, and how near. */
struct VisibleLeaf {
  std::uint32_t surfel = 0;
  double nearest = 0.0;  ///< no ray meets the ball before this depth
  PixelRect blend;       ///< pixels of the whole ball
  PixelRect first;       ///< pixels of the ball shrunk by alpha
};

/** \brief Visible leaves by tile, each tile's from near to far.
 *
 * Tile t covers pixels [32 (t mod columns), ...] x [32 (t div columns), ...]; its leaves are
 * entries[begin[t] ... begin[t + 1]), indices into leaves.
 */
struct SurfelBins {
  int columns = 0, rows = 0;
  std::vector<VisibleLeaf> leaves;
  std::vector<std::uint64_t> begin;
  std::vector<std::uint32_t> entries;

  std::size_t numTiles() const {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
};

/** \brief Sorts what may be seen into a picture's tiles by blend, each tile's from near to far,
 * equals by their place in leaves. O(leaves + entries log entries). */
SurfelBins binByTile(const ImageSize& size, std::vector<VisibleLeaf> leaves, int threads);

/** \brief Runs body(t, tile, statistics) for every tile with leaves; tile: memory that one thread
 * uses for all its tiles. \return the sum of what body counted. */
template <typename Tile, typename Statistics, typename Body>
Statistics forEachTile(const SurfelBins& bins, int threads, const Body& body) {
  std::vector<Tile> tiles(static_cast<std::size_t>(threads));
  std::vector<Statistics> parts(tiles.size());
  parallelFor(bins.numTiles(), threads, 1, [&](std::size_t t, int thread) {
    if (bins.begin[t] == bins.begin[t + 1]) return;
    Statistics counts;
    body(t, tiles[static_cast<std::size_t>(thread)], counts);
    parts[static_cast<std::size_t>(thread)] += counts;
  });
  Statistics total;
  for (const Statistics& part : parts) total += part;
  return total;
}

/** \brief An upper bound on |grad h| over the unit ball, from the coefficients' absolute values. */
double slopeBound(const SLIMSurface& surface, std::size_t i);

/** \brief Marks some pixels in a row as met by nothing. */
void clearPixels(GBuffer& buffer, std::size_t begin, std::size_t count);

/** \brief Sums of one pixel's blend (eqs. 6, 7, 8 left), before division by the weight. */
struct BlendSum {
  double weight = 0.0;
  double shift = 0.0;  ///< of w (t - t^): q is on the ray
  double coverage = 0.0;
  double outside = 0.0;                    ///< of w outsideShare(): of the trim maps
  double clearance = 0.0;                  ///< of w r heightBehind()
  double offset_sum[3] = {0.0, 0.0, 0.0};  ///< of w (q - c) / r
  double spread[3] = {0.0, 0.0,
                      0.0};  ///< of (q - c) / r, all leaves alike; by the ray tracer alone
  int leaves = 0;
  double gradient[3] = {0.0, 0.0, 0.0};
  Symmetric3<double> hessian{};
  double largest_weight = 0.0;
  std::uint32_t surfel = GBuffer::kNothing;
  std::int32_t facing = 0;  ///< leaves seen from the front minus those seen from behind
};

/** \brief Depth of the first root of a leaf between two depths at which its own trim map has data,
 * or infinity. */
double firstRoot(const FrameRules& rules, const RaySurfel& surfel, const Ray& ray, double nearest,
                 double limit, std::uint64_t& evaluated);

/** \brief The height of a leaf under a ray just behind q^, as it counts in BlendSum::clearance.
 *
 * Beside a silhouette a ray meets the leaf that extends farthest and passes above the others, which
 * have no root on it and no part in the blend. So leaves that the ray misses count with their height
 * and those that it meets with their depth, if they are met before: else their root is farther
 * behind. Where the sum is above 0 the ray passes above the surface.
 * \param[in] behind f at kBehind behind q^, above 0 outside [radii]; of a leaf seen from behind, that of the
 * side which is seen
 * \param[in] met whether the leaf has a root on the ray. O(1). */
inline double heightBehind(double behind, bool met) {
  return met && behind > 0.0 ? 0.0 : behind;
}

/** \brief Adds one leaf to one pixel's blend. */
void blendLeaf(const FrameRules& rules, WeightKernel kernel, const RaySurfel& surfel,
               std::uint32_t id, const Ray& ray, double depth_hat, BlendSum& sum,
               std::uint64_t& evaluated);

/** \brief Whether a blend is beyond the border that trim maps draw. */
bool isOutside(const BlendSum& sum);

/** \brief Whether a ray passes above the leaves around its first intersection, taken together. */
inline bool passesAbove(const BlendSum& sum) {
  return sum.clearance > 0.0;
}

/** \brief From a first intersection that is not on the surface to where the search continues
 * [radii]. */
inline double peelStep(const BlendSum& sum) {
  return passesAbove(sum) ? kBehind : kPeelStep;
}

/** \brief Whether a blend belongs to the surface: its leaves cover it, or it is in a gap between
 * leaves all around it; and it is not isOutside(). Beyond the rim of what was measured all leaves
 * are on one side. passesAbove() is not looked at. */
bool isSupported(const BlendSum& sum, double min_coverage);

/** \brief Divides a blend's sums and writes them into a pixel of the buffer. */
void writeBlend(const SLIMSurface& surface, const Ray& ray, double depth_hat, const BlendSum& sum,
                std::size_t pixel, GBuffer& out);

}  // namespace pcl_slim::detail
