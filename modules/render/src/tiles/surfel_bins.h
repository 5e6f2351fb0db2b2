// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

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

  std::size_t numTiles() const
  {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
};

/** \brief Sorts what may be seen into a picture's tiles by blend, each tile's from near to far,
 * equals by their place in leaves. O(leaves + entries log entries). */
SurfelBins
binByTile(const ImageSize& size, std::vector<VisibleLeaf> leaves, int threads);

/** \brief Culls leaves against the frustum and, with front_only, by their cone of normals, and
 * sorts the rest into tiles. Counts what was left out. O(leaves + entries log entries). */
SurfelBins
binLeaves(const SLIMSurface& surface, const CameraRays& rays, const ImageSize& size, double shrink,
          double near_plane, bool front_only, int threads, RenderStatistics& statistics);

/** \brief Runs body(t, tile, statistics) for every tile with leaves; tile: memory that one thread uses
 * for all its tiles. \return the sum of what body counted. */
template <typename Tile, typename Statistics, typename Body>
Statistics
forEachTile(const SurfelBins& bins, int threads, const Body& body)
{
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
double
slopeBound(const SLIMSurface& surface, std::size_t i);

}  // namespace pcl_slim::detail
