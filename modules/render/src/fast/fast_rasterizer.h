// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "camera/camera_rays.h"
#include "fast/frame_stages.h"
#include "fast/setup/leaf_setup.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/surface.h"
#include "tiles/tiles.h"

namespace pcl_slim::detail {

/** \brief A half space as a view's rays meet it: points of depth value D on the ray through (x, y)
 * of the plane z = 1 (anywhere, if parallel) are in it where by_x x + by_y y + rest + gain D >= 0.
 */
struct FrameCut {
  double by_x, by_y, rest, gain;
};

/** \brief Surfels of one frame sorted into tiles, each tile's from near to far. */
struct FrameTiles {
  int columns = 0, rows = 0;
  std::vector<std::uint32_t> begin;    ///< tile t: entries[begin[t] ... begin[t + 1])
  std::vector<std::uint32_t> entries;  ///< places of records

  std::size_t size() const {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
};

/** \brief What every tile of a frame needs. */
struct FrameScene {
  const SLIMSurface& surface;
  const FrameView& view;
  const CameraRays& rays;  ///< the same camera in double, for surfels too near for records
  const FrameRules& rules;
  const std::vector<FrameCut>& cuts;  ///< of the rules, as this view's rays meet them
  BallShares shares;
  unsigned columns;  ///< GBufferColumn bits
  const AlignedVector<std::uint8_t>& records;
  std::size_t stride;
  const FrameTiles& tiles;
  bool timed;  ///< whether threads count the ticks of their stages

  const FrameLeaf& leaf(std::uint32_t place) const {
    return *reinterpret_cast<const FrameLeaf*>(records.data() + place * stride);
  }
};

/** \brief A record in one tile's coordinates. */
struct TileLeaf {
  const FrameLeaf* leaf;
  float x, y;     ///< X and Y of the tile's upper left pixel
  float sigma;    ///< sigma = sigma + beta * depth, depth being D less the tile's
  float nearest;  ///< in the tile's depth
};

/** \brief Values of some leaves, a row each, padded to whole vectors. */
class LeafTable {
 public:
  static constexpr std::size_t kPadding = 16;

  void reset(std::size_t rows, std::size_t capacity) {
    stride_ = (capacity + 2 * kPadding - 1) / kPadding * kPadding;
    count = 0;
    if (values_.size() < rows * stride_) values_.resize(rows * stride_);
  }
  float* row(std::size_t k) { return values_.data() + k * stride_; }
  const float* row(std::size_t k) const { return values_.data() + k * stride_; }

  std::size_t count = 0;

 private:
  AlignedVector<float> values_;
  std::size_t stride_ = 0;
};

/** \brief A ray of a tile whose hit is not on the surface. */
struct UncoveredRay {
  float x, y;     ///< pixel, from the tile's corner
  float nearest;  ///< where it continues, in the tile's depth
};

/** \brief What pass 1 computes of leaves on a block's rays, kept for pass 2. */
class KeptRays {
 public:
  static constexpr std::size_t kRow = 16;   ///< lanes
  static constexpr std::size_t kRows = 4;   ///< of a leaf
  static constexpr std::size_t kMost = 64;  ///< leaves; 16 KB, the first-level cache has 32

  void beginTile(std::size_t leaves) {
    slots_.assign(leaves, 0);
    block_ = 0;
    values_.resize(kMost * kRows * kRow);
  }
  void beginBlock() {
    ++block_;
    count_ = 0;
  }
  /** \brief Memory for a leaf, or nullptr if there is no more. */
  float* keep(std::uint32_t place) {
    if (count_ == kMost) return nullptr;
    slots_[place] = block_ * kMost + count_;
    return values_.data() + count_++ * kRows * kRow;
  }
  /** \brief What was kept of a leaf in this block, or nullptr. */
  const float* find(std::uint32_t place) const {
    const std::uint32_t slot = slots_[place];
    return slot / kMost == block_ ? values_.data() + slot % kMost * kRows * kRow : nullptr;
  }

 private:
  std::uint32_t block_ = 0, count_ = 0;
  std::vector<std::uint32_t> slots_;  ///< by leaf: block kMost + place in values_
  AlignedVector<float> values_;
};

/** \brief One thread's memory for tiles, reused from tile to tile. */
struct TileScratch {
  std::vector<TileLeaf> leaves;
  StageTicks ticks;
  KeptRays kept;
  LeafTable tile;          ///< all leaves
  LeafTable first, blend;  ///< those that one patch's passes may meet
  LeafTable list;          ///< those of one block in one pass
  std::vector<UncoveredRay> uncovered, packed;
};

/** \brief Some pixels of a tile and what their rays have met, as a kernel's lanes store them. */
struct NearLanes {
  static constexpr std::size_t kSize = 16;

