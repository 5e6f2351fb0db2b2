// SPDX-License-Identifier: BSD-3-Clause
// Residuals of small patches as a sensor sees them, by which a frame is compared with the noise of
// an earlier one (docs/noise.md, "A sensor's next frame").
#include "pcl_slim/cloud/detail/patch_residuals.h"

#include <algorithm>
#include <cmath>

#include "noise/patch.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kTask = 16;         ///< number of runs of a task
constexpr std::size_t kPlaneStride = 4;   ///< every fourth point makes planes
constexpr double kThin = 0.2;             ///< thickness over width of a plane with little noise
constexpr std::ptrdiff_t kMostWidth = 8;  ///< largest number of runs to either side of a plane

/** Sums of the places of points, about the middle of the cloud. */
struct RunSums {
  double count = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();

  void add(const RunSums& other) {
    count += other.count;
    first += other.first;
    second += other.second;
  }
};

std::vector<RunSums> sumRuns(const PointStore& store, std::size_t runs, int threads) {
  std::vector<RunSums> sums(runs);
  parallelFor(runs, threads, kTask, [&](std::size_t r, int) {
    const std::size_t end = (r + 1) * store.size() / runs;
    for (std::size_t i = r * store.size() / runs; i < end; i += kPlaneStride) {
      const Vector3 p = store.position(i);
      const Eigen::Vector3d place(p[0], p[1], p[2]);
      sums[r].count += 1;
      sums[r].first += place;
      sums[r].second += place * place.transpose();
    }
  });
  return sums;
}

/** The normal of the plane at a run, as wide as its noise needs. Neighbours along the curve may be
 * far apart: where no width is thin, the thinnest one counts. */
Eigen::Vector3d normalAt(const std::vector<RunSums>& sums, std::size_t run) {
  const auto at = static_cast<std::ptrdiff_t>(run), runs = static_cast<std::ptrdiff_t>(sums.size());
  RunSums around = sums[run];
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double least = HUGE_VAL;
  for (std::ptrdiff_t width = 0, next = 1;; next *= 2) {
    const Eigen::Vector3d mean = around.first / around.count;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
    axes.computeDirect(around.second / around.count - mean * mean.transpose());
    const Eigen::Vector3d squares = axes.eigenvalues();
    const double thickness =
        squares[1] > 0 ? std::sqrt(std::max(0.0, squares[0]) / squares[1]) : HUGE_VAL;
    if (thickness < least) {
      least = thickness;
      normal = axes.eigenvectors().col(0);
    }
    if (thickness < kThin || next > kMostWidth) return normal;
    while (width < next) {
      ++width;
      if (at - width >= 0) around.add(sums[static_cast<std::size_t>(at - width)]);
      if (at + width < runs) around.add(sums[static_cast<std::size_t>(at + width)]);
    }
  }
}

}  // namespace

std::vector<SensorRay> raysToRuns(const PointStore& store, const std::optional<Vector3>& sensor,
                                  std::size_t runs, const NoiseConstants& constants, int threads) {
  threads = resolveThreads(threads);
  if (runs == 0) runs = profileRuns(store, constants);
  const std::vector<RunSums> sums = sumRuns(store, runs, threads);
  std::vector<SensorRay> rays(runs);
  parallelFor(runs, threads, kTask, [&](std::size_t r, int) {
    const std::size_t middle = (2 * r + 1) * store.size() / (2 * runs);
    const Vector3 ray = subtract(store.position(middle), sensor ? *sensor : store.sensor(middle));
    const double range = length(ray);
    const Eigen::Vector3d normal = normalAt(sums, r);
    const double along = std::abs(dot(ray, {normal[0], normal[1], normal[2]}));
    rays[r] = {range, along / std::max(range, 1e-300)};
  });
  return rays;
}

std::vector<PlaceResiduals> residualsAtPlaces(const PointStore& store,
                                              const std::array<std::size_t, 2>& sizes,
                                              std::size_t places,
                                              const std::vector<SensorRay>& rays,
                                              const NoiseConstants& constants, int threads,
                                              double& radius) {
  threads = resolveThreads(threads);
  places = std::min(places, store.size());
  std::vector<PlaceResiduals> found(places);
  for (std::size_t size = 0; size < sizes.size(); ++size) {
    const std::size_t k = sizes[size];
    std::vector<double> radii(places);
    const auto measure = [&](NeighborSearch& search, std::size_t sample, std::size_t s) {
      return patchVariance(store, search, sample, k, constants, radii[s]);
    };
    std::vector<double> variances =
        sampleStore(store, places, patchStride(k, constants), threads, measure);
    restoreCutVariances(radii, constants, threads, variances);
    for (std::size_t s = 0; s < places; ++s) found[s].variances[size] = variances[s];
    radius = median(radii);
  }
  for (std::size_t s = 0; s < places && !rays.empty(); ++s)
    found[s].ray = rays[(2 * s + 1) * rays.size() / (2 * places)];
  return found;
}

std::vector<float> rangeNoise(const std::vector<SensorRay>& rays,
                              const std::array<double, 3>& error, const NoiseConstants& constants,
                              int threads) {
  std::vector<double> variances(rays.size());
  std::transform(rays.begin(), rays.end(), variances.begin(), [&](const SensorRay& ray) {
    const double across =
        ray.cosine * (error[0] + error[1] * ray.range + error[2] * ray.range * ray.range);
    return across * across;
  });
  return windowedMeans(variances, constants, resolveThreads(threads));
}

}  // namespace pcl_slim::detail
