// SPDX-License-Identifier: BSD-3-Clause
#include "support/lab/sensor.h"

#include <cmath>
#include <limits>
#include <random>

namespace pcl_slim::measure {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kTwoPi = 2 * M_PI;
constexpr double kNear = 1e-6;  ///< rays start so far off
constexpr int kMarch = 400;     ///< steps in which waves are looked for around their plane
constexpr int kHalvings = 60;

/** The tangent that waves run along: as near to x as the axis allows. */
Vector3 firstTangent(const Vector3& axis) {
  return normalized({1 - axis[0] * axis[0], -axis[0] * axis[1], -axis[0] * axis[2]});
}

/** Height above a plane with waves, in the direction of its axis. */
double heightOver(const Solid& s, const Vector3& p) {
  const Vector3 d = subtract(p, s.center);
  const double phase = kTwoPi / s.wavelength * dot(d, firstTangent(s.axis));
  return dot(d, s.axis) - s.amplitude * std::sin(phase);
}

/** The nearer root of a quadratic a t^2 + 2 b t + c that is positive. */
double nearerRoot(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (!(discriminant > 0) || !(a > 0)) return kNever;
  const double root = std::sqrt(discriminant);
  if ((-b - root) / a > kNear) return (-b - root) / a;
  return (-b + root) / a > kNear ? (-b + root) / a : kNever;
}

double meetWaves(const Solid& s, const Vector3& origin, const Vector3& direction) {
  const double slope = dot(direction, s.axis), height = dot(subtract(origin, s.center), s.axis);
  const double near = (-height + s.amplitude) / slope, far = (-height - s.amplitude) / slope;
  double low = std::min(near, far), last = heightOver(s, along(origin, low, direction));
  const double step = std::abs(far - near) / kMarch;
  for (int i = 0; i <= kMarch; ++i, low += step) {
    const double next = heightOver(s, along(origin, low + step, direction));
    if ((next > 0) == (last > 0)) continue;
    double high = low + step;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (low + high);
      const bool same = (heightOver(s, along(origin, middle, direction)) > 0) == (last > 0);
      (same ? low : high) = middle;
    }
    return low > kNear ? low : kNever;
  }
  return kNever;
}

double meetUnbounded(const Solid& s, const Vector3& origin, const Vector3& direction) {
  const Vector3 d = subtract(origin, s.center);
  switch (s.kind) {
    case Solid::Kind::kPlane: {
      const double t = -dot(d, s.axis) / dot(direction, s.axis);
      return t > kNear ? t : kNever;
    }
    case Solid::Kind::kWaves: return meetWaves(s, origin, direction);
    case Solid::Kind::kSphere:
      return nearerRoot(dot(direction, direction), dot(d, direction),
                        dot(d, d) - s.radius * s.radius);
    default:
      return nearerRoot(direction[0] * direction[0] + direction[1] * direction[1],
                        d[0] * direction[0] + d[1] * direction[1],
                        d[0] * d[0] + d[1] * d[1] - s.radius * s.radius);
  }
}

Foot footFrom(const Vector3& offset, double radius) {
  return {length(offset) - radius, normalized(offset)};
}

/** Newton steps along the plane's tangent to where the waves' normal points at the point. */
Foot footOnWaves(const Solid& s, const Vector3& point) {
  const Vector3 d = subtract(point, s.center), tangent = firstTangent(s.axis);
  const double k = kTwoPi / s.wavelength, x = dot(d, tangent), h = dot(d, s.axis);
  double u = x;
  for (int step = 0; step < 30; ++step) {
    const double wave = s.amplitude * std::sin(k * u), slope = s.amplitude * k * std::cos(k * u);
    const double residual = (u - x) + slope * (wave - h);
    const double bend = -k * k * wave;
    u -= residual / std::max(0.2, 1 + slope * slope + bend * (wave - h));
  }
  const double wave = s.amplitude * std::sin(k * u), slope = s.amplitude * k * std::cos(k * u);
  return {((h - wave) - slope * (x - u)) / std::sqrt(1 + slope * slope),
          normalized(along(s.axis, -slope, tangent))};
}

}  // namespace

double meet(const Solid& solid, const Vector3& origin, const Vector3& direction) {
  const double t = meetUnbounded(solid, origin, direction);
  if (t == kNever) return kNever;
  const Vector3 p = along(origin, t, direction);
  for (int a = 0; a < 3; ++a) {
    if (p[a] < solid.low[a] || p[a] > solid.high[a]) return kNever;
  }
  return t;
}

Foot footOn(const Solid& solid, const Vector3& point) {
  const Vector3 d = subtract(point, solid.center);
  switch (solid.kind) {
    case Solid::Kind::kPlane: return {dot(d, solid.axis), solid.axis};
    case Solid::Kind::kWaves: return footOnWaves(solid, point);
    case Solid::Kind::kSphere: return footFrom(d, solid.radius);
    default: return footFrom({d[0], d[1], 0}, solid.radius);
  }
}

