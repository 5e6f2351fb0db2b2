// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Merged frames": noise that points of one frame share, where the frames' numbers or the places of
// sensors show which points those are.
#include <algorithm>
#include <cmath>
#include <map>

#include "noise/patch_scale.h"
#include "pcl_slim/cloud/detail/noise_measurement.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

namespace {

/** What points of one frame have in common: its number or, where frames have none, the place of its sensor. */
Vector3
frameOf(const PointStore& store, std::size_t point)
{
  if (store.hasFrameNumbers()) return {static_cast<double>(store.frameNumber(point)), 0, 0};
  return store.sensor(point);
}

/** The frames of most points of a sample, those of most points first; none where all are of one, or each of
 * its own as along a trajectory. */
std::vector<Vector3>
largestFrames(const PointStore& store, const FrameConstants& constants)
{
  std::map<Vector3, std::size_t> counts;
  const std::size_t samples = std::min(constants.sample, store.size());
  for (std::size_t s = 0; s < samples; ++s)
    ++counts[frameOf(store, (2 * s + 1) * store.size() / (2 * samples))];
  if (counts.size() < 2) return {};
  const double stands_for = static_cast<double>(store.size()) / static_cast<double>(samples);
  std::vector<std::pair<std::size_t, Vector3>> frames;
  for (const auto& [frame, count] : counts) {
    if (count > 1 && static_cast<double>(count) * stands_for >= constants.least_points)
      frames.emplace_back(count, frame);
  }
  std::stable_sort(frames.begin(), frames.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  frames.resize(std::min(frames.size(), constants.most_frames));
  std::vector<Vector3> largest(frames.size());
  std::transform(frames.begin(), frames.end(), largest.begin(),
                 [](const auto& frame) { return frame.second; });
  return largest;
}

/** The points of a frame. One sensor sees one side of a part: they need no sides. */
PointStore
pointsOf(const PointStore& store, const Vector3& frame, int threads)
{
  std::vector<std::uint32_t> others;
  for (std::size_t i = 0; i < store.size(); ++i) {
    if (frameOf(store, i) != frame) others.push_back(static_cast<std::uint32_t>(i));
  }
  PointStore points = store.without(others, threads);
  points.clearSides();
  return points;
}

std::size_t
widestPatch(const PointStore& store, const NoiseConstants& constants)
{
  return std::max(constants.first_neighbors, store.size() / constants.most_part);
}

/** Patches whose cells contain about as many points as share their errors. */
PatchScale
scaleOfCells(const PointStore& store, double correlation, const NoiseConstants& constants,
             int threads)
{
  const SharedNoiseConstants& shared = constants.shared;
  const double least = static_cast<double>(shared.cells) * std::max(2.0, correlation);
  std::size_t k = constants.first_neighbors;
  while (static_cast<double>(k) < least && 2 * k <= widestPatch(store, constants)) k *= 2;
  return measureScale(store, k, constants, threads);
}

/** What patches of some radius show: between those of two sizes. */
struct RadiusFigures {
  double shared = 1;  ///< correlationOf()
  std::size_t k = 0;  ///< of the nearer size
  double radius = 0;
};

RadiusFigures
figuresAtRadius(const PointStore& store, double radius, const NoiseConstants& constants,
                int threads)
{
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

/** What single frames show. */
class FrameNoise {
 public:
  explicit FrameNoise(const NoiseConstants& constants, int threads)
      : constants_(constants), threads_(threads)
  {
  }

  void add(const PointStore& frame)
  {
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
  double shared() const { return median(shared_); }  ///< by patches of that radius

  /** The mean of the variances by points, and of what shares an error by points and variance. */
  NoiseLevel mean() const
  {
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

NoiseLevel
recognizeFrameNoise(const PointStore& store, const NoiseLevel& white,
                    const NoiseConstants& constants, int threads)
{
  if (!store.hasSensors() && !store.hasFrameNumbers())
    return recognizeSharedNoise(store, white, constants, threads);
  threads = resolveThreads(threads);
  FrameNoise frames(constants, threads);
  for (const Vector3& frame : largestFrames(store, constants.frames))
    frames.add(pointsOf(store, frame, threads));
  NoiseLevel noise;
  if (!frames.empty()) noise = frames.mean();
  if (!(noise.correlation > constants.shared.white))
    return recognizeSharedNoise(store, white, constants, threads);
  const RadiusFigures all = figuresAtRadius(store, frames.radius(), constants, threads);
  // Frames from one place round a surface alike: then as many more points share an error as there are frames.
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

}  // namespace pcl_slim::detail
