// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/block_tree.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/detail/projection_kernel.h"

namespace pcl_slim::detail {

/** A leaf, ready for evaluation anywhere. */
struct ProbeLeaf {
  BlockLeaf leaf;  ///< but for its shift
  Vector3 center;
  float effective_count;
};

/** The leaves that reach into a box, relative to its middle, with columns to choose among them. */
class LeafRegion {
 public:
  bool covers(const Vector3& low, const Vector3& high) const;
  void clear() { valid_ = false; }

  /** Collects the leaves about a box and a margin around it. \param[in] tree of the leaves' boxes
   * \param[in] reach how far a leaf reaches, in radii of its ball */
  void build(const std::vector<ProbeLeaf>& leaves, const BlockTree& tree, double reach,
             const Vector3& low, const Vector3& high, double margin);

  const Vector3& origin() const { return origin_; }
  /** A place relative to the origin. */
  std::array<float, 3> offset(const Vector3& p) const
  {
    return {static_cast<float>(p[0] - origin_[0]), static_cast<float>(p[1] - origin_[1]),
            static_cast<float>(p[2] - origin_[2])};
  }

  /** Leaves that reach into a box inside the region. */
  void choose(const Vector3& low, const Vector3& high, std::vector<const BlockLeaf*>& chosen);

  /** Calls body(leaf, number of points, squared distance over squared radius) for each leaf whose ball contains
   * a place. */
  template <typename Body>
  void forHolding(const Vector3& place, const Body& body)
  {
    const auto p = offset(place);
    for (std::size_t j = 0; j < count_; ++j) {
      const float dx = x_[j] - p[0], dy = y_[j] - p[1], dz = z_[j] - p[2];
      measure_[j] = dx * dx + dy * dy + dz * dz - share_ * reach_sq_[j];
    }
    for (std::size_t j = 0; j < count_; ++j) {
      if (measure_[j] < 0) {
        body(leaves_[j], effective_count_[j], 1 + measure_[j] / (share_ * reach_sq_[j]));
      }
    }
  }

 private:
  void resize(std::size_t count);

  bool valid_ = false;
  float share_ = 1;  ///< of the squared reach: the squared radius
  Vector3 low_{}, high_{}, origin_{};
  std::size_t count_ = 0;
  std::vector<std::uint32_t> places_;
  std::vector<float> x_, y_, z_, reach_sq_, effective_count_, measure_;
  std::vector<BlockLeaf> leaves_;
};

}  // namespace pcl_slim::detail