namespace {

Solid plane(const Vector3& center, const Vector3& axis) {
  Solid solid;
  solid.center = center;
  solid.axis = normalized(axis);
  return solid;
}

Solid sphere(const Vector3& center, double radius) {
  Solid solid;
  solid.kind = Solid::Kind::kSphere;
  solid.center = center;
  solid.radius = radius;
  return solid;
}

Solid waves(double wavelength, double amplitude) {
  Solid solid = plane({0, 0, 1.2}, {0.3, 0.2, -1});
  solid.kind = Solid::Kind::kWaves;
  solid.wavelength = wavelength;
  solid.amplitude = amplitude;
  return solid;
}

/** Part of an upright wall. */
Solid wall(const Vector3& center, const Vector3& axis, double length, double height) {
  Solid solid = plane(center, axis);
  for (int a = 0; a < 2; ++a) {
    solid.low[a] = center[a] - 0.5 * length;
    solid.high[a] = center[a] + 0.5 * length;
  }
  solid.low[2] = 0;
  solid.high[2] = height;
  return solid;
}

Solid pole(double x, double y, double radius, double height) {
  Solid solid;
  solid.kind = Solid::Kind::kPole;
  solid.center = {x, y, 0};
  solid.radius = radius;
  solid.low[2] = 0;
  solid.high[2] = height;
  return solid;
}

Solid foot() {
  Solid solid = pole(0.01, -0.02, 0.04, 0);
  solid.low[2] = -0.18;
  return solid;
}

/** Wall, floor and two spheres in the air, 1.2 to 2.8 m away.
 * \param[in] tilt of the wall across the view [slope] */
std::vector<Solid> hall(double tilt) {
  return {plane({0, 0, 2.5}, {tilt, 0.02, -1}), plane({0, 0.5, 0}, {0, -1, 0}),
          sphere({-0.4375, 0.1, 2}, 0.3), sphere({0.436, 0.15, 1.6}, 0.25)};
}

std::vector<Solid> street() {
  return {plane({0, 0, 0}, {0, 0, 1}),
          wall({3, 9, 0}, {0, 1, 0}, 40, 6),
          wall({-4, -11, 0}, {0.05, 1, 0}, 36, 5),
          wall({22, 0, 0}, {1, 0.1, 0}, 16, 7),
          pole(6, 4, 0.15, 5),
          pole(-7, 5, 0.2, 5),
          pole(9, -6, 0.12, 5),
          pole(-5, -6, 0.3, 4)};
}

}  // namespace

std::vector<Solid> namedSolids(const std::string& name) {
  if (name == "room") {
    return {plane({0, 0, 3}, {0.15, 0, -1}), plane({0, 0.7, 0}, {0, -1, 0}),
            sphere({-0.35, 0.2, 1.6}, 0.3), sphere({0.45, 0.35, 1.1}, 0.2)};
  }
  if (name == "hall") return hall(0.2);
  if (name == "frontal hall") return hall(0.1);
  if (name == "balls") {
    return {plane({0, 0, 1.7}, {0.3, 0.1, -1}), plane({0, 0.5, 1.4}, {0, -1, -0.25}),
            sphere({-0.4, -0.1, 1.35}, 0.25),   sphere({0.1, 0.15, 1.1}, 0.16),
            sphere({0.35, -0.2, 1.2}, 0.1),     sphere({-0.1, -0.2, 0.9}, 0.08),
            sphere({0.2, 0.25, 0.85}, 0.06)};
  }
  if (name == "wave40") return {waves(0.4, 0.03)};
  if (name == "wave15") return {waves(0.15, 0.01)};
  if (name == "wave6") return {waves(0.06, 0.004)};
  if (name == "street") return street();
  if (name == "figure") {
    return {sphere({0, 0, 0}, 0.09), sphere({0.02, 0.01, 0.1}, 0.05), foot()};
  }
  return {};
}

namespace {

constexpr double kRadiansPerDegree = 0.017453292519943295;
constexpr double kDepthStep = 0.03;  ///< [of depth]; neighbours that differ more are two surfaces

/** The first solid that a ray meets. */
struct Hit {
  double t = kNever;
  int solid = -1;
};

Hit firstHit(const std::vector<Solid>& solids, const Vector3& origin, const Vector3& direction) {
  Hit hit;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const double t = meet(solids[i], origin, direction);
    if (t < hit.t) hit = {t, static_cast<int>(i)};
  }
  return hit;
}

/** An image of Gaussian errors of variance 1, each the mean of a box of independent ones. */
std::vector<double> correlatedErrors(const DepthCamera& camera, std::mt19937_64& rng) {
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

Vector3 pixelRay(const DepthCamera& camera, int x, int y) {
  return {(x + 0.5 - 0.5 * camera.width) / camera.focal,
          (y + 0.5 - 0.5 * camera.height) / camera.focal, 1};
}

/** The depth that the camera measures, given the error of its disparity in px. */
double measuredDepth(const DepthCamera& camera, double depth, double error) {
  const double scale = camera.disparity_focal * camera.baseline;
  double disparity = scale / depth + camera.sigma * error;
  if (camera.step > 0) disparity = camera.step * std::round(disparity / camera.step);
  depth = scale / disparity;
  return camera.depth_step > 0 ? camera.depth_step * std::round(depth / camera.depth_step) : depth;
}

void add(const Vector3& origin, const Vector3& direction, double t, int solid, SensorScan& scan) {
  for (int a = 0; a < 3; ++a) {
    scan.points.push_back(static_cast<float>(origin[a] + t * direction[a]));
  }
  scan.solid.push_back(solid);
}

}  // namespace

std::vector<Solid> seenFrom(std::vector<Solid> solids, const Vector3& camera, double turn) {
  const double c = std::cos(turn), s = std::sin(turn);
  const auto turned = [&](const Vector3& v) {
    return Vector3{c * v[0] - s * v[2], v[1], s * v[0] + c * v[2]};
  };
  for (Solid& solid : solids) {
    solid.center = turned(subtract(solid.center, camera));
    solid.axis = turned(solid.axis);
  }
  return solids;
}

SensorScan scanByCamera(const std::vector<Solid>& solids, const DepthCamera& camera,
                        std::uint64_t seed) {
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

SensorScan scanByLidar(const std::vector<Solid>& solids, const TurningLidar& lidar,
                       std::uint64_t seed) {
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

SensorScan scanInLayers(const std::vector<Solid>& solids, const LayeredScan& layers,
                        std::uint64_t seed) {
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
