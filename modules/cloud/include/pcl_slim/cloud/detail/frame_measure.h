// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/store_frame.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim::detail {

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
  /** \brief Puts what a pass has found of all parts of the cloud in place of what it has found here. */
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
