// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "fit_settings.h"

namespace pcl_slim::detail {

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

/** \brief A cell's points that are not served when their turn comes, one after another. */
class CellVisits {
 public:
  /** \param[in] points n > 0 of them, which stay where they are; \param[in] start < n. */
  CellVisits(const std::uint32_t* points, std::uint32_t n, std::uint32_t start)
      : points_(points), n_(n), patience_(n / 32 + 16), order_(n, start)
  {
  }

  /** \brief Finds the next point that served(point) does not hold for; a point served once must
   * stay so. \return whether there is one. */
  template <typename Served>
  bool next(const Served& served, std::uint32_t& point)
  {
    for (; visit_ < n_ && in_vain_ < patience_; ++in_vain_) {
      point = points_[order_.at()];
      ++visit_;
      order_.advance();
      if (served(point)) continue;
      in_vain_ = 0;
      return true;
    }
    // Once many visits have been in vain, the few points that still want one are sought out.
    if (visit_ < n_) seekUnserved(served);
    while (next_left_ < left_.size()) {
      point = left_[next_left_++].second;
      if (!served(point)) return true;
    }
    return false;
  }

 private:
  template <typename Served>
  void seekUnserved(const Served& served)
  {
    order_.prepareWhen();
    for (std::uint32_t i = 0; i < n_; ++i) {
      if (served(points_[i])) continue;
      const std::uint32_t when = order_.when(i);
      if (when >= visit_) left_.emplace_back(when, points_[i]);
    }
    std::sort(left_.begin(), left_.end());
    visit_ = n_;
  }

  const std::uint32_t* points_;
  std::uint32_t n_;
  std::uint32_t
      patience_;  ///< visits in vain after which the rest is sought; the order is the same
  std::uint32_t visit_ = 0, in_vain_ = 0;
  VisitOrder order_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> left_;  ///< when, and which point
  std::size_t next_left_ = 0;
};

}  // namespace pcl_slim::detail
