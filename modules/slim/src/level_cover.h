// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "ball_fitter.h"
#include "pcl_slim/core/progress.h"

namespace pcl_slim {

/** \brief Covers the points level by level (section 2, "Multi-scale surfel-based approximation").
 *
 * Within a level the centres of one Morton cell are tried one after another, cells of one of
 * eight colours at the same time: cells are at least twice as wide as a ball reaches, so no two
 * threads touch the same point and the result does not depend on their number.
 */
class LevelCover {
 public:
  LevelCover(const PointStore& store, const FitSettings& settings, int threads);

  /** \brief Runs levels from first_level until no point is left; surfels come in Morton order
   * within each level. */
  Error run(int first_level, Progress* progress, std::vector<SurfelRecord>& surfels);

  const std::vector<float>& coverage() const { return coverage_; }
  int lastLevel() const { return last_level_; }
  std::uint64_t numLoneNormals() const { return lone_normals_; }
  BallCounters counters() const;
  std::uint64_t numFits() const;
  std::uint64_t peakBytes() const { return peak_bytes_; }

 private:
  struct Cell {
    std::uint32_t begin, end;  ///< range of active_
    std::uint64_t code;
  };
  /** Surfels of one cell, in its thread's arena. */
  struct Output {
    int thread = 0;
    std::uint32_t begin = 0, end = 0;
  };

  void coverLevel(int level, std::vector<SurfelRecord>& surfels);
  void findCells(int level);
  void coverCell(const Cell& cell, int level, int thread, Output& output);
  void prepareNeighborhood(const Cell& cell, int level, BallFitter& fitter);
  void dropServed();

  const PointStore& store_;
  const FitSettings& settings_;
  int threads_;
  std::vector<std::unique_ptr<BallFitter>> fitters_;
  std::vector<std::vector<SurfelRecord>> arenas_;
  std::vector<float> coverage_;
  std::vector<std::uint8_t> marks_;    ///< served at this level, or for good
  std::vector<std::uint32_t> active_;  ///< points not yet covered, ascending
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> color_order_;
  std::array<std::size_t, 9> color_begin_{};
  int last_level_ = 0;
  std::uint64_t lone_normals_ = 0, peak_bytes_ = 0;
};

}  // namespace pcl_slim
