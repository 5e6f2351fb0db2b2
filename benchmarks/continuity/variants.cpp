// SPDX-License-Identifier: BSD-3-Clause
#include "continuity/variants.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "continuity/unpredictable.h"
#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim::continuity {

namespace {

using measure::SmoothedPoints;

/** Beyond this many diagonals from the origin, float coordinates lose more than noise and are not
 * what a user has. */
constexpr double kFarFromOrigin = 100;

Varied mapped(const Scan& scan, const SmoothedPoints& smoothed, const Eigen::Affine3d& map,
              bool floats) {
  Varied varied;
  varied.map = map;
  varied.scale = std::cbrt(std::abs(map.linear().determinant()));
  varied.floats = floats;
  varied.leaves = static_cast<double>(smoothed.leaves.size());
  varied.source.resize(scan.points.size());
  std::iota(varied.source.begin(), varied.source.end(), 0);
  for (const Eigen::Vector3d& p : scan.points) varied.points.emplace_back(map * p);
  return varied;
}

bool keepsFloats(const Scan& scan) {
  const Eigen::AlignedBox3d box = scan.box();
  return scan.floats && box.center().norm() < kFarFromOrigin * box.diagonal().norm();
}

/** A linear map about the middle of the scan's box. */
Variant turned(const std::string& name, const Eigen::Matrix3d& linear) {
  return {name, [linear](const Scan& scan, const SmoothedPoints& smoothed) {
            const Eigen::Vector3d middle = scan.box().center();
            return mapped(scan, smoothed,
                          Eigen::Translation3d(middle) * linear * Eigen::Translation3d(-middle),
                          keepsFloats(scan));
          }};
}

Variant shifted(const std::string& name, double diagonals) {
  return {name, [diagonals](const Scan& scan, const SmoothedPoints& smoothed) {
            const Eigen::Vector3d direction = Eigen::Vector3d(0.62, -0.53, 0.58).normalized();
            return mapped(scan, smoothed,
                          Eigen::Affine3d(Eigen::Translation3d(
                              diagonals * scan.box().diagonal().norm() * direction)),
                          keepsFloats(scan));
          }};
}

/** The scan about the origin in another precision. */
Variant inPrecision(const std::string& name, bool floats) {
  return {name, [floats](const Scan& scan, const SmoothedPoints& smoothed) {
            return mapped(scan, smoothed,
                          Eigen::Affine3d(Eigen::Translation3d(-scan.box().center())), floats);
          }};
}

/** Coordinates rounded to a tenth of their own step, else to 1e-4 of the points' spacing. */
Varied rounded(const Scan& scan, const SmoothedPoints& smoothed) {
  const Eigen::Vector3d size = scan.box().sizes();
  const double step = smoothed.fit.noise.step * size.norm();
  // A surface's area is about that of its box's largest side.
  const double area = size.prod() / size.minCoeff();
  const double spacing = std::sqrt(area / static_cast<double>(scan.points.size()));
  const double grid = step > 0 ? step / 10 : 1e-4 * spacing;
  Varied varied = mapped(scan, smoothed, Eigen::Affine3d::Identity(), scan.floats);
  for (Eigen::Vector3d& p : varied.points) p = ((p / grid).array().round() * grid).matrix();
  return varied;
}

/** Signed distances of the points from the smoothed surface; NaN where there is none. */
std::vector<double> residuals(const Scan& scan, const SmoothedPoints& smoothed) {
  std::vector<double> result;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Map<const Eigen::Vector3d> q(smoothed.points[i].data());
    const Eigen::Map<const Eigen::Vector3d> normal(smoothed.normals[i].data());
    result.push_back((scan.points[i] - q).dot(normal));
  }
  return result;
}

double medianSize(const std::vector<double>& values) {
  std::vector<double> sizes;
  for (const double v : values) {
    if (!std::isnan(v)) sizes.push_back(std::abs(v));
  }
  return sizes.empty() ? 0 : median(std::move(sizes));
}

double rms(const std::vector<double>& values) {
  double sum_sq = 0, finite = 0;
  for (const double v : values) {
    if (std::isnan(v)) continue;
    sum_sq += v * v;
    ++finite;
  }
  return std::sqrt(sum_sq / finite);
}

