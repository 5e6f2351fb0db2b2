// SPDX-License-Identifier: BSD-3-Clause
// Connected regions of leaves' trim maps: the elements that components consist of.
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief The regions of all leaves' trim maps, over nodes next to each other, also diagonally,
 * numbered in the order of leaves. A closed leaf is one region; internal surfels have none. */
class Regions {
 public:
  static constexpr std::uint32_t kOutside = 0xffffffffu;

  Regions(const SLIMSurface& surface, int threads);

  std::size_t count() const { return begin_.back(); }
  /** \brief A surfel's regions are begin to end. */
  std::uint32_t begin(std::size_t surfel) const { return begin_[surfel]; }
  std::uint32_t end(std::size_t surfel) const { return begin_[surfel + 1]; }

  /** \brief The region of a node inside an open leaf's map. */
  std::uint32_t at(std::size_t leaf, int node) const {
    if (of_node_[leaf].empty()) return begin_[leaf];
    const std::uint16_t own = of_node_[leaf][static_cast<std::size_t>(node)];
    return own == 0 ? kOutside : begin_[leaf] + own - 1;
  }

 private:
  std::vector<std::uint32_t> begin_;
  /// Of each surfel, from 1, 0 outside; empty where there is one region at most.
  std::vector<std::vector<std::uint16_t>> of_node_;
};

/** \brief A place of a leaf's sheet, local coordinates, and its region. */
struct SheetPlace {
  Vector3 position;
  std::uint32_t region;
};

/** \brief A leaf's sheet, in which places are looked up. */
class Sheet {
 public:
  Sheet(const SLIMSurface& surface, const Regions& regions, std::uint32_t leaf);

  /** \brief The region that a place next to the sheet is in; kOutside beyond the ball, the map and
   * .3 of a radius from the sheet. */
  std::uint32_t regionAt(const Vector3& place) const;

  /** \brief Places evenly spread over what exists of the sheet: some sixty, and one at least in
   * every region. */
  void placesOf(std::vector<SheetPlace>& places) const;

  /** \brief About the number of points in the ball, from their effective number and from where an
   * open leaf has data. \param[in] places of the sheet */
  double numPoints(const std::vector<SheetPlace>& places) const;

 private:
  void add(double u, double v, std::uint32_t region, std::vector<SheetPlace>& places) const;

  const Regions* regions_;
  std::uint32_t leaf_;
  Vector3 center_;
  double radius_;
  LocalFrame frame_;
  int degree_;
  const float* c_;
  TrimMap map_;
  WeightKernel kernel_;
  double effective_count_;
};

}  // namespace pcl_slim::detail
