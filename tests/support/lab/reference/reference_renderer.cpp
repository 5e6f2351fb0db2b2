// SPDX-License-Identifier: BSD-3-Clause
#include "support/lab/reference/reference_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/core/parallel.h"
#include "shading/shading.h"
#include "tiles/tiles.h"
#include "tracer/tracer.h"

namespace pcl_slim::lab {

using namespace detail;
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

enum class Visibility : std::uint8_t { kVisible, kOutside, kBackFacing };

/** \brief True when grad f . d > 0 for every point of the ball and every ray through it. */
bool turnedAway(const SLIMSurface& surface, std::size_t i, const CameraRays& rays,
                const Vector3& center) {
  const Vector3 normal{surface.nx[i], surface.ny[i], surface.nz[i]};
  const double cosine = std::clamp(dot(normal, rays.directionTo(center)), -1.0, 1.0);
  const double spread =
      std::atan(slopeBound(surface, i)) + rays.halfAngle(center, surface.radius[i]);
  return std::acos(cosine) + spread < 0.5 * M_PI - 1e-6;
}

Visibility classify(const SLIMSurface& surface, std::size_t i, const CameraRays& rays,
                    double shrink, double near_plane, bool front_only, VisibleLeaf& leaf) {
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

/** \brief Culls leaves against the frustum and, with front_only, by their cone of normals, and
 * sorts the rest into tiles. Counts what was left out. O(leaves + entries log entries). */
SurfelBins binLeaves(const SLIMSurface& surface, const CameraRays& rays, const ImageSize& size,
                     double shrink, double near_plane, bool front_only, int threads,
                     RenderStatistics& statistics) {
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

/** \brief What every tile of a frame needs. */
struct FrameContext {
  const SLIMSurface& surface;
  const CameraRays& rays;
  const SurfelBins& bins;
  const FrameRules& rules;
};

/** \brief One tile's pixels while they are being rendered; reused from tile to tile. */
struct Tile {
  int x0 = 0, y0 = 0, width = 0, height = 0;
  std::vector<Ray> rays;
  std::vector<double> first_depth;  ///< t^ of pass 1; farthest where nothing was met
  std::vector<double> nearest;      ///< pass 1 looks no nearer than this ...
  std::vector<double> farthest;     ///< ... and no farther
  std::vector<BlendSum> sums;
  PixelRect pending;  ///< contains every pixel of the next passes
  std::vector<std::uint8_t> is_pending;

  /** \brief Takes up tile number t of a frame and prepares its rays. */
  void begin(const FrameContext& frame, const ImageSize& size, std::size_t t);
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - y0) * kTileSize + static_cast<std::size_t>(x - x0);
  }
  /** \brief The part of a rectangle inside this tile. */
  PixelRect clip(const PixelRect& rect) const;
};

/** \brief Largest first depth of the pending pixels: the rays' far ends until each has one. */
double farthestFirst(const Tile& tile) {
  double depth = 0.0;
  for (int y = tile.pending.y0; y <= tile.pending.y1; ++y) {
    for (int x = tile.pending.x0; x <= tile.pending.x1; ++x) {
      const std::size_t pixel = tile.index(x, y);
      if (tile.is_pending[pixel]) depth = std::max(depth, tile.first_depth[pixel]);
    }
  }
  return depth;
}

void Tile::begin(const FrameContext& frame, const ImageSize& size, std::size_t t) {
  const auto columns = static_cast<std::size_t>(frame.bins.columns);
  x0 = static_cast<int>(t % columns) * kTileSize;
  y0 = static_cast<int>(t / columns) * kTileSize;
  width = std::min(kTileSize, size.width - x0);
  height = std::min(kTileSize, size.height - y0);
  rays.resize(kTileSize * kTileSize);
  nearest.assign(kTileSize * kTileSize, frame.rules.near_plane);
  farthest.assign(kTileSize * kTileSize, kInfinity);
  is_pending.assign(kTileSize * kTileSize, 1);
  sums.assign(kTileSize * kTileSize, BlendSum());
  pending = {x0, y0, x0 + width - 1, y0 + height - 1};
  for (int y = y0; y < y0 + height; ++y) {
    for (int x = x0; x < x0 + width; ++x) {
      const Ray ray = rays[index(x, y)] = frame.rays.ray(x, y);
      const RayStretch seen = within(frame.rules.cuts, ray, {frame.rules.near_plane, kInfinity});
      nearest[index(x, y)] = seen.near;
      farthest[index(x, y)] = seen.far;
    }
  }
  first_depth = farthest;
}

PixelRect Tile::clip(const PixelRect& rect) const {
  return {std::max(rect.x0, pending.x0), std::max(rect.y0, pending.y0),
          std::min(rect.x1, pending.x1), std::min(rect.y1, pending.y1)};
}

/** \brief Pass 1: the first intersection of each ray with a leaf inside its shrunk ball. */
void findFirstIntersections(const FrameContext& frame, std::size_t t, Tile& tile,
                            RenderStatistics& statistics) {
  constexpr std::uint64_t kLookEvery = 16;  // entries between looks at the whole tile's depth
  const SurfelBins& bins = frame.bins;
  for (std::uint64_t e = bins.begin[t]; e < bins.begin[t + 1]; ++e) {
    const VisibleLeaf& leaf = bins.leaves[bins.entries[e]];
    if (frame.rules.skip && (e - bins.begin[t]) % kLookEvery == 0 &&
        leaf.nearest > farthestFirst(tile)) {
      statistics.occluded_entries += bins.begin[t + 1] - e;
      return;  // entries are sorted: every later one is as far
    }
    const PixelRect rect = tile.clip(leaf.first);
    if (rect.empty()) continue;
    const RaySurfel surfel(frame.surface, leaf.surfel);
    for (int y = rect.y0; y <= rect.y1; ++y) {
      for (int x = rect.x0; x <= rect.x1; ++x) {
        const std::size_t pixel = tile.index(x, y);
        double& first = tile.first_depth[pixel];
        if (!tile.is_pending[pixel] || leaf.nearest > first) continue;
        first = std::min(first, firstRoot(frame.rules, surfel, tile.rays[pixel],
                                          tile.nearest[pixel], first, statistics.rays_first));
      }
    }
  }
}

/** \brief Pass 2: sums over the leaves whose ball contains q^, each at its root nearest to q^. */
void gatherBlends(const FrameContext& frame, std::size_t t, Tile& tile,
                  RenderStatistics& statistics) {
  const SurfelBins& bins = frame.bins;
  double last = 0.0;
  for (std::size_t i = 0; i < tile.first_depth.size(); ++i) {
    if (tile.first_depth[i] < tile.farthest[i]) last = std::max(last, tile.first_depth[i]);
  }
  for (std::uint64_t e = bins.begin[t]; e < bins.begin[t + 1]; ++e) {
    const VisibleLeaf& leaf = bins.leaves[bins.entries[e]];
    if (frame.rules.skip && leaf.nearest > last) return;
    const PixelRect rect = tile.clip(leaf.blend);
    if (rect.empty()) continue;
    const RaySurfel surfel(frame.surface, leaf.surfel);
    for (int y = rect.y0; y <= rect.y1; ++y) {
      for (int x = rect.x0; x <= rect.x1; ++x) {
        const std::size_t pixel = tile.index(x, y);
        const double first = tile.first_depth[pixel];
        if (!tile.is_pending[pixel] || !(first < tile.farthest[pixel])) continue;
        blendLeaf(frame.rules, frame.surface.info.blend_kernel, surfel, leaf.surfel,
                  tile.rays[pixel], first, tile.sums[pixel], statistics.rays_blend);
      }
    }
  }
}

/** \brief Sends pixels whose blend is not covered back to pass 1, to look behind it.
 * \return false when there are none. */
bool peelUncovered(const FrameContext& frame, Tile& tile) {
  // Nothing well covered is within a leaf's reach of an uncovered q^, or it would have been
  // blended: a step of a share of its radius passes over the other leaves of the same flap.
  PixelRect left;
  left.x0 = left.y0 = std::numeric_limits<int>::max();
  for (int y = tile.pending.y0; y <= tile.pending.y1; ++y) {
    for (int x = tile.pending.x0; x <= tile.pending.x1; ++x) {
      const std::size_t pixel = tile.index(x, y);
      if (!tile.is_pending[pixel]) continue;
      BlendSum& sum = tile.sums[pixel];
      const bool met = sum.surfel != GBuffer::kNothing;
      if (!met || (isSupported(sum, frame.rules.min_coverage) && !passesAbove(sum))) {
        tile.is_pending[pixel] = 0;
        continue;
      }
      tile.nearest[pixel] =
          tile.first_depth[pixel] + peelStep(sum) * frame.surface.radius[sum.surfel];
      tile.first_depth[pixel] = tile.farthest[pixel];
      sum = BlendSum();
      left = {std::min(left.x0, x), std::min(left.y0, y), std::max(left.x1, x),
              std::max(left.y1, y)};
    }
  }
  tile.pending = left;
  return !left.empty();
}

/** \brief Divides the sums and writes the tile's pixels into the buffer. */
void resolveTile(const FrameContext& frame, const Tile& tile, GBuffer& buffer,
                 RenderStatistics& statistics) {
  for (int y = tile.y0; y < tile.y0 + tile.height; ++y) {
    for (int x = tile.x0; x < tile.x0 + tile.width; ++x) {
      const std::size_t pixel = tile.index(x, y);
      const BlendSum& sum = tile.sums[pixel];
      if (sum.surfel == GBuffer::kNothing) continue;
      writeBlend(frame.surface, tile.rays[pixel], tile.first_depth[pixel], sum, buffer.index(x, y),
                 buffer);
      ++statistics.covered_pixels;
    }
  }
}

/** \brief Renders a frame in double, leaf by leaf and ray by ray, in tiles of 32 x 32 pixels.
 *
 * \param[in,out] buffer of the camera's size, marked as met by nothing
 * Cost: O(leaves + sum of visible balls' pixels).
 */
void drawLeaves(const SLIMSurface& surface, const Camera& camera, const FrameRules& rules,
                GBuffer& buffer, RenderStatistics& statistics) {
  const CameraRays rays(camera, surface.info.origin, surface.info.scale);
  const SurfelBins bins = binLeaves(surface, rays, camera.size, rules.shrink, rules.near_plane,
                                    rules.front_only && rules.skip, rules.threads, statistics);
  const FrameContext frame{surface, rays, bins, rules};
  statistics += forEachTile<Tile, RenderStatistics>(
      bins, rules.threads, [&](std::size_t t, Tile& tile, RenderStatistics& counts) {
        tile.begin(frame, camera.size, t);
        for (int layer = 0; layer < kMaxLayers; ++layer) {
          findFirstIntersections(frame, t, tile, counts);
          gatherBlends(frame, t, tile, counts);
          if (!peelUncovered(frame, tile)) break;
        }
        resolveTile(frame, tile, buffer, counts);
      });
}

}  // namespace

