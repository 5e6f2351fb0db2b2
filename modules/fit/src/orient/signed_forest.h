// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace pcl_slim::detail {

/** \brief Union-find in which every member knows its sign relative to its root, the least member. */
class SignedForest {
 public:
  explicit SignedForest(std::size_t count) : parent_(count), sign_(count, 1)
  {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  std::uint32_t root(std::uint32_t i, int& sign)
  {
    sign = 1;
    std::uint32_t r = i;
    while (parent_[r] != r) {
      sign *= sign_[r];
      r = parent_[r];
    }
    int rest = sign;
    while (parent_[i] != r && i != r) {
      const std::uint32_t next = parent_[i];
      const bool turns = sign_[i] < 0;
      parent_[i] = r;
      sign_[i] = static_cast<signed char>(rest);
      rest = turns ? -rest : rest;
      i = next;
    }
    return r;
  }

  std::uint32_t root(std::uint32_t i)
  {
    int sign;
    return root(i, sign);
  }

  void join(std::uint32_t a, std::uint32_t b, bool opposed)
  {
    int sign_a, sign_b;
    const std::uint32_t ra = root(a, sign_a), rb = root(b, sign_b);
    if (ra == rb) return;
    parent_[std::max(ra, rb)] = std::min(ra, rb);
    sign_[std::max(ra, rb)] = static_cast<signed char>(sign_a * sign_b * (opposed ? -1 : 1));
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<signed char> sign_;
};

}  // namespace pcl_slim::detail
