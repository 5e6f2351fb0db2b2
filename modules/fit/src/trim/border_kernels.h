// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief Points around a place as columns, in local units, padded with zeros to whole vectors. */
struct NearPoints {
  AlignedVector<float> x, y, z, distance_sq;  ///< offsets from the place, and their squared length
  AlignedVector<float> u, v, w;               ///< the offsets in the axes of a plane
  std::size_t count = 0;

  void reserve(std::size_t capacity);
};

/** \brief Which points are of the place's side, where normals part sheets. */
struct PlaceSide {
  std::array<float, 3> normal{};
  float min_dot = -2;  ///< the normal bound: of the cosine to the normal; below -1 for all points
};

/** \brief An empty disc that touches the place, and the nearest point ahead. */
struct EmptyDisc {
  float u = 0, v = 0;        ///< direction of its middle from the place
  float width = 0;           ///< diameter
  float next_sq = 0;         ///< squared distance of the nearest point within 60 degrees of (u, v)
  std::ptrdiff_t next = -1;  ///< that point; -1: there is none
};

constexpr int kBorderSectors = 64;  ///< of directions, equal in the circle |u| + |v| = 1

namespace kernels {

/** \brief Collects the points of some blocks within a distance of a place, those of its side. */
void
gatherOffsets(const PointStore& store, const std::vector<std::uint32_t>& blocks,
              const Vector3& place, double reach, const PlaceSide& side, NearPoints& points);

/** \brief Brings offsets into the axes u, v, w. \return bit k: sector k has a point whose distance from the
 * place, in the plane, exceeds blind. */
std::uint64_t
projectOffsets(const std::array<Vector3, 3>& axes, double blind, NearPoints& points);

/** \brief Narrows a disc to the points of the place's sheet: those no higher over the plane than away from
 * the place, or than thick. Its width and next_sq are upper bounds before. */
void
findDisc(const NearPoints& points, double thick, EmptyDisc& disc);

}  // namespace kernels
}  // namespace pcl_slim::detail