  alignas(64) float x[kSize], y[kSize];           ///< pixel
  alignas(64) float nearest[kSize];               ///< depth value less the tile's
  alignas(64) float first[kSize];                 ///< the same of q^; in and out for pass 1
  alignas(64) float live[kSize];                  ///< 1: to be looked at
  alignas(64) float weight[kSize], shift[kSize];  ///< of one leaf in pass 2
  alignas(64) float coverage[kSize], facing[kSize], offset_sum[3][kSize];
  alignas(64) float outside[kSize];
  alignas(64) float clearance[kSize];                       ///< of leaves without weight, too
  alignas(64) float gradient[3][kSize], hessian[6][kSize];  ///< times weight, camera's axes
  float tile_depth;                                         ///< D of the tile
  std::size_t count;
};

/** \brief Pass 1 of a surfel so near to the camera, or around it, that its record contains no
 * polynomial: in double, ray by ray. */
void firstOfNearLeaf(const FrameScene& scene, std::uint32_t surfel, NearLanes& lanes);

/** \brief Pass 2 of the same. */
void blendNearLeaf(const FrameScene& scene, std::uint32_t surfel, NearLanes& lanes);

}  // namespace pcl_slim::detail

namespace pcl_slim::detail::kernels {

/** \brief Draws tile t of a frame: both passes for each block of pixels, and writes every pixel of
 * the tile. Blocks are 4 pixels wide and as high as the vectors allow. */
void drawTile(const FrameScene& scene, std::size_t t, TileScratch& scratch, GBuffer& buffer,
              RenderStatistics& statistics);

}  // namespace pcl_slim::detail::kernels

namespace pcl_slim::detail {

/** \brief The place of a record in the picture. */
struct PlacedLeaf {
  std::uint32_t depth;          ///< bits in the order of depth values
  std::int16_t x0, y0, x1, y1;  ///< tiles that it touches; x0 > x1: none
};

/** \brief Draws frames of one surface in single precision; keeps its clusters and its memory. */
class FastRasterizer {
 public:
  FastRasterizer(const SLIMSurface& surface, int threads);

  /** \brief Draws a frame. \param[in,out] buffer of the camera's size; every pixel is written
   * \param[in,out] ticks are added for all threads; nullptr: nothing is measured */
  void draw(const Camera& camera, const FrameRules& rules, unsigned columns, GBuffer& buffer,
            RenderStatistics& statistics, StageTicks* ticks = nullptr);

 private:
  void setUp(const FrameView& view, const FrameRules& rules, const BallShares& shares,
             RenderStatistics& statistics);
  void findClusters(const FrameView& view, const VisibilityRules& rules, int threads,
                    RenderStatistics& statistics);
  void setUpCluster(std::size_t n, const FrameView& view, const VisibilityRules& rules,
                    const BallShares& shares, RenderStatistics& statistics);
  void place(std::size_t group, std::size_t count, const FrameView& view);
  void sortByDepth(const FrameRules& rules);
  void bin(const FrameView& view);
  FrameLeaf& record(std::size_t place) {
    return *reinterpret_cast<FrameLeaf*>(records_.data() + place * stride_);
  }

  const SLIMSurface& surface_;
  LeafClusters leaves_;
  TrimTables trims_;
  bool trim_ = true;                        ///< whether this frame ends where trim maps do
  std::unique_ptr<LeafClusters> internal_;  ///< made when a level of detail is first requested
  std::size_t stride_;
  std::vector<std::uint32_t> clusters_;  ///< those that may be seen, leaves' first
  std::size_t leaf_clusters_ = 0;
  BallShape leaf_shape_, internal_shape_;  ///< of this frame
  std::vector<std::uint8_t> counts_;       ///< records of each
  AlignedVector<std::uint8_t> records_;    ///< kClusterSize places for each of them
  std::vector<PlacedLeaf> placed_;         ///< by record
  AlignedVector<std::uint64_t> by_depth_;  ///< depth value's bits and place
  FrameTiles tiles_;
  std::vector<TileScratch> scratch_;
};

}  // namespace pcl_slim::detail
