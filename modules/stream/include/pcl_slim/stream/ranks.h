// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief Processes that fit one cloud together, each with a share of its points and tiles: all of
 * them take the same steps in the same order. MpiRanks are those of an MPI job. */
class PCL_SLIM_EXPORT Ranks {
 public:
  using Bytes = std::vector<unsigned char>;

  virtual ~Ranks() = default;

  virtual int rank() const = 0;  ///< from 0 on
  virtual int size() const = 0;  ///< number of ranks

  /** \brief Sends a message to each rank and receives one from each.
   * \param[in,out] messages size() of them: to each rank, then from each; the own one stays */
  void exchange(std::vector<Bytes>& messages);

  std::uint64_t bytesSent() const { return sent_; }     ///< to others
  double secondsExchanged() const { return seconds_; }  ///< spent in exchange(), waits included

 protected:
  /** \brief Does it. A rank that fails ends all: there is no error to return. */
  virtual void swap(std::vector<Bytes>& messages) = 0;

 private:
  std::uint64_t sent_ = 0;
  double seconds_ = 0;
};

}  // namespace pcl_slim
