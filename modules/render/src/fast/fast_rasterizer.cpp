// SPDX-License-Identifier: BSD-3-Clause
// Frames in single precision: surfels too near for records, clusters, tiles.
#include "fast/fast_rasterizer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "fast/setup/leaf_setup.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/render/detail/frame_constants.h"
#include "tiles/tiles.h"

namespace pcl_slim::detail {
namespace {

/** \brief Depths along a ray and the tile's depth values, both ways. */
struct DepthScale {
  bool perspective;
  double tile, slant;  ///< slant: length of the ray's step to the next unit of z

  DepthScale(const FrameScene& scene, const Ray& ray, float tile_depth)
      : perspective(scene.view.perspective), tile(tile_depth) {
    const auto& f = scene.view.forward;
    const auto& d = ray.direction;
    slant = 1.0 / (d[0] * f[0] + d[1] * f[1] + d[2] * f[2]);
  }
  double along(double value) const {
    const double depth = value + tile;
    if (!perspective) return depth;
    return depth < 0.0 ? -slant / depth : std::numeric_limits<double>::infinity();
  }
  float value(double depth) const {
    return static_cast<float>((perspective ? -slant / depth : depth) - tile);
  }
};

/** \brief A vector or a symmetric matrix in the camera's axes. */
void turn(const FrameView& view, const BlendSum& sum, std::size_t lane, NearLanes& lanes) {
  const float* const axes[3] = {view.right, view.up, view.forward};
  const Symmetric3<double>& h = sum.hessian;
  const auto product = [&](int i, int j) {
    double value = 0.0;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) value += h[kSymmetricEntry[a][b]] * axes[i][a] * axes[j][b];
    }
    return static_cast<float>(value);
  };
  for (int i = 0; i < 3; ++i) {
    double value = 0.0;
    for (int a = 0; a < 3; ++a) value += sum.gradient[a] * axes[i][a];
    lanes.gradient[i][lane] = static_cast<float>(value);
    for (int j = i; j < 3; ++j) lanes.hessian[kSymmetricEntry[i][j]][lane] = product(i, j);
    lanes.offset_sum[i][lane] = static_cast<float>(sum.offset_sum[i]);
  }
}

}  // namespace

void firstOfNearLeaf(const FrameScene& scene, std::uint32_t surfel, NearLanes& lanes) {
  const RaySurfel leaf(scene.surface, surfel);
  std::uint64_t evaluated = 0;
  for (std::size_t i = 0; i < lanes.count; ++i) {
    if (!(lanes.live[i] > 0.0f)) continue;
    const Ray ray = scene.rays.ray(static_cast<int>(lanes.x[i]), static_cast<int>(lanes.y[i]));
    const DepthScale scale(scene, ray, lanes.tile_depth);
    const double nearest = std::max(scene.rules.near_plane, scale.along(lanes.nearest[i]));
    const double limit = scale.along(lanes.first[i]);
    const double depth = firstRoot(scene.rules, leaf, ray, nearest, limit, evaluated);
    if (depth < limit && depth > 0.0) lanes.first[i] = scale.value(depth);
  }
}

void blendNearLeaf(const FrameScene& scene, std::uint32_t surfel, NearLanes& lanes) {
  const RaySurfel leaf(scene.surface, surfel);
  std::uint64_t evaluated = 0;
  for (std::size_t i = 0; i < lanes.count; ++i) {
    lanes.weight[i] = lanes.clearance[i] = 0.0f;
    if (!(lanes.live[i] > 0.0f)) continue;
    const Ray ray = scene.rays.ray(static_cast<int>(lanes.x[i]), static_cast<int>(lanes.y[i]));
    const DepthScale scale(scene, ray, lanes.tile_depth);
    BlendSum sum;
    blendLeaf(scene.rules, scene.surface.info.blend_kernel, leaf, surfel, ray,
              scale.along(lanes.first[i]), sum, evaluated);
    lanes.clearance[i] = static_cast<float>(sum.clearance);
    if (sum.leaves == 0) continue;
    lanes.weight[i] = static_cast<float>(sum.weight);
    lanes.shift[i] = static_cast<float>(sum.shift / scale.slant);
    lanes.coverage[i] = static_cast<float>(sum.coverage);
    lanes.outside[i] = static_cast<float>(sum.outside);
    lanes.facing[i] = static_cast<float>(sum.facing);
    turn(scene.view, sum, i, lanes);
  }
}

