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

/** \brief The neighbours of one point after another, for decisions about outliers. */
class Neighborhood {
 public:
  explicit Neighborhood(const PointStore& store) : store_(store), search_(store) {}

  /** \brief Finds the nearest others of a stored point, nearest first.
   * \param[in] left_out one byte a stored point: those not to be taken; null: none.
   * \param[in] among how many neighbours are looked through for them. \return how many were found.
   */
  std::size_t find(std::size_t point, std::size_t count, const unsigned char* left_out,
                   std::size_t among);

  /** \brief Whether a stored point surely has this many others within a distance: much cheaper than
   * to find them. false where rounding leaves a doubt. */
  bool hasOthersWithin(double distance, std::size_t point, std::size_t count,
                       const unsigned char* left_out = nullptr);

  /** \brief Distance of the n-th other, n from 1 on; infinite where there are fewer. */
  double distance(std::size_t n) const;

  /** \brief Whether the point and its neighbours fill a volume, as those of no surface or line do:
   * least over greatest eigenvalue of their covariance. */
  bool fillsVolume(double least_ratio) const;

  /** \brief Whether most neighbours are a patch that is far denser than the point's surroundings,
   * and the point is outside of it, off its plane or line.
   * \param[in] closeness half of the neighbours have others within the eighth's distance over this.
   * \param[in] spreads least distance from the patch's mean, over its RMS distance from it.
   * \param[in] off least share of it that points away from plane or line. */
  bool standsApart(double closeness, double spreads, double off) const;

  /** \brief Whether the point is off its neighbours' plane: by more than this multiple of their own
   * RMS distance from it, and a given share of its distance from their mean and from the eighth. */
  bool standsOffPlane(double heights, double share) const;

 private:
  PatchPoints densePatch(double distance) const;

  const PointStore& store_;
  NeighborSearch search_;
  std::vector<std::uint32_t> found_;
  std::vector<std::uint32_t> blocks_;  ///< those of hasOthersWithin(), and what it finds in them
  AlignedVector<float> within_sq_;
  AlignedVector<std::uint32_t> within_;
  std::vector<float> distances_sq_;
  PatchPoints others_;  ///< relative to the point
  std::vector<double> distances_;
};

constexpr std::size_t kEighth = 8;
constexpr float kMargin = 1.4f;  ///< of a squared distance, for as many points
constexpr double kLine =
    0.05;  ///< second eigenvalue over the greatest, below which points are a line

Eigen::Vector3d meanOf(const PatchPoints& points) {
  return kernels::sumPatch(points).first / static_cast<double>(points.size());
}

