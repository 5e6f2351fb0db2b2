// SPDX-License-Identifier: BSD-3-Clause
// Borders and holes of the data in the discs of surfels (docs/theory.md, "Borders").
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/surface/surface.h"
#include "scan/ball_kernels.h"
#include "trim/border_test.h"

namespace pcl_slim::detail {

struct FitPlan;

/** \brief A square of bits, row by row, each row in whole words: one operation handles many
 * columns. */
class BitRows {
 public:
  /** \brief Sets the size; every bit is 0 then. */
  void reset(int side) {
    side_ = side;
    words_ = static_cast<std::size_t>(side + 63) / 64;
    bits_.assign(words_ * static_cast<std::size_t>(side), 0);
  }

  int side() const { return side_; }
  std::size_t wordsPerRow() const { return words_; }
  std::size_t numWords() const { return bits_.size(); }
  std::uint64_t* row(int y) { return bits_.data() + static_cast<std::size_t>(y) * words_; }
  const std::uint64_t* row(int y) const {
    return bits_.data() + static_cast<std::size_t>(y) * words_;
  }

  void set(int x, int y) { row(y)[x >> 6] |= std::uint64_t{1} << (x & 63); }

  bool has(int x, int y) const { return (row(y)[x >> 6] >> (x & 63) & 1) != 0; }

  /** \brief The bits of a row's last word that are columns. */
  std::uint64_t inLastWord() const { return (std::uint64_t{2} << ((side_ - 1) & 63)) - 1; }

  /** \brief Sets the bits that others of the same side have. */
  void add(const BitRows& other) {
    for (std::size_t w = 0; w < bits_.size(); ++w) bits_[w] |= other.bits_[w];
  }

  /** \brief Sets columns first to last, both among the row's. */
  void setRun(int y, int first, int last) {
    std::uint64_t* words = row(y);
    if (first >> 6 == last >> 6) {
      words[first >> 6] |= (std::uint64_t{2} << (last & 63)) - (std::uint64_t{1} << (first & 63));
      return;
    }
    for (int w = first >> 6; w <= last >> 6; ++w) {
      const int low = first > 64 * w ? first - 64 * w : 0;
      const int high = last < 64 * w + 63 ? last - 64 * w : 63;
      words[w] |= (std::uint64_t{2} << high) - (std::uint64_t{1} << low);
    }
  }

  /** \brief Sets all columns but those from first to last; all if last < first. */
  void setAllBut(int y, int first, int last) {
    if (last < first) {
      setRun(y, 0, side_ - 1);
      return;
    }
    if (first > 0) setRun(y, 0, first - 1);
    if (last < side_ - 1) setRun(y, last + 1, side_ - 1);
  }

 private:
  int side_ = 0;
  std::size_t words_ = 0;
  std::vector<std::uint64_t> bits_;
};

/** \brief The part of a surfel's (u, v) plane that the gathering ball covers: where the surfel's
 * surface is inside that ball. A surface that bends leaves the ball before its rim. */
class KnownRegion {
 public:
  /** \param[in] c coefficients of the surfel \param[in] radius of the ball, in the surfel's radii
   */
  KnownRegion(int degree, const float* c, double radius);

  /** \brief Sets the bits of cells beyond. Cell (x, y) is at cell times (x - middle, y - middle).
   * O(rows).
   * Where the surface bends, the cells before are those connected to the middle. */
  void markBeyond(double cell, int middle, BitRows& rows) const;

  /** \brief Likewise as if the surface were flat: no cell more. O(rows), faster. */
  void markBeyondCircle(double cell, int middle, BitRows& rows) const;

 private:
  struct Run {
    int first, last;  ///< empty if last < first
  };

  Run circleRun(double v, double cell, double middle, int end) const;
  Run narrowed(Run circle, Run from, double cell, double middle, double v) const;