namespace {

double along(const HalfSpace& cut, const float axis[3]) {
  return cut.normal[0] * axis[0] + cut.normal[1] * axis[1] + cut.normal[2] * axis[2];
}

/** Half spaces of local coordinates as a view's rays meet them. */
std::vector<FrameCut> frameCuts(const FrameView& view, const std::vector<HalfSpace>& cuts) {
  std::vector<FrameCut> frame;
  for (const HalfSpace& cut : cuts) {
    const double offset = cut.offset - along(cut, view.eye) - along(cut, view.eye_rest);
    const double forward = along(cut, view.forward);
    // n . (x z, y z, z) >= offset, divided by z > 0: 1 / z = -D.
    frame.push_back({along(cut, view.right), along(cut, view.up),
                     view.perspective ? forward : -offset, view.perspective ? offset : forward});
  }
  return frame;
}

constexpr float kFarAway = -1e9f;  ///< pixels: left of every picture

/** \brief Bits that order floats as their values do. */
std::uint32_t orderedBits(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

/** \brief The tiles that contain pixels of a leaf's circle. */
PlacedLeaf placeOf(const FrameLeaf& leaf, const FrameView& view) {
  constexpr float kToTile = 1.0f / kTileSize;
  const auto tile = [](float pixel, int size) {
    const float inside = std::clamp(pixel, -1.0f, static_cast<float>(size));
    return static_cast<std::int16_t>(static_cast<int>((inside + kTileSize) * kToTile) - 1);
  };
  PlacedLeaf placed;
  placed.depth = orderedBits(leaf.nearest);
  placed.x0 = std::max<std::int16_t>(0, tile(leaf.blend_x - leaf.blend_reach, view.width));
  placed.y0 = std::max<std::int16_t>(0, tile(leaf.blend_y - leaf.blend_reach, view.height));
  placed.x1 = tile(std::min(leaf.blend_x + leaf.blend_reach, view.width - 1.0f), view.width);
  placed.y1 = tile(std::min(leaf.blend_y + leaf.blend_reach, view.height - 1.0f), view.height);
  return placed;
}

/** \brief Adds leaves left out to a frame's counts; internal surfels are not counted. */
void countHidden(bool are_leaves, const std::uint64_t* hidden, RenderStatistics& statistics) {
  if (!are_leaves) return;
  const auto of = [&](Visibility v) { return hidden[static_cast<std::size_t>(v)]; };
  statistics.outside_frustum += of(Visibility::kOutside);
  statistics.outside_region += of(Visibility::kCutAway);
  statistics.back_facing += of(Visibility::kBackFacing);
  statistics.below_detail += of(Visibility::kTooSmall);
}

}  // namespace

FastRasterizer::FastRasterizer(const SLIMSurface& surface, int threads)
    : surface_(surface),
      leaves_(surface, threads),
      trims_(surface),
      stride_(leafStride(std::max(2, surface.info.degree))) {}

void FastRasterizer::place(std::size_t group, std::size_t count, const FrameView& view) {
  counts_[group] = static_cast<std::uint8_t>(count);
  const float scale = group < leaf_clusters_ ? leaf_shape_.scale : internal_shape_.scale;
  for (std::size_t k = 0; k < count; ++k) {
    FrameLeaf& leaf = record(group * kClusterSize + k);
    leaf.trim = trim_ ? trims_.of(leaf.surfel) : TrimTable();
    leaf.trim_scale = scale;
    if (leaf.degree == kNearLeaf) {
      // The camera is inside the ball or next to it: it may be seen anywhere.
      leaf.blend_x = leaf.blend_y = leaf.first_x = leaf.first_y = 0.0f;
      leaf.blend_reach = leaf.first_reach = 1e9f;
      leaf.nearest = -std::numeric_limits<float>::max();
    } else if (!std::isfinite(leaf.blend_x + leaf.blend_y + leaf.blend_reach)) {
      leaf.blend_x = leaf.first_x = kFarAway;  // too many radii away for a float
      leaf.blend_y = leaf.blend_reach = 0.0f;
    }
    placed_[group * kClusterSize + k] = placeOf(leaf, view);
  }
}

void FastRasterizer::setUpCluster(std::size_t n, const FrameView& view,
                                  const VisibilityRules& rules, const BallShares& shares,
                                  RenderStatistics& statistics) {
  const bool are_leaves = n < leaf_clusters_;
  const LeafClusters& leaves = are_leaves ? leaves_ : *internal_;
  const LeafCluster& cluster = leaves.cluster(clusters_[n]);
  Visibility visibility[kClusterSize];
  float weights[kClusterSize], drawn[kClusterSize];
  kernels::cullLeaves(leaves, cluster.begin, cluster.end, view, rules, visibility, weights);
  const BallShape shape = are_leaves ? leaf_shape_ : internal_shape_;
  BatchFiller filler(surface_, view, shares);
  std::size_t count = 0;
  std::uint64_t hidden[kVisibilities] = {};
  for (std::uint32_t i = cluster.begin; i < cluster.end; ++i) {
    ++hidden[static_cast<std::size_t>(visibility[i - cluster.begin])];
    if (visibility[i - cluster.begin] != Visibility::kVisible) continue;
    drawn[count] = weights[i - cluster.begin];
    filler.add(leaves.surfel[i], leaves.variance_weight[i] * drawn[count], shape,
               &record(n * kClusterSize + count));
    ++count;
  }
  filler.flushAll();
  place(n, count, view);
  for (std::size_t k = 0; k < count; ++k) {
    FrameLeaf& leaf = record(n * kClusterSize + k);
    const bool behind = rules.front_only && leaf.turn == LeafTurn::kRises;
    if (drawn[k] < DetailRule::kMeets || (behind && leaf.degree != kNearLeaf)) {
      leaf.first_x = kFarAway;
    }
  }
  countHidden(are_leaves, hidden, statistics);
  if (!are_leaves) statistics.coarse_surfels += count;
}

void FastRasterizer::findClusters(const FrameView& view, const VisibilityRules& rules, int threads,
                                  RenderStatistics& statistics) {
  clusters_.clear();
  std::uint64_t hidden[kVisibilities] = {};
  leaves_.findVisible(view, rules, clusters_, hidden);
  countHidden(true, hidden, statistics);
  leaf_clusters_ = clusters_.size();
  if (!rules.detail.active()) return;
  if (!internal_) {
    internal_ = std::make_unique<LeafClusters>(surface_, threads, ClusteredSurfels::kInternal);
  }
  internal_->findVisible(view, rules, clusters_, hidden);
}

void FastRasterizer::setUp(const FrameView& view, const FrameRules& rules, const BallShares& shares,
                           RenderStatistics& statistics) {
  const VisibilityRules visible{rules.front_only && rules.skip,
                                DetailRule{static_cast<float>(rules.lod)}, rules.cuts};
  findClusters(view, visible, rules.threads, statistics);
  trim_ = rules.trim;
  leaf_shape_ = {1.0f, static_cast<float>(1.0 / (rules.cover_radius * rules.cover_radius))};
  // Internal surfels overlap far less than leaves: rays meet them in the whole ball.
  internal_shape_ = {static_cast<float>(kMaxShrink / rules.shrink), 0.0f};
  counts_.resize(clusters_.size());
  records_.resize(clusters_.size() * kClusterSize * stride_);
  placed_.resize(clusters_.size() * kClusterSize);
  std::vector<RenderStatistics> parts(static_cast<std::size_t>(rules.threads));
  parallelFor(clusters_.size(), rules.threads, 8, [&](std::size_t n, int thread) {
    setUpCluster(n, view, visible, shares, parts[static_cast<std::size_t>(thread)]);
  });
  for (const RenderStatistics& part : parts) statistics += part;
}

void FastRasterizer::sortByDepth(const FrameRules& rules) {
  by_depth_.clear();
  for (std::size_t n = 0; n < counts_.size(); ++n) {
    for (std::size_t k = 0; k < counts_[n]; ++k) {
      const std::size_t place = n * kClusterSize + k;
      by_depth_.push_back(std::uint64_t{placed_[place].depth} << 32 | place);
    }
  }
  sortByBits(by_depth_, 32, 64, rules.threads);
}

void FastRasterizer::bin(const FrameView& view) {
  tiles_.columns = (view.width + kTileSize - 1) / kTileSize;
  tiles_.rows = (view.height + kTileSize - 1) / kTileSize;
  tiles_.begin.assign(tiles_.size() + 1, 0);
  const auto forEachPair = [&](const auto& visit) {
    for (const std::uint64_t value : by_depth_) {
      const auto place = static_cast<std::uint32_t>(value);
      const PlacedLeaf& leaf = placed_[place];
      for (int y = leaf.y0; y <= leaf.y1; ++y) {
        for (int x = leaf.x0; x <= leaf.x1; ++x) {
          visit(static_cast<std::size_t>(y * tiles_.columns + x), place);
        }
      }
    }
  };
  forEachPair([&](std::size_t t, std::uint32_t) { ++tiles_.begin[t + 1]; });
  for (std::size_t t = 0; t < tiles_.size(); ++t) tiles_.begin[t + 1] += tiles_.begin[t];
  tiles_.entries.resize(tiles_.begin.back());
  std::vector<std::uint32_t> next(tiles_.begin.begin(), tiles_.begin.end() - 1);
  forEachPair([&](std::size_t t, std::uint32_t place) { tiles_.entries[next[t]++] = place; });
}

void FastRasterizer::draw(const Camera& camera, const FrameRules& rules, unsigned columns,
                          GBuffer& buffer, RenderStatistics& statistics, StageTicks* ticks) {
  const FrameView view(camera, surface_.info.origin, surface_.info.scale);
  const CameraRays rays(camera, surface_.info.origin, surface_.info.scale);
  const BallShares shares{
      static_cast<float>(rules.shrink),
      std::max(weightReach(surface_.info.blend_kernel), static_cast<float>(rules.shrink))};
  statistics.leaves += leaves_.size();
  {
    const StageTimer timer(ticks, FrameStage::kSetup);
    setUp(view, rules, shares, statistics);
  }
  {
    const StageTimer timer(ticks, FrameStage::kSort);
    sortByDepth(rules);
    bin(view);
  }
  statistics.tile_entries += tiles_.entries.size();

  const std::vector<FrameCut> cuts = frameCuts(view, rules.cuts);
  const FrameScene scene{surface_, view,    rays,   rules,           cuts, shares, columns,
                         records_, stride_, tiles_, ticks != nullptr};
  const auto threads = static_cast<std::size_t>(rules.threads);
  if (scratch_.size() < threads) scratch_.resize(threads);
  for (TileScratch& own : scratch_) own.ticks = {};
  std::vector<RenderStatistics> parts(threads);
  parallelFor(tiles_.size(), rules.threads, 1, [&](std::size_t t, int thread) {
    const auto own = static_cast<std::size_t>(thread);
    if (tiles_.begin[t] < tiles_.begin[t + 1]) {
      kernels::drawTile(scene, t, scratch_[own], buffer, parts[own]);
      return;
    }
    const StageTimer timer(ticks ? &scratch_[own].ticks : nullptr, FrameStage::kOutput);
    const int x0 = static_cast<int>(t) % tiles_.columns * kTileSize;
    const int y0 = static_cast<int>(t) / tiles_.columns * kTileSize;
    const int width = std::min(kTileSize, view.width - x0);
    for (int y = y0; y < std::min(y0 + kTileSize, view.height); ++y) {
      clearPixels(buffer, buffer.index(x0, y), static_cast<std::size_t>(width));
    }
  });
  for (const RenderStatistics& part : parts) statistics += part;
  if (!ticks) return;
  for (const TileScratch& own : scratch_) *ticks += own.ticks;
}

}  // namespace pcl_slim::detail
