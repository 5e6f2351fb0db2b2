// SPDX-License-Identifier: BSD-3-Clause
#include "trim/trim.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "fit_plan.h"
#include "pcl_slim/core/parallel.h"
#include "trim/support.h"

namespace pcl_slim::detail {

namespace {

constexpr BorderConstants kBorder;

/** For each block of points, whether a leaf ends at one of them. */
using OpenBlocks = std::vector<std::atomic<std::uint8_t>>;

/** \brief Makes the trim maps of one surface's surfels, one after another. One per thread: it keeps
 * its memory. */
class TrimMaker {
 public:
  TrimMaker(const PointStore& store, const FitPlan& plan, double hole_size, bool edges_end,
            const SLIMSurface& surface, LocalSpacing& local_spacing, OpenBlocks& open_blocks,
            PointBorders& borders)
      : store_(store),
        plan_(plan),
        hole_size_(hole_size),
        surface_(surface),
        local_spacing_(local_spacing),
        open_blocks_(open_blocks),
        border_(store, kBorder, std::sqrt(plan.noise), hole_size,
                plan.with_normals ? plan.min_dot : -2.0f, edges_end, local_spacing, borders) {}

  /** \brief Surfels begin to end are made next: lists the points around them, if they are near to
   * each other. */
  void prepare(std::size_t begin, std::size_t end);

  /** \brief Appends the bits of surfel i's map; nothing if it is closed. \return the map's side, 0
   * if it is closed. \param[in] by_leaves whether gaps count only where a leaf made before is open.
   * O(points of the ball). */
  int make(std::size_t i, bool by_leaves, std::vector<std::uint8_t>& bits);

  /** \brief Surfels with gaps so far. */
  std::uint64_t numCandidates() const { return candidates_; }

 private:
  kernels::CoverLeaf wideSurfel(std::size_t i, const std::array<float, 3>& normal) const;
  void listBlocks(const kernels::CoverLeaf& surfel);
  bool hasOpenBlock() const;
  void gather(std::size_t i, const kernels::CoverLeaf& surfel);
  bool dataEndAtGaps();
  void markOpen(std::uint32_t k);
  bool standsOff(std::size_t i, SupportedSurface& surface);
  int appendMap(double spacing, std::vector<std::uint8_t>& bits) const;

