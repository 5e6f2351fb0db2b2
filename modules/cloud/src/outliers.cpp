// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/outliers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "noise/patch.h"
#include "pcl_slim/cloud/detail/block_kernels.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

using namespace detail;

namespace {

/** \brief The neighbours of one point at a time, and the tests for outliers on them. */
class Neighborhood {
 public:
  explicit Neighborhood(const PointStore& store) : store_(store), search_(store) {}

  /** \brief Finds the nearest other points of a stored point, nearest first.
   * \param[in] left_out one byte for each stored point, 1: not to be found; null: none is left out
   * \param[in] among number of nearest points from which they are taken
   * \return the number of points found */
  std::size_t find(std::size_t point, std::size_t count, const unsigned char* left_out,
                   std::size_t among);

  /** \brief Whether a stored point certainly has this number of others within a distance. Costs
   * much less than find(). \return false if rounding leaves a doubt */
  bool hasOthersWithin(double distance, std::size_t point, std::size_t count);

  /** \brief Distance of the n-th neighbour found, n >= 1; infinite if there are fewer. */
  double distance(std::size_t n) const;

  /** \brief Whether the point and its neighbours fill a volume, unlike points of a surface or line.
   * \param[in] least_ratio of the least to the greatest eigenvalue of their covariance */
  bool fillsVolume(double least_ratio) const;

  /** \brief Whether most neighbours form a much denser patch, and the point is far from it and off
   * its plane or line.
   * \param[in] density_ratio the patch is dense if the median distance of its points to the nearest
   * is below the distance of the point's eighth neighbour over this
   * \param[in] spreads least distance from the mean of the patch [RMS distance of its points]
   * \param[in] off_share least distance from its plane or line [distance from its mean] */
  bool isApartFromPatch(double density_ratio, double spreads, double off_share) const;

  /** \brief Whether the point is far from its neighbours' plane.
   * \param[in] heights least distance from the plane [RMS distance of the neighbours]
   * \param[in] share least distance from the plane [distance from their mean, and that from the
   * eighth neighbour] */
  bool isOffPlane(double heights, double share) const;

 private:
  PatchPoints densePatch(double distance) const;

