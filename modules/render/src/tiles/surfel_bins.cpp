// SPDX-License-Identifier: BSD-3-Clause
#include "tiles/surfel_bins.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcl_slim::detail {
namespace {

enum class Visibility : std::uint8_t { kVisible, kOutside, kBackFacing };

/** \brief True when grad f . d > 0 for every point of the ball and every ray through it. */
bool
turnedAway(const SLIMSurface& surface, std::size_t i, const CameraRays& rays, const Vector3& center)
{
  const Vector3 normal{surface.nx[i], surface.ny[i], surface.nz[i]};
  const double cosine = std::clamp(dot(normal, rays.directionTo(center)), -1.0, 1.0);
  const double spread =
      std::atan(slopeBound(surface, i)) + rays.halfAngle(center, surface.radius[i]);
  return std::acos(cosine) + spread < 0.5 * M_PI - 1e-6;
}

Visibility
classify(const SLIMSurface& surface, std::size_t i, const CameraRays& rays, double shrink,
         double near_plane, bool front_only, VisibleLeaf& leaf)
{
  const Vector3 center{surface.cx[i], surface.cy[i], surface.cz[i]};
  const double radius = surface.radius[i];
  leaf.blend = rays.pixelsOfBall(center, radius);
  leaf.nearest = rays.nearestDepth(center, radius);
  if (leaf.blend.empty() || leaf.nearest + 2.0 * radius <= near_plane) return Visibility::kOutside;
  if (front_only && turnedAway(surface, i, rays, center)) return Visibility::kBackFacing;
  leaf.first = rays.pixelsOfBall(center, shrink * radius);
  leaf.surfel = static_cast<std::uint32_t>(i);
  return Visibility::kVisible;
}

/** \brief Calls visit(tile) for each tile a leaf touches. */
template <typename Visit>
void
forEachTile(const SurfelBins& bins, const VisibleLeaf& leaf, const Visit& visit)
{
  for (int ty = leaf.blend.y0 / kTileSize; ty <= leaf.blend.y1 / kTileSize; ++ty) {
    for (int tx = leaf.blend.x0 / kTileSize; tx <= leaf.blend.x1 / kTileSize; ++tx) {
      visit(static_cast<std::size_t>(ty) * static_cast<std::size_t>(bins.columns) +
            static_cast<std::size_t>(tx));
    }
  }
}

/** \brief Counting sort of (leaf, tile) pairs, then each tile by depth. */
void
fillTiles(SurfelBins& bins, int threads)
{
  bins.begin.assign(bins.numTiles() + 1, 0);
  for (const VisibleLeaf& leaf : bins.leaves) {
    forEachTile(bins, leaf, [&](std::size_t tile) { ++bins.begin[tile + 1]; });
  }
  for (std::size_t t = 0; t < bins.numTiles(); ++t) bins.begin[t + 1] += bins.begin[t];
  bins.entries.resize(bins.begin.back());
  std::vector<std::uint64_t> next(bins.begin.begin(), bins.begin.end() - 1);
  for (std::size_t i = 0; i < bins.leaves.size(); ++i) {
    forEachTile(bins, bins.leaves[i], [&](std::size_t tile) {
      bins.entries[next[tile]++] = static_cast<std::uint32_t>(i);
    });
  }
  parallelFor(bins.numTiles(), threads, 8, [&](std::size_t tile, int) {
    const auto first = bins.entries.begin() + static_cast<std::ptrdiff_t>(bins.begin[tile]);
    const auto last = bins.entries.begin() + static_cast<std::ptrdiff_t>(bins.begin[tile + 1]);
    std::sort(first, last, [&](std::uint32_t a, std::uint32_t b) {
      const double depth_a = bins.leaves[a].nearest, depth_b = bins.leaves[b].nearest;
      return depth_a < depth_b || (depth_a == depth_b && a < b);
    });
  });
}

}  // namespace

double
slopeBound(const SLIMSurface& surface, std::size_t i)
{
  const float* c = surface.coefficientsOf(i);
  double bound = 0.0;
  for (int degree = 1, k = 1; degree <= surface.degree[i]; ++degree) {
    for (int j = 0; j <= degree; ++j, ++k) bound += degree * std::abs(static_cast<double>(c[k]));
  }
  return bound;
}

SurfelBins
binByTile(const ImageSize& size, std::vector<VisibleLeaf> leaves, int threads)
{
  SurfelBins bins;
  bins.columns = (size.width + kTileSize - 1) / kTileSize;
  bins.rows = (size.height + kTileSize - 1) / kTileSize;
  bins.leaves = std::move(leaves);
  fillTiles(bins, threads);
  return bins;
}

SurfelBins
binLeaves(const SLIMSurface& surface, const CameraRays& rays, const ImageSize& size, double shrink,
          double near_plane, bool front_only, int threads, RenderStatistics& statistics)
{
  std::vector<std::uint32_t> candidates;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.isLeaf(i)) candidates.push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<VisibleLeaf> leaves(candidates.size());
  std::vector<Visibility> visibility(candidates.size());
  parallelFor(candidates.size(), threads, 1024, [&](std::size_t i, int) {
    visibility[i] =
        classify(surface, candidates[i], rays, shrink, near_plane, front_only, leaves[i]);
  });
  std::vector<VisibleLeaf> visible;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (visibility[i] == Visibility::kVisible) visible.push_back(leaves[i]);
    if (visibility[i] == Visibility::kOutside) ++statistics.outside_frustum;
    if (visibility[i] == Visibility::kBackFacing) ++statistics.back_facing;
  }
  statistics.leaves += candidates.size();
  SurfelBins bins = binByTile(size, std::move(visible), threads);
  statistics.tile_entries += bins.entries.size();
  return bins;
}

}  // namespace pcl_slim::detail