  const PointStore& store_;
  const FitPlan& plan_;
  double hole_size_;
  const SLIMSurface& surface_;
  LocalSpacing& local_spacing_;
  OpenBlocks& open_blocks_;
  BlockNeighborhood nearby_;  ///< of the surfels being made
  bool has_nearby_ = false;
  std::vector<std::uint32_t> found_;
  BlockList blocks_;  ///< of the ball
  SheetPoints points_;
  TrimRaster raster_;
  BorderTest border_;
  SupportTest support_;
  std::vector<std::array<double, 2>> places_;  ///< in gaps, [r]
  std::vector<std::uint32_t> rims_;            ///< of gaps: points_
  std::uint64_t candidates_ = 0;
};

/** Sets the bit of the node next to each point: smoothing removes points that are isolated or in a
 * single row. */
void keepPoints(const SheetPoints& points, int side, std::uint8_t* bits) {
  const float per_unit = 0.5f * static_cast<float>(side - 1);
  for (std::size_t i = 0; i < points.count; ++i) {
    const float u = points.u[i], v = points.v[i];
    if (std::max(std::abs(u), std::abs(v)) > 1.0f) continue;
    const int column = static_cast<int>((u + 1.0f) * per_unit + 0.5f);
    const int k = static_cast<int>((v + 1.0f) * per_unit + 0.5f) * side + column;
    bits[k >> 3] |= static_cast<std::uint8_t>(1 << (k & 7));
  }
}

/** Surfel i as the cover sees it, with a wider ball and a larger residual bound around it.
 * \param[in] normal its own, which must outlive the result */
kernels::CoverLeaf TrimMaker::wideSurfel(std::size_t i, const std::array<float, 3>& normal) const {
  const float r = surface_.radius[i];
  kernels::CoverLeaf surfel;
  surfel.ball = {{surface_.cx[i], surface_.cy[i], surface_.cz[i]},
                 static_cast<float>(kTrim.known * r),
                 plan_.with_normals ? normal.data() : nullptr,
                 plan_.min_dot};
  surfel.frame = LocalFrame({normal[0], normal[1], normal[2]});
  surfel.degree = surface_.degree[i];
  surfel.support_radius = r;
  surfel.c = surface_.coefficientsOf(i);
  surfel.max_residual = static_cast<float>(
      std::max(kTrim.gate * r, plan_.constants.cover.residual_bound * surface_.error[i]));
  return surfel;
}

void TrimMaker::listBlocks(const kernels::CoverLeaf& surfel) {
  if (has_nearby_) {
    nearby_.blocksInBall(surfel.ball.center.data(), surfel.ball.radius, blocks_);
  } else {
    found_.clear();
    store_.tree().blocksInBall(surfel.ball.center.data(), surfel.ball.radius, found_);
    blocks_.assign(found_.begin(), found_.end());
  }
}

/** Whether a leaf with a block in the list is open. */
bool TrimMaker::hasOpenBlock() const {
  return std::any_of(blocks_.begin(), blocks_.end(), [&](std::uint32_t b) {
    return open_blocks_[b].load(std::memory_order_relaxed) != 0;
  });
}

void TrimMaker::gather(std::size_t i, const kernels::CoverLeaf& surfel) {
  if (!surface_.isLeaf(i) && blocks_.size() * PointStore::kBlock > kTrim.sampled) {
    sampleSheet(store_, blocks_, surfel, points_);
  } else {
    kernels::gatherSheet(store_, blocks_, surfel, points_);
  }
}

void TrimMaker::prepare(std::size_t begin, std::size_t end) {
  constexpr float kMostSpread = 16;  // of the balls' box over the widest ball; saves time alone
  const float* centers[3] = {surface_.cx.data(), surface_.cy.data(), surface_.cz.data()};
  float low[3], high[3], widest = 0, spread = 0;
  for (std::size_t i = begin; i < end; ++i) widest = std::max(widest, surface_.radius[i]);
  widest *= static_cast<float>(kTrim.known);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [least, most] = std::minmax_element(centers[a] + begin, centers[a] + end);
    low[a] = *least - widest;
    high[a] = *most + widest;
    spread = std::max(spread, high[a] - low[a]);
  }
  has_nearby_ = spread < kMostSpread * widest;
  if (has_nearby_) nearby_.collect(store_.tree(), low, high);
}

/** Whether the data end at a point next to a gap, in the part of the surfel that is drawn. Where
 * there are many, as beside a dense clump, a part is tested, the same from all leaves. */
bool TrimMaker::dataEndAtGaps() {
  constexpr auto kMost = static_cast<float>(kTrim.looked_at * kTrim.looked_at);
  const std::size_t stride = strideFor(rims_.size(), kTrim.enough_rims);
  const auto border = std::find_if(rims_.begin(), rims_.end(), [&](std::uint32_t k) {
    const float u = points_.u[k], v = points_.v[k], w = points_.w[k];
    return points_.index[k] % stride == 0 && u * u + v * v + w * w < kMost &&
           border_.isBorder(points_.index[k]);
  });
  if (border == rims_.end()) return false;
  markOpen(*border);
  return true;
}

/** Makes the block of one of the gathered points known as open. */
void TrimMaker::markOpen(std::uint32_t k) {
  open_blocks_[points_.index[k] / PointStore::kBlock].store(1, std::memory_order_relaxed);
}

/** Whether the surfel's surface leaves its points where these turn away from it. At a step of density
 * the spacing is that of the sparse side, of which points are next to gaps. */
bool TrimMaker::standsOff(std::size_t i, SupportedSurface& surface) {
  if (!support_.standsOff(points_, surface)) return false;
  double widest = kBorder.step * surface.spacing;
  const std::size_t stride = strideFor(rims_.size(), kTrim.enough_rims);
  for (const std::uint32_t k : rims_) {
    if (points_.index[k] % stride == 0)
      widest = std::max<double>(widest, local_spacing_.at(points_.index[k]) / surface_.radius[i]);
  }
  if (widest > kBorder.step * surface.spacing) {
    surface.spacing = widest;
    if (!support_.standsOff(points_, surface)) return false;
  }
  for (const std::uint32_t k : rims_) markOpen(k);
  return true;
}

int TrimMaker::make(std::size_t i, bool by_leaves, std::vector<std::uint8_t>& bits) {
  const std::array<float, 3> normal{surface_.nx[i], surface_.ny[i], surface_.nz[i]};
  const kernels::CoverLeaf surfel = wideSurfel(i, normal);
  listBlocks(surfel);
  if (by_leaves && !hasOpenBlock()) return 0;
  gather(i, surfel);
  const float* c = surface_.coefficientsOf(i);
  // The finest map has a node a spacing, the coarsest five a side.
  double least = 2.0 / (TrimMap::kMostSide - 1);
  if (!surface_.isLeaf(i)) least = 2.0 / (kTrim.internal_side - 1);
  const double spacing = std::clamp(support_.spacingOf(points_), least, 0.5);
  const TrimScale scale{spacing, hole_size_ * spacing, kTrim.growth * spacing};
  // The disc of a border point is empty up to its middle, and farther.
  const double sure = std::min(kTrim.known, kTrim.looked_at + 0.5 * scale.hole);
  raster_.findGaps(points_, KnownRegion(surface_.degree[i], c, sure), scale, places_);
  if (places_.empty()) return 0;
  ++candidates_;
  SupportedSurface supported{surface_.degree[i], c, spacing,
                             std::sqrt(plan_.noise) / surface_.radius[i]};
  if (!by_leaves) {
    raster_.findRims(points_, places_, rims_);
    if (!dataEndAtGaps() && !standsOff(i, supported)) return 0;
  }
  raster_.measureDepths(points_, KnownRegion(surface_.degree[i], c, kTrim.known));
  const double clear = TrimRaster::kDepthUnit * kTrim.clear * spacing / raster_.cell();
  if (raster_.leastDepth(kTrim.looked_at) > clear) return 0;
  const std::size_t begin = bits.size();
  const int side = appendMap(spacing, bits);
  support_.cutMap(points_, supported, side, bits.data() + begin);
  return side;
}

/** \return the map's side: a node a spacing. */
int TrimMaker::appendMap(double spacing, std::vector<std::uint8_t>& bits) const {
  const int side = std::clamp(static_cast<int>(std::ceil(2.0 / spacing)) + 1, TrimMap::kLeastSide,
                              TrimMap::kMostSide);
  const std::size_t begin = bits.size();
  bits.resize(begin + TrimMap::numBytes(side), 0);
  raster_.fillMap(side, bits.data() + begin);
  keepPoints(points_, side, bits.data() + begin);
  return side;
}

constexpr std::size_t kRun = 64;  ///< surfels a thread takes at a time; no result depends on it

}  // namespace

