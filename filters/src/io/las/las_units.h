// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "io/las/las_header.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** Coordinates of points as doubles. */
class LasPositions {
 public:
  /** \param[in] cloud must have x y z and outlive this object. */
  explicit LasPositions(const pcl::PCLPointCloud2& cloud);

  double at(std::size_t point, std::size_t axis) const;
  std::size_t size() const { return size_; }

 private:
  const pcl::PCLPointCloud2& cloud_;
  std::array<const pcl::PCLPointField*, 3> fields_{};
  std::size_t size_ = 0;
};

/** How coordinates become whole numbers of 32 bits. */
struct LasUnits {
  std::array<double, 3> scale{}, offset{};
  std::array<double, 3> low{}, high{};  ///< box of the points
  bool exact = true;                    ///< every coordinate comes back bit by bit

  std::int32_t code(double value, std::size_t axis) const;
};

/** The units of a file, or finer ones where its own cannot represent the coordinates, as after smoothing:
 * its scale over a power of ten, up to 10^6, as far as 32 bits reach. \param[in] given the file's
 * header, or null for units of the cloud's own. \return an error for coordinates that are not finite. */
Result<LasUnits>
lasUnits(const LasPositions& positions, const LasHeader* given);

}  // namespace pcl_slim
