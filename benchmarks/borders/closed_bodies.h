// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "support/lab/scenes.h"

/** \brief Points of closed bodies, which have no border anywhere. Scene units. */
namespace pcl_slim::measure {

enum class Body { kSphere, kTorus, kBumpy, kEllipsoid, kAmphora, kCube, kSlab, kWedge };

/** \brief How points are spread over a body. */
enum class Spread {
  kRandom,  ///< evenly, each on its own
  kBlue,    ///< evenly, none nearer to another than some .7 of the mean spacing
  kUneven,  ///< each on its own, the density falling to 1/20 from one end of the body to the other
  kStep     ///< each on its own, half of the body twenty times as dense as the other
};

/** \brief Body by name: sphere, torus, bumpy, ellipsoid, amphora, cube, slab, wedge. \return false for
 * another name. */
bool parseBody(const std::string& name, Body& body);

/** \brief Spread by name: random, blue, uneven, step. \return false for another name. */
bool parseSpread(const std::string& name, Spread& spread);

/** \brief count points of a body, fixed by seed, without normals.
 * \param[in] noise isotropic Gaussian, share of the diagonal of the body's box */
Scene makeBody(Body body, Spread spread, std::size_t count, double noise, std::uint64_t seed);

}  // namespace pcl_slim::measure
