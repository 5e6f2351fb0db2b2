// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "fit_constants.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief Whether the data end next to a point, in the point's own tangent plane.
 *
 * A surfel's plane does not show it: where the surface turns away from it, at the silhouette of a tube, its
 * points end although the data go on. The neighbours of the point, in the plane of their least variance, leave a
 * sector empty at a border and at a hole, and nowhere else. The disc that fits into that sector and touches the
 * point has to be wider than chance leaves discs empty at the spacing on either side of it. One per
 * thread: it keeps its memory.
 */
class BorderTest {
 public:
  /** \param[in] noise RMS distance of points from the surface, local length
   * \param[in] hole_size diameter of the smallest hole kept, in spacings */
  BorderTest(const PointStore& store, const BorderConstants& constants, double noise,
             double hole_size);

  /** \brief Whether the data end at a place. \param[in] place of an outermost point, local coordinates
   * \param[in] spacing of the points around it, about, a local length. O(neighbours). */
  bool endsAt(const Vector3& place, double spacing);

 private:
  struct Neighbor {
    double u, v, w;
  };

  /** \brief An empty disc that touches the place, and the nearest neighbour ahead. */
  struct Disc {
    double direction = 0, u = 0, v = 0;
    double width = 0;
    const Neighbor* next = nullptr;  ///< null: there is none
    double next_sq = 0;
  };

  std::size_t count(const Vector3& place, double reach);
  void gather(const Vector3& place, double reach);
  void gatherNear(const Vector3& place, double spacing);
  void findPlane();
  void project();
  double widestSector(double* direction) const;
  bool isOfSheet(const Neighbor& p) const;
  void findDiscs(std::array<Disc, 3>& discs) const;
  bool isAsDense(const Vector3& place, double spacing);

  const PointStore& store_;
  const BorderConstants& constants_;
  double noise_, least_disc_;
  double reach_ = 0;         ///< neighbours are gathered within
  Vector3 u_{}, v_{}, w_{};  ///< axes of the plane
  std::vector<std::uint32_t> blocks_, found_;
  std::vector<float> distances_sq_;
  std::vector<Vector3> offsets_;  ///< of the neighbours from the place
  std::vector<Neighbor> flat_;    ///< the same in the plane's axes
};

}  // namespace pcl_slim::detail
