// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief A surface in a store's units. Where the surface was fitted to the store, origins agree
 * and scales are powers of two: its numbers then stay as they are. */
struct Placement {
  double shift[3];
  double factor;

  Placement(const PointStore& store, const SLIMSurface& surface)
      : factor(surface.info.scale / store.scale())
  {
    for (std::size_t a = 0; a < 3; ++a) {
      shift[a] = (surface.info.origin[a] - store.origin()[a]) / store.scale();
    }
  }

  std::array<double, 3> center(const SLIMSurface& surface, std::uint32_t i) const
  {
    return {shift[0] + factor * surface.cx[i], shift[1] + factor * surface.cy[i],
            shift[2] + factor * surface.cz[i]};
  }
  float radius(const SLIMSurface& surface, std::uint32_t i) const
  {
    return static_cast<float>(factor * surface.radius[i]);
  }
};

}  // namespace pcl_slim::detail
