// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cells/cell_counts.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/stopwatch.h"
#include "pcl_slim/stream/stream_fit.h"
#include "ranks/fitted_tiles.h"
#include "ranks/rank_messages.h"
#include "scratch/tile_store.h"
#include "tiles/tile_loader.h"

namespace pcl_slim::detail {

/** \brief The error of a fit that was cancelled. */
inline Error
cancelled()
{
  return {ErrorCode::kCancelled, "the fit was cancelled"};
}

/** \brief What a fit by tiles knows between its steps. */
struct StreamState {
  explicit StreamState(StreamParams given) : params(std::move(given))
  {
    params.fit.threads = threads = resolveThreads(params.fit.threads);
    if (params.ranks == nullptr) params.ranks = &alone;
  }

  StreamParams params;
  OneRank alone;
  int threads;
  StoreFrame frame;
  CellCounts counts;
  TilePlan plan;
  std::vector<std::size_t> first_tiles;  ///< of each rank, and the number of all tiles
  TileStore store;                       ///< points of the own tiles ...
  TileStore halo;                        ///< ... and of other ranks' near them
  CloudTraits traits;
  LevelRadii radii;
  std::vector<int> first_levels;
  std::vector<std::uint64_t> halos;  ///< most points of each tile's
  std::vector<std::uint64_t> balls;  ///< points of each tile's largest, about
  SLIMSurface coarse;                ///< surfels above the tiles' first levels
  StatisticsSum sum;
  StreamStatistics stats;

  TileLoader loader(int with_threads) const { return {plan, store, halo, frame, with_threads}; }
  Ranks& ranks() const { return *params.ranks; }
  bool isAlone() const { return ranks().size() == 1; }
  std::size_t firstTile() const { return first_tiles[static_cast<std::size_t>(ranks().rank())]; }
  std::size_t endTile() const { return first_tiles[static_cast<std::size_t>(ranks().rank()) + 1]; }
  bool owns(std::size_t tile) const { return tile >= firstTile() && tile < endTile(); }

  Error pass(PointSource& source, Progress* progress, float begin, float end, const char* stage,
             const PointSource::Visit& visit);
  Error measureFrame(PointSource& source, Progress* progress);
  Error countCells(PointSource& source, Progress* progress);
  Error sumCells();
  void shareTiles();
  std::size_t ownerOf(std::uint64_t key) const;
  Error sortPoints(PointSource& source, Progress* progress);
  Error sendPoints(PointSource& source, Progress* progress);
  Error takePoints(TileStore& into, const Ranks::Bytes& records, PointKeys& keys) const;
  Error fetchHalo(const std::vector<char>& wanted);
  Error sendHalo(const std::vector<std::vector<std::uint64_t>>& asked);
  Error measureNoise();
  Error survey(Progress* progress);
  std::uint64_t coarseThinning() const;
  Error surveyTile(std::size_t tile, std::vector<unsigned char>& sample, std::vector<char>& wanted);
  void addSample(const std::vector<unsigned char>& core, std::vector<unsigned char>& sample) const;
  Error fitCoarse(const std::vector<unsigned char>& sample);
  int firstLevelAt(std::uint64_t key) const;
  Error load(std::size_t tile, int with_threads, std::vector<unsigned char>& records) const;

  bool keeps() const { return !params.state.empty(); }
  bool takeKept(PointSource& source);
  Error keep() const;
  Error fitAnew(std::size_t tile, int with_threads, FittedTile& made, Progress& progress) const;
  Error fitNext(std::size_t tile, FittedTile& made, Progress* progress) const;
  Error fitTile(std::size_t tile, int with_threads, FittedTile& made, Progress& progress) const;
  void addTile(std::size_t tile, const FittedTile& made);
  Error give(std::size_t tile, const FittedTile& made, const StreamFit::Sink& sink);
  Error gatherTiles(const std::vector<std::size_t>& tiles, const StreamFit::Sink& sink);
  std::string identity;  ///< of source and parameters
  FittedTiles fitted;    ///< that rank 0 has not taken yet
};

}  // namespace pcl_slim::detail
