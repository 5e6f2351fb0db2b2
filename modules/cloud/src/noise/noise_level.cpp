// SPDX-License-Identifier: BSD-3-Clause
// The noise of a cloud by its smallest patches (docs/noise.md, "White noise"),
// of merged frames, and of its normals.
#include "pcl_slim/cloud/noise_level.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "noise/patch.h"
#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kSamples = 500;          ///< number of patches of the smallest size
constexpr std::size_t kPointsPerSample = 250;  ///< a large cloud has one for this many points
/// Least sqrt(lambda) [PointStore::bulkDiagonal()]: float positions resolve no less.
constexpr double kLeastNoise = 1e-11;

/** The noise of patches of k points: their trimmed mean variance and median radius. */
NoiseLevel patchLevel(const PointStore& store, std::size_t k, const NoiseConstants& constants,
                      int threads) {
  // Larger patches average more points each, so fewer of them are needed.
  // No more patches of the smallest size are needed than contain each point once.
  const std::size_t smallest =
      std::max(std::min(kSamples, store.size() / constants.first_neighbors),
               store.size() / kPointsPerSample);
  const std::size_t samples =
      std::max(constants.least_samples, smallest * constants.first_neighbors / k);
  std::vector<double> radii(std::min(samples, store.size()));
  const auto measure = [&](NeighborSearch& search, std::size_t sample, std::size_t s) {
    return patchVariance(store, search, sample, k, constants, radii[s]);
  };
  auto values = sampleStore(store, samples, patchStride(k, constants), threads, measure);
  restoreCutVariances(radii, constants, threads, values);
  NoiseLevel level;
  level.error = 0.5 * trimmedMeanError(values, constants.trim);
  level.variance = trimmedMean(values, constants.trim);
  level.patch_radius = median(radii);
  level.neighbors = k;
  level.patches = radii.size();
  return level;
}

/** Subtracts the cubic's bias, which is estimated from patches of twice as many points. */
void removeBias(const NoiseLevel& wider, const NoiseConstants& constants, NoiseLevel& noise) {
  const double growth = constants.bias_growth;
  const double bias_free = (growth * noise.variance - wider.variance) / (growth - 1);
  const double error =
      std::hypot(growth * noise.variance * noise.error, wider.variance * wider.error) /
      (growth - 1);
  noise.error = bias_free > error ? error / bias_free : 1;
  noise.variance = std::clamp(bias_free, 0.0, noise.variance);
}

}  // namespace

NoiseLevel measureNoise(const PointStore& store, const NoiseConstants& constants, int threads) {
  if (store.size() < kCubicTerms + 2) return {};
  threads = resolveThreads(threads);
  const std::size_t first = smallestPatch(store, constants, threads);
  const std::size_t most = store.size() / constants.most_part + first;
  NoiseLevel noise = patchLevel(store, first, constants, threads);
  std::size_t patches = noise.patches;
  for (std::size_t k = 2 * first; k <= most; k *= 2) {
    const NoiseLevel wider = patchLevel(store, k, constants, threads);
    patches += wider.patches;
    if (std::sqrt(noise.variance) < constants.patch_noise * noise.patch_radius) {
      removeBias(wider, constants, noise);
      break;
    }
    noise = wider;
  }
  const double floor = kLeastNoise * store.bulkDiagonal();
  if (noise.variance < floor * floor) noise.error = 0;
  noise.variance = std::max(noise.variance, floor * floor);
  noise.line = first > constants.first_neighbors ? first / 2 : 0;
  noise.patches = patches;
  return noise;
}

NoiseLevel measurePaperNoise(const PointStore& store, int threads) {
  constexpr std::size_t kNeighborhoods = 1000;
  constexpr std::size_t kNeighbors = 10;  // of each, without the sample
  constexpr double kLeastError = 1e-6;    // sqrt(lambda) [L]
  if (store.size() < kCubicTerms + 2) return {};
  threads = resolveThreads(threads);
  const auto measure = [&](NeighborSearch& search, std::size_t sample, std::size_t) {
    thread_local Patch patch;
    patchAbout(store, search, sample, kNeighbors + 1, patch);
    if (patch.points.size() < 4) return -1.0;
    return std::max(0.0, principalAxes(patch.points).eigenvalues()(0));
  };
  const auto values = sampleStore(store, kNeighborhoods, 1, threads, measure);
  double sum = 0;
  std::size_t count = 0;
  for (const double value : values) {
    sum += std::max(value, 0.0);
    count += value >= 0.0;
  }
  const double floor = kLeastError * store.diagonal();
  NoiseLevel noise;
  noise.variance = std::max(count > 0 ? sum / static_cast<double>(count) : 0.0, floor * floor);
  noise.neighbors = kNeighbors;
  noise.patches = values.size();
  return noise;
}

// Noise that points of one frame share (docs/noise.md, "Frames"). Frame numbers or sensor
// positions give the points of a frame.

