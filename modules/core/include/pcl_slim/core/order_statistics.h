// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace pcl_slim {

/** \brief The k-th smallest value, k from 0. O(n). */
template <typename T>
T kthSmallest(std::vector<T> values, std::size_t k) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(k);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/** \brief The median of at least one value, of an even number the greater of the middle two. O(n).
 */
template <typename T>
T median(std::vector<T> values) {
  const std::size_t middle = values.size() / 2;
  return kthSmallest(std::move(values), middle);
}

}  // namespace pcl_slim