std::size_t Neighborhood::find(std::size_t point, std::size_t count, const unsigned char* left_out,
                               std::size_t among) {
  // The next point's neighbours are about as far as the last one's.
  const float last = found_.size() == among + 1 ? kMargin * distances_sq_.back() : 0;
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

bool Neighborhood::hasOthersWithin(double distance, std::size_t point, std::size_t count,
                                   const unsigned char* left_out) {
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
  const std::size_t found =
      kernels::pointsUpTo(store_, blocks_.data(), blocks_.size(), center.data(),
                          static_cast<float>(sure * sure), within_sq_.data(), within_.data());
  if (left_out == nullptr) return found > count;
  const auto isOther = [&](std::uint32_t other) { return other != point && left_out[other] == 0; };
  const auto end = within_.begin() + static_cast<std::ptrdiff_t>(found);
  return static_cast<std::size_t>(std::count_if(within_.begin(), end, isOther)) >= count;
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

/** The neighbours that are as dense as their median; none if that is no closer to another than a
 * given distance. */
PatchPoints Neighborhood::densePatch(double distance) const {
  constexpr double kAlike = 3;  // times the median's distance to its nearest
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
    if (nearest[i] <= kAlike * middle) patch.set(count++, others_.at(i));
  }
  patch.cut(count);
  return patch;
}

bool Neighborhood::standsApart(double closeness, double spreads, double off) const {
  const PatchPoints patch = densePatch(distance(kEighth) / closeness);
  if (patch.size() < 3) return false;
  const Eigen::Vector3d mean = meanOf(patch);
  const auto axes = principalAxes(patch);
  const Eigen::Vector3d spread = axes.eigenvalues().cwiseMax(0.0);
  const double distance_sq = mean.squaredNorm();
  if (!(distance_sq > spreads * spreads * spread.sum())) return false;
  const double along = mean.dot(axes.eigenvectors().col(2)),
               across = mean.dot(axes.eigenvectors().col(0));
  const bool line = spread[1] < kLine * spread[2];
  const double off_sq = line ? distance_sq - along * along : across * across;
  return off_sq > off * off * distance_sq;
}

bool Neighborhood::standsOffPlane(double heights, double share) const {
  const Eigen::Vector3d mean = meanOf(others_);
  const auto axes = principalAxes(others_);
  const double height = std::abs(mean.dot(axes.eigenvectors().col(0)));
  const double own = std::sqrt(std::max(0.0, axes.eigenvalues()[0]));
  return height > heights * own && height > share * mean.norm() &&
         height > share * distance(kEighth);
}

constexpr std::size_t kBlock = PointStore::kBlock;
constexpr std::size_t kTask = 64;          ///< blocks a thread takes at a time
constexpr std::size_t kLeastPoints = 100;  ///< of a cloud whose density means something
constexpr std::size_t kNear = 8;           ///< neighbours that make a point's spacing
constexpr std::size_t kSample = 256;       ///< points whose spacing makes the cloud's
constexpr double kFar = 3.0;               ///< spacings, from which on a point is looked at
constexpr std::size_t kAround = 16;        ///< its neighbours that are looked at
constexpr double kVolume = 0.1;            ///< ratio of eigenvalues: uniform volumes have .1 to .7
constexpr double kCloseness =
    4;                          ///< a patch this many times denser than around a point is another's
constexpr double kApart = 2.5;  ///< RMS distances from the neighbours' mean
constexpr double kOff = 0.3;    ///< share of that distance off their plane
constexpr double kMany = 0.005;       ///< share of outliers that have others near the surface ...
constexpr std::size_t kWindow = 128;  ///< ... among these blocks before and after along the curve
constexpr double kClose = 1.5;        ///< spacings, from which on those are looked at
constexpr std::size_t kPlane = 24;    ///< neighbours whose plane they are off ...
constexpr std::size_t kAmong = 63;    ///< ... of this many nearest points
constexpr double kHeights = 4.0;      ///< times the neighbours' own RMS height
constexpr double kSteep = 0.25;       ///< share of their distance that is height
constexpr double kFew = 0.001;        ///< share of new outliers below which none hides another
constexpr int kRounds = 2;            ///< at most

/** One byte a stored point: 1 of an outlier. */
using Marks = std::vector<unsigned char>;

/** Runs a decision on all points that have fewer than kNear others within a distance, and marks
 * those of which it is true. \return how many were marked. */
template <typename Decision>
std::size_t markSparse(const PointStore& store, double distance, int threads, Marks& marks,
                       const Decision& decide, const std::vector<bool>* blocks = nullptr) {
  const auto limit_sq = static_cast<float>(distance * distance);
  const Marks before = marks;
  std::vector<Neighborhood> around(static_cast<std::size_t>(threads), Neighborhood(store));
  std::vector<std::size_t> marked(static_cast<std::size_t>(threads), 0);
  parallelFor(store.numBlocks(), threads, kTask, [&](std::size_t block, int thread) {
    if (blocks != nullptr && !(*blocks)[block]) return;
    std::uint32_t sparse = kernels::sparsePoints(store, block, limit_sq, kNear);
    for (; sparse != 0; sparse &= sparse - 1) {
      const std::size_t i = block * kBlock + static_cast<std::size_t>(__builtin_ctz(sparse));
      if (i >= store.size() || before[i] != 0) continue;
      const auto t = static_cast<std::size_t>(thread);
      if (!decide(i, before, around[t])) continue;
      marks[i] = 1;
      ++marked[t];
    }
  });
  std::size_t sum = 0;
  for (const std::size_t count : marked) sum += count;
  return sum;
}

/** Points far from all others, unless they belong to a sparse surface or line. */
std::size_t markScattered(const PointStore& store, double spacing, int threads, Marks& marks) {
  const double far = kFar * spacing;
  return markSparse(
      store, far, threads, marks, [far](std::size_t i, const Marks&, Neighborhood& around) {
        if (around.hasOthersWithin(far, i, kNear)) return false;
        around.find(i, kAround, nullptr, kAround);
        return around.distance(kNear) >= far &&
               (around.fillsVolume(kVolume) || around.standsApart(kCloseness, kApart, kOff));
      });
}

/** Points far from all others at least half of whose neighbours are outliers. */
std::size_t markCompany(const PointStore& store, double spacing, int threads, Marks& marks) {
  const double far = kFar * spacing;
  return markSparse(store, far, threads, marks,
                    [far](std::size_t i, const Marks& known, Neighborhood& around) {
                      if (around.hasOthersWithin(far, i, kNear)) return false;
                      around.find(i, kAround, nullptr, kAround);
                      if (around.distance(kNear) < far) return false;
                      return around.find(i, kAround, known.data(), kAround) <= kAround / 2;
                    });
}

/** The blocks around which many points are outliers. */
std::vector<bool> blocksAmongOutliers(const PointStore& store, const Marks& marks) {
  const std::size_t blocks = store.numBlocks();
  std::vector<std::size_t> before(blocks + 1, 0);
  for (std::size_t i = 0; i < store.size(); ++i) before[i / kBlock + 1] += marks[i];
  for (std::size_t b = 0; b < blocks; ++b) before[b + 1] += before[b];
  std::vector<bool> among(blocks);
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t first = b - std::min(b, kWindow), end = std::min(b + kWindow + 1, blocks);
    const auto points = static_cast<double>((end - first) * kBlock);
    among[b] = static_cast<double>(before[end] - before[first]) > kMany * points;
  }
  return among;
}

