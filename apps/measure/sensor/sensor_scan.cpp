// SPDX-License-Identifier: BSD-3-Clause
#include "measure/sensor/sensor_scan.h"

#include <cmath>
#include <limits>
#include <random>

namespace pcl_slim::measure {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kRadiansPerDegree = 0.017453292519943295;
constexpr double kDepthStep = 0.03;  ///< [of depth]; neighbours that differ more are two surfaces

/** The first solid that a ray meets. */
struct Hit {
  double t = kNever;
  int solid = -1;
};

Hit
firstHit(const std::vector<Solid>& solids, const Vector3& origin, const Vector3& direction)
{
  Hit hit;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const double t = meet(solids[i], origin, direction);
    if (t < hit.t) hit = {t, static_cast<int>(i)};
  }
  return hit;
}

/** An image of Gaussian errors of variance 1, each the mean of a box of independent ones. */
std::vector<double>
correlatedErrors(const DepthCamera& camera, std::mt19937_64& rng)
{
  const int w = camera.width, h = camera.height;
  const int bx = camera.correlated_x, by = camera.correlated_y;
  std::normal_distribution<double> gauss;
  std::vector<double> white(static_cast<std::size_t>((w + bx) * (h + by)));
  for (double& value : white) value = gauss(rng);
  std::vector<double> errors(static_cast<std::size_t>(w * h));
  const double scale = 1 / std::sqrt(static_cast<double>(bx * by));
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      double sum = 0;
      for (int j = 0; j < by; ++j) {
        for (int i = 0; i < bx; ++i)
          sum += white[static_cast<std::size_t>((y + j) * (w + bx) + x + i)];
      }
      errors[static_cast<std::size_t>(y * w + x)] = scale * sum;
    }
  }
  return errors;
}

Vector3
pixelRay(const DepthCamera& camera, int x, int y)
{
  return {(x + 0.5 - 0.5 * camera.width) / camera.focal,
          (y + 0.5 - 0.5 * camera.height) / camera.focal, 1};
}

/** The depth that the camera measures, given the error of its disparity in px. */
double
measuredDepth(const DepthCamera& camera, double depth, double error)
{
  const double scale = camera.disparity_focal * camera.baseline;
  double disparity = scale / depth + camera.sigma * error;
  if (camera.step > 0) disparity = camera.step * std::round(disparity / camera.step);
  depth = scale / disparity;
  return camera.depth_step > 0 ? camera.depth_step * std::round(depth / camera.depth_step) : depth;
}

void
add(const Vector3& origin, const Vector3& direction, double t, int solid, SensorScan& scan)
{
  for (int a = 0; a < 3; ++a) {
    scan.points.push_back(static_cast<float>(origin[a] + t * direction[a]));
  }
  scan.solid.push_back(solid);
}

}  // namespace

SensorScan
scanByCamera(const std::vector<Solid>& solids, const DepthCamera& camera, std::uint64_t seed)
{
  std::mt19937_64 rng(seed);
  const std::vector<double> errors = correlatedErrors(camera, rng);
  std::uniform_real_distribution<double> unit;
  SensorScan scan;
  scan.solids = solids;
  Hit last;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Vector3 ray = pixelRay(camera, x, y);
      Hit hit = firstHit(solids, scan.sensor, ray);
      const Hit seen = hit;
      const bool beside_step = x > 0 && last.solid >= 0 && hit.solid >= 0 &&
                               std::abs(hit.t - last.t) > kDepthStep * hit.t;
      if (beside_step && camera.mixed > 0 && unit(rng) < camera.mixed) {
        const double share = unit(rng);
        hit = {share * hit.t + (1 - share) * last.t, -1};
      }
      last = seen;
      if (hit.t == kNever) continue;
      const double depth =
          measuredDepth(camera, hit.t, errors[static_cast<std::size_t>(y * camera.width + x)]);
      add(scan.sensor, ray, depth, hit.solid, scan);
    }
  }
  return scan;
}

SensorScan
scanByLidar(const std::vector<Solid>& solids, const TurningLidar& lidar, std::uint64_t seed)
{
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> gauss;
  SensorScan scan;
  scan.solids = solids;
  scan.sensor = lidar.origin;
  for (int step = 0; step < lidar.steps; ++step) {
    const double turn = 360.0 * kRadiansPerDegree * step / lidar.steps;
    for (int ring = 0; ring < lidar.rings; ++ring) {
      const double share = static_cast<double>(ring) / (lidar.rings - 1);
      const double up = kRadiansPerDegree * (lidar.lowest + share * (lidar.highest - lidar.lowest));
      const Vector3 ray = {std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn),
                           std::sin(up)};
      const Hit hit = firstHit(solids, lidar.origin, ray);
      if (!(hit.t < lidar.farthest)) continue;
      add(lidar.origin, ray, hit.t + lidar.sigma * gauss(rng), hit.solid, scan);
    }
  }
  return scan;
}

SensorScan
scanInLayers(const std::vector<Solid>& solids, const LayeredScan& layers, std::uint64_t seed)
{
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> gauss;
  SensorScan scan;
  scan.solids = solids;
  scan.one_sensor = false;
  const int side = static_cast<int>(2 * layers.reach / layers.spacing);
  for (int layer = 0; layer < layers.layers; ++layer) {
    const Vector3 ray = normalized({gauss(rng), gauss(rng), gauss(rng)});
    const Vector3 right = normalized(cross(ray, {0.1, 0.2, 1})), down = cross(ray, right);
    Vector3 shift;
    for (double& value : shift) value = layers.shift * gauss(rng);
    for (int i = 0; i < side * side; ++i) {
      const double x = layers.spacing * (i % side + gauss(rng) * 0.1) - layers.reach;
      const double y = layers.spacing * (i / side + gauss(rng) * 0.1) - layers.reach;
      const Vector3 from = along(along(scaled(ray, -2 * layers.reach), x, right), y, down);
      const Hit hit = firstHit(solids, from, ray);
      if (hit.t == kNever) continue;
      add(along(from, 1, shift), ray, hit.t + layers.sigma * gauss(rng), hit.solid, scan);
    }
  }
  return scan;
}

}  // namespace pcl_slim::measure
