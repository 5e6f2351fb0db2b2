// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "fast/frame_scene.h"
#include "fast/setup/leaf_clusters.h"
#include "fast/setup/leaf_setup.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/render_params.h"

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

  /** \brief Draws a frame. \param[in,out] buffer of the camera's size; every pixel is written */
  void draw(const Camera& camera, const FrameRules& rules, unsigned columns, GBuffer& buffer,
            RenderStatistics& statistics);

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
  FrameLeaf& record(std::size_t place)
  {
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