/** Points off the surface, but near it. */
std::size_t markNearSurface(const PointStore& store, double spacing, int threads, Marks& marks) {
  const std::vector<bool> among = blocksAmongOutliers(store, marks);
  const double close = kClose * spacing;
  return markSparse(
      store, close, threads, marks,
      [close](std::size_t i, const Marks& known, Neighborhood& around) {
        if (around.hasOthersWithin(close, i, kNear, known.data())) return false;
        if (around.find(i, kPlane, known.data(), kPlane) < kPlane &&
            around.find(i, kPlane, known.data(), kAmong) < kNear)
          return true;
        return around.distance(kNear) >= close && around.standsOffPlane(kHeights, kSteep);
      },
      &among);
}

}  // namespace

double medianSpacing(const PointStore& store) {
  const std::size_t samples = std::min(kSample, store.size());
  Neighborhood around(store);
  std::vector<double> spacings;
  for (std::size_t s = 0; s < samples; ++s) {
    around.find(s * store.size() / samples, kNear, nullptr, kNear);
    spacings.push_back(around.distance(kNear));
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
  markCompany(store, spacing, threads, marks);
  for (int round = 0; round < kRounds; ++round) {
    const std::size_t marked = markNearSurface(store, spacing, threads, marks);
    if (static_cast<double>(marked) < kFew * static_cast<double>(n)) break;
  }
  std::vector<std::uint32_t> outliers;
  for (std::size_t i = 0; i < n; ++i) {
    if (marks[i] != 0) outliers.push_back(static_cast<std::uint32_t>(i));
  }
  return outliers;
}

}  // namespace pcl_slim
