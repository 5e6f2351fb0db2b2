// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pcl_slim/fit/fit.h"
#include "pcl_slim/stream/ranks.h"
#include "pcl_slim/surface/surface.h"
#include "scratch/tile_store.h"

namespace pcl_slim::detail {

/** \brief Sums what the fits of tiles did. Measured noise and normals stay as they are. */
class StatisticsSum {
 public:
  /** \brief Adds a tile's. O(surfels). */
  void add(const FitStatistics& tile, const SLIMSurface& surface);
  FitStatistics& sum() { return sum_; }
  const FitStatistics& sum() const { return sum_; }

 private:
  FitStatistics sum_;
  double weight_ = 0, square_ = 0;  ///< of the residuals
  bool any_ = false;
};

/** \brief A tile's counts as numbers, to be kept with its surfels. */
std::vector<double>
packedStatistics(const FitStatistics& tile);

/** \brief The inverse, with leaves_per_level counted on the surfels. */
FitStatistics
unpackedStatistics(const std::vector<double>& numbers, const SLIMSurface& surface);

/** \brief Length of packedStatistics(). */
std::size_t
numPackedStatistics();

/** \brief What the fit of one tile has made. */
struct FittedTile {
  SLIMSurface surface;
  FitStatistics statistics;
  std::uint64_t halo_points = 0;
  double seconds_load = 0;
  bool kept = false;  ///< by an earlier run
};

/** \brief A tile's surfels and statistics as bytes, without its times. */
Ranks::Bytes
packedTile(const FittedTile& made);

/** \brief The inverse. \return an error for bytes of another kind. */
Error
unpackTile(const Ranks::Bytes& bytes, FittedTile& made);

/** \brief Fitted tiles of a rank, on disk until rank 0 takes them. */
class FittedTiles {
 public:
  /** \brief Adds one. \param[in] folder of the scratch file; empty: the system's */
  Error add(std::size_t tile, const FittedTile& made, const std::string& folder);
  /** \brief Reads one that was added, as packedTile() made it. */
  Error read(std::size_t tile, Ranks::Bytes& bytes) const;

 private:
  struct Place {
    std::uint64_t at = 0, bytes = 0;
  };

  ScratchFile file_;
  std::map<std::size_t, Place> places_;
  std::uint64_t end_ = 0;
};

}  // namespace pcl_slim::detail
