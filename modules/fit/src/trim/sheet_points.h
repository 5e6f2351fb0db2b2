// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ball/ball_kernels.h"

namespace pcl_slim::detail {

/** \brief Points near a surfel's own surface, in its (u, v) plane and in units of its radius;
 * columns have room for whole vectors. */
struct SheetPoints {
  AlignedVector<float> u, v;
  AlignedVector<float> w;  ///< along the surfel's normal
  std::size_t count = 0;

  void reserve(std::size_t capacity)
  {
    const std::size_t needed = capacity + BallBuffer::kPadding;
    if (u.size() < needed) {
      u.resize(needed + needed / 2);
      v.resize(needed + needed / 2);
      w.resize(needed + needed / 2);
    }
  }
};

/** \brief Mean spacing of points in the unit disc, in units of its radius: the root of the area that
 * one point has. The area reaches, in each of 16 sectors (or 8 or 4, where points are few), as far as
 * the farthest point of the sector tells.
 * \return 0 where points have no area. O(points). */
double
spacingOf(const SheetPoints& points);

/** \brief Collects, of the stored points that a surfel serves, the middle one of every block: a sample
 * for surfels of many points. O(blocks). */
void
sampleSheet(const PointStore& store, const std::vector<std::uint32_t>& blocks,
            const kernels::CoverLeaf& surfel, SheetPoints& points);

namespace kernels {

/** \brief Collects the stored points that a surfel serves: in its ball, within the normal bound and
 * at most max_residual from f = 0. */
void
gatherSheet(const PointStore& store, const BlockList& blocks, const CoverLeaf& surfel,
            SheetPoints& points);

}  // namespace kernels
}  // namespace pcl_slim::detail
