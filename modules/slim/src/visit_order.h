// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <numeric>

#include "fit_settings.h"

namespace pcl_slim {

/** \brief The order in which n places are visited: golden strides from a start spread over them. */
class VisitOrder {
 public:
  /** \param[in] n > 0; \param[in] start < n. */
  VisitOrder(std::uint32_t n, std::uint32_t start)
      : n_(n), start_(start), at_(start), stride_(goldenStride(n))
  {
  }

  std::uint32_t at() const { return at_; }
  void advance() { at_ = at_ >= n_ - stride_ ? at_ - (n_ - stride_) : at_ + stride_; }

  /** \brief When a place is visited, counted from 0. Call prepareWhen() first. */
  std::uint32_t when(std::uint32_t place) const
  {
    const std::uint64_t steps = place >= start_ ? place - start_ : place + (n_ - start_);
    return static_cast<std::uint32_t>(steps * inverse_ % n_);
  }

  /** \brief Seeks the inverse of the stride modulo n (Euclid). */
  void prepareWhen()
  {
    std::int64_t r = n_, next_r = stride_, s = 0, next_s = 1;
    while (next_r != 0) {
      const std::int64_t quotient = r / next_r, rest = r % next_r, old_s = s;
      r = next_r;
      next_r = rest;
      s = next_s;
      next_s = old_s - quotient * next_s;
    }
    inverse_ = static_cast<std::uint64_t>(s < 0 ? s + n_ : s);
  }

 private:
  /** A step coprime to n near its golden section. */
  static std::uint32_t goldenStride(std::uint32_t n)
  {
    auto stride = static_cast<std::uint32_t>(kGolden * n);
    if (stride == 0) return 1;
    while (std::gcd(stride, n) != 1) --stride;
    return stride;
  }

  std::uint32_t n_, start_, at_, stride_;
  std::uint64_t inverse_ = 0;
};

}  // namespace pcl_slim
