// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "ball/ball_gather.h"
#include "fit_plan.h"
#include "pcl_slim/cloud/point_store.h"
#include "radius/radius_search.h"

namespace pcl_slim::detail {

/** \brief A surfel as the cover makes it; the columns of SLIMSurface are filled at the end. */
struct SurfelRecord {
  std::array<float, 3> center, normal;
  float radius, error, effective_count;
  std::uint8_t degree, level, flags;
  bool sided;  ///< made of the points on its normal's side alone
  std::array<float, kMaxCoefficients> c;
};

/** \brief The surfel of a ball whose radius is chosen: its polynomial in units of that radius,
 * without what noise adds to it on average (docs/theory.md, "Bias"). */
SurfelRecord
recordOf(const FramedBall& ball, const RadiusChoice& choice, int level,
         const BiasConstants& constants);

/** \brief Moves a ball onto its own fit where noise has displaced its centre: it would contain a
 * lopsided part of the points (docs/theory.md, "Where the default departs from the paper"). It is
 * gathered and framed anew there. \param[in] stride of the blocks gathered \param[in,out] search
 * begun on the ball, and begun anew where it moves */
FramedBall
recentred(const FramedBall& ball, const FitPlan& plan, std::size_t stride, BallGatherer& gatherer,
          RadiusSearch& search);

/** \brief The interval of residuals that belongs to the centre's sheet. */
struct SheetRange {
  bool split = false;
  float low = 0, high = 0;
};

/** \brief Looks for two sheets in the residuals of one ball (docs/theory.md, "Sheets").
 *
 * Otsu's threshold on a histogram; two sheets only if the valley between the peaks is low, and the
 * means of the sides are apart compared with their thickness. \param[in] center_residual residual of the ball's
 * centre. O(count).
 */
SheetRange
findSheet(const float* residuals, std::size_t count, double center_residual,
          const SheetConstants& constants = {});

/** \brief Keeps the centre's sheet of balls with two sheets. One per thread: it keeps its memory. */
class SheetSplitter {
 public:
  /** \brief Where the residuals at r_r show two sheets, drops the other one's points and frames the
   * ball anew. \param[in,out] search begun on the ball, and begun anew on what is left of it. */
  FramedBall ownSheet(FramedBall ball, const SheetConstants& constants, RadiusSearch& search);

  /** \brief Balls whose sheets were separated so far. */
  std::uint64_t numSplit() const { return split_; }

 private:
  SheetRange sheetAt(const FramedBall& ball, const SheetConstants& constants, RadiusSearch& search);

  BallBuffer kept_;
  std::vector<float> residuals_;
  std::uint64_t split_ = 0;
};

/** \brief What became of a centre. */
enum class BallOutcome : unsigned char {
  kLeaf,
  kInternal,
  kLine,  ///< many points, but along a line: to be divided, and there is no surfel
  kUnsupported,
  kLoneNormal
};

/** \brief Counters of one thread; they add up in any order. */
struct BallCounters {
  std::uint64_t gathered = 0, split_sheets = 0, tried = 0, lines = 0;
  FitCounts fits;
};

/** \brief Makes the surfel of one centre (docs/theory.md, "One ball"). One per thread: it keeps the
 * scratch memory of its stages, each of which takes a value and returns the next one's. */
class BallFitter {
 public:
  BallFitter(const PointStore& store, const FitPlan& plan)
      : store_(store), plan_(plan), gatherer_(store, plan), search_(plan)
  {
  }

  /** \brief The blocks near the region whose centres come next. */
  NearbyBlocks& nearby() { return gatherer_.nearby(); }

  /** \brief Fits the ball of stored point i at level k. \param[out] surfel of a leaf or internal
   * node; of a line, the ball around it. */
  BallOutcome fit(std::size_t i, int level, SurfelRecord& surfel);

  BallCounters counters() const
  {
    return {gatherer_.numGathered(), splitter_.numSplit(), tried_, lines_, search_.counts()};
  }

 private:
  bool tooWideAtAGlance(const BallSite& site, int level, SurfelRecord& surfel);
  BallOutcome prepare(const BallSite& site, std::size_t stride, FramedBall& ball);
  FramedBall searchable(const FramedBall& ball, double rho_right);
  FramedBall ownSheet(const FramedBall& ball);
  FramedBall onItsFit(const FramedBall& ball, std::size_t stride);
  RadiusChoice chooseRadius(FramedBall& ball);
  BallOutcome widest(const FramedBall& ball, int level, SurfelRecord& surfel);
  BallOutcome withoutFit(const FramedBall& ball, const BallSite& site, const Trial& trial,
                         SurfelRecord& surfel);

  const PointStore& store_;
  const FitPlan& plan_;
  BallGatherer gatherer_;
  RadiusSearch search_;
  SheetSplitter splitter_;
  std::uint64_t tried_ = 0, lines_ = 0;
};

}  // namespace pcl_slim::detail
