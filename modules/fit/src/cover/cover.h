// SPDX-License-Identifier: BSD-3-Clause
// The cover of a cloud's points by balls, level by level (docs/theory.md, "Levels" and "Cover").
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "ball.h"
#include "fit_plan.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/progress.h"

namespace pcl_slim::detail {

constexpr double kReachMargin = 1.001;  ///< widens how far a level's balls reach, for rounding

/** \brief Points of a store, cut into runs of one Morton cell each; cells have eight colours, and
 * those of one never touch. */
class CoverCells {
 public:
  struct Cell {
    std::uint32_t begin, end;  ///< range of the points
    std::uint64_t code;
  };

  /** \brief Cuts points, which ascend, into cells at least twice as wide as a reach. About the
   * number of cells in time, by steps along the points. */
  void divide(const PointStore& store, const AlignedVector<std::uint32_t>& points, double reach);

  std::size_t size() const { return cells_.size(); }
  const Cell& operator[](std::size_t i) const { return cells_[i]; }

  /** \brief Cells by colour; the largest of a colour come first, so that threads end together. */
  const std::vector<std::uint32_t>& byColor() const { return by_color_; }
  /** \brief Where a colour begins there, 0 to 7, and where the last ends, 8. */
  std::size_t colorBegin(int color) const { return color_begin_[static_cast<std::size_t>(color)]; }

  static std::size_t colorOf(const Cell& cell) { return cell.code & 7; }
  std::size_t colorOf(std::uint32_t i) const { return colorOf(cells_[i]); }

  /** \brief Calls body(j) for the cells that touch cell i; at the border of the space for some that
   * do not. */
  template <typename Body>
  void forTouching(std::uint32_t i, const Body& body) const {
    for (int step = 0; step < 27; ++step) {
      const std::uint32_t other = beside(i, step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1);
      if (other != size() && other != i) body(other);
    }
  }

  std::size_t memoryBytes() const { return cells_.capacity() * sizeof(Cell); }

 private:
  /** The cell x, y, z steps along the axes from cell i; size() if there is none. */
  std::uint32_t beside(std::uint32_t i, int x, int y, int z) const;
  void orderByColor();

  std::vector<Cell> cells_;
  std::vector<std::uint32_t> by_color_;
  std::array<std::size_t, 9> color_begin_{};
};

/** \brief The order in which n places are visited: strides by the golden section, which spread
 * evenly. */
class VisitOrder {
 public:
  /** \param[in] n > 0; \param[in] start < n. */
  VisitOrder(std::uint32_t n, std::uint32_t start)
      : n_(n), start_(start), at_(start), stride_(goldenStride(n)) {}

  std::uint32_t at() const { return at_; }
  void advance() { at_ = at_ >= n_ - stride_ ? at_ - (n_ - stride_) : at_ + stride_; }

  /** \brief When a place is visited, counted from 0. Call prepareWhen() first. */
  std::uint32_t when(std::uint32_t place) const {
    const std::uint64_t steps = place >= start_ ? place - start_ : place + (n_ - start_);
    return static_cast<std::uint32_t>(steps * inverse_ % n_);
  }

  /** \brief Seeks the inverse of the stride modulo n (Euclid). */
  void prepareWhen() {
    std::int64_t r = n_, next_r = stride_, s = 0, next_s = 1;
    while (next_r != 0) {
      const std::int64_t quotient = r / next_r, rest = r % next_r, old_s = s;
      r = next_r;
      next_r = rest;
      s = next_s;
      next_s = old_s - quotient * next_s;
    }
    inverse_ = static_cast<std::uint64_t>(s < 0 ? s + n_ : s);
  }

 private:
  /** A step coprime to n near its golden section. */
  static std::uint32_t goldenStride(std::uint32_t n) {
    auto stride = static_cast<std::uint32_t>(kGolden * n);
    if (stride == 0) return 1;
    while (std::gcd(stride, n) != 1) --stride;
    return stride;
  }

  std::uint32_t n_, start_, at_, stride_;
  std::uint64_t inverse_ = 0;
};

/** \brief A cell's points that are not done (covered or marked) at their turn, one after another.
 */
class CellVisits {
 public:
  /** \param[in] points n > 0 of them, which stay where they are; \param[in] start < n. */
  CellVisits(const std::uint32_t* points, std::uint32_t n, std::uint32_t start)
      : points_(points), n_(n), patience_(n / 32 + 16), order_(n, start) {}

  /** \brief Finds the next point for which is_done(point) is false; once true, it must
   * stay true. \return whether there is one. */
  template <typename IsDone>
  bool next(const IsDone& is_done, std::uint32_t& point) {
    for (; visit_ < n_ && in_vain_ < patience_; ++in_vain_) {
      point = points_[order_.at()];
      ++visit_;
      order_.advance();
      if (is_done(point)) continue;
      in_vain_ = 0;
      return true;
    }
    // After many visits in vain the few points that are not done are listed.
    if (visit_ < n_) seekOpen(is_done);
    while (next_left_ < left_.size()) {
      point = left_[next_left_++].second;
      if (!is_done(point)) return true;
    }
    return false;
  }

