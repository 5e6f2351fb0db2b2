// SPDX-License-Identifier: BSD-3-Clause
// The places at which pcl::MovingLeastSquares' methods of upsampling add points.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim::detail {

using Position = std::array<double, 3>;

/** Displacements (u, v) on a grid of this step over the open disc of this radius, as
 * pcl::MovingLeastSquares makes it: from -radius on. */
std::vector<std::array<double, 2>> discGrid(double radius, double step);

/** Displacements spread evenly over the closed disc of this radius; the same for the same seed. */
std::vector<std::array<double, 2>> discSamples(std::size_t count, double radius,
                                               std::uint64_t seed);

/** Corners of the voxels that contain points, dilated a number of times by all neighbours;
 * ascending in x, then y, then z. \return an error for voxels too small to be counted. */
Result<std::vector<Position>> dilatedVoxels(const CloudView& view, double edge, int dilations);

/** For each place the nearest finite point of the view. O(places log points). */
std::vector<std::uint32_t> nearestPoints(const CloudView& view,
                                         const std::vector<Position>& places);

/** How many points are within a radius of each point of the view, itself included; 0 for those
 * that are not finite. */
std::vector<std::uint32_t> countNeighbors(const CloudView& view, double radius);

}  // namespace pcl_slim::detail