/** Some of the points. */
template <typename Keep>
Varied part(const Scan& scan, const SmoothedPoints& smoothed, const Keep& keep) {
  Varied varied;
  varied.floats = scan.floats;
  varied.leaves = static_cast<double>(smoothed.leaves.size());
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (!keep(i)) continue;
    varied.points.push_back(scan.points[i]);
    varied.source.push_back(i);
  }
  varied.density =
      static_cast<double>(varied.points.size()) / static_cast<double>(scan.points.size());
  return varied;
}

/** Fewer points, from which detail that was predictable may be no more. Errors that points share
 * are predictable, too: then sigma is to stay. */
template <typename Keep>
Varied sparser(const Scan& scan, const SmoothedPoints& smoothed, std::uint64_t seed,
               const Keep& keep) {
  Varied varied = part(scan, smoothed, keep);
  constexpr double kWhite = 1.5;
  if (smoothed.fit.noise.correlation < kWhite)
    varied.sigma[1] = unpredictable(varied.points, seed) / unpredictable(scan.points, seed);
  return varied;
}

Variant thinned(const std::string& name, double share, std::uint64_t seed) {
  return {name, [share, seed](const Scan& scan, const SmoothedPoints& smoothed) {
            std::mt19937_64 rng(seed);
            std::uniform_real_distribution<double> unit(0, 1);
            return sparser(scan, smoothed, seed, [&](std::size_t) { return unit(rng) < share; });
          }};
}

/** The same points in another order. */
Variant shuffled(std::uint64_t seed) {
  return {"shuffled", [seed](const Scan& scan, const SmoothedPoints& smoothed) {
            Varied varied = mapped(scan, smoothed, Eigen::Affine3d::Identity(), scan.floats);
            std::mt19937_64 rng(seed);
            std::shuffle(varied.source.begin(), varied.source.end(), rng);
            for (std::size_t i = 0; i < varied.source.size(); ++i)
              varied.points[i] = scan.points[varied.source[i]];
            return varied;
          }};
}

Variant everySecondRow(const std::string& name, std::uint32_t first, std::uint64_t seed) {
  return {name, [first, seed](const Scan& scan, const SmoothedPoints& smoothed) {
            if (scan.row.empty()) return Varied{};
            return sparser(scan, smoothed, seed,
                           [&](std::size_t i) { return scan.row[i] % 2 == first; });
          }};
}

/** The half below the median along the box's longest edge, at the scan's own density. Its sigma is
 * that of the scan by the residuals there: their median and their RMS differ where the noise
 * varies. */
Varied cropped(const Scan& scan, const SmoothedPoints& smoothed) {
  Eigen::Index axis = 0;
  scan.box().sizes().maxCoeff(&axis);
  std::vector<double> along;
  for (const Eigen::Vector3d& p : scan.points) along.push_back(p[axis]);
  const auto middle = along.begin() + static_cast<std::ptrdiff_t>(along.size() / 2);
  std::nth_element(along.begin(), middle, along.end());
  const double cut = *middle;
  Varied varied = part(scan, smoothed, [&](std::size_t i) { return scan.points[i][axis] < cut; });
  varied.density = 1;
  const std::vector<double> all = residuals(scan, smoothed);
  std::vector<double> kept;
  for (const std::size_t i : varied.source) kept.push_back(all[i]);
  varied.sigma = {medianSize(kept) / medianSize(all), rms(kept) / rms(all)};
  varied.leaves = static_cast<double>(std::count_if(
      smoothed.leaves.begin(), smoothed.leaves.end(),
      [&](const Vector3& leaf) { return leaf[static_cast<std::size_t>(axis)] < cut; }));
  return varied;
}

Eigen::Matrix3d tilt(double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 0.7, 0.3).normalized()).toRotationMatrix();
}

/** A second frame made of a scan's only one: every smoothed point with the residual of the point
 * half a patch further in the scan's order along its own normal, so that correlated errors stay
 * correlated. What the leaves follow of the noise is missing in residuals: they are made as large
 * as sigma. */
Points secondFrame(const Scan& scan, const SmoothedPoints& smoothed) {
  constexpr std::size_t kFurther = 997;
  const std::vector<double> all = residuals(scan, smoothed);
  const double missing = std::max(1.0, smoothed.sigma / rms(all));
  Points frame;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Map<const Eigen::Vector3d> q(smoothed.points[i].data());
    const Eigen::Map<const Eigen::Vector3d> normal(smoothed.normals[i].data());
    const Eigen::Vector3d p = q + missing * all[(i + kFurther) % scan.points.size()] * normal;
    if (p.allFinite()) frame.push_back(p);
  }
  return frame;
}

