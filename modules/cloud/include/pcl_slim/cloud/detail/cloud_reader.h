// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

#include "hwy/cache_control.h"
#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/store_frame.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim::detail {

/** \brief Reads a CloudView's points as doubles, whatever their stored type. */
class PCL_SLIM_EXPORT CloudReader {
 public:
  explicit CloudReader(const CloudView& view) : view_(view) {}

  std::array<double, 3> position(std::size_t input) const {
    const char* p = static_cast<const char*>(view_.xyz) + input * view_.xyz_stride;
    if (view_.scalar == CloudView::Scalar::kFloat) {
      const auto q = three<float>(p);
      return {q[0], q[1], q[2]};
    }
    return three<double>(p);
  }

  /** \brief Has a point's memory on its way when it is read soon after. */
  void prefetch(std::size_t input, bool normal) const {
    hwy::Prefetch(static_cast<const char*>(view_.xyz) + input * view_.xyz_stride);
    if (normal) hwy::Prefetch(static_cast<const char*>(view_.normal) + input * view_.normal_stride);
  }

  /** \brief A point's normal as it is given, of any length. */
  std::array<float, 3> givenNormal(std::size_t input) const {
    return three<float>(static_cast<const char*>(view_.normal) + input * view_.normal_stride);
  }

  /** \brief Whether a point's normal is neither zero nor out of range. */
  bool hasNormal(std::size_t input) const {
    const auto n = givenNormal(input);
    const float length_sq = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    return length_sq > 1e-24f && length_sq <= std::numeric_limits<float>::max();
  }

  /** \brief Unit normal of a point that has one. */
  std::array<float, 3> normal(std::size_t input) const {
    const auto n = givenNormal(input);
    const float scale = 1.0f / std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    return {n[0] * scale, n[1] * scale, n[2] * scale};
  }

 private:
  /** One by one: what is copied as a whole is written and read back in pieces that do not match. */
  template <typename T>
  static std::array<T, 3> three(const char* p) {
    T x, y, z;
    std::memcpy(&x, p, sizeof(T));
    std::memcpy(&y, p + sizeof(T), sizeof(T));
    std::memcpy(&z, p + 2 * sizeof(T), sizeof(T));
    return {x, y, z};
  }

  const CloudView& view_;
};

/** \brief Points of a cloud by what becomes of them in a store. */
struct FrameCounts {
  std::uint64_t input = 0, finite = 0, near = 0, with_normal = 0;
  std::uint64_t stored = 0;  ///< those that a store takes, duplicates included
};

/** \brief Measures the StoreFrame of a cloud that is given in pieces: the units that
 * PointStore::build() gives the whole cloud.
 *
 * One pass over the pieces is enough unless there are strays or some points lack a normal; then
 * another finds the box of those that count. The order of pieces changes nothing.
 */
class PCL_SLIM_EXPORT FrameMeasure {
 public:
  FrameMeasure();
  ~FrameMeasure();
  FrameMeasure(const FrameMeasure&) = delete;
  FrameMeasure& operator=(const FrameMeasure&) = delete;

  /** \brief Adds a piece of the pass that is under way. O(points). */
  void add(const CloudView& piece, int threads);
  /** \brief What the pass under way has found of a part of the cloud, for merge(). */
  std::vector<unsigned char> packed();
  /** \brief Puts what a pass has found of all parts of the cloud in place of what it has found
   * here. */
  void merge(const std::vector<std::vector<unsigned char>>& parts);
  /** \brief Ends a pass. \return whether another one over all pieces is needed. */
  bool needsAnotherPass();
  /** \brief The frame, once no other pass is needed; an error where no point is finite. */
  Error finish(StoreFrame& frame, FrameCounts& counts) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pcl_slim::detail
