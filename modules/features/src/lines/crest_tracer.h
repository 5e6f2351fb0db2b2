// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lines/crest_field.h"
#include "lines/crest_seeds.h"
#include "lines/crest_stepper.h"
#include "lines/place_grid.h"

namespace pcl_slim::detail {

/** A line as traced, before anything is left out. */
struct TracedLine {
  std::vector<CrestVertex> vertices;
  bool closed = false;
};

/** Follows the lines of one type from its seeds. */
class CrestTracer {
 public:
  /** \param[in] sigma the noise's deviation, at least the store's precision, local units;
   * mean_radius of the leaves. */
  CrestTracer(const ProbeIndex& index, CrestType type, const CrestParams& params, double sigma,
              bool analytic, double mean_radius);

  /** Traces the line through a seed, unless one is there already or noise explains it. */
  void follow(const CrestSeed& seed);

  const std::vector<TracedLine>& lines() const { return lines_; }
  /** Seeds, ends and requests so far. */
  CrestStatistics statistics() const;

 private:
  enum class End { kGoesOn, kClosed, kJoined, kLost, kFaded };

  bool refuse(const CrestSeed& seed, std::uint64_t& counter);
  double reachOf(double radius) const;
  bool begin(const CrestSeed& seed, const ProbeScale& scale, CrestVertex& first);
  End walk(std::vector<CrestVertex>& line, bool forward);
  End advance(std::vector<CrestVertex>& line, std::int64_t number);
  bool faded(std::vector<CrestVertex>& line, std::size_t begin);
  void measure(std::vector<CrestVertex>& line, std::size_t begin, std::size_t end);
  void count(End end);
  void keep(std::vector<CrestVertex> forward, const std::vector<CrestVertex>& backward,
            bool closed);

  CrestParams params_;
  CrestField field_;
  CrestStepper stepper_;
  double sigma_, mean_radius_;
  double seed_radius_ = 0;  ///< of the leaves at the seed being followed
  PlaceGrid traced_;        ///< vertices of all lines so far, numbered in order
  PlaceGrid refused_;       ///< seeds that were looked at in vain
  PlaceGrid own_;           ///< vertices of the line being traced, numbered from kMiddle both ways
  std::vector<CrestVertex> vertices_;
  std::vector<TracedLine> lines_;
  CrestStatistics statistics_;
};

}  // namespace pcl_slim::detail