  int degree_;
  const float* c_;
  double radius_;
  double highest_;  ///< bound on |h| in the ball
};

/** \brief Points near a surfel's own surface, in its (u, v) plane and in units of its radius;
 * columns have room for whole vectors. */
struct SheetPoints {
  AlignedVector<float> u, v;
  AlignedVector<float> w;               ///< along the surfel's normal
  AlignedVector<std::uint32_t> index;   ///< of the stored points
  AlignedVector<std::uint32_t> sector;  ///< of spacingOf()
  std::size_t count = 0;

  void reserve(std::size_t capacity) {
    const std::size_t needed = capacity + BallBuffer::kPadding;
    if (u.size() < needed) {
      u.resize(needed + needed / 2);
      v.resize(needed + needed / 2);
      w.resize(needed + needed / 2);
      index.resize(needed + needed / 2);
      sector.resize(needed + needed / 2);
    }
  }

  /** \brief Fills up the last vector with points too far away to matter. */
  void pad() {
    constexpr float kFar = 1e9f;
    std::fill_n(u.begin() + static_cast<std::ptrdiff_t>(count), PointStore::kBlock, kFar);
    std::fill_n(v.begin() + static_cast<std::ptrdiff_t>(count), PointStore::kBlock, kFar);
  }
};

/** \brief Mean spacing of points in the unit disc, in units of its radius: the root of the area
 * that one point has. The area reaches, in each of 16 sectors (or 8 or 4, where points are few), as
 * far as the farthest point of the sector.
 * \return 0 where points have no area. O(points). */
double spacingOf(SheetPoints& points);

/** \brief Collects, of the stored points that a surfel covers, the middle one of every block: a
 * sample for surfels of many points. O(blocks). */
void sampleSheet(const PointStore& store, const BlockList& blocks, const kernels::CoverLeaf& surfel,
                 SheetPoints& points);

namespace kernels {

/** \brief Collects the stored points that a surfel covers: in its ball, within the normal bound and
 * at most max_residual from f = 0. */
void gatherSheet(const PointStore& store, const BlockList& blocks, const CoverLeaf& surfel,
                 SheetPoints& points);

constexpr std::uint32_t kSheetSectors = 16;

/** \brief Finds which of 16 equal sectors contains each point; halves of them differ in the highest
 * bit. Points outside of the unit disc get kSheetSectors. */
void findSectors(SheetPoints& points);

/** \brief Squared distance of the point next to a place of the plane. */
float nearestSq(const SheetPoints& points, float u, float v);

}  // namespace kernels

/** \brief Borders and holes (docs/theory.md, "Borders"). Lengths are in spacings of a surfel's
 * points unless brackets give another unit. */
struct TrimConstants {
  double known = 1.15;         ///< [r] points are gathered within
  double gate = 0.25;          ///< [r] points farther from the surfel are no points of it, ...
  double growth = 0.3;         ///< a sample owns this much beyond itself, plus half a cell
  double cell = 0.5;           ///< width of a raster's cells
  double clear = 0.3;          ///< depth inside data from which on a place is clear of any border
  double looked_at = 0.9;      ///< [r] borders beyond do not open a surfel: its weight is next to 0
  int internal_side = 9;       ///< nodes a side of internal surfels' maps, which are drawn small
  std::size_t sampled = 1024;  ///< points of an internal ball from which on samples of them do
  std::size_t enough_rims = 512;  ///< points next to gaps of which at least as many are tested
};

inline constexpr TrimConstants kTrim;

/** \brief What a raster measures by, in units of the surfel's radius. */
struct TrimScale {
  double spacing;  ///< of the surfel's points
  double hole;     ///< diameter of the smallest hole kept
  double growth;   ///< how far the surface extends beyond its outermost points
};

/** \brief The depth of places of a surfel's disc inside its data, on a raster.
 *
 * The points' region is closed by discs of the smallest hole's diameter, then grown: with R the
 * discs' radius, a place nearer than R to a point is covered, D is a covered place's distance to
 * what is not, and its depth D - (R - growth). Depths are smoothed. Integers throughout; one per
 * thread: it keeps its memory.
 */
class TrimRaster {
 public:
  static constexpr int kDepthUnit = 64;  ///< depth of one cell

