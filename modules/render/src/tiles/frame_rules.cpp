// SPDX-License-Identifier: BSD-3-Clause
// What a frame's parameters mean for a surface, its buffer, and tiles of what may be seen.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/render_params.h"
#include "tiles/tiles.h"

namespace pcl_slim {

using detail::kMaxShrink;

Error RenderParams::validate() const {
  if (!(shrink >= 0.0 && shrink <= kMaxShrink)) {
    return {ErrorCode::kBadArgument, "the ball's shrink factor must be 0 (automatic) to 0.95"};
  }
  if (!std::isfinite(min_coverage)) {
    return {ErrorCode::kBadArgument, "the least coverage must be a finite number"};
  }
  if (!(near_plane >= 0.0 && std::isfinite(near_plane))) {
    return {ErrorCode::kBadArgument, "the near plane must be a finite distance, 0 or more"};
  }
  if (Error error = detail::checkHalfSpaces(cuts)) return error;
  if (!(lod >= 0.0 && lod <= 1024.0)) {
    return {ErrorCode::kBadArgument, "the level of detail must be 0 to 1024 pixels"};
  }
  return checkThreads(threads);
}

RenderStatistics& RenderStatistics::operator+=(const RenderStatistics& other) {
  leaves += other.leaves;
  outside_frustum += other.outside_frustum;
  outside_region += other.outside_region;
  back_facing += other.back_facing;
  below_detail += other.below_detail;
  coarse_surfels += other.coarse_surfels;
  tile_entries += other.tile_entries;
  occluded_entries += other.occluded_entries;
  rays_first += other.rays_first;
  rays_blend += other.rays_blend;
  rays_bracketed += other.rays_bracketed;
  covered_pixels += other.covered_pixels;
  closed_pixels += other.closed_pixels;
  return *this;
}

}  // namespace pcl_slim

namespace pcl_slim::detail {

Error checkHalfSpaces(const std::vector<HalfSpace>& cuts) {
  for (const HalfSpace& cut : cuts) {
    const double size = length(cut.normal);
    if (!(size > 0.0 && std::isfinite(size) && std::isfinite(cut.offset))) {
      return {ErrorCode::kBadArgument,
              "a half space needs a finite offset and a finite normal that is not 0"};
    }
  }
  return {};
}

std::vector<HalfSpace> localHalfSpaces(std::vector<HalfSpace> cuts, const Vector3& origin,
                                       double scale) {
  for (HalfSpace& cut : cuts) {
    const double size = length(cut.normal);
    cut.offset = (cut.offset - dot(cut.normal, origin)) / (size * scale);
    for (double& n : cut.normal) n /= size;
  }
  return cuts;
}

RayStretch within(const std::vector<HalfSpace>& cuts, const Ray& ray, RayStretch stretch) {
  for (const HalfSpace& cut : cuts) {
    const double inside = dot(cut.normal, ray.origin) - cut.offset;
    const double slope = dot(cut.normal, ray.direction);
    if (slope > 0.0) {
      stretch.near = std::max(stretch.near, -inside / slope);
    } else if (slope < 0.0) {
      stretch.far = std::min(stretch.far, -inside / slope);
    } else if (inside < 0.0) {
      stretch.far = -std::numeric_limits<double>::infinity();
    }
  }
  return stretch;
}

bool isCutAway(const std::vector<HalfSpace>& cuts, const Vector3& center, double radius) {
  return std::any_of(cuts.begin(), cuts.end(), [&](const HalfSpace& cut) {
    return dot(cut.normal, center) - cut.offset < -radius;
  });
}

FrameRules::FrameRules(const SurfaceInfo& info, const RenderParams& params)
    : shrink(std::clamp(params.shrink > 0.0 ? params.shrink : info.cover_radius, 0.05, kMaxShrink)),
      cover_radius(std::clamp(info.cover_radius, 0.05, 1.0)),
      min_coverage(params.min_coverage >= 0.0 ? params.min_coverage : info.cover_threshold),
      near_plane(params.near_plane / info.scale),
      lod(params.lod),
      trim(params.trim),
      front_only(params.sides == VisibleSides::kFront ||
                 (params.sides == VisibleSides::kAuto && info.hasFront() && params.cuts.empty())),
      skip(params.skip),
      threads(resolveThreads(params.threads)),
      cuts(localHalfSpaces(params.cuts, info.origin, info.scale)) {}

}  // namespace pcl_slim::detail

