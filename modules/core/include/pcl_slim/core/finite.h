// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

inline bool
isFinite(const Vector3& a)
{
  return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]);
}

}  // namespace pcl_slim