 private:
  template <typename IsDone>
  void seekOpen(const IsDone& is_done) {
    order_.prepareWhen();
    for (std::uint32_t i = 0; i < n_; ++i) {
      if (is_done(points_[i])) continue;
      const std::uint32_t when = order_.when(i);
      if (when >= visit_) left_.emplace_back(when, points_[i]);
    }
    std::sort(left_.begin(), left_.end());
    visit_ = n_;
  }

  const std::uint32_t* points_;
  std::uint32_t n_;
  std::uint32_t
      patience_;  ///< visits in vain after which the rest is listed; the order stays the same
  std::uint32_t visit_ = 0, in_vain_ = 0;
  VisitOrder order_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> left_;  ///< when, and which point
  std::size_t next_left_ = 0;
};

/** \brief Numbers of points without a leaf, by reason. */
struct PointCounts {
  std::uint64_t uncovered = 0, unsupported = 0;  ///< unsupported: by any leaf at all
  std::uint64_t lone_normals = 0;                ///< passed over for their normals
  std::uint64_t unresolved =
      0;  ///< their balls are smaller than the spacing of the grid of centres
};

/** \brief Stored points from begin on, to before end. */
struct PointRange {
  std::size_t begin = 0, end = 0;

  std::size_t size() const { return end - begin; }
};

/** \brief Covers the points level by level (section 2, "Multi-scale surfel-based approximation";
 * docs/theory.md, "Levels").
 *
 * Within a level the centres of one Morton cell are tried one after another, cells of one of
 * eight colours at the same time: cells are at least twice as wide as a ball reaches, so no two
 * threads touch the same point and the result does not depend on their number. Where cells are few,
 * each waits for the cells alone that it touches, and threads share cells (level_cover_shared.cpp).
 */
class LevelCover {
 public:
  LevelCover(const PointStore& store, const FitPlan& plan, int threads);

  /** \brief Covers a range of the points only: other points are part of its balls, but are no
   * centres and are not counted. */
  LevelCover(const PointStore& store, const FitPlan& plan, int threads, PointRange core);

  /** \brief Runs levels from first_level until no point is left. */
  Error run(int first_level, Progress* progress);

  /** \brief Surfels that are contiguous in memory. */
  struct Piece {
    const SurfelRecord *begin, *end;
    std::size_t first;  ///< place of the first in the whole sequence
  };

  /** \brief All surfels: by level, in the Morton order of cells within each. */
  std::vector<Piece> pieces() const;

  int firstLevel() const { return first_level_; }
  int lastLevel() const { return last_level_; }
  PointCounts countPoints() const;
  BallCounters counters() const;
  std::uint64_t peakBytes() const { return peak_bytes_; }

 private:
  /** Surfels of one cell, in its thread's arena. */
  struct Output {
    int thread = 0;
    std::uint32_t begin = 0, end = 0;
    bool lasts = false;  ///< whether some points are done beyond this level
    std::uint32_t unresolved = 0;
  };
  /** A thread's own data, in cache lines of their own. */
  struct alignas(64) Worker {
    Worker(const PointStore& store, const FitPlan& plan) : fitter(store, plan) {}
    BallFitter fitter;
    std::vector<SurfelRecord> arena;
  };
  class Sharing;

  void coverLevel(int level);
  void shareCells(int level, std::size_t first_output);
  CellVisits visitsOf(const CoverCells::Cell& cell) const;
  void coverCell(const CoverCells::Cell& cell, int level, int thread, Output& output);
  Worker& worker(int thread) const { return *workers_[static_cast<std::size_t>(thread)]; }
  std::uint32_t giveUp(std::uint32_t point, NearbyBlocks& nearby);
  void keep(std::uint32_t point, BallOutcome outcome, const SurfelRecord& surfel,
            NearbyBlocks& nearby, std::vector<SurfelRecord>& surfels, Output& output);
  void collectNearby(const CoverCells::Cell& cell, int level, NearbyBlocks& nearby) const;
  void countBytes();
  template <typename Body>
  void forSlices(std::size_t count, const Body& body) const;
  void endLevel(std::size_t first_output);
  void dropDone();
  bool isDone(std::uint32_t point) const {
    return coverage_[point] >= plan_.gamma || (marks_[point] & done_marks_) != 0;
  }

  const PointStore& store_;
  const FitPlan& plan_;
  int threads_;
  PointRange core_;
  std::vector<std::unique_ptr<Worker>> workers_;  ///< one per thread
  AlignedVector<float> coverage_;
  AlignedVector<std::uint8_t> marks_;     ///< done for good, or at a level
  AlignedVector<std::uint32_t> active_;   ///< points not yet covered, ascending
  CoverCells cells_;                      ///< of active_, at this level
  std::vector<Output> outputs_;           ///< of all levels so far
  std::uint8_t level_mark_, done_marks_;  ///< mark of this level, and all that count at it
  int first_level_ = 1, last_level_ = 0;
  std::uint64_t unresolved_ = 0;  ///< points left when levels became too fine
  std::uint64_t peak_bytes_ = 0;
};

}  // namespace pcl_slim::detail
