// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "fit_settings.h"
#include "pcl_slim/cloud/point_store.h"
#include "trim/border_test.h"
#include "trim/sheet_points.h"
#include "trim/trim_raster.h"

namespace pcl_slim::detail {

/** \brief Makes the trim maps of one surface's surfels, one after another. One per thread: it keeps
 * its memory. */
class TrimMaker {
 public:
  TrimMaker(const PointStore& store, const FitSettings& settings, double hole_size,
            const SLIMSurface& surface, PointBorders& borders)
      : store_(store),
        settings_(settings),
        hole_size_(hole_size),
        surface_(surface),
        border_(store, settings.constants.border, std::sqrt(settings.noise), hole_size,
                settings.with_normals ? settings.min_dot : -2.0f, borders)
  {
  }

  /** \brief Surfels begin to end are made next: lists the points around them, if they are near to each
   * other. */
  void prepare(std::size_t begin, std::size_t end);

  /** \brief Appends the bits of surfel i's map; nothing if it is closed. \return the map's side, 0
   * if it is closed. O(points of the ball). */
  int make(std::size_t i, std::vector<std::uint8_t>& bits);

  /** \brief Surfels with gaps so far. */
  std::uint64_t numCandidates() const { return candidates_; }

 private:
  kernels::CoverLeaf wideSurfel(std::size_t i, const std::array<float, 3>& normal) const;
  void gather(std::size_t i);
  Vector3 normalAt(std::size_t i, std::size_t point, const LocalFrame& frame) const;
  bool dataEndAtGaps(std::size_t i, double spacing);
  int appendMap(double spacing, std::vector<std::uint8_t>& bits) const;

  const PointStore& store_;
  const FitSettings& settings_;
  double hole_size_;
  const SLIMSurface& surface_;
  BlockNeighborhood nearby_;  ///< of the surfels being made
  bool has_nearby_ = false;
  std::vector<std::uint32_t> found_;
  BlockList blocks_;  ///< of the ball
  SheetPoints points_;
  TrimRaster raster_;
  BorderTest border_;
  std::vector<std::array<double, 2>> places_;  ///< in gaps, [r]
  std::uint64_t candidates_ = 0;
};

}  // namespace pcl_slim::detail
