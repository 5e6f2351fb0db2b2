// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pcl_slim/cloud/block_tree.h"
#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/store_frame.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

namespace detail {
class PointStoreBuilder;
}

/** \brief What happened to the input on its way into a PointStore. */
struct PointStoreStatistics {
  std::uint64_t input_points = 0;    ///< points selected (by indices, if any)
  std::uint64_t non_finite = 0;      ///< skipped: a coordinate is NaN or infinite
  std::uint64_t far_away = 0;        ///< skipped: a stray thousands of times as far as the bulk
  std::uint64_t without_normal = 0;  ///< skipped: others have normals, this one has none
  std::uint64_t duplicates = 0;      ///< merged into an earlier point at the same position
  double seconds = 0;                ///< wall time of build()
};

/** \brief A cloud in Morton order, which every later stage reads in this order.
 *
 * Finite points are centred in double, divided by a power of two (so that converting back is exact)
 * until the bounding box's diagonal is in (.49, 1), sorted by 63-bit Morton code, merged where
 * coordinates coincide, and cut into blocks of 16. Strays that are more than 2^14 times as far from
 * the median as the quartiles do are left out, as units follow the box of what is stored. A block
 * has one origin on a 2^-22 grid and float offsets from it, which keeps about 1e-9 of the diagonal
 * in 12 bytes a point. The last block is padded with points too far away for any ball.
 *
 * Same input, same store, for any number of threads. O(N) time, about 40 bytes a point while
 * building and 28 to 40 bytes a point after.
 */
class PCL_SLIM_EXPORT PointStore {
 public:
  static constexpr std::size_t kBlock = 16;
  static constexpr float kFarAway = 1e15f;                ///< offset of padding in the last block
  static constexpr std::uint32_t kSkipped = 0xffffffffu;  ///< in storeOfInput(): not in the store

  /** \brief Brings a cloud into Morton order. \return the store, or why there is none: no input,
   * more than 2^32 - 2 points, not one finite point, or one without a finite place of its sensor
   * where others have one. \param[in] threads 0: all cores.
   * \param[in] frame store of a larger cloud that these points belong to: what is far away relative
   * to that is far away here, too, and the units are at least its own. null: none. */
  static Result<PointStore> build(const CloudView& cloud, int threads = 0,
                                  const PointStore* frame = nullptr);

  /** \brief The same in given units, as a part of a larger cloud has: equal points get the
   * coordinates, keys and order that they have in a store of all. Points that the frame counts as
   * strays, or whose normal it misses, are left out. */
  static Result<PointStore> build(const CloudView& cloud, const StoreFrame& frame, int threads = 0);

  /** \brief The same without some points, in the same units; they count as skipped in
   * storeOfInput().
   * \param[in] dropped stored points, ascending. O(N). */
  PointStore without(const std::vector<std::uint32_t>& dropped, int threads = 1) const;
  /** \brief Drops them from this store, which takes memory for one column more. */
  void drop(const std::vector<std::uint32_t>& dropped, int threads = 1);
  /** \brief Moves every point to another local position. Keys and order stay those of the places
   * before. */
  void moveTo(const std::vector<std::array<double, 3>>& positions, int threads = 1);

  /** \brief Number of stored points. */
  std::size_t size() const { return size_; }
  /** \brief Number of blocks of kBlock points. */
  std::size_t numBlocks() const { return block_origin_x_.size(); }
  /** \brief Whether the cloud came with normals. */
  bool hasNormals() const { return !nx_.empty() && !found_sides_; }
  /** \brief Whether points have normals of a common side: given ones, or those of setSides(). */
  bool hasSides() const { return !nx_.empty(); }

  /** \brief Local position of point i, exact to the store's precision. */
  std::array<double, 3> position(std::size_t i) const {
    const std::size_t b = i / kBlock;
    return {static_cast<double>(block_origin_x_[b]) + x_[i],
            static_cast<double>(block_origin_y_[b]) + y_[i],
            static_cast<double>(block_origin_z_[b]) + z_[i]};
  }
  /** \brief Unit normal of point i; only if hasSides(). */
  std::array<float, 3> normal(std::size_t i) const { return {nx_[i], ny_[i], nz_[i]}; }

