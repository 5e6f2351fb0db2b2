// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "scan/ball_kernels.h"

namespace pcl_slim::detail {

/** \brief Points near a surfel's own surface, in its (u, v) plane and in units of its radius;
 * columns have room for whole vectors. */
struct SheetPoints {
  AlignedVector<float> u, v;
  AlignedVector<float> w;               ///< along the surfel's normal
  AlignedVector<std::uint32_t> index;   ///< of the stored points
  AlignedVector<std::uint32_t> sector;  ///< of spacingOf()
  std::size_t count = 0;

  void reserve(std::size_t capacity)
  {
    const std::size_t needed = capacity + BallBuffer::kPadding;
    if (u.size() < needed) {
      u.resize(needed + needed / 2);
      v.resize(needed + needed / 2);
      w.resize(needed + needed / 2);
      index.resize(needed + needed / 2);
      sector.resize(needed + needed / 2);
    }
  }

  /** \brief Fills up the last vector with points too far away to matter. */
  void pad()
  {
    constexpr float kFar = 1e9f;
    std::fill_n(u.begin() + static_cast<std::ptrdiff_t>(count), PointStore::kBlock, kFar);
    std::fill_n(v.begin() + static_cast<std::ptrdiff_t>(count), PointStore::kBlock, kFar);
  }
};

/** \brief Mean spacing of points in the unit disc, in units of its radius: the root of the area that
 * one point has. The area reaches, in each of 16 sectors (or 8 or 4, where points are few), as far as
 * the farthest point of the sector.
 * \return 0 where points have no area. O(points). */
double
spacingOf(SheetPoints& points);

/** \brief Collects, of the stored points that a surfel covers, the middle one of every block: a sample
 * for surfels of many points. O(blocks). */
void
sampleSheet(const PointStore& store, const BlockList& blocks, const kernels::CoverLeaf& surfel,
            SheetPoints& points);

namespace kernels {

/** \brief Collects the stored points that a surfel covers: in its ball, within the normal bound and
 * at most max_residual from f = 0. */
void
gatherSheet(const PointStore& store, const BlockList& blocks, const CoverLeaf& surfel,
            SheetPoints& points);

constexpr std::uint32_t kSheetSectors = 16;

/** \brief Finds which of 16 equal sectors contains each point; halves of them differ in the highest bit.
 * Points outside of the unit disc get kSheetSectors. */
void
findSectors(SheetPoints& points);

/** \brief The point next to a place in each of its four quadrants, by u, then v; kNone where none is at most
 * twice as far as the nearest of all. */
struct QuadrantPoints {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::array<std::uint32_t, 4> nearest{kNone, kNone, kNone, kNone};
  std::array<float, 4> distance_sq{};
};

/** \brief Squared distance of the point next to a place of the plane. */
float
nearestSq(const SheetPoints& points, float u, float v);

/** \brief O(points). */
QuadrantPoints
nearestInQuadrants(const SheetPoints& points, float u, float v);

}  // namespace kernels
}  // namespace pcl_slim::detail