namespace pcl_slim {

void detail::clearPixels(GBuffer& buffer, std::size_t begin, std::size_t count) {
  const auto clear = [&](auto& column, auto value) {
    if (!column.empty()) std::fill_n(column.data() + begin, count, value);
  };
  clear(buffer.depth, std::numeric_limits<float>::infinity());
  for (auto* column : {&buffer.position, &buffer.normal, &buffer.gradient}) {
    clear(*column, std::array<float, 3>{});
  }
  clear(buffer.hessian, std::array<float, 6>{});
  for (auto* column : {&buffer.mean_curvature, &buffer.gaussian_curvature, &buffer.radius,
                       &buffer.residual, &buffer.weight, &buffer.coverage}) {
    clear(*column, 0.0f);
  }
  clear(buffer.principal, std::array<float, 2>{});
  clear(buffer.surfel, GBuffer::kNothing);
  for (auto* column : {&buffer.level, &buffer.back_face}) clear(*column, std::uint8_t{0});
}

void GBuffer::reserve(int new_width, int new_height, unsigned columns) {
  width = new_width;
  height = new_height;
  const std::size_t n = static_cast<std::size_t>(new_width) * static_cast<std::size_t>(new_height);
  const auto wanted = [&](unsigned column) { return (columns & column) != 0 ? n : 0; };
  depth.resize(n);
  normal.resize(n);
  surfel.resize(n);
  back_face.resize(n);
  position.resize(wanted(kPositionColumn));
  gradient.resize(wanted(kGradientColumn));
  hessian.resize(wanted(kHessianColumn));
  mean_curvature.resize(wanted(kCurvatureColumn));
  gaussian_curvature.resize(wanted(kCurvatureColumn));
  principal.resize(wanted(kCurvatureColumn));
  level.resize(wanted(kLeafColumns));
  radius.resize(wanted(kLeafColumns));
  residual.resize(wanted(kResidualColumn));
  weight.resize(wanted(kWeightColumns));
  coverage.resize(wanted(kWeightColumns));
  color.clear();
}

void GBuffer::resize(int new_width, int new_height, unsigned columns) {
  reserve(new_width, new_height, columns);
  detail::clearPixels(*this, 0, numPixels());
}

std::size_t GBuffer::numCovered() const {
  return numPixels() - static_cast<std::size_t>(std::count(surfel.begin(), surfel.end(), kNothing));
}

}  // namespace pcl_slim

namespace pcl_slim::detail {
namespace {

/** \brief Calls visit(tile) for each tile a leaf touches. */
template <typename Visit>
void forEachTile(const SurfelBins& bins, const VisibleLeaf& leaf, const Visit& visit) {
  for (int ty = leaf.blend.y0 / kTileSize; ty <= leaf.blend.y1 / kTileSize; ++ty) {
    for (int tx = leaf.blend.x0 / kTileSize; tx <= leaf.blend.x1 / kTileSize; ++tx) {
      visit(static_cast<std::size_t>(ty) * static_cast<std::size_t>(bins.columns) +
            static_cast<std::size_t>(tx));
    }
  }
}

/** \brief Counting sort of (leaf, tile) pairs, then each tile by depth. */
void fillTiles(SurfelBins& bins, int threads) {
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

double slopeBound(const SLIMSurface& surface, std::size_t i) {
  const float* c = surface.coefficientsOf(i);
  double bound = 0.0;
  for (int degree = 1, k = 1; degree <= surface.degree[i]; ++degree) {
    for (int j = 0; j <= degree; ++j, ++k) bound += degree * std::abs(static_cast<double>(c[k]));
  }
  return bound;
}

SurfelBins binByTile(const ImageSize& size, std::vector<VisibleLeaf> leaves, int threads) {
  SurfelBins bins;
  bins.columns = (size.width + kTileSize - 1) / kTileSize;
  bins.rows = (size.height + kTileSize - 1) / kTileSize;
  bins.leaves = std::move(leaves);
  fillTiles(bins, threads);
  return bins;
}

}  // namespace pcl_slim::detail
