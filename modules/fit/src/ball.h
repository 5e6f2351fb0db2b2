// SPDX-License-Identifier: BSD-3-Clause
// One ball (docs/theory.md, "One ball"): its points gathered, framed, parted from another sheet,
// moved onto their fit, and made a surfel.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "fit_plan.h"
#include "pcl_slim/cloud/point_store.h"
#include "radius/radius.h"
#include "scan/ball_kernels.h"

namespace pcl_slim::detail {

/** \brief The blocks near a cell, and those of them that meet the last requested ball. One per
 * thread: it keeps its memory. */
class NearbyBlocks {
 public:
  /** \brief Collects the blocks that meet a box; it contains the balls requested next. */
  void collect(const BlockTree& tree, const float low[3], const float high[3]) {
    neighborhood_.collect(tree, low, high);
    listed_radius_ = -1.0f;
  }

  /** \brief The blocks that meet a ball, ascending; valid until the next call. */
  const BlockList& within(const std::array<float, 3>& center, double radius) {
    const auto r = static_cast<float>(radius);
    if (r != listed_radius_ || center != listed_center_) {
      neighborhood_.blocksInBall(center.data(), r, blocks_);
      listed_center_ = center;
      listed_radius_ = r;
    }
    return blocks_;
  }

 private:
  BlockNeighborhood neighborhood_;
  BlockList blocks_;
  std::array<float, 3> listed_center_{};
  float listed_radius_ = -1.0f;  ///< blocks_ are those of a ball of this radius; < 0: of none
};

/** \brief The place of a ball, before any point is read. Local units. */
struct BallSite {
  std::array<float, 3> center{};  ///< on the grid of centres
  std::array<float, 3> normal{};  ///< of the point there: what the normal bound compares with ...
  bool sided = false;             ///< ... if it has one
  double radius = 0;              ///< of the gather
  double lambda = 0;              ///< noise variance that E(r) reckons with
  double noise = 0;  ///< variance of the points about the surface, in space; 0: not known
};

/** \brief The points about a site: offsets from its centre, in scratch memory of the thread. */
struct GatheredBall {
  BallSite site;
  BallSums sums;
  BallBuffer* points = nullptr;

  bool empty() const { return points->count == 0 || !(sums.weight > 0); }
};

/** \brief The site of stored point i for balls of a radius. */
BallSite siteOf(const PointStore& store, const FitPlan& plan, std::size_t i, double radius);

/** \brief Gathers balls of one store. One per thread: it keeps its scratch memory, so a gathered
 * ball lasts until the next. */
class BallGatherer {
 public:
  BallGatherer(const PointStore& store, const FitPlan& plan) : store_(store), plan_(plan) {}

  NearbyBlocks& nearby() { return nearby_; }

  /** \brief How many blocks a site's ball meets. */
  std::size_t countBlocks(const BallSite& site) {
    return nearby_.within(site.center, site.radius).size();
  }

  /** \brief Gathers the points of every stride-th block. */
  GatheredBall gather(const BallSite& site, std::size_t stride = 1);

  /** \brief Points gathered so far. */
  std::uint64_t numGathered() const { return gathered_; }

 private:
  const PointStore& store_;
  const FitPlan& plan_;
  NearbyBlocks nearby_;
  BlockList sampled_;
  BallBuffer points_;
  std::uint64_t gathered_ = 0;
};

/** \brief Whether the ball's points turn elsewhere than its centre: too few share its side, or
 * those that do are the ball's rim, bent away from it (docs/theory.md, "Lone normals"). */
bool normalIsAlone(const GatheredBall& ball, const FitPlan& plan);

/** \brief A gathered ball in the frame of its normal n_c: its points are frame coordinates in units
 * of the site's radius. */
struct FramedBall {
  BallSite site;
  std::array<float, 3> normal{};  ///< n_c, as a surfel stores it
  BallBuffer* points = nullptr;

  LocalFrame frame() const { return LocalFrame({normal[0], normal[1], normal[2]}); }
};

/** \brief Frames a ball by the mean normal of its points, or where none are given by the direction
 * of their least weighted spread. */
FramedBall framed(const GatheredBall& ball, const FitPlan& plan);

/** \brief A surfel as the cover makes it; the columns of SLIMSurface are filled at the end. */
struct SurfelRecord {
  std::array<float, 3> center, normal;
  float radius, error, effective_count;
  std::uint8_t degree, level, flags;
  bool sided;  ///< made of the points on its normal's side alone
  std::array<float, kMaxCoefficients> c;
};

/** \brief Moves a ball onto its own fit where noise has displaced its centre: it would contain a
 * lopsided part of the points (docs/theory.md, "Where the default departs from the paper"). It is
 * gathered and framed anew there. \param[in] stride of the blocks gathered \param[in,out] search
 * begun on the ball, and begun anew where it moves */
FramedBall recentred(const FramedBall& ball, const FitPlan& plan, std::size_t stride,
                     BallGatherer& gatherer, RadiusSearch& search);

struct SheetRange;

/** \brief Keeps the centre's sheet of balls with two sheets. One per thread: it keeps its memory.
 */
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
      : store_(store), plan_(plan), gatherer_(store, plan), search_(plan) {}

  /** \brief The blocks near the region whose centres come next. */
  NearbyBlocks& nearby() { return gatherer_.nearby(); }

  /** \brief Fits the ball of stored point i at level k. \param[out] surfel of a leaf or internal
   * node; of a line, the ball around it. */
  BallOutcome fit(std::size_t i, int level, SurfelRecord& surfel);

  BallCounters counters() const {
    return {gatherer_.numGathered(), splitter_.numSplit(), tried_, lines_, search_.counts()};
  }

 private:
  bool tooWideAtAGlance(const BallSite& site, int level, SurfelRecord& surfel);
  BallOutcome prepare(const BallSite& site, std::size_t stride, FramedBall& ball);
  FramedBall searchable(const FramedBall& ball, double rho_right);
  FramedBall ownSheet(const FramedBall& ball);
  FramedBall onItsFit(const FramedBall& ball, std::size_t stride);
  RadiusChoice chooseRadius(FramedBall& ball);
  bool missesItsCenter(const RadiusChoice& choice) const;
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
