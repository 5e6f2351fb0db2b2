// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "cells/cell_counts.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/stream/stream_fit.h"
#include "scratch/tile_store.h"
#include "tiles/statistics_sum.h"
#include "tiles/tile_loader.h"

namespace pcl_slim::detail {

class Stopwatch {
 public:
  double seconds() const
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/** \brief What is said of a fit that was cancelled. */
inline Error
cancelled()
{
  return {ErrorCode::kCancelled, "the fit was cancelled"};
}

/** \brief What the fit of one tile has made. */
struct FittedTile {
  SLIMSurface surface;
  FitStatistics statistics;
  std::uint64_t halo_points = 0;
  double seconds_load = 0;
  bool kept = false;  ///< by an earlier run
};

/** \brief What a fit by tiles knows between its steps. */
struct StreamState {
  explicit StreamState(StreamParams given) : params(std::move(given))
  {
    params.fit.threads = threads = resolveThreads(params.fit.threads);
  }

  StreamParams params;
  int threads;
  StoreFrame frame;
  CellCounts counts;
  TilePlan plan;
  TileStore store;
  CloudTraits traits;
  LevelRadii radii;
  std::vector<int> first_levels;
  std::vector<std::uint64_t> halos;  ///< most points of each tile's
  SLIMSurface coarse;                ///< surfels above the tiles' first levels
  StatisticsSum sum;
  StreamStatistics stats;

  TileLoader loader(int with_threads) const { return {plan, store, frame, with_threads}; }

  template <typename Visit>
  Error pass(PointSource& source, Progress* progress, float begin, float end, const char* stage,
             const Visit& visit);
  Error measureFrame(PointSource& source, Progress* progress);
  Error countCells(PointSource& source, Progress* progress);
  Error sortPoints(PointSource& source, Progress* progress);
  Error measureNoise();
  Error survey(Progress* progress);
  std::uint64_t coarseThinning() const;
  void addSample(const std::vector<unsigned char>& core, std::vector<unsigned char>& sample) const;
  Error fitCoarse(const std::vector<unsigned char>& sample);
  int firstLevelAt(std::uint64_t key) const;
  Error load(std::size_t tile, int with_threads, std::vector<unsigned char>& records) const;

  bool keeps() const { return !params.state.empty(); }
  bool takeKept(PointSource& source);
  Error keep() const;
  Error fitAnew(std::size_t tile, int with_threads, FittedTile& made, Progress& progress) const;
  Error fitTile(std::size_t tile, int with_threads, FittedTile& made, Progress& progress) const;
  void addTile(std::size_t tile, const FittedTile& made);
  std::string identity;  ///< of source and parameters
};

}  // namespace pcl_slim::detail
