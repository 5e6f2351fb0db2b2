// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>

namespace pcl_slim {

/** \brief The least and the greatest of some values. */
struct Extent {
  float low, high;
};

/** \brief Of count values, at least one: in lanes, which do not wait for each other. */
inline Extent extentOf(const float* values, std::size_t count) {
  constexpr std::size_t kLanes = 8;
  float low[kLanes], high[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) low[k] = high[k] = values[std::min(k, count - 1)];
  std::size_t i = kLanes;
  for (; i + kLanes <= count; i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      low[k] = std::min(low[k], values[i + k]);
      high[k] = std::max(high[k], values[i + k]);
    }
  }
  for (; i < count; ++i) {
    low[0] = std::min(low[0], values[i]);
    high[0] = std::max(high[0], values[i]);
  }
  for (std::size_t half = kLanes / 2; half > 0; half /= 2) {
    for (std::size_t k = 0; k < half; ++k) {
      low[k] = std::min(low[k], low[k + half]);
      high[k] = std::max(high[k], high[k + half]);
    }
  }
  return {low[0], high[0]};
}

}  // namespace pcl_slim
