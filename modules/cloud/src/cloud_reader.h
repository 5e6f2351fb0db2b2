// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "hwy/cache_control.h"
#include "pcl_slim/cloud/cloud_view.h"

namespace pcl_slim {

/** \brief Reads a CloudView's points as doubles, whatever their stored type. */
class CloudReader {
 public:
  explicit CloudReader(const CloudView& view) : view_(view) {}

  std::array<double, 3> position(std::size_t input) const
  {
    const char* p = static_cast<const char*>(view_.xyz) + input * view_.xyz_stride;
    if (view_.scalar == CloudView::Scalar::kDouble) {
      std::array<double, 3> q;
      std::memcpy(q.data(), p, sizeof(q));
      return q;
    }
    std::array<float, 3> q;
    std::memcpy(q.data(), p, sizeof(q));
    return {q[0], q[1], q[2]};
  }

  /** \brief Has a point's memory on its way when it is read soon after. */
  void prefetch(std::size_t input, bool normal) const
  {
    hwy::Prefetch(static_cast<const char*>(view_.xyz) + input * view_.xyz_stride);
    if (normal) hwy::Prefetch(static_cast<const char*>(view_.normal) + input * view_.normal_stride);
  }

  /** \brief Whether a point's normal is neither zero nor out of range. */
  bool hasNormal(std::size_t input) const { return isUsable(lengthSq(givenNormal(input))); }

  /** \brief Unit normal, or zero where the point has none. */
  std::array<float, 3> normal(std::size_t input) const
  {
    const std::array<float, 3> n = givenNormal(input);
    const float length_sq = lengthSq(n);
    if (!isUsable(length_sq)) return {0, 0, 0};
    const float scale = 1.0f / std::sqrt(length_sq);
    return {n[0] * scale, n[1] * scale, n[2] * scale};
  }

 private:
  std::array<float, 3> givenNormal(std::size_t input) const
  {
    std::array<float, 3> n;
    const char* p = static_cast<const char*>(view_.normal) + input * view_.normal_stride;
    std::memcpy(n.data(), p, sizeof(n));
    return n;
  }

  static float lengthSq(const std::array<float, 3>& n)
  {
    return n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  }

  static bool isUsable(float length_sq)
  {
    return length_sq > 1e-24f && length_sq <= std::numeric_limits<float>::max();
  }

  const CloudView& view_;
};

}  // namespace pcl_slim
