// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "points/point_window.h"

namespace pcl_slim::detail {

/** Reads points' records, in any order, into columns. */
class PointFetcher {
 public:
  static constexpr std::size_t kBlock = 64;  ///< points converted at a time
  static constexpr std::size_t kAhead = 24;  ///< points between asking for one and using it

  PointFetcher(const OctreeFrame& frame, const OctreeSource& source);

  /** Fetches n points. points: their places in the caller's arrays, and kBlock + kAhead places more
   * that may be read; columns: aligned, with room for kBlock more. */
  void run(const std::uint32_t* points, std::size_t n,
           const std::array<float*, PointWindow::kNumColumns>& columns) const;

 private:
  /** One attribute: an address, and bytes from one point to the next. */
  struct Attribute {
    const unsigned char* first = nullptr;
    std::size_t stride = 0;

    const unsigned char* of(std::size_t point) const { return first + point * stride; }
  };

  template <typename T>
  void positions(const std::uint32_t* points, std::size_t n, float* const out[3]) const;
  void vectors(const Attribute& attribute, const std::uint32_t* points, std::size_t n,
               float* const out[3]) const;
  void colors(const std::uint32_t* points, std::size_t n, float* const out[3]) const;

  const OctreeFrame& frame_;
  const LabTable& table_;
  bool doubles_;
  std::uint32_t last_;  ///< place behind which no fourth float may stand
  Attribute xyz_, normal_, bgr_;
  /** What lies together in memory, and bytes from its begin to its last one. */
  struct Stretch {
    Attribute begin;
    std::size_t span = 0;
  };

  std::array<Stretch, 3> stretches_;
  std::size_t num_stretches_ = 0;
};

}  // namespace pcl_slim::detail
