// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fit_constants.h"
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

/** \brief What a border test has found at a stored point. Threads share it, as it depends on nothing else. */
struct PointBorder {
  std::atomic<float> spacing{
      0};  ///< the largest at which the data end there; < 0: none; 0: not tested
  std::atomic<std::uint32_t> plane{
      0};  ///< normal of the tangent plane, ten bits a coordinate; 0: unknown
};
using PointBorders = std::vector<PointBorder>;

/** \brief Whether the data end next to a point, in the point's own tangent plane.
 *
 * A surfel's plane does not show it: where the surface turns away from it, at the silhouette of a tube, its
 * points end although the data continue. The neighbours of the point, in the plane of their least variance, leave a
 * sector empty at a border and at a hole, and nowhere else. The disc that fits into that sector and touches the
 * point has to be wider than chance leaves discs empty at the spacing on either side of it. One per
 * thread: it keeps its memory.
 */
class BorderTest {
 public:
  /** \param[in] noise RMS distance of points from the surface, local length
   * \param[in] hole_size diameter of the smallest hole kept, in spacings
   * \param[in] min_dot the normal bound where normals part sheets, else -2: a face ends at a sharp edge
   * \param[in,out] borders one for each stored point */
  BorderTest(const PointStore& store, const BorderConstants& constants, double noise,
             double hole_size, float min_dot, PointBorders& borders);

  /** \brief Whether the data end at a stored point, or leave a surfel's surface at an edge.
   * \param[in] spacing of a surfel's points around it, local length: a narrower gap may be chance
   * \param[in] normal unit normal of its surface there. O(neighbours) at a point's first test, O(1) then. */
  bool endsAt(std::size_t point, double spacing, const Vector3& normal);

 private:
  float measure(std::size_t point, double spacing);
  void gather(const Vector3& place, double reach);
  bool gatherNear(const Vector3& place, double reach);
  void findPlane();
  double findSector(double* middle);
  void findDiscs(double middle, std::array<EmptyDisc, 3>& discs) const;
  float spacingAcross(const Vector3& place, const EmptyDisc& disc);
  bool isAsDense(const Vector3& place, double spacing);

  const PointStore& store_;
  const BorderConstants& constants_;
  double thick_, least_disc_;
  PlaceSide side_;  ///< of the point at hand
  PointBorders& borders_;
  double reach_ = 0;               ///< neighbours are gathered within
  std::uint32_t plane_ = 0;        ///< of the point measured last
  std::array<Vector3, 3> axes_{};  ///< of the plane, and its normal
  std::vector<std::uint32_t> blocks_, found_;
  std::vector<float> distances_sq_;
  NearPoints near_;
};

}  // namespace pcl_slim::detail
