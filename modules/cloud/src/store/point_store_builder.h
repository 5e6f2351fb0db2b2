// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "pcl_slim/cloud/point_store.h"
#include "store/bulk.h"

namespace pcl_slim::detail {

/** \brief The steps of PointStore::build, in order. */
class PointStoreBuilder {
 public:
  PointStoreBuilder(const CloudView& cloud, int threads, const PointStore* frame);
  PointStoreBuilder(const CloudView& cloud, int threads, const StoreFrame& given);

  Error measure();         ///< which points count, their box, origin and scale
  void sortPoints();       ///< Morton keys, sorted
  void mergeDuplicates();  ///< equal positions become one entry
  Error fillSensors();     ///< where each point was seen from, if the cloud knows it
  void fillFrames();       ///< which frame each point is from, likewise
  void fillBlocks();       ///< block origins, offsets, normals, boxes
  PointStore take() { return std::move(store_); }

 private:
  std::array<double, 3> localPosition(std::uint32_t order) const;
  bool usable(const std::array<double, 3>& position, std::size_t input) const;
  bool allUsable() const { return store_.size_ == cloud_.count(); }
  Bulk bulkOfPoints() const;
  void adopt(const StoreFrame& frame);
  std::size_t countUsable(std::size_t begin, std::size_t end) const;
  void makeKeys(std::size_t begin, std::size_t end, std::size_t out);
  void mergeRun(std::size_t begin, std::size_t end, std::size_t& kept);
  void prefetchBlock(std::size_t block) const;
  void fillBlock(std::size_t block, BlockTree::Level& boxes);
  void fillNormals(std::size_t begin, std::size_t count);
  std::array<float, 3> mergedNormal(std::size_t i) const;

  const CloudView& cloud_;
  CloudReader reader_;
  int threads_;
  const PointStore* larger_ = nullptr;  ///< store of a larger cloud, or null
  const StoreFrame* given_ = nullptr;   ///< units that are not to be measured, or null
  bool with_normals_ = false;
  double inverse_scale_ = 1;
  Bulk bulk_;  ///< of the usable points
  PointStore store_;
  AlignedVector<std::uint64_t> keys_;
  AlignedVector<std::uint32_t> usable_;  ///< position in the caller's sequence, where some are not
  AlignedVector<std::uint32_t> order_;   ///< position in the caller's sequence, per sorted point
};

}  // namespace pcl_slim::detail
