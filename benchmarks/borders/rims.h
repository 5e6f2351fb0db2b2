// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::borders {

/** \brief A place on the true rim of a scene, in the (x, y) plane, and the direction out of it. */
struct RimPlace {
  std::array<double, 2> at, outward;
};

/** \brief A flat piece of known outline on a gently curved sheet z(x, y), a point per unit of area:
 * its spacing is 1. */
struct RimScene {
  std::vector<double> points;               ///< x y z
  std::vector<std::vector<RimPlace>> rims;  ///< each a quarter of a spacing from place to place
};

/** \brief A scene by name: half, hole (a disc of 100 with a hole of 12), strip (winding, 8 wide) or
 * grid (the disc by a jittered grid). \param[in] noise sigma of the points, isotropic */
RimScene makeRimScene(const std::string& name, double noise, std::uint64_t seed);

/** \brief Where a surface's drawn rim stands, in spacings outside of the true one. */
struct RimFigures {
  double mean = 0.0, deviation = 0.0, farthest = 0.0;
  double jag = 0.0;  ///< RMS change over one spacing of the rim
};

/** \brief Measures all of a scene's rims in a picture from above, by the reference rasteriser if
 * wanted. */
RimFigures measureRims(const RimScene& scene, const SLIMSurface& surface,
                       const RenderParams& params, bool reference);

}  // namespace pcl_slim::borders
