// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/fit/tile_fit.h"
#include "pcl_slim/stream/point_source.h"
#include "pcl_slim/stream/ranks.h"
#include "pcl_slim/stream/tile_plan.h"

namespace pcl_slim {

namespace detail {
struct StreamState;
}

/** \brief Parameters of a fit by tiles. Those of the fit and the tile size decide the result; the
 * scratch folder and the number of threads do not. */
struct PCL_SLIM_EXPORT StreamParams {
  FitParams fit;
  std::uint64_t tile_points = 4000000;  ///< most points of a tile's core, at least kLeastTile
  std::string scratch;                  ///< folder of the scratch file; empty: the system's
  /// Folder that keeps plan, points and fitted tiles, so that a later run of the same cloud and
  /// parameters, or other processes, continue with them; empty: nothing is kept.
  std::string state;
  /// Processes that fit the cloud together, each with a source of its share of the points; null:
  /// this one alone. Their number does not change the result.
  Ranks* ranks = nullptr;
  std::string source_name;  ///< with it: identifies the source, by its path, size and date

  static constexpr std::uint64_t kLeastTile = 10000;
  /** \brief Points of the median ball that a tile's first level begins with. */
  std::uint64_t firstBallPoints() const { return tile_points / 50; }

  /** \brief Names the first parameter that is out of range, or that tiles cannot honour. */
  Error validate() const;
};

/** \brief What a fit by tiles did, how much it read and wrote and how long its stages took. */
struct StreamStatistics {
  FitStatistics fit;            ///< sums over the tiles; measured noise and normals
  PointStoreStatistics points;  ///< what happened to the input; duplicates of the tiles' cores
  std::uint64_t tiles = 0, kept_tiles = 0;  ///< kept_tiles: of an earlier run
  bool remade =
      false;  ///< what an earlier run has kept of this cloud is damaged, and was made again
  std::uint64_t halo_points = 0;     ///< points that tiles read around their own
  std::uint64_t noise_thinning = 1;  ///< noise was measured on one of this number of points
  std::uint64_t passes = 0;          ///< over the source
  std::uint64_t coarse_surfels = 0;  ///< of levels above the tiles' first
  std::uint64_t scratch_read = 0, scratch_written = 0;  ///< bytes
  std::uint64_t halo_sent = 0;  ///< bytes, of points around other ranks' tiles
  double seconds_measure = 0, seconds_sort = 0, seconds_plan = 0, seconds_load = 0;
};

/** \brief A fit of a cloud that need not fit into memory, tile by tile (docs/tiles.md).
 *
 * prepare() reads the source, at least three times, and sorts the points into a scratch file; then
 * tiles are fitted in any order. All surfels are in one frame(). Same bytes for any order of the
 * points and the tiles, and for any number of threads and ranks. With ranks each keeps the points
 * of its own tiles, a run of them, in its own scratch file; prepare() and fit() of several tiles
 * are calls that all ranks make.
 */
class PCL_SLIM_EXPORT StreamFit {
 public:
  explicit StreamFit(StreamParams params);
  ~StreamFit();
  StreamFit(const StreamFit&) = delete;
  StreamFit& operator=(const StreamFit&) = delete;

  /** \brief Measures, plans and sorts. \return an error for bad parameters, a source that cannot be
   * read, points without extent, a full disk, or cancellation. */
  Error prepare(PointSource& source, Progress* progress = nullptr);

  const StoreFrame& frame() const;
  const TilePlan& plan() const;
  const CloudTraits& traits() const;
  /** \brief First of this rank's tiles, and the one after its last. */
  std::pair<std::size_t, std::size_t> ownTiles() const;
  /** \brief Level that a tile's balls begin with. */
  int firstLevel(std::size_t tile) const;
  /** \brief Points that a tile has in memory, its halo included, at most. */
  std::uint64_t loadedPoints(std::size_t tile) const;
  /** \brief Bytes that fitting one tile takes at most, without its surfels. \param[in] threads of
   * this fit, each of which works on a ball */
  std::uint64_t workingBytes(int threads = 1) const;

  /** \brief Surfels of the levels above the tiles' first, for a level of detail; none is a leaf.
   * They are fitted to a sample of the cloud, have no links or common side, and belong in front of
   * all tiles'. Rank 0 has them. */
  const SLIMSurface& coarse() const;

  /** \brief Fits one of the own tiles. \param[out] surface its surfels, without links or common
   * side; may be empty */
  Error fit(std::size_t tile, SLIMSurface& surface, Progress* progress = nullptr);

  /** \brief Takes the surfels of a tile; an error ends the work. */
  using Sink = std::function<Error(std::size_t tile, const SLIMSurface& surface)>;

  /** \brief Fits some tiles, several at the same time with a thread each, and gives them to a sink
   * in the order requested, one after another, from any thread. \param[in] at_once 1: one after
   * another, with all threads; each takes workingBytes(). Of several ranks each fits those of the
   * tiles that are its own, and rank 0's sink takes all. */
  Error fit(const std::vector<std::size_t>& tiles, int at_once, const Sink& sink,
            Progress* progress = nullptr);

  /** \brief Of prepare() and all tiles fitted so far. */
  const StreamStatistics& statistics() const;

 private:
  std::unique_ptr<detail::StreamState> state_;
};

/** \brief Fits all tiles into one surface with links, and with a common side where points have no
 * normals: for clouds whose surfels fit into memory. */
PCL_SLIM_EXPORT Error fitTiles(PointSource& source, const StreamParams& params,
                               SLIMSurface& surface, StreamStatistics* statistics = nullptr,
                               Progress* progress = nullptr);

}  // namespace pcl_slim
