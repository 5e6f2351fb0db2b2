// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/splat_kernels.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/symmetric.h"
#include "pcl_slim/splat/octree_cloud.h"

namespace pcl_slim::detail {

/** Where points come from. */
struct OctreeSource {
  const CloudView& cloud;
  const ColorView& colors;
  const LabTable& table;
};

/** A stretch of a cloud's points along its curve, brought together in memory as columns; points are
 * named by their places in the whole cloud. Windows of two threads share no cache line. */
class alignas(64) PointWindow {
 public:
  enum Column { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kL, kA, kB, kNumColumns };

  /** Fetches the points [begin, end): positions in root cells from the grid's low corner; normals
   * of unit length, or zero where a point has none; CIELAB, or zero where the cloud has none. */
  void load(const OctreeCloud& cloud, const OctreeSource& source, std::size_t begin,
            std::size_t end);
  /** The same with up to reach points more on either side. */
  void loadAround(const OctreeCloud& cloud, const OctreeSource& source, std::size_t begin,
                  std::size_t end, std::size_t reach);

  std::size_t begin() const { return begin_; }
  std::size_t end() const { return end_; }

  /** One column from the i-th point of the cloud on. */
  const float* column(int c, std::size_t i) const {
    return columns_[static_cast<std::size_t>(c)].data() + (i - begin_);
  }
  /** Three columns of one point. */
  std::array<float, 3> vector(Column first, std::size_t i) const {
    return {*column(first, i), *column(first + 1, i), *column(first + 2, i)};
  }
  std::array<float, 3> position(std::size_t i) const { return vector(kX, i); }
  std::array<float, 3> normal(std::size_t i) const { return vector(kNormalX, i); }
  std::array<float, 3> lab(std::size_t i) const { return vector(kL, i); }
  /** The i of CloudView::inputIndex(i). */
  std::uint32_t order(std::size_t i) const { return order_[i - begin_]; }

 private:
  /** Fills order_. \return places in the caller's arrays. */
  const std::uint32_t* fetchOrder(const OctreeCloud& cloud, const OctreeSource& source);

  std::array<AlignedVector<float>, kNumColumns> columns_;
  AlignedVector<std::uint32_t> order_, inputs_;  ///< inputs: places in the caller's arrays
  std::size_t begin_ = 0, end_ = 0;
};

/** m m. */
inline Symmetric3<double> squared(const Symmetric3<double>& m) {
  const auto [a, b, c, d, e, f] = m;
  return {a * a + b * b + c * c, a * b + b * d + c * e, a * c + b * e + c * f,
          b * b + d * d + e * e, b * c + d * e + e * f, c * c + e * e + f * f};
}

/** The octree's sums over a cell's points: they add up over children. */
struct CellSums {
  double count = 0;
  double position[3] = {}, position_sq = 0;  ///< sum of p, of |p|^2
  double normal[3] = {};                     ///< sum of n
  Symmetric3<double> product{};              ///< sum of n n^T
  double lab[3] = {}, lab_sq = 0;            ///< sum of Lab, of |Lab|^2

  /** The points [begin, end) of a cloud. */
  void add(const PointWindow& window, std::size_t begin, std::size_t end);

  void add(const CellSums& other) {
    count += other.count;
    position_sq += other.position_sq;
    lab_sq += other.lab_sq;
    for (int a = 0; a < 3; ++a) {
      position[a] += other.position[a];
      normal[a] += other.normal[a];
      lab[a] += other.lab[a];
    }
    for (std::size_t k = 0; k < 6; ++k) product[k] += other.product[k];
  }

  /** Number of points that have a normal, up to rounding. */
  double normals() const { return product[kXX] + product[kYY] + product[kZZ]; }

  /** Squared standard deviation of the colour, in squared Delta E. */
  double colorVariance() const {
    const double mean_sq = (lab[0] * lab[0] + lab[1] * lab[1] + lab[2] * lab[2]) / count;
    return std::max(0.0, (lab_sq - mean_sq) / count);
  }

  /** 1 - |mean normal|^2: the squared deviation of normals that share one side. */
  double orientedVariance() const {
    const double total = normals();
    if (!(total > 0.0)) return 0.0;
    const double sq = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
    return std::max(0.0, 1.0 - sq / (total * total));
  }

  /** det(t I - sum n n^T), times the sign that makes it positive above the largest eigenvalue. */
  double characteristic(double t) const {
    const double a = t - product[kXX], b = t - product[kYY], c = t - product[kZZ];
    const double d = product[kXY], e = product[kXZ], f = product[kYZ];
    return a * (b * c - f * f) - d * (d * c + f * e) - e * (d * f + b * e);
  }