  /** \brief World position of local 0. */
  const std::array<double, 3>& origin() const { return frame_.origin; }
  /** \brief World position that the points were seen from, where the cloud knows it. */
  const std::optional<std::array<double, 3>>& sensor() const { return frame_.sensor; }
  /** \brief Whether the cloud knows where each of its points was seen from. */
  bool hasSensors() const { return !sensors_.empty(); }
  /** \brief Local position that point i was seen from; of merged points, the first one's. */
  std::array<double, 3> sensor(std::size_t i) const {
    return {sensors_[i][0], sensors_[i][1], sensors_[i][2]};
  }
  /** \brief Whether the cloud knows which of several merged frames each of its points is from. */
  bool hasFrameNumbers() const { return !frame_numbers_.empty(); }
  /** \brief The frame of point i; of merged points, the first one's. */
  std::uint32_t frameNumber(std::size_t i) const { return frame_numbers_[i]; }
  /** \brief What local coordinates are relative to. */
  const StoreFrame& frame() const { return frame_; }
  double scale() const { return frame_.scale; }  ///< world units per local unit, a power of two
  /** \brief L of the bulk alone, local units: four times the diagonal between the quartiles of each
   * coordinate, and L where that is less, as it is of most clouds. */
  double bulkDiagonal() const { return frame_.bulk_diagonal; }
  /** \brief L in local units, in (.49, 1); 0: one position. */
  double diagonal() const { return frame_.diagonal; }

  /** \brief How far moveTo() moved points at most, local length. */
  double drift() const { return drift_; }

  /** \brief 63-bit Morton codes, ascending; three bits a level, x highest; of the places before
   * moveTo(). */
  const std::uint64_t* keys() const { return keys_.data(); }
  /** \brief Surfel centres are multiples of this, so that world = origin + scale * centre is exact
   * in float (unless the origin is beyond 256 L). */
  double centerGrid() const { return frame_.center_grid; }

  /** \brief For each stored point, its place in the sequence of selected points (the i of
   * CloudView::inputIndex(i)). */
  const AlignedVector<std::uint32_t>& orderOfStore() const { return order_of_store_; }
  /** \brief The inverse: for each selected point, its stored point (merged ones share it) or
   * kSkipped. Computed on demand. */
  std::vector<std::uint32_t> storeOfInput() const;

  // Raw columns for kernels; numBlocks() * kBlock values each, origins one per block.
  const float* x() const { return x_.data(); }
  const float* y() const { return y_.data(); }
  const float* z() const { return z_.data(); }
  const float* nx() const { return nx_.data(); }
  const float* ny() const { return ny_.data(); }
  const float* nz() const { return nz_.data(); }
  const float* blockOriginX() const { return block_origin_x_.data(); }
  const float* blockOriginY() const { return block_origin_y_.data(); }
  const float* blockOriginZ() const { return block_origin_z_.data(); }

  /** \brief The boxes of the blocks, level by level. */
  const BlockTree& tree() const { return tree_; }
  /** \brief What build() found in the cloud. */
  const PointStoreStatistics& statistics() const { return statistics_; }

  /** \brief Gives the points of a cloud without normals a side each: unit normals, in stored order.
   */
  void setSides(const std::vector<std::array<float, 3>>& normals);
  /** \brief Takes them away again; given normals stay. */
  void clearSides();
  /** \brief Turns the given normals of points whose sign is negative. \param[in] signs one for each
   * stored point */
  void turnNormals(const std::vector<signed char>& signs);
  /** \brief Forgets the given normals. */
  void dropNormals();

  /** \brief Bytes of the store. */
  std::size_t memoryBytes() const;

 private:
  friend class detail::PointStoreBuilder;

  double coordinate(std::size_t i, std::size_t axis) const {
    const AlignedVector<float>& offsets = axis == 0 ? x_ : axis == 1 ? y_ : z_;
    const AlignedVector<float>& origins = axis == 0   ? block_origin_x_
                                          : axis == 1 ? block_origin_y_
                                                      : block_origin_z_;
    return static_cast<double>(origins[i / kBlock]) + offsets[i];
  }
  template <typename Position>
  void cutColumns(std::size_t size, const Position& position, int threads);

  std::size_t size_ = 0;
  StoreFrame frame_;
  AlignedVector<float> x_, y_, z_, nx_, ny_, nz_;
  AlignedVector<float> block_origin_x_, block_origin_y_, block_origin_z_;
  AlignedVector<std::uint32_t> order_of_store_;
  AlignedVector<std::uint64_t> keys_;
  std::vector<std::array<std::uint32_t, 2>> merged_;  ///< (place among the selected, stored point)
  BlockTree tree_;
  PointStoreStatistics statistics_;
  std::vector<std::array<float, 3>> sensors_;  ///< local positions, in stored order, or none
  std::vector<std::uint32_t> frame_numbers_;   ///< in stored order, or none
  bool found_sides_ = false;                   ///< the normals are those of setSides()
  double drift_ = 0;
};

}  // namespace pcl_slim
