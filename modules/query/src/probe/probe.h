// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/block_tree.h"
#include "pcl_slim/core/vector3.h"
#include "projection/projection.h"

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

// What a probe finds at sixteen places side by side.
namespace pcl_slim::detail {

/** Which leaves a place's distance is blended from; lengths in radii of a leaf but for the noise. */
struct SheetRules {
  WeightKernel kernel = WeightKernel::kPower4;
  bool oriented = false;
  float most_distance = 0;  ///< leaves farther from a place do not count
  float reach_sq = 0;       ///< nor do those whose centre is farther, squared
  float same_sheet = 0;     ///< leaves of one sheet differ by no more than this and the noise
  float softening = 0;      ///< leaves nearer than this and the noise are equally near
  float noise = 0;          ///< local units
  float min_dot = 0;  ///< oriented leaves of one sheet have normals whose cosine is above this
};

/** The nearest leaf of a block's 16 places, then sums over the leaves of its sheet. */
struct BlockSheets {
  alignas(64) float score[16];      ///< of the nearest leaf; 0: there is none
  alignas(64) float distance[16];   ///< to it, signed, local units
  alignas(64) float normal[3][16];  ///< its normal at the foot
  alignas(64) float weight[16], distance_sum[16], normal_sum[3][16];
};

/** Sums over the leaves of a block's 16 places. */
struct BlockColors {
  alignas(64) float weight[16];
  alignas(64) float sum[3][16];  ///< weighted red, green, blue, 0..255
};

/** The blended surface from a block's sums, columns per point; undefined where nothing was added. */
struct BlockPrincipals {
  alignas(64) float length[16];     ///< of the blended gradient
  alignas(64) float normal[3][16];  ///< unit
  alignas(64) float k1[16], k2[16];
  alignas(64) float direction1[3][16], direction2[3][16];
};

namespace kernels {

void
clearSheets(BlockSheets& sheets);

/** Pass 1: keeps a leaf where it scores more than those before it. */
void
findSheets(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
           BlockSheets& sheets);

/** Pass 2: adds a leaf where it belongs to the sheet of the nearest one. */
void
addSheets(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
          BlockSheets& sheets);

/** Adds a leaf's colour at the places in its ball. It counts in full where its polynomial passes within
 * kColorGate and, if the places have normals, faces as they do; elsewhere by kOtherSheet. */
void
addColors(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
          BlockColors& colors);

/** Like principalCurvatures(), in single precision and for sixteen points together. */
void
findPrincipals(const BlockSums& sums, BlockPrincipals& principals);

}  // namespace kernels
}  // namespace pcl_slim::detail