  /** Largest eigenvalue of sum n n^T: Newton's steps fall towards it from the eighth root of the
   * eighth powers' sum, which is close to it already where normals agree. */
  double largestEigenvalue() const {
    const double total = normals();
    Symmetric3<double> m;
    for (std::size_t k = 0; k < 6; ++k) m[k] = product[k] / total;
    m = squared(squared(m));
    const double eighth = m[kXX] * m[kXX] + m[kYY] * m[kYY] + m[kZZ] * m[kZZ] +
                          2.0 * (m[kXY] * m[kXY] + m[kXZ] * m[kXZ] + m[kYZ] * m[kYZ]);
    double t = total * std::sqrt(std::sqrt(std::sqrt(eighth))) * (1.0 + 1e-15);
    for (int step = 0; step < 40; ++step) {
      const double a = t - product[kXX], b = t - product[kYY], c = t - product[kZZ];
      const double slope = a * b + b * c + a * c - product[kXY] * product[kXY] -
                           product[kXZ] * product[kXZ] - product[kYZ] * product[kYZ];
      if (!(slope > 0.0)) break;
      const double next = t - characteristic(t) / slope;
      const bool still = !(next < t - 1e-10 * t);
      t = std::min(t, next);
      if (still) break;
    }
    return t;
  }

  /** 1 - largest eigenvalue of the mean of n n^T: the same deviation whatever the signs. */
  double unorientedVariance() const {
    const double total = normals();
    return total > 0.0 ? std::max(0.0, 1.0 - largestEigenvalue() / total) : 0.0;
  }

  /** Whether unorientedVariance() > limit, without the eigenvalue where limit < 1/2: no other
   * eigenvalue is that large, so one value of the characteristic polynomial decides. */
  bool unorientedAbove(double limit) const {
    const double total = normals();
    if (limit >= 0.5) return unorientedVariance() > limit;
    return characteristic(total * (1.0 - limit)) > 1e-13 * total * total * total;
  }

  /** Mean distance between neighbours if the points spread evenly over a disc. */
  double spacing() const {
    const double mean_sq =
        (position[0] * position[0] + position[1] * position[1] + position[2] * position[2]) / count;
    const double trace = std::max(0.0, (position_sq - mean_sq) / count);
    return std::sqrt(2.0 * M_PI * trace / count);
  }
};

inline CellSums sumsOf(const PointWindow& window, std::size_t begin, std::size_t end) {
  const float* columns[PointWindow::kNumColumns];
  for (int c = 0; c < PointWindow::kNumColumns; ++c) columns[c] = window.column(c, begin);
  double s[splat_kernels::kNumSums];
  splat_kernels::sumPoints(columns, end - begin, s);
  return {static_cast<double>(end - begin),        {s[0], s[1], s[2]},    s[3], {s[4], s[5], s[6]},
          {s[7], s[8], s[9], s[10], s[11], s[12]}, {s[13], s[14], s[15]}, s[16]};
}

static_assert(sizeof(CellSums) == splat_kernels::kCellNumbers * sizeof(double));

inline void CellSums::add(const PointWindow& window, std::size_t begin, std::size_t end) {
  add(sumsOf(window, begin, end));
}

/** Variances that a cell shows without any structure in it. */
struct SampleNoise {
  double color = 0;   ///< squared Delta E
  double normal = 0;  ///< squared deviation of unit normals, whatever their signs
};

/** When a cell of the octree is divided: a deviation above its tolerance by more than noise
 * explains. */
struct SplitRule {
  double geometric_error = 0.2;  ///< standard deviation of unit normals
  double color_error =
      10.0;               ///< standard deviation of CIELAB, Delta E; infinite: colour is ignored
  bool oriented = false;  ///< deviation of signed normals; false: of the lines along them
  SampleNoise noise;
  double noise_z = 2.0;                ///< noise counts as its variance times 1 + z / sqrt(n - 1)
  std::uint32_t min_points = 2;        ///< cells of fewer points stay whole
  int max_depth = OctreeCloud::kBits;  ///< halvings of a root cell at most
};

/** One cell: the points [begin, end) of the cloud. */
struct OctreeCell {
  std::uint32_t begin = 0, end = 0;
  float spacing = 0;       ///< mean distance between points around here, in root cells; 0: unknown
  std::int32_t shift = 0;  ///< its size, for OctreeCloud::edge
};

/** The target of an optimal cut; one of the two. */
struct CutBudget {
  std::uint64_t max_cells = 0;  ///< most cells; 0: no limit
  double target_error = 0;      ///< mean Delta E between points and their cells; 0: none
};

/** Some cells of one window. Batches of two threads share no cache line. */
struct alignas(64) CellBatch {
  std::vector<OctreeCell> cells;
  std::vector<CellSums> sums;  ///< over the points of each

