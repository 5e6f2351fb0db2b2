// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/cloud/cloud_view.h"

namespace pcl_slim_test {

/** Three numbers a point, with or without normals. */
inline pcl_slim::CloudView viewOf(const std::vector<double>& points,
                                  const std::vector<float>& normals) {
  pcl_slim::CloudView view;
  view.xyz = points.data();
  view.xyz_stride = 3 * sizeof(double);
  view.scalar = pcl_slim::CloudView::Scalar::kDouble;
  view.size = points.size() / 3;
  if (!normals.empty()) {
    view.normal = normals.data();
    view.normal_stride = 3 * sizeof(float);
  }
  return view;
}

}  // namespace pcl_slim_test
