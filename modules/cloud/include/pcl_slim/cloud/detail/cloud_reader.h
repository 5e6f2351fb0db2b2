// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "hwy/cache_control.h"
#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim::detail {

/** \brief Reads a CloudView's points as doubles, whatever their stored type. */
class PCL_SLIM_EXPORT CloudReader {
 public:
  explicit CloudReader(const CloudView& view) : view_(view) {}

  std::array<double, 3> position(std::size_t input) const
  {
    const char* p = static_cast<const char*>(view_.xyz) + input * view_.xyz_stride;
    if (view_.scalar == CloudView::Scalar::kFloat) {
      const auto q = three<float>(p);
      return {q[0], q[1], q[2]};
    }
    return three<double>(p);
  }

  /** \brief Has a point's memory on its way when it is read soon after. */
  void prefetch(std::size_t input, bool normal) const
  {
    hwy::Prefetch(static_cast<const char*>(view_.xyz) + input * view_.xyz_stride);
    if (normal) hwy::Prefetch(static_cast<const char*>(view_.normal) + input * view_.normal_stride);
  }

  /** \brief A point's normal as it is given, of any length. */
  std::array<float, 3> givenNormal(std::size_t input) const
  {
    return three<float>(static_cast<const char*>(view_.normal) + input * view_.normal_stride);
  }

  /** \brief Whether a point's normal is neither zero nor out of range. */
  bool hasNormal(std::size_t input) const
  {
    const auto n = givenNormal(input);
    const float length_sq = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    return length_sq > 1e-24f && length_sq <= std::numeric_limits<float>::max();
  }

  /** \brief Unit normal of a point that has one. */
  std::array<float, 3> normal(std::size_t input) const
  {
    const auto n = givenNormal(input);
    const float scale = 1.0f / std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    return {n[0] * scale, n[1] * scale, n[2] * scale};
  }

 private:
  /** One by one: what is copied as a whole is written and read back in pieces that do not match. */
  template <typename T>
  static std::array<T, 3> three(const char* p)
  {
    T x, y, z;
    std::memcpy(&x, p, sizeof(T));
    std::memcpy(&y, p + sizeof(T), sizeof(T));
    std::memcpy(&z, p + 2 * sizeof(T), sizeof(T));
    return {x, y, z};
  }

  const CloudView& view_;
};

}  // namespace pcl_slim::detail
