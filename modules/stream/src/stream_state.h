// SPDX-License-Identifier: BSD-3-Clause
// What the steps of a fit by tiles share: messages between ranks, fitted tiles, what is kept, and
// the state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

#include "cell_counts.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/stopwatch.h"
#include "pcl_slim/fit/tile_fit.h"
#include "pcl_slim/stream/ranks.h"
#include "pcl_slim/stream/stream_fit.h"
#include "pcl_slim/stream/tile_plan.h"
#include "pcl_slim/surface/surface.h"
#include "tile_store.h"

namespace pcl_slim::detail {

/** \brief One process alone. */
class OneRank : public Ranks {
 public:
  int rank() const override { return 0; }
  int size() const override { return 1; }

 protected:
  void swap(std::vector<Bytes>&) override {}
};

template <typename T>
void appendBytes(const T& value, Ranks::Bytes& bytes) {
  static_assert(std::is_trivially_copyable_v<T>);
  bytes.resize(bytes.size() + sizeof(T));
  std::memcpy(bytes.data() + bytes.size() - sizeof(T), &value, sizeof(T));
}

/** \brief The values stored in bytes, one behind the other. */
template <typename T>
std::vector<T> valuesOf(const Ranks::Bytes& bytes) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

inline std::vector<Ranks::Bytes> emptyMessages(const Ranks& ranks) {
  return std::vector<Ranks::Bytes>(static_cast<std::size_t>(ranks.size()));
}

/** \brief The bytes of all ranks, in the order of the ranks, at each of them. */
std::vector<Ranks::Bytes> fromAll(Ranks& ranks, const Ranks::Bytes& own);

/** \brief Appends all ranks' bytes at rank 0, in their order; none are left at the others. */
void gather(Ranks& ranks, Ranks::Bytes& bytes);

/** \brief All ranks' values, in the order of the ranks, at each of them. */
template <typename T>
std::vector<T> allOf(Ranks& ranks, const std::vector<T>& own) {
  Ranks::Bytes bytes;
  for (const T& value : own) appendBytes(value, bytes);
  std::vector<T> all;
  for (const Ranks::Bytes& part : fromAll(ranks, bytes)) {
    const std::vector<T> values = valuesOf<T>(part);
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

/** \brief The value of rank 0. */
template <typename T>
T ofFirst(Ranks& ranks, const T& own) {
  std::vector<T> first;
  if (ranks.rank() == 0) first.push_back(own);
  return allOf(ranks, first).front();
}

/** \brief Messages that ranks exchange in rounds, until none has more to send. */
class Rounds {
 public:
  explicit Rounds(Ranks& ranks) : ranks_(ranks), messages_(emptyMessages(ranks)) {}

  /** \brief What the next round sends to a rank. */
  Ranks::Bytes& to(std::size_t rank) { return messages_[rank]; }
  /** \brief Exchanges what is there. \param[in] more whether this rank has another round to come
   * \param[out] received from all ranks, in their order \return whether some rank has more */
  bool exchange(bool more, Ranks::Bytes& received);

 private:
  Ranks& ranks_;
  std::vector<Ranks::Bytes> messages_;
};

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

/** \brief What the fit of one tile has made. */
struct FittedTile {
  SLIMSurface surface;
  FitStatistics statistics;
  std::uint64_t halo_points = 0;
  double seconds_load = 0;
  bool kept = false;  ///< by an earlier run
};

/** \brief A tile from bytes as FittedTiles has them. \return an error for bytes of another kind. */
Error unpackTile(const Ranks::Bytes& bytes, FittedTile& made);

/** \brief Fitted tiles of a rank, on disk until rank 0 takes them. */
class FittedTiles {
 public:
  /** \brief Adds one. \param[in] folder of the scratch file; empty: the system's */
  Error add(std::size_t tile, const FittedTile& made, const std::string& folder);
  /** \brief Reads one that was added: its surfels and statistics as bytes, without its times. */
  Error read(std::size_t tile, Ranks::Bytes& bytes) const;

 private:
  struct Place {
    std::uint64_t at = 0, bytes = 0;
  };

  ScratchFile file_;
  std::map<std::size_t, Place> places_;
  std::uint64_t end_ = 0;
};

/** \brief The results of prepare() that fits of tiles need in addition to the points. */
struct KeptPlan {
  StoreFrame frame;
  PointRecord record;
  CloudTraits traits;
  FitStatistics noise;  ///< what was measured, without times
  PointStoreStatistics points;
  std::uint64_t thinning = 1;
  TilePlan plan;  ///< tiles are made again from the cells
  std::vector<int> first_levels;
  std::vector<std::uint64_t> halos, balls;
  std::vector<std::uint64_t> checksums;  ///< of the buckets of points
};

/** \brief Writes a plan into a folder. \param[in] identity of source and parameters */
Error savePlan(const std::string& folder, const std::string& identity, const KeptPlan& plan);

/** \brief Reads a plan. \return whether the folder has one of this identity that is whole; an error
 * is not returned: the plan is made again then. */
bool loadPlan(const std::string& folder, const std::string& identity, KeptPlan& plan);

/** \brief Keeps the surfels of a tile in a folder. */
Error saveTile(const std::string& folder, const std::string& identity, std::size_t tile,
               const FittedTile& made);

/** \brief Reads a tile that was kept under the same identity. \return whether there is one that is
 * whole */
bool loadTile(const std::string& folder, const std::string& identity, std::size_t tile,
              FittedTile& made);

/** \brief The error of a fit that was cancelled. */
inline Error cancelled() {
  return {ErrorCode::kCancelled, "the fit was cancelled"};
}

/** \brief What a fit by tiles knows between its steps. */
struct StreamState {
  explicit StreamState(StreamParams given) : params(std::move(given)) {
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
