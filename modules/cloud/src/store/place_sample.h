// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "store/bulk.h"

namespace pcl_slim::detail {

/** \brief At most 4096 places of a cloud: those whose hashes are the least, one of each hash, so that
 * neither the points' order nor their repetition changes anything. */
class PlaceSample {
 public:
  /** \brief Offers a finite place. */
  void offer(const std::array<double, 3>& place);
  /** \brief Offers the places of another part of the cloud. */
  void merge(PlaceSample& other);
  /** \brief The places that are kept of those offered. */
  std::vector<std::array<double, 3>> places();
  /** \brief The bulk of the cloud by the places offered so far. */
  Bulk bulk();

 private:
  struct Entry {
    std::uint64_t hash;
    std::array<double, 3> place;

    bool operator<(const Entry& other) const
    {
      return hash != other.hash ? hash < other.hash : place < other.place;
    }
    bool operator==(const Entry& other) const { return hash == other.hash; }
  };

  void offer(const Entry& entry);
  void shrink();

  std::vector<Entry> entries_;
  std::array<std::uint64_t, 1024> recent_{};  ///< what is there already, for points all alike
  std::uint64_t bound_ = std::numeric_limits<std::uint64_t>::max();
};

}  // namespace pcl_slim::detail
