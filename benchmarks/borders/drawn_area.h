// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/query/projection.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::borders {

/** \brief A scan's points on its surface: where data are. */
struct Feet {
  PointStore store;                          ///< of the feet, in units of their own
  std::vector<float> spacing;                ///< about each stored foot, the store's units
  std::vector<std::array<float, 3>> normal;  ///< of the surface at each stored foot
};

/** \brief The feet of a store's points, and .627 times their distances to the 8th neighbour. */
Feet feetOf(const PointStore& points, const SLIMSurface& surface, int threads);

/** \brief Whether places are near data: within 1.5 of a foot's spacings. */
class FootSearch {
 public:
  /** \brief Keeps a reference to the feet. */
  explicit FootSearch(const Feet& feet);

  /** \param[in] world a place in the scan's units. \param[in,out] blocks scratch. */
  bool isNear(const std::array<double, 3>& world, std::vector<std::uint32_t>& blocks) const;

 private:
  bool nearBlock(const std::array<double, 3>& place, std::uint32_t block) const;

  const Feet& feet_;
  float widest_ = 0.0f;
  float usual_ = 0.0f;  ///< 1.5 spacings where points are as dense as usual
};

/** \brief Drawn area, and the part of it that is far from data. */
struct DrawnArea {
  double total = 0.0, far = 0.0;  ///< any unit
  double seconds = 0.0;           ///< of drawing, without measuring
};

/** \brief Sums up, over six views in parallel projection along the axes, the area that pixels show:
 * all of it, and the part that is farther than 1.5 spacings from every foot.
 * \param[in] reference draw with the reference rasteriser */
DrawnArea drawnArea(const SLIMSurface& surface, const Feet& feet, const RenderParams& params,
                    int size, bool reference);

/** \brief The share of points within half a spacing of which nothing is drawn: neither at the foot
 * nor at 8 places around it. */
double lostShare(const SLIMSurface& surface, const Feet& feet, const RenderParams& params);

}  // namespace pcl_slim::borders
