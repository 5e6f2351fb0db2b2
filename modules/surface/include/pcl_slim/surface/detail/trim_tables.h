// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief A trim map laid out for kernels: one aligned word has the 3 x 3 nodes around a node.
 *
 * Word q of a row has columns 8 q - 1 ... 8 q + 8, three bits each, lowest first: whether the
 * nodes below, on and above the row are outside. Beyond the map its border repeats.
 */
struct TrimTable {
  const std::int32_t* words = nullptr;  ///< null: closed
  std::int32_t words_per_row = 0;
  float last = 0.0f;  ///< largest coordinate of a node: side - 1

  bool closed() const { return words == nullptr; }
};

/** \brief Tables of all of a surface's open surfels; 4 to 8 bytes for every 8 nodes. */
class PCL_SLIM_EXPORT TrimTables {
 public:
  TrimTables() = default;
  /** \brief O(nodes). */
  explicit TrimTables(const SLIMSurface& surface);

  bool empty() const { return begin_.empty(); }
  /** \brief Of surfel i; valid as long as this object. */
  TrimTable of(std::size_t i) const {
    if (empty() || sides_[i] == 0) return {};
    return {words_.data() + begin_[i], (sides_[i] + 7) / 8, static_cast<float>(sides_[i] - 1)};
  }

 private:
  std::vector<std::uint32_t> begin_;
  std::vector<std::uint8_t> sides_;
  std::vector<std::int32_t> words_;
};

}  // namespace pcl_slim::detail
