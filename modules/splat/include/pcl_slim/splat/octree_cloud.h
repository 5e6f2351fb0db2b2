// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/splat/cielab.h"

namespace pcl_slim {

/** \brief Colours owned by someone else: three consecutive bytes blue, green, red per point, as PCL
 * keeps them; as many points as the CloudView beside it. */
struct ColorView {
  const void* bgr = nullptr;  ///< address of the first point's blue, or null: no colours
  std::size_t stride = 0;     ///< bytes from one point to the next
};

/** \brief One point as the colour octree sees it. */
struct OctreePoint {
  float position[3];    ///< in root cells from OctreeCloud::origin
  float normal[3];      ///< unit, or zero where the point has none
  float lab[3];         ///< CIELAB, or zero where the cloud has no colours
  std::uint32_t order;  ///< the i of CloudView::inputIndex(i)
};

/** \brief The grid of root cells over a cloud. */
struct RootGrid {
  static constexpr int kMaxResolution = 1 << 20;

  int resolution = 0;   ///< cells along the box's longest side; 0: as occupied asks
  double occupied = 0;  ///< occupied cells wanted, roughly, where resolution is 0
};

/** \brief A cloud brought into the Morton order of a grid of cubic cells chosen by its user.
 *
 * Root cells number floor((p - origin) / cell) along each axis; below them keys resolve depth
 * halvings, 21 bits an axis in all. An octree cell at any level is one run of points. Unlike
 * PointStore, whose cells are powers of two of the box, the grid has any size, every finite
 * point stays (also without a normal, also at a position taken), and nothing is built for
 * neighbour searches: about a third of its cost.
 *
 * O(N) time, 48 bytes a point. Same input, same cloud, for any number of threads.
 */
class OctreeCloud {
 public:
  static constexpr int kBits = 21;  ///< of a key, per axis

  /** \brief Orders a cloud. \return why there is none: no points, more than 2^32 - 2, an index
   * outside, not one finite point, or coordinates near the largest double. */
  static Result<OctreeCloud> build(const CloudView& cloud, const ColorView& colors,
                                   const LabTable& table, const RootGrid& grid, int threads = 0);

  std::size_t size() const { return points_.size(); }
  const OctreePoint& point(std::size_t i) const { return points_[i]; }
  const OctreePoint* points() const { return points_.data(); }
  const std::uint64_t* keys() const { return keys_.data(); }

  const std::array<double, 3>& origin() const { return origin_; }  ///< low corner of the grid
  double cell() const { return cell_; }  ///< edge of a root cell, world units; 0: one position
  int depth() const { return depth_; }   ///< halvings that keys resolve below a root cell
  int resolution() const { return resolution_; }  ///< root cells along the longest side
  bool hasColors() const { return has_colors_; }
  std::uint64_t numNonFinite() const { return num_non_finite_; }

  /** \brief Edge, in root cells, of cells whose keys agree above shift bits an axis. */
  double edge(int shift) const;
  /** \brief Centre, in root cells, of the cell of that size around a point. */
  std::array<double, 3> center(std::size_t point, int shift) const;
  /** \brief Number of occupied cells of that size. O(N). */
  std::size_t countCells(int shift, int threads) const;

 private:
  friend class OctreeCloudBuilder;

  AlignedVector<OctreePoint> points_;
  AlignedVector<std::uint64_t> keys_;
  std::array<double, 3> origin_{};
  double cell_ = 0;
  int depth_ = 0, resolution_ = 1;
  bool has_colors_ = false;
  std::uint64_t num_non_finite_ = 0;
};

}  // namespace pcl_slim
