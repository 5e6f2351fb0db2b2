// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "hwy/cache_control.h"
#include "pcl_slim/cloud/point_store.h"

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

  /** \brief Unit normal, or zero where the point has none. */
  std::array<float, 3> normal(std::size_t input) const
  {
    std::array<float, 3> n;
    const char* p = static_cast<const char*>(view_.normal) + input * view_.normal_stride;
    std::memcpy(n.data(), p, sizeof(n));
    const float length_sq = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    if (!(length_sq > 1e-24f) || !std::isfinite(length_sq)) return {0, 0, 0};
    const float scale = 1.0f / std::sqrt(length_sq);
    return {n[0] * scale, n[1] * scale, n[2] * scale};
  }

 private:
  const CloudView& view_;
};

/** \brief The steps of PointStore::build, in order. */
class PointStoreBuilder {
 public:
  PointStoreBuilder(const CloudView& cloud, int threads);

  Error measure();         ///< which points count, their box, origin and scale
  void sortPoints();       ///< Morton keys, sorted
  void mergeDuplicates();  ///< equal positions become one entry
  void fillBlocks();       ///< block origins, offsets, normals, boxes
  PointStore take() { return std::move(store_); }

 private:
  std::array<double, 3> localPosition(std::uint32_t order) const;
  bool usable(const std::array<double, 3>& position, std::size_t input) const;
  void mergeRun(std::size_t begin, std::size_t end, std::size_t& kept);
  void prefetchBlock(std::size_t block) const;
  void fillBlock(std::size_t block);
  std::array<float, 3> mergedNormal(std::size_t i) const;

  const CloudView& cloud_;
  CloudReader reader_;
  int threads_;
  bool with_normals_ = false;
  PointStore store_;
  AlignedVector<std::uint64_t> keys_;
  AlignedVector<std::uint32_t> order_;  ///< position in the caller's sequence, per sorted point
};

}  // namespace pcl_slim
