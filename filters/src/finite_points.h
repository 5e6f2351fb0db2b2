// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief A view's finite points as PCL searches them: floats, relative to the first of them. */
struct FinitePoints {
  pcl::PointCloud<pcl::PointXYZ>::Ptr points = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  std::vector<std::uint32_t> source;  ///< which of the view's points each is
  Vector3 origin{};

  explicit FinitePoints(const CloudView& view) {
    for (std::size_t i = 0; i < view.count(); ++i) {
      const Vector3 p = view.position(view.inputIndex(i));
      if (!isFinite(p)) continue;
      if (source.empty()) origin = p;
      source.push_back(static_cast<std::uint32_t>(i));
      points->push_back(local(p));
    }
  }

  pcl::PointXYZ local(const Vector3& p) const {
    return {static_cast<float>(p[0] - origin[0]), static_cast<float>(p[1] - origin[1]),
            static_cast<float>(p[2] - origin[2])};
  }
};

}  // namespace pcl_slim::detail