std::uint64_t makeTrimMaps(const PointStore& store, const FitPlan& plan, const FitParams& params,
                           int threads, SLIMSurface& surface) {
  if (!params.trim || params.paper_mode) return 0;
  LocalSpacing spacing(store, kBorder, std::sqrt(plan.noise));
  PointBorders borders(store.size());
  OpenBlocks open(store.numBlocks());
  std::vector<std::unique_ptr<TrimMaker>> makers;
  makers.reserve(static_cast<std::size_t>(threads));
  for (int t = 0; t < threads; ++t)
    makers.push_back(std::make_unique<TrimMaker>(
        store, plan, params.hole_size, params.sharp_features, surface, spacing, open, borders));
  std::vector<std::uint8_t> sides(surface.size());
  // Internal surfels know from the leaves, which are made first, where the data end.
  const std::size_t leaves = surface.numLeaves(), count = (surface.size() + kRun - 1) / kRun;
  std::array<std::vector<std::vector<std::uint8_t>>, 2> runs;
  for (const bool leaf : {true, false}) {
    runs[leaf].resize(count);
    parallelFor(count, threads, 1, [&](std::size_t run, int thread) {
      const std::size_t begin = run * kRun, end = std::min(surface.size(), begin + kRun);
      TrimMaker& maker = *makers[static_cast<std::size_t>(thread)];
      maker.prepare(begin, end);
      for (std::size_t i = begin; i < end; ++i) {
        if (surface.isLeaf(i) != leaf) continue;
        sides[i] = static_cast<std::uint8_t>(maker.make(i, !leaf && leaves > 0, runs[leaf][run]));
      }
    });
  }
  std::vector<std::uint8_t> bits;
  for (std::size_t run = 0; run < count; ++run) {
    std::array<const std::uint8_t*, 2> next{runs[0][run].data(), runs[1][run].data()};
    for (std::size_t i = run * kRun; i < std::min(surface.size(), (run + 1) * kRun); ++i) {
      if (sides[i] == 0) continue;
      const std::uint8_t*& from = next[surface.isLeaf(i)];
      bits.insert(bits.end(), from, from + TrimMap::numBytes(sides[i]));
      from += TrimMap::numBytes(sides[i]);
    }
  }
  surface.setTrimMaps(sides, bits);
  std::uint64_t candidates = 0;
  for (const auto& maker : makers) candidates += maker->numCandidates();
  return candidates;
}

}  // namespace pcl_slim::detail
