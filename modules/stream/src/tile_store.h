// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "cell_counts.h"
#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/store_frame.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/stream/tile_plan.h"

namespace pcl_slim::detail {

/** \brief A file for points in some folder. Unless it is kept it has no name, and goes when it is
 * closed, however the program ends. */
class ScratchFile {
 public:
  ScratchFile() = default;
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  /** \brief Makes it. \param[in] folder empty: the system's for temporary files \param[in] bytes
   * that will be written \return an error where there is no folder or not enough room. */
  Error create(const std::string& folder, std::uint64_t bytes);
  /** \brief Makes one that is kept under a name in the folder, in place of an older one. */
  Error createKept(const std::string& folder, std::uint64_t bytes);
  /** \brief Opens one that was kept, for reading. \return an error where its size differs from
   * bytes. */
  Error openKept(const std::string& folder, std::uint64_t bytes);
  Error write(std::uint64_t at, const void* from, std::size_t bytes);
  Error read(std::uint64_t at, void* to, std::size_t bytes) const;

  std::uint64_t bytesWritten() const { return written_; }
  std::uint64_t bytesRead() const { return read_; }

 private:
  Error checkRoom(std::uint64_t bytes);
  Error failed(const char* verb, std::uint64_t at, int code) const;

  std::string folder_, kind_ = "scratch";
  int file_ = -1;
  std::uint64_t written_ = 0;
  mutable std::atomic<std::uint64_t> read_ = 0;
};

/** \brief How points are kept: coordinates as floats or doubles, then a normal's three floats, if
 * any. */
struct PointRecord {
  CloudView::Scalar scalar = CloudView::Scalar::kFloat;
  bool normals = false;

  std::size_t positionBytes() const { return scalar == CloudView::Scalar::kFloat ? 12 : 24; }
  std::size_t bytes() const { return positionBytes() + (normals ? 12 : 0); }
  /** \brief Copies a piece's point. */
  void write(const CloudView& piece, std::size_t i, unsigned char* to) const;
  /** \brief A view of records stored one behind the other. */
  CloudView view(const std::vector<unsigned char>& records) const;
};

/** \brief How many points each of a plan's cells has. */
std::vector<std::uint32_t> pointsOfCells(const TilePlan& plan);

/** \brief A run of a tile's cells whose points are contiguous in the scratch file. */
struct Bucket {
  std::size_t first_cell = 0, end_cell = 0, tile = 0;
  std::uint64_t points = 0, first_point = 0;  ///< first_point: of the file
  std::uint64_t written = 0;                  ///< points so far
  std::uint64_t checksum = 0;                 ///< of their bytes, where they are kept
};

/** \brief The cloud's points on disk, sorted into buckets. */
class TileStore {
 public:
  /** \brief Cuts the tiles into buckets and makes the file. \param[in] points that it will contain
   * of each of the plan's cells */
  Error create(const TilePlan& plan, const std::vector<std::uint32_t>& points,
               const PointRecord& record, const std::string& folder, bool kept);
  /** \brief Opens the points that an earlier run has sorted by the same plan, and reads them all
   * once. \param[in] checksums of the buckets \return an error where there are none, or others. */
  Error open(const TilePlan& plan, const PointRecord& record, const std::string& folder,
             const std::vector<std::uint64_t>& checksums);

  /** \brief Adds a piece's points to their buckets. \param[in] cells numbered */
  Error add(const CloudView& piece, const std::uint64_t* keys, const CellCounts& cells);
  /** \brief Writes what is still buffered. \return an error where the points are not those counted.
   */
  Error finish();

  const PointRecord& record() const { return record_; }
  const std::vector<Bucket>& buckets() const { return buckets_; }
  /** \brief Checksums of the buckets of a store that is kept. */
  std::vector<std::uint64_t> checksums() const;
  /** \brief Appends the records of a bucket. */
  Error read(const Bucket& bucket, std::vector<unsigned char>& records) const;
  const ScratchFile& file() const { return file_; }

 private:
  void cut(const TilePlan& plan, const std::vector<std::uint32_t>& points);
  Error flush(std::size_t bucket);

  PointRecord record_;
  bool kept_ = false;
  std::vector<Bucket> buckets_;
  std::vector<std::uint32_t> bucket_of_;  ///< of each cell, while points are added
  std::size_t buffer_points_ = 0;         ///< room of a bucket's buffer
  std::vector<unsigned char> buffers_;    ///< one a bucket
  std::vector<std::uint32_t> filled_;     ///< points in it
  ScratchFile file_;
};

/** \brief Cells of a grid whose distance from a tile's points may be within a reach.
 *
 * Cells are a sixth to a twelfth of the reach wide, so they contain little beyond it. A function of
 * the points' set alone.
 */
class HaloMask {
 public:
  /** \param[in] plan,tile whose cells bound the mask \param[in] keys of the tile's points, any
   * order
   * \param[in] reach local length. O(points + cells of the tile's box + columns of cells with points
   * times reach squared in cells). */
  HaloMask(const TilePlan& plan, const TilePlan::Tile& tile,
           const AlignedVector<std::uint64_t>& keys, double reach);

  bool holds(std::uint64_t key) const { return hasCell(cellOf(key, depth_)); }
  /** \brief Whether some part of a plan's cell is in the mask. */
  bool meets(const TilePlan::Cell& cell) const;

 private:
  using Place = std::array<int, 3>;

  std::size_t columnOf(int x, int y) const;
  bool isMarked(const Place& p) const;
  bool inside(const Place& p) const;
  bool hasCell(std::uint64_t code) const;
  bool fitBox(const TilePlan& plan, const TilePlan::Tile& tile, double reach);
  void markCore(const AlignedVector<std::uint64_t>& keys);
  void grow(double cells);

  int depth_ = 0;
  Place low_{}, size_{};
  std::size_t words_ = 0;  ///< of a column along z, a bit a cell
  std::vector<std::uint64_t> columns_;
};

/** \brief Brings tiles from disk into memory. */
class TileLoader {
 public:
  /** \param[in] halo other ranks' points near this one's tiles; none where one process has all */
  TileLoader(const TilePlan& plan, const TileStore& store, const TileStore& halo,
             const StoreFrame& frame, int threads)
      : plan_(plan), store_(store), halo_(halo), frame_(frame), threads_(threads) {}

  /** \brief Reads the points of a tile's core. */
  Error loadCore(std::size_t tile, std::vector<unsigned char>& records) const;
  /** \brief The mask of a tile's surroundings. \param[in] records its core */
  HaloMask maskOf(std::size_t tile, const std::vector<unsigned char>& records, double reach) const;
  /** \brief The cells that a mask meets outside a tile, ascending: they contain its halo. */
  std::vector<std::uint64_t> haloCells(std::size_t tile, const HaloMask& mask) const;
  /** \brief Appends the points of a tile's halo. */
  Error loadHalo(std::size_t tile, const HaloMask& mask, std::vector<unsigned char>& records) const;
  /** \brief Appends the points of some cells, [first, end), of which every thinning-th is kept,
   * chosen by its place. */
  Error loadCells(std::size_t first, std::size_t end, std::uint64_t thinning,
                  std::vector<unsigned char>& records) const;

  const TilePlan& plan() const { return plan_; }
  const PointRecord& record() const { return store_.record(); }

 private:
  template <typename Wanted>
  Error loadSome(const TileStore& store, const Bucket& bucket, const Wanted& wanted,
                 std::vector<unsigned char>& records) const;

  const TilePlan& plan_;
  const TileStore &store_, &halo_;
  const StoreFrame& frame_;
  int threads_;
};

}  // namespace pcl_slim::detail