  const PointStore& store_;
  NeighborSearch search_;
  std::vector<std::uint32_t> found_;
  std::vector<std::uint32_t> blocks_;  ///< scratch of hasOthersWithin(), as the next two
  AlignedVector<float> within_sq_;
  AlignedVector<std::uint32_t> within_;
  std::vector<float> distances_sq_;
  PatchPoints others_;  ///< relative to the point
  std::vector<double> distances_;
};

/// The distance to this neighbour is the spacing around a point.
constexpr std::size_t kSpacingNeighbor = 8;
/// Factor of the last point's squared search radius that probably suffices for the next point.
constexpr float kRadiusMargin = 1.4f;
/// Largest ratio of the second to the greatest eigenvalue of points on a line.
constexpr double kLineRatio = 0.05;

Eigen::Vector3d meanOf(const PatchPoints& points) {
  return kernels::sumPatch(points).first / static_cast<double>(points.size());
}

std::size_t Neighborhood::find(std::size_t point, std::size_t count, const unsigned char* left_out,
                               std::size_t among) {
  // The next point's neighbours are about as far as the last one's.
  const float last = found_.size() == among + 1 ? kRadiusMargin * distances_sq_.back() : 0;
  search_.nearest(point, among + 1, found_, distances_sq_, last);
  others_.resize(count);
  distances_.clear();
  const auto center = store_.position(point);
  for (std::size_t j = 0; j < found_.size() && distances_.size() < count; ++j) {
    const std::size_t other = found_[j];
    if (other == point || (left_out != nullptr && left_out[other] != 0)) continue;
    const auto p = store_.position(other);
    others_.set(distances_.size(), {p[0] - center[0], p[1] - center[1], p[2] - center[2]});
    distances_.push_back(std::sqrt(static_cast<double>(distances_sq_[j])));
  }
  others_.cut(distances_.size());
  return distances_.size();
}

bool Neighborhood::hasOthersWithin(double distance, std::size_t point, std::size_t count) {
  constexpr double kRounding = 1e-5;
  const auto center = store_.position(point);
  const float c[3] = {static_cast<float>(center[0]), static_cast<float>(center[1]),
                      static_cast<float>(center[2])};
  const double sure = distance * (1 - kRounding);
  blocks_.clear();
  store_.tree().blocksInBall(c, static_cast<float>(distance), blocks_);
  const std::size_t most = (blocks_.size() + 1) * PointStore::kBlock;
  within_sq_.resize(most);
  within_.resize(most);
  return kernels::pointsUpTo(store_, blocks_.data(), blocks_.size(), center.data(),
                             static_cast<float>(sure * sure), within_sq_.data(),
                             within_.data()) > count;
}

double Neighborhood::distance(std::size_t n) const {
  return n <= distances_.size() ? distances_[n - 1] : std::numeric_limits<double>::infinity();
}

bool Neighborhood::fillsVolume(double least_ratio) const {
  PatchPoints all = others_;
  all.resize(others_.size() + 1);
  all.set(others_.size(), Eigen::Vector3d::Zero());
  const Eigen::Vector3d spread = principalAxes(all).eigenvalues();
  return spread[0] > least_ratio * spread[2];
}

/** The neighbours whose distance to the nearest is about the median of these distances.
 * \return empty if the median exceeds a given distance */
PatchPoints Neighborhood::densePatch(double distance) const {
  constexpr double kMostRatio = 3;  // of the distance to the nearest and its median
  const std::size_t n = others_.size();
  std::vector<double> nearest(n, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double between = (others_.at(i) - others_.at(j)).norm();
      nearest[i] = std::min(nearest[i], between);
      nearest[j] = std::min(nearest[j], between);
    }
  }
  const double middle = median(nearest);
  PatchPoints patch;
  if (!(middle <= distance)) return patch;
  patch.resize(n);
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (nearest[i] <= kMostRatio * middle) patch.set(count++, others_.at(i));
  }
  patch.cut(count);
  return patch;
}

bool Neighborhood::isApartFromPatch(double density_ratio, double spreads, double off_share) const {
  const PatchPoints patch = densePatch(distance(kSpacingNeighbor) / density_ratio);
  if (patch.size() < 3) return false;
  const Eigen::Vector3d mean = meanOf(patch);
  const auto axes = principalAxes(patch);
  const Eigen::Vector3d spread = axes.eigenvalues().cwiseMax(0.0);
  const double distance_sq = mean.squaredNorm();
  if (!(distance_sq > spreads * spreads * spread.sum())) return false;
  const double along = mean.dot(axes.eigenvectors().col(2)),
               across = mean.dot(axes.eigenvectors().col(0));
  const bool line = spread[1] < kLineRatio * spread[2];
  const double off_sq = line ? distance_sq - along * along : across * across;
  return off_sq > off_share * off_share * distance_sq;
}

bool Neighborhood::isOffPlane(double heights, double share) const {
  const Eigen::Vector3d mean = meanOf(others_);
  const auto axes = principalAxes(others_);
  const double height = std::abs(mean.dot(axes.eigenvectors().col(0)));
  const double own = std::sqrt(std::max(0.0, axes.eigenvalues()[0]));
  return height > heights * own && height > share * mean.norm() &&
         height > share * distance(kSpacingNeighbor);
}

constexpr std::size_t kBlock = PointStore::kBlock;
constexpr std::size_t kTask = 64;             ///< number of blocks that a thread takes at a time
constexpr std::size_t kLeastPoints = 100;     ///< fewer points have no meaningful density
constexpr std::size_t kSpacingSamples = 256;  ///< points whose median spacing is the cloud's

