// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief Coloured discs, as columns of equal length.
 *
 * World position = origin + (x, y, z); lengths in world units.
 */
struct PCL_SLIM_EXPORT SplatSet {
  /** \brief Change of red, green and blue (0..255) per world unit along x, y and z: red's three
   * numbers first. In the disc's plane. */
  using Gradient = std::array<float, 9>;

  std::array<double, 3> origin{};
  std::vector<float> x, y, z;          ///< centres, relative to origin
  std::vector<float> nx, ny, nz;       ///< unit normals
  std::vector<float> radius;           ///< 0 only where all points share one position
  std::vector<std::uint32_t> rgb;      ///< 0xRRGGBB
  std::vector<float> confidence;       ///< number of points behind the disc
  std::vector<float> normal_variance;  ///< 1 - share of the normals' common line, in [0, 2/3]
  std::vector<std::uint32_t> kept;     ///< input index of the point that represents the cell
  std::vector<Gradient> gradient;      ///< one per splat, or none at all

  std::size_t size() const { return x.size(); }
  bool empty() const { return x.empty(); }

  /** \brief Whether two discs differ in colour: of a cloud without colours all are of one. O(N). */
  bool hasColors() const {
    return std::adjacent_find(rgb.begin(), rgb.end(), std::not_equal_to<>()) != rgb.end();
  }

  void resize(std::size_t count, bool with_gradient) {
    for (auto* column : {&x, &y, &z, &nx, &ny, &nz, &radius, &confidence, &normal_variance}) {
      column->resize(count);
    }
    rgb.resize(count);
    kept.resize(count);
    gradient.resize(with_gradient ? count : 0);
  }
};

}  // namespace pcl_slim
