// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "camera/camera_rays.h"
#include "fast/setup/frame_leaf.h"
#include "fast/setup/leaf_setup.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/surface/surface.h"
#include "tiles/frame_rules.h"

namespace pcl_slim::detail {

/** \brief A half space as a view's rays meet it: points of depth value D on the ray through (x, y) of
 * the plane z = 1 (anywhere, if parallel) are in it where by_x x + by_y y + rest + gain D >= 0. */
struct FrameCut {
  double by_x, by_y, rest, gain;
};

/** \brief Surfels of one frame sorted into tiles, each tile's from near to far. */
struct FrameTiles {
  int columns = 0, rows = 0;
  std::vector<std::uint32_t> begin;    ///< tile t: entries[begin[t] ... begin[t + 1])
  std::vector<std::uint32_t> entries;  ///< places of records

  std::size_t size() const
  {
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

  const FrameLeaf& leaf(std::uint32_t place) const
  {
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

  void reset(std::size_t rows, std::size_t capacity)
  {
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

/** \brief One thread's memory for tiles, reused from tile to tile. */
struct TileScratch {
  std::vector<TileLeaf> leaves;
  LeafTable tile;          ///< all leaves
  LeafTable first, blend;  ///< those that one patch's passes may meet
  LeafTable list;          ///< those of one block in one pass
  std::vector<UncoveredRay> uncovered, packed;
};

}  // namespace pcl_slim::detail