// Points far from all others (docs/theory.md, "Outliers", rules 1 to 3).
/// Least distance to the eighth neighbour of a point that may be such an outlier [spacings].
constexpr double kFarSpacings = 3.0;
constexpr std::size_t kFarNeighbors = 16;  ///< neighbours on which it is tested
/// Least ratio of the eigenvalues of points that fill a volume. Uniform volumes have .1 to .7.
constexpr double kVolumeRatio = 0.1;
/// Least ratio of spacings around the point and within a patch that it does not belong to.
constexpr double kDensityRatio = 4;
constexpr double kPatchDistance = 2.5;  ///< least distance from this patch [its RMS radius]
constexpr double kOffPlaneShare = 0.3;  ///< least distance from its plane [distance from its mean]

// Points off the surface, but near it, where many other points are outliers.
/// Least share of outliers in a window from which points near the surface are tested.
constexpr double kOutlierShare = 0.005;
constexpr std::size_t kWindowBlocks = 128;  ///< blocks of the window to either side along the curve
constexpr std::size_t kPlaneNeighbors = 24;  ///< inliers whose plane the point is compared with
/// Number of nearest points that must contain at least kSpacingNeighbor inliers.
constexpr std::size_t kPlaneCandidates = 63;
constexpr double kHeightRatio = 5.0;   ///< least height over this plane [RMS height of the inliers]
constexpr double kHeightShare = 0.25;  ///< least height over this plane [distance of the inliers]
constexpr int kMostRounds = 2;  ///< largest number of rounds: outliers hide others from the test
/// Share of new outliers below which no other round follows [points of the cloud].
constexpr double kNegligibleShare = 0.001;

/** One byte for each stored point; 1: it is an outlier. */
using Marks = std::vector<unsigned char>;

/** Tests points that are not marked yet, and marks those that the test accepts.
 * \param[in] candidates called with a block: bits of those of its points that are tested
 * \param[in] isOutlier called with the point, the marks before, and a Neighborhood
 * \return the number of points marked */
template <typename Candidates, typename Test>
std::size_t markOutliers(const PointStore& store, int threads, Marks& marks,
                         const Candidates& candidates, const Test& isOutlier) {
  const Marks before = marks;
  std::vector<Neighborhood> around(static_cast<std::size_t>(threads), Neighborhood(store));
  std::vector<std::size_t> marked(static_cast<std::size_t>(threads), 0);
  parallelFor(store.numBlocks(), threads, kTask, [&](std::size_t block, int thread) {
    std::uint32_t tested = candidates(block);
    for (; tested != 0; tested &= tested - 1) {
      const std::size_t i = block * kBlock + static_cast<std::size_t>(__builtin_ctz(tested));
      if (i >= store.size() || before[i] != 0) continue;
      const auto t = static_cast<std::size_t>(thread);
      if (!isOutlier(i, before, around[t])) continue;
      marks[i] = 1;
      ++marked[t];
    }
  });
  std::size_t sum = 0;
  for (const std::size_t count : marked) sum += count;
  return sum;
}

/** Those of a block's points that have fewer than kSpacingNeighbor others within a distance in it. */
auto sparseWithin(const PointStore& store, double distance) {
  const auto limit_sq = static_cast<float>(distance * distance);
  return [&store, limit_sq](std::size_t block) {
    return kernels::sparsePoints(store, block, limit_sq, kSpacingNeighbor);
  };
}

/** Marks points far from all others that belong to no sparse surface or line (rules 1 and 3). */
std::size_t markScattered(const PointStore& store, double spacing, int threads, Marks& marks) {
  const double far = kFarSpacings * spacing;
  return markOutliers(
      store, threads, marks, sparseWithin(store, far),
      [far](std::size_t i, const Marks&, Neighborhood& around) {
        if (around.hasOthersWithin(far, i, kSpacingNeighbor)) return false;
        around.find(i, kFarNeighbors, nullptr, kFarNeighbors);
        return around.distance(kSpacingNeighbor) >= far &&
               (around.fillsVolume(kVolumeRatio) ||
                around.isApartFromPatch(kDensityRatio, kPatchDistance, kOffPlaneShare));
      });
}