/** Of a registered frame. */
Eigen::Affine3d registration(const Scan& scan) {
  const Eigen::Vector3d middle = scan.box().center();
  return Eigen::Translation3d(middle) * tilt(0.001) * Eigen::Translation3d(-middle);
}

/** The scan and a second frame of the same surface that is moved. */
Varied mergedBy(const Eigen::Affine3d& map, const Scan& scan, const SmoothedPoints& smoothed) {
  Varied varied = mapped(scan, smoothed, Eigen::Affine3d::Identity(), scan.floats);
  for (const Eigen::Vector3d& p : scan.second.empty() ? secondFrame(scan, smoothed) : scan.second)
    varied.points.emplace_back(map * p);
  varied.density = 2;
  return varied;
}

/** The scan and a second frame, registered with an error of .001 rad. */
Varied merged(const Scan& scan, const SmoothedPoints& smoothed) {
  return mergedBy(registration(scan), scan, smoothed);
}

/** Gives the points of two frames their numbers. */
Varied numbered(const Scan& scan, Varied varied) {
  varied.origins.frames.assign(scan.points.size(), 0);
  varied.origins.frames.resize(varied.points.size(), 1);
  return varied;
}

std::optional<Eigen::Vector3d> sensorOf(const Scan& scan) {
  return scan.sensor ? scan.sensor : scan.camera;
}

/** The same, with the place that each frame was seen from. */
Varied mergedWithSensors(const Scan& scan, const SmoothedPoints& smoothed) {
  const std::optional<Eigen::Vector3d> sensor = sensorOf(scan);
  if (!sensor) return {};
  Varied varied = merged(scan, smoothed);
  varied.origins.sensors.assign(scan.points.size(), *sensor);
  varied.origins.sensors.resize(varied.points.size(), registration(scan) * *sensor);
  return varied;
}

/** The same, with each point's frame and no sensor. */
Varied mergedWithNumbers(const Scan& scan, const SmoothedPoints& smoothed) {
  return numbered(scan, merged(scan, smoothed));
}

/** Two frames of a sensor that does not move. */
Varied mergedOfOnePlace(const Scan& scan, const SmoothedPoints& smoothed) {
  Varied varied = numbered(scan, mergedBy(Eigen::Affine3d::Identity(), scan, smoothed));
  varied.sensor = sensorOf(scan);
  return varied;
}

}  // namespace

std::vector<Variant> allVariants(std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> gauss;
  const auto randomTurn = [&]() -> Eigen::Matrix3d {
    return Eigen::Quaterniond(gauss(rng), gauss(rng), gauss(rng), gauss(rng))
        .normalized()
        .toRotationMatrix();
  };
  Eigen::Matrix3d permuted = Eigen::Matrix3d::Zero();
  permuted(0, 1) = permuted(1, 2) = permuted(2, 0) = 1;
  return {turned("tilt .001", tilt(0.001)),
          turned("tilt .01", tilt(0.01)),
          turned("tilt .03", tilt(0.03)),
          turned("tilt .3", tilt(0.3)),
          turned("turn 1", randomTurn()),
          turned("turn 2", randomTurn()),
          turned("mirror", Eigen::Vector3d(-1, 1, 1).asDiagonal()),
          turned("permuted axes", permuted),
          shifted("shift 10 L", 10),
          shifted("shift 1e-6 L", 1e-6),
          turned("scale 1000", 1000 * Eigen::Matrix3d::Identity()),
          turned("scale .001", 0.001 * Eigen::Matrix3d::Identity()),
          inPrecision("float", true),
          inPrecision("double", false),
          {"rounded", rounded},
          shuffled(seed),
          thinned("80 %", 0.8, seed),
          thinned("50 %", 0.5, seed),
          everySecondRow("every second row", 0, seed),
          everySecondRow("the other rows", 1, seed),
          {"cropped half", cropped},
          {"two frames merged", merged},
          {"two frames merged, sensors known", mergedWithSensors},
          {"two frames merged, numbers known", mergedWithNumbers},
          {"two frames merged, of one place", mergedOfOnePlace}};
}

}  // namespace pcl_slim::continuity
