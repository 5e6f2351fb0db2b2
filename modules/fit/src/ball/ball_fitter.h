// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "fit_settings.h"
#include "pcl_slim/cloud/point_store.h"
#include "radius/radius_search.h"

namespace pcl_slim::detail {

/** \brief A surfel as the cover makes it; the columns of SLIMSurface are filled at the end. */
struct SurfelRecord {
  std::array<float, 3> center, normal;
  float radius, error, confidence;
  std::uint8_t degree, level, flags;
  std::array<float, kMaxCoefficients> c;
};

/** \brief How far a ball may move onto its fit, in units of r_r; the cover's cells allow for it. */
constexpr double kLargestShift = 0.3;

/** \brief What became of a centre. */
enum class BallOutcome : unsigned char { kLeaf, kInternal, kUnsupported, kLoneNormal };

/** \brief Counters of one thread; they add up in any order. */
struct BallCounters {
  std::uint64_t gathered = 0, split_sheets = 0, tried = 0;
};

/** \brief Makes the surfel of one centre: gather, frame, radius, polynomial. One per thread. */
class BallFitter {
 public:
  BallFitter(const PointStore& store, const FitSettings& settings)
      : store_(store), settings_(settings), search_(settings)
  {
  }

  /** \brief The blocks near the region whose centres come next. */
  BlockNeighborhood& neighborhood() { return neighborhood_; }

  /** \brief Fits the ball of stored point i at level k. \param[out] surfel of a leaf or internal
   * node. */
  BallOutcome fit(std::size_t i, int level, SurfelRecord& surfel);

  /** \brief Adds a leaf to the coverage of the points it serves. */
  void cover(const SurfelRecord& surfel, float* coverage);

  /** \brief Marks the points of an internal ball as served at this level. */
  void mark(const SurfelRecord& surfel, std::uint8_t value, std::uint8_t* marks);

  const BallCounters& counters() const { return counters_; }
  std::uint64_t numFits() const { return search_.numFits(); }

 private:
  BallOutcome prepare(double radius, std::size_t stride);
  bool tooWideAtAGlance(double radius, int level, SurfelRecord& surfel);
  bool normalIsAlone() const;
  const BlockList& blocksWithin(const std::array<float, 3>& center, double radius);
  bool gather(double radius);
  std::array<double, 3> frameNormal() const;
  bool splitSheets();
  void reframe();
  void centerOnSurface();
  void setFrame();
  void record(const RadiusChoice& choice, int level, SurfelRecord& surfel) const;

  const PointStore& store_;
  const FitSettings& settings_;
  RadiusSearch search_;
  BlockNeighborhood neighborhood_;
  BlockList blocks_, sampled_;
  std::array<float, 3> listed_center_{};
  float listed_radius_ = -1.0f;  ///< blocks_ are those of such a ball; < 0: of none
  BallBuffer ball_, kept_;
  BallSums sums_;
  std::array<float, 3> center_{}, gate_{}, normal_{};
  double gather_radius_ = 0;
  double noise_ = 0;        ///< variance of the points about the surface, local units; 0: not known
  std::size_t stride_ = 1;  ///< one of so many blocks is gathered
  std::vector<float> residuals_;
  BallCounters counters_;
};

}  // namespace pcl_slim::detail