  std::size_t size() const { return cells.size(); }

  void add(const OctreeCell& cell, const CellSums& of_points) {
    cells.push_back(cell);
    sums.push_back(of_points);
  }

  void clear() {
    cells.clear();
    sums.clear();
  }
};

constexpr std::size_t kSpacingPoints = 8;  ///< fewer points do not determine their density
constexpr std::size_t kSpacingReach = 32;  ///< points to look at on either side of a cell for more
constexpr std::size_t kRootSlice = 1 << 12;  ///< points per slice: their window fits into a cache

inline std::size_t numRootSlices(const OctreeCloud& cloud) {
  return (cloud.size() + kRootSlice - 1) / kRootSlice;
}

/** First root of a slice that no cell 2^growth roots wide shares with the slice before. */
inline std::size_t firstRoot(const OctreeCloud& cloud, std::size_t slice, int growth) {
  const std::size_t point = slice * kRootSlice, n = cloud.numRoots();
  if (point >= cloud.size()) return n;
  std::size_t r = cloud.rootOf(point);
  if (cloud.root(r).begin < point) ++r;
  while (r > 0 && r < n && (cloud.root(r).key ^ cloud.root(r - 1).key) >> 3 * growth == 0) ++r;
  return r;
}

/** Runs body(slice, thread, first, last) for the roots [first, last) of every slice; cells 2^growth
 * roots wide are in one slice each, and slices do not depend on threads. body may write to things
 * of its slice only. */
template <typename Body>
void forEachRootSlice(const OctreeCloud& cloud, int growth, int threads, const Body& body) {
  parallelFor(numRootSlices(cloud), threads, 1, [&](std::size_t slice, int thread) {
    const std::size_t first = firstRoot(cloud, slice, growth);
    const std::size_t last = firstRoot(cloud, slice + 1, growth);
    if (first < last) body(slice, static_cast<std::size_t>(thread), first, last);
  });
}

/** A cloud's keys, which give the runs of points that share a cell. */
struct RunKeys {
  const std::uint64_t* keys;

  std::uint64_t above(std::size_t i, int shift) const { return keys[i] >> 3 * shift; }

  /** End of the run that starts at begin and shares its cell of that size. */
  std::size_t runEnd(std::size_t begin, std::size_t end, int shift) const {
    const std::uint64_t cell = above(begin, shift);
    // Galloping: runs are short compared with the rest of the cloud.
    std::size_t step = 1, low = begin;
    while (low + step < end && above(low + step, shift) == cell) {
      low += step;
      step *= 2;
    }
    std::size_t high = std::min(end, low + step);
    while (low + 1 < high) {
      const std::size_t middle = low + (high - low) / 2;
      (above(middle, shift) == cell ? low : high) = middle;
    }
    return high;
  }

  /** The level at which a run falls apart; -1: at none that keys resolve. */
  int dividingShift(std::size_t begin, std::size_t end) const {
    std::uint64_t difference = keys[begin] ^ keys[end - 1];
    int shift = -1;
    for (; difference != 0; difference >>= 3) ++shift;
    return shift;
  }
};

/** A cut through the whole octree. */
struct OctreeCut {
  std::vector<OctreeCell> cells;
  double error = 0;         ///< mean Delta E between points and their cells, noise taken off
  std::uint64_t nodes = 0;  ///< cells of the whole tree
};

/** The cells that keep most of shape and colour for their number.
 *
 * Minimises sum D + lambda * cells over all cuts of the octree, D = points^(1/2) * d^(3/2) *
 * edge^(5/4) with d^2 = c / 100^2 + v / 20 + v^2 / 2, c the variance of colours and v that of
 * normals, and solves for lambda: as many cells as max_cells allows (within 1 %, where the cloud
 * has that many), or as few as meet target_error (else the finest cut). Roots are grown where
 * max_cells is below their number. The tolerances of rule are not used; its noise, least points and
 * depth are. O(N) time, 40 bytes a cell of the tree.
 */
OctreeCut cutOptimally(const OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule,
                       const CutBudget& budget, int threads);

}  // namespace pcl_slim::detail
