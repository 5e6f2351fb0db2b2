// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fit_settings.h"
#include "gaps/gap_evidence.h"
#include "pcl_slim/cloud/point_store.h"
#include "trim/gap_search.h"
#include "trim/sheet_points.h"
#include "trim/trim_raster.h"

namespace pcl_slim::detail {

/** \brief Finds the gaps of one surface's surfels and makes their trim maps, one after another. One per
 * thread: it keeps its memory. */
class TrimMaker {
 public:
  TrimMaker(const PointStore& store, const FitSettings& settings, double hole_size,
            const SLIMSurface& surface)
      : store_(store),
        settings_(settings),
        hole_size_(hole_size),
        surface_(surface),
        evidence_(settings.constants.trim, store.size())
  {
  }

  /** \brief The gaps of a leaf, none of them real. O(points of the ball)
   * \param[in] with_folds also where the sheet turns away from the plane */
  LeafGaps findGaps(std::size_t i, bool with_folds);

  /** \brief Whether the leaf last searched may have gaps at all. */
  bool mayHaveGaps() const { return may_have_gaps_; }

  /** \brief The gaps of a leaf that chance does not explain. O(points around the ball)
   * \param[out] real appended to \return whether there is one */
  bool findReal(const LeafGaps& gaps, std::vector<std::uint32_t>& real);

  /** \brief Appends the bits of surfel i's map; nothing if it is closed. \param[in] gaps of a leaf: those
   * that are not real are closed; null: every gap counts. \return the map's side, 0 if it is closed.
   * O(points of the ball). */
  int make(std::size_t i, const LeafGaps* gaps, std::vector<std::uint8_t>& bits);

 private:
  kernels::SheetQuery wideSurfel(std::size_t i, const std::array<float, 3>& normal) const;
  void gather(std::size_t i);
  void gatherWidely(std::size_t i, double view);
  void fillUnreal(const LeafGaps& gaps);
  KnownRegion knownOf(std::size_t i, double radius) const
  {
    return {surface_.degree[i], surface_.coefficientsOf(i), radius};
  }
  SheetHeight sheetOf(std::size_t i) const
  {
    return {surface_.degree[i], surface_.coefficientsOf(i)};
  }

  const PointStore& store_;
  const FitSettings& settings_;
  double hole_size_;
  const SLIMSurface& surface_;
  std::vector<std::uint32_t> found_;  ///< blocks of the ball ...
  BlockList blocks_;                  ///< ... as kernels want them
  SheetPoints points_, seen_;
  double spacing_ = 0.0;  ///< of points_, radii of the surfel
  bool may_have_gaps_ = false;
  GapSearch search_;
  GapEvidence evidence_;
  std::vector<LeafGaps::Place> places_;
  TrimRaster raster_;
};

}  // namespace pcl_slim::detail