namespace {

constexpr std::size_t kFrameSample = 8192;  ///< number of points whose frames are counted
constexpr double kFramePoints = 2000;       ///< least number of points of a frame that is measured
constexpr std::size_t kMostFrames = 8;      ///< most frames that are measured; more add little

/** Key of a point's frame: its number or, without numbers, the position of its sensor. */
Vector3 frameOf(const PointStore& store, std::size_t point) {
  if (store.hasFrameNumbers()) return {static_cast<double>(store.frameNumber(point)), 0, 0};
  return store.sensor(point);
}

/** The largest frames in a sample of the points, largest first. \return empty if all points are of
 * one frame, or each of its own as along a trajectory */
std::vector<Vector3> largestFrames(const PointStore& store) {
  std::map<Vector3, std::size_t> counts;
  const std::size_t samples = std::min(kFrameSample, store.size());
  for (std::size_t s = 0; s < samples; ++s)
    ++counts[frameOf(store, (2 * s + 1) * store.size() / (2 * samples))];
  if (counts.size() < 2) return {};
  const double points_per_sample = static_cast<double>(store.size()) / static_cast<double>(samples);
  std::vector<std::pair<std::size_t, Vector3>> frames;
  for (const auto& [frame, count] : counts) {
    if (count > 1 && static_cast<double>(count) * points_per_sample >= kFramePoints)
      frames.emplace_back(count, frame);
  }
  std::stable_sort(frames.begin(), frames.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  frames.resize(std::min(frames.size(), kMostFrames));
  std::vector<Vector3> largest(frames.size());
  std::transform(frames.begin(), frames.end(), largest.begin(),
                 [](const auto& frame) { return frame.second; });
  return largest;
}

/** The points of a frame, without sides: one sensor sees only one side of a part. */
PointStore pointsOf(const PointStore& store, const Vector3& frame, int threads) {
  std::vector<std::uint32_t> others;
  for (std::size_t i = 0; i < store.size(); ++i) {
    if (frameOf(store, i) != frame) others.push_back(static_cast<std::uint32_t>(i));
  }
  PointStore points = store.without(others, threads);
  points.clearSides();
  return points;
}

std::size_t widestPatch(const PointStore& store, const NoiseConstants& constants) {
  return std::max(constants.first_neighbors, store.size() / constants.most_part);
}

/** Patches whose cells contain about as many points as share an error. */
PatchScale scaleOfCells(const PointStore& store, double correlation,
                        const NoiseConstants& constants, int threads) {
  const SharedNoiseConstants& shared = constants.shared;
  const double least = static_cast<double>(shared.cells) * std::max(2.0, correlation);
  std::size_t k = constants.first_neighbors;
  while (static_cast<double>(k) < least && 2 * k <= widestPatch(store, constants)) k *= 2;
  return measureScale(store, k, constants, threads);
}

/** Figures of patches of a given radius, interpolated between two sizes. */
struct RadiusFigures {
  double shared = 1;  ///< correlationOf()
  std::size_t k = 0;  ///< number of points of the size nearer in radius
  double radius = 0;  ///< median radius of this size
};

RadiusFigures figuresAtRadius(const PointStore& store, double radius,
                              const NoiseConstants& constants, int threads) {
  PatchScale below = measureScale(store, constants.first_neighbors, constants, threads);
  PatchScale above = below;
  while (median(above.radii) < radius && 2 * above.k <= widestPatch(store, constants)) {
    below = std::move(above);
    above = measureScale(store, 2 * below.k, constants, threads);
  }
  const double low = std::log(median(below.radii)), high = std::log(median(above.radii));
  const double part =
      high > low ? std::clamp((std::log(radius) - low) / (high - low), 0.0, 1.0) : 1.0;
  const double shared = std::log(correlationOf(below, constants));
  const double wider = std::log(correlationOf(above, constants));
  const PatchScale& nearer = part < 0.5 ? below : above;
  return {std::exp(shared + part * (wider - shared)), nearer.k, median(nearer.radii)};
}

/** The mean noise of single frames. */
class FrameNoise {
 public:
  explicit FrameNoise(const NoiseConstants& constants, int threads)
      : constants_(constants), threads_(threads) {}

  void add(const PointStore& frame) {
    const NoiseLevel white = measureNoise(frame, constants_, threads_);
    const NoiseLevel noise = recognizeSharedNoise(frame, white, constants_, threads_);
    if (!(noise.variance > 0)) return;
    const PatchScale scale = scaleOfCells(frame, noise.correlation, constants_, threads_);
    radii_.push_back(median(scale.radii));
    shared_.push_back(correlationOf(scale, constants_));
    const auto points = static_cast<double>(frame.size());
    const double weight = points * noise.variance;
    points_ += points;
    weights_ += weight;
    sharing_ += weight * noise.correlation;
    dependent_ += weight * noise.dependence;
    squares_ += std::pow(weight * noise.error, 2);
    sharing_squares_ += std::pow(weight * noise.correlation * noise.correlation_error, 2);
    sum_.step = std::max(sum_.step, noise.step);
    sum_.patches += noise.patches + scale.variances.size();
    ++sum_.frames;
  }

  bool empty() const { return sum_.frames == 0; }
  double radius() const { return median(radii_); }
  double shared() const { return median(shared_); }  ///< correlationOf() on patches of radius()

  /** Mean of the variances, weighted by points, and of the correlations, by points and variance. */
  NoiseLevel mean() const {
    NoiseLevel noise = sum_;
    noise.variance = weights_ / points_;
    noise.error = std::sqrt(squares_) / weights_;
    noise.correlation = sharing_ / weights_;
    noise.correlation_error = std::sqrt(sharing_squares_) / sharing_;
    noise.dependence = dependent_ / weights_;
    return noise;
  }

 private:
  const NoiseConstants& constants_;
  int threads_;
  NoiseLevel sum_;
  double points_ = 0, weights_ = 0, sharing_ = 0, dependent_ = 0;
  double squares_ = 0, sharing_squares_ = 0;
  std::vector<double> radii_, shared_;
};

}  // namespace

NoiseLevel recognizeFrameNoise(const PointStore& store, const NoiseLevel& white,
                               const NoiseConstants& constants, int threads) {
  if (!store.hasSensors() && !store.hasFrameNumbers())
    return recognizeSharedNoise(store, white, constants, threads);
  threads = resolveThreads(threads);
  FrameNoise frames(constants, threads);
  for (const Vector3& frame : largestFrames(store)) frames.add(pointsOf(store, frame, threads));
  NoiseLevel noise;
  if (!frames.empty()) noise = frames.mean();
  if (!(noise.correlation > constants.shared.white_correlation))
    return recognizeSharedNoise(store, white, constants, threads);
  const RadiusFigures all = figuresAtRadius(store, frames.radius(), constants, threads);
  // Frames from one place have the same rounding errors. Each frame then multiplies the number of
  // points that share an error.
  const double more = std::max(1.0, all.shared / frames.shared());
  noise.correlation *= more;
  noise.dependence *= more;
  // Errors of registration are white noise to the smallest patches of all points.
  noise.variance = std::max(noise.variance, white.variance);
  noise.neighbors = all.k;
  noise.patch_radius = all.radius;
  noise.patches += white.patches;
  return noise;
}

namespace {

/// Exact normals of one sheet differ by at most 90 degrees and the angle of this sine.
constexpr double kExactTurn = 0.25;
constexpr std::size_t kBlocks = 1000;    ///< number of blocks examined, evenly strided
constexpr std::size_t kLeastPoints = 8;  ///< least number of points of such a block
constexpr double kOneSheetMean = 0.5;    ///< a shorter mean of unit normals mixes two sheets
constexpr double kMostTilt = 0.6435;     ///< largest angle for errors of normals [rad]: asin(0.6)
/// Median of (1 - cos) / sigma^2 for normals tilted by sigma about each axis.
constexpr double kMedianOfTilt = 0.6931;

/** Appends 1 - cos of the angles between a block's normals and their mean. */
void addTilts(const PointStore& store, std::size_t block, std::vector<double>& tilts) {
  const std::size_t begin = block * PointStore::kBlock;
  const std::size_t end = std::min(begin + PointStore::kBlock, store.size());
  if (end < begin + kLeastPoints) return;
  double mean[3] = {};
  for (std::size_t i = begin; i < end; ++i) {
    const auto n = store.normal(i);
    for (std::size_t a = 0; a < 3; ++a) mean[a] += n[a];
  }
  const double length = std::sqrt(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]);
  if (length < kOneSheetMean * static_cast<double>(end - begin)) return;
  for (std::size_t i = begin; i < end; ++i) {
    const auto n = store.normal(i);
    tilts.push_back(1.0 - (n[0] * mean[0] + n[1] * mean[1] + n[2] * mean[2]) / length);
  }
}

}  // namespace

float normalBound(const PointStore& store, const NormalBoundConstants& constants) {
  std::vector<double> tilts;
  const double least_fall = store.hasNormals() ? kExactTurn : 0;
  const std::size_t blocks = store.numBlocks(), stride = std::max<std::size_t>(1, blocks / kBlocks);
  for (std::size_t block = 0; block < blocks; block += stride) addTilts(store, block, tilts);
  if (tilts.empty()) return static_cast<float>(-least_fall);
  const double sigma = std::sqrt(std::max(0.0, median(tilts)) / kMedianOfTilt);
  return static_cast<float>(
      std::min(-least_fall, -std::sin(std::min(constants.deviations * sigma, kMostTilt))));
}

}  // namespace pcl_slim::detail

namespace pcl_slim {

double estimateNoise(const PointStore& store, NoiseEstimator estimator, int threads) {
  const bool paper = estimator == NoiseEstimator::kMinEigenvalue10;
  return (paper ? detail::measurePaperNoise(store, threads)
                : detail::measureNoise(store, {}, threads))
      .variance;
}

}  // namespace pcl_slim