  /** \brief Lists the places of a region that are not covered, in units of the surfel's radius.
   * O(points + cells / 64) where there are none. */
  void findGaps(const SheetPoints& points, const KnownRegion& sure, const TrimScale& scale,
                std::vector<std::array<double, 2>>& places);

  /** \brief Lists the points at the rims of places that findGaps() found. O(points + places). */
  void findRims(const SheetPoints& points, const std::vector<std::array<double, 2>>& places,
                std::vector<std::uint32_t>& rims);

  /** \brief Measures the depths, after findGaps() of the same points. What is not known counts as
   * covered. O(points + cells). */
  void measureDepths(const SheetPoints& points, const KnownRegion& known);

  /** \brief The least depth within a share of the radius, in cells / 64. */
  int leastDepth(double share) const;

  /** \brief Width of a cell in units of the surfel's radius. */
  double cell() const { return cell_; }

  /** \brief Sets those bits of a map of side x side nodes, all 0 before, that are inside. */
  void fillMap(int side, std::uint8_t* bits) const;

 private:
  void setScale(const TrimScale& scale);
  void markEmpty(const SheetPoints& points);
  void markEmptyDiscs(const SheetPoints& points);
  void markNear(const BitRows& cells, int reach);
  void markNearGaps(int reach);
  void coverGaps(const SheetPoints& points);
  void dropCovered(const SheetPoints& points, std::vector<std::array<double, 2>>& places) const;
  void cutDisc(double reach);
  void coverDisc(int x, int y);
  bool hasGap() const;
  void listGaps(std::vector<std::array<double, 2>>& places) const;
  void findRowDistances(int cap);
  bool findDistances(int y, int cap, std::int16_t* distance_sq) const;
  void spreadDistances(int cap);
  void findDepths(int cap, double offset);
  void smoothRows();
  void smoothColumns();
  int depthAt(int x_fixed, int y_fixed) const;

  double cell_ = 0.0;
  double reach_ = 0.0, growth_ = 0.0;  ///< radius of the discs and TrimScale's growth, in cells
  int half_ = 0, side_ = 0;            ///< cells from the middle, and in all
  bool all_covered_ = false;           ///< not only those of findGaps()'s region
  BitRows filled_;                     ///< cells whose disc covers a whole cell with points
  BitRows covered_, unsure_, near_gaps_, scratch_bits_;
  std::vector<BitRows>
      eroded_;  ///< [k]: cells that are empty with k neighbours on either side in the row
  std::vector<int> run_halves_;            ///< of a disc's rows
  int disc_rows_ = 0;                      ///< of these, on either side of the middle's
  std::vector<std::size_t> whole_halves_;  ///< likewise of the cells that it contains whole
  std::vector<std::uint8_t> row_has_gap_;
  int stride_ = 0;  ///< of the rows below: whole vectors
  std::vector<std::int16_t> row_distance_sq_, distance_sq_, depth_, scratch_, depth_of_sq_;
};

/** \brief Gives the surfels that data do not fill their trim maps (docs/theory.md, "Borders"), if
 * the parameters ask for them and not for the paper's choices.
 *
 * Every surfel's ball is gathered once more, and searched for gaps; those that may have one are
 * measured. Internal surfels, which level of detail draws small, get coarse maps. Surfels in
 * parallel; the same bytes for any number of threads.
 * \return the number of surfels whose gaps were measured
 */
std::uint64_t makeTrimMaps(const PointStore& store, const FitPlan& plan, const FitParams& params,
                           int threads, SLIMSurface& surface);

}  // namespace pcl_slim::detail