struct ReferenceRenderer::State {
  const SLIMSurface& surface;
  Error defect;  ///< of the surface
  SurfacePainter painter;
  GapCloser gaps;
};

ReferenceRenderer::ReferenceRenderer(const SLIMSurface& surface)
    : state_(new State{surface, surface.validate(), SurfacePainter(surface), GapCloser(surface)}) {}

ReferenceRenderer::~ReferenceRenderer() = default;

Error ReferenceRenderer::check(const Camera& camera, const RenderParams& params) const {
  if (Error error = camera.validate()) return error;
  if (Error error = params.validate()) return error;
  if (params.lod > 0.0) {
    return {ErrorCode::kBadArgument,
            "the reference rasteriser draws every leaf; set the level of detail to 0"};
  }
  return state_->defect;
}

Error ReferenceRenderer::render(const Camera& camera, const RenderParams& params, GBuffer& buffer,
                                RenderStatistics* statistics) {
  if (Error error = check(camera, params)) {
    buffer.resize(0, 0);
    return error;
  }
  const SLIMSurface& surface = state_->surface;
  RenderParams wanted = params;
  if (params.columns & kColorColumn) wanted.columns |= kPositionColumn;
  RenderStatistics counts;
  buffer.resize(camera.size.width, camera.size.height, wanted.columns);
  drawLeaves(surface, camera, FrameRules(surface.info, params), buffer, counts);
  const int threads = resolveThreads(params.threads);
  if (closesGaps(params)) {
    counts.closed_pixels = state_->gaps.close(camera, wanted, threads, buffer);
    counts.covered_pixels += counts.closed_pixels;
  }
  for (std::size_t i = 0; i < buffer.residual.size(); ++i) {
    buffer.residual[i] = buffer.covered(i) ? surface.error[buffer.surfel[i]] : 0.0f;
  }
  if (wanted.columns & kColorColumn) state_->painter.paint(camera, threads, buffer);
  if (statistics) *statistics = counts;
  return {};
}

Error renderReference(const SLIMSurface& surface, const Camera& camera, const RenderParams& params,
                      GBuffer& buffer, RenderStatistics* statistics) {
  return ReferenceRenderer(surface).render(camera, params, buffer, statistics);
}

}  // namespace pcl_slim::lab