/** Marks points far from all others at least half of whose neighbours are outliers (rule 2). */
std::size_t markAmongOutliers(const PointStore& store, double spacing, int threads, Marks& marks) {
  const double far = kFarSpacings * spacing;
  return markOutliers(store, threads, marks, sparseWithin(store, far),
                      [far](std::size_t i, const Marks& known, Neighborhood& around) {
                        if (around.hasOthersWithin(far, i, kSpacingNeighbor)) return false;
                        around.find(i, kFarNeighbors, nullptr, kFarNeighbors);
                        if (around.distance(kSpacingNeighbor) < far) return false;
                        return around.find(i, kFarNeighbors, known.data(), kFarNeighbors) <=
                               kFarNeighbors / 2;
                      });
}

/** The blocks in whose window many points are outliers. */
std::vector<bool> blocksAmongOutliers(const PointStore& store, const Marks& marks) {
  const std::size_t blocks = store.numBlocks();
  std::vector<std::size_t> before(blocks + 1, 0);
  for (std::size_t i = 0; i < store.size(); ++i) before[i / kBlock + 1] += marks[i];
  for (std::size_t b = 0; b < blocks; ++b) before[b + 1] += before[b];
  std::vector<bool> among(blocks);
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t first = b - std::min(b, kWindowBlocks),
                      end = std::min(b + kWindowBlocks + 1, blocks);
    const auto points = static_cast<double>((end - first) * kBlock);
    among[b] = static_cast<double>(before[end] - before[first]) > kOutlierShare * points;
  }
  return among;
}

/** Marks points off the surface, but near it: those with few inliers around, and those off the
 * plane of these. */
std::size_t markNearSurface(const PointStore& store, int threads, Marks& marks) {
  const std::vector<bool> among = blocksAmongOutliers(store, marks);
  constexpr std::uint32_t kAll = (std::uint32_t{1} << kBlock) - 1;
  return markOutliers(
      store, threads, marks, [&among](std::size_t block) { return among[block] ? kAll : 0; },
      [](std::size_t i, const Marks& known, Neighborhood& around) {
        if (around.find(i, kPlaneNeighbors, known.data(), kPlaneNeighbors) < kPlaneNeighbors &&
            around.find(i, kPlaneNeighbors, known.data(), kPlaneCandidates) < kSpacingNeighbor)
          return true;
        return around.isOffPlane(kHeightRatio, kHeightShare);
      });
}

}  // namespace

double medianSpacing(const PointStore& store) {
  const std::size_t samples = std::min(kSpacingSamples, store.size());
  Neighborhood around(store);
  std::vector<double> spacings;
  for (std::size_t s = 0; s < samples; ++s) {
    around.find(s * store.size() / samples, kSpacingNeighbor, nullptr, kSpacingNeighbor);
    spacings.push_back(around.distance(kSpacingNeighbor));
  }
  return median(spacings);
}

std::vector<std::uint32_t> findOutliers(const PointStore& store, int threads, double spacing) {
  const std::size_t n = store.size();
  if (n < kLeastPoints) return {};
  threads = resolveThreads(threads);
  if (spacing <= 0) spacing = medianSpacing(store);
  Marks marks(n, 0);
  if (markScattered(store, spacing, threads, marks) == 0) return {};
  markAmongOutliers(store, spacing, threads, marks);
  for (int round = 0; round < kMostRounds; ++round) {
    const std::size_t marked = markNearSurface(store, threads, marks);
    if (static_cast<double>(marked) < kNegligibleShare * static_cast<double>(n)) break;
  }
  std::vector<std::uint32_t> outliers;
  for (std::size_t i = 0; i < n; ++i) {
    if (marks[i] != 0) outliers.push_back(static_cast<std::uint32_t>(i));
  }
  return outliers;
}

}  // namespace pcl_slim
