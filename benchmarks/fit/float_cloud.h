// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace pcl_slim::measure {

/** \brief Points x y z x y z ... as nanoflann reads them. */
struct FloatCloud {
  const std::vector<float>& xyz;
  std::size_t kdtree_get_point_count() const { return xyz.size() / 3; }
  float kdtree_get_pt(std::size_t i, std::size_t a) const { return xyz[3 * i + a]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

}  // namespace pcl_slim::measure
