// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mpi.h>

#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/stream/ranks.h"

namespace pcl_slim {

/** \brief Waits for an MPI request without keeping a core busy. \param[in] seconds at most so long;
 * negative: as long as it takes \return whether it is done */
PCL_SLIM_EXPORT bool waitFor(MPI_Request& request, double seconds = -1);

/** \brief The ranks of an MPI job, for StreamParams::ranks. MPI must be initialised, and outlive
 * this. */
class PCL_SLIM_EXPORT MpiRanks : public Ranks {
 public:
  explicit MpiRanks(MPI_Comm world = MPI_COMM_WORLD);
  ~MpiRanks() override;
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  int rank() const override { return rank_; }
  int size() const override { return size_; }

 protected:
  void swap(std::vector<Bytes>& messages) override;

 private:
  MPI_Comm ranks_ = MPI_COMM_NULL;  ///< apart from the caller's own messages
  int rank_ = 0, size_ = 1;
};

}  // namespace pcl_slim
