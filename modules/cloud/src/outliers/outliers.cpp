// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/outliers.h"

#include <algorithm>
#include <cmath>

#include "outliers/neighborhood.h"
#include "pcl_slim/cloud/detail/block_kernels.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

using namespace detail;

namespace {

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

/** Runs a decision on all points that have fewer than kNear others within a distance, and marks those
 * of which it is true. \return how many were marked. */
template <typename Decision>
std::size_t
markSparse(const PointStore& store, double distance, int threads, Marks& marks,
           const Decision& decide, const std::vector<bool>* blocks = nullptr)
{
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
std::size_t
markScattered(const PointStore& store, double spacing, int threads, Marks& marks)
{
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
std::size_t
markCompany(const PointStore& store, double spacing, int threads, Marks& marks)
{
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
std::vector<bool>
blocksAmongOutliers(const PointStore& store, const Marks& marks)
{
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

/** Points that stand off the surface, but near it. */
std::size_t
markNearSurface(const PointStore& store, double spacing, int threads, Marks& marks)
{
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

double
medianSpacing(const PointStore& store)
{
  const std::size_t samples = std::min(kSample, store.size());
  Neighborhood around(store);
  std::vector<double> spacings;
  for (std::size_t s = 0; s < samples; ++s) {
    around.find(s * store.size() / samples, kNear, nullptr, kNear);
    spacings.push_back(around.distance(kNear));
  }
  const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(samples / 2);
  std::nth_element(spacings.begin(), middle, spacings.end());
  return *middle;
}

std::vector<std::uint32_t>
findOutliers(const PointStore& store, int threads, double spacing)
{
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
