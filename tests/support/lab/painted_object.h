// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_slim::measure {

/** \brief Points of a painted object with exact normals. */
struct PaintedObject {
  std::vector<float> xyz, normals;  ///< three per point
  std::vector<std::uint32_t> rgb;   ///< 0xRRGGBB
};

/** \brief A duck, star-shaped about the origin, about 2 long: the distance to its surface is a
 * smooth function of direction (body, head, bill, tail, ripples as feathers on the rump), x
 * forwards and z upwards. Painted with stripes, a bill, a light belly and two eyes with white,
 * iris, pupil and highlight, all with sharp borders but the belly. count points even over the area,
 * in random order, fixed by seed. */
PaintedObject paintDuck(std::size_t count, std::uint64_t seed);

/** \brief Middle of the eye on the duck's right side (-y), on its surface; its radius is .095. */
std::array<double, 3> duckEye();

}  // namespace pcl_slim::measure
