// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/cielab.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

namespace detail {
class OctreeCloudBuilder;
}

/** \brief The grid of root cells over a cloud. */
struct RootGrid {
  static constexpr int kMaxResolution = 1 << 20;

  int resolution = 0;   ///< cells along the box's longest side; 0: from the others
  double occupied = 0;  ///< occupied cells wanted, roughly, where resolution is 0
  double points_per_root =
      0;  ///< > 0: approximate number of distinct places in an occupied cell, instead
};

/** \brief From world coordinates to root cells. */
struct OctreeFrame {
  std::array<double, 3> origin{};  ///< low corner of the grid
  double scale = 0;                ///< root cells per world unit; 0: one position
  float last = 0;                  ///< largest position inside the grid

  template <typename T>
  void position(const T world[3], float cells[3]) const {
    for (std::size_t a = 0; a < 3; ++a) {
      const auto c = static_cast<float>((static_cast<double>(world[a]) - origin[a]) * scale);
      cells[a] = c < last ? c : last;
    }
  }
};

/** \brief The order of a cloud's points along the Morton curve of a grid of cubic cells chosen by
 * its user; the points themselves stay where they are.
 *
 * Root cells number floor((p - origin) / cell) along each axis; below them keys resolve depth
 * halvings, 21 bits an axis in all. An octree cell at any level is one run of points. Unlike
 * PointStore, whose cells are powers of two of the box, the grid has any size, every finite
 * point stays (also without a normal), and nothing is built for neighbour searches.
 *
 * Points equal in place, normal and colour count once. Points with equal keys are ordered by
 * place, normal and colour, so that nothing depends on the order in which the owner has them. O(N)
 * time, 12 bytes a point and 16 a root; 8 bytes a point more while it is built. Same input, same
 * order, for any number of threads.
 */
class PCL_SLIM_EXPORT OctreeCloud {
 public:
  static constexpr int kBits = 21;  ///< cells resolved along an axis: 2 to this power

  /** \brief Where a root's points begin. */
  struct Root {
    std::uint64_t key;    ///< Morton code of the root cell
    std::uint32_t begin;  ///< its first point
  };

  /** \brief Orders a cloud. \return why there is none: no points, more than 2^32 - 2, an index
   * outside, not one finite point, or coordinates near the largest double. */
  static Result<OctreeCloud> build(const CloudView& cloud, const RootGrid& grid, int threads = 0,
                                   const ColorView& colors = {});

  std::size_t size() const { return order_.size(); }
  /** \brief The i-th point along the curve, as the i of CloudView::inputIndex. */
  std::uint32_t order(std::size_t i) const { return order_[i]; }

  /** \brief Ascending Morton codes; their bits from 3 shift on identify cells of 2^shift times the
   * smallest. Below the bits that distinguish a point from all others they are 0. */
  const std::uint64_t* keys() const { return keys_.data(); }

  std::size_t numRoots() const { return roots_.size() - 1; }
  /** \brief Occupied roots along the curve; the one behind the last begins at size(). */
  const Root& root(std::size_t r) const { return roots_[r]; }
  /** \brief The root that contains a point. O(log roots). */
  std::size_t rootOf(std::size_t point) const;
  /** \brief Number of occupied cells 2^growth roots wide. O(roots). */
  std::size_t countCells(int growth) const;

  const OctreeFrame& frame() const { return frame_; }
  double cell() const { return cell_; }  ///< edge of a root cell, world units; 0: one position
  int depth() const { return depth_; }   ///< halvings that positions resolve below a root cell
  int resolution() const { return resolution_; }  ///< root cells along the longest side
  std::uint64_t numNonFinite() const { return num_non_finite_; }
  std::uint64_t numDuplicates() const { return num_duplicates_; }

  /** \brief Edge, in root cells, of cells 2^shift times the smallest. */
  double edge(int shift) const;
  /** \brief Centre, in root cells, of the cell of that size around a position. */
  std::array<double, 3> center(const std::array<float, 3>& position, int shift) const;

 private:
  friend class detail::OctreeCloudBuilder;

  AlignedVector<std::uint32_t> order_;
  AlignedVector<std::uint64_t> keys_;
  std::vector<Root> roots_{{0, 0}};
  OctreeFrame frame_;
  double cell_ = 0;
  int depth_ = 0, resolution_ = 1;
  std::uint64_t num_non_finite_ = 0, num_duplicates_ = 0;
};

}  // namespace pcl_slim
