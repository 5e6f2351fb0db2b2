// SPDX-License-Identifier: BSD-3-Clause
// What the pieces of an object show of its shape and of where it was seen from.
#include "camera/sphere_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace pcl_slim::detail {
namespace {

constexpr double kLevel = 0.94;   ///< cosine of what is level, to 20 degrees
constexpr double kEnd = 0.06;     ///< [extent] of what is at an end
constexpr double kUpright = 0.5;  ///< most that a wall's normal points up or down

}  // namespace

SphereCloud::SphereCloud(const BoundingSpheres& object) {
  for (const BoundingSphere& sphere : object.spheres) {
    const auto &c = sphere.center, &n = sphere.normal;
    const double weight = std::sqrt(double{sphere.points}) * sphere.radius;
    centers.push_back({c[0], c[1], c[2]});
    normals.push_back({n[0], n[1], n[2]});
    radii.push_back(std::min(1.0, 2.0 * object.seen_radius) * sphere.radius);
    weights.push_back(weight);
    total += weight;
    mean_normal = along(mean_normal, weight, {n[0], n[1], n[2]});
  }
  if (empty()) return;
  mean_normal = scaled(mean_normal, 1.0 / total);
  for (std::size_t axis = 0; axis < 3; ++axis) measureAxis(axis);
}

void SphereCloud::measureAxis(std::size_t axis) {
  std::vector<std::size_t> order(centers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return centers[a][axis] < centers[b][axis]; });
  double below = 0.0, sum = 0.0, sum_sq = 0.0, weight = 0.0;
  low[axis] = centers[order.front()][axis];
  high[axis] = centers[order.back()][axis];
  bool begun = false;
  for (const std::size_t i : order) {
    below += weights[i];
    if (below < 0.01 * total) continue;
    if (!begun) low[axis] = centers[i][axis];
    begun = true;
    const double x = centers[i][axis] - low[axis];
    sum += weights[i] * x;
    sum_sq += weights[i] * x * x;
    weight += weights[i];
    if (below < 0.99 * total) continue;
    high[axis] = centers[i][axis];
    break;
  }
  const double mean = sum / weight;
  deviation[axis] = std::sqrt(std::max(0.0, sum_sq / weight - mean * mean));
}

double SphereCloud::flatShare(const SignedAxis& up, double side) const {
  double share = 0.0;
  for (std::size_t i = 0; i < centers.size(); ++i) {
    if (heightOf(centers[i], up) < kEnd * extent(up.axis) && side * up.of(normals[i]) > kLevel)
      share += weights[i];
  }
  return share / total;
}

double SphereCloud::shelfShare(const SignedAxis& up) const {
  const double end = kEnd * extent(up.axis);
  double share = 0.0;
  for (std::size_t i = 0; i < centers.size(); ++i) {
    const double height = heightOf(centers[i], up);
    if (height > end && height < extent(up.axis) - end && up.of(normals[i]) > kLevel)
      share += weights[i];
  }
  return share / total;
}

SphereCloud::Plane SphereCloud::widestPlane() const {
  constexpr double kNear = 0.866, kAlike = 0.94;  // cosines of 30 and 20 degrees
  Plane plane{normalized(mean_normal), 0.0};
  for (int round = 0; round < 4; ++round) {
    Vector3 sum{};
    plane.share = 0.0;
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const double cosine = dot(normals[i], plane.normal);
      if (cosine > kNear) sum = along(sum, weights[i], normals[i]);
      if (cosine > kAlike) plane.share += weights[i] / total;
    }
    plane.normal = normalized(sum);
  }
  return plane;
}

Vector3 middleOf(const SphereCloud& cloud) {
  Vector3 middle{};
  for (std::size_t i = 0; i < cloud.centers.size(); ++i)
    middle = along(middle, cloud.weights[i] / cloud.total, cloud.centers[i]);
  return middle;
}

namespace {

/** \brief An object's height over the ground that it touches, by the direction that is down. */
double heightAbove(const SphereCloud& cloud, const Vector3& middle, const Vector3& down) {
  double height = 0.0;
  for (const Vector3& c : cloud.centers) height = std::max(height, dot(down, c));
  return height - dot(down, middle);
}

/** \brief The direction at an angle from another in which an object's middle is lowest, of twelve
 * ways round, and its height. */
std::pair<double, Vector3> lowestAround(const SphereCloud& cloud, const Vector3& middle,
                                        const Vector3& down, double degrees) {
  constexpr int kWays = 12;
  const double tilt = degrees * M_PI / 180.0;
  const Vector3 any = std::abs(down[0]) < 0.6 ? Vector3{1.0, 0.0, 0.0} : Vector3{0.0, 1.0, 0.0};
  const Vector3 u = normalized(cross(down, any)), v = cross(down, u);
  std::pair<double, Vector3> lowest{HUGE_VAL, down};
  for (int k = 0; k < kWays; ++k) {
    const double way = 2.0 * M_PI * k / kWays;
    const Vector3 tilted =
        along(along(scaled(down, std::cos(tilt)), std::sin(tilt) * std::cos(way), u),
              std::sin(tilt) * std::sin(way), v);
    const double height = heightAbove(cloud, middle, tilted);
    if (height < lowest.first) lowest = {height, tilted};
  }
  return lowest;
}

}  // namespace

double standing(const SphereCloud& cloud, const SignedAxis& up) {
  constexpr double kTilt = 14.0;  // [degrees] most tilt of an upright object in its file
  constexpr double kTip = 10.0;   // [degrees] tilt at which its middle must rise
  const Vector3 middle = middleOf(cloud), down = scaled(up.direction(), -1.0);
  std::pair<double, Vector3> rest{heightAbove(cloud, middle, down), down};
  for (double tilt = 2.0; tilt <= kTilt; tilt += 2.0)
    rest = std::min(rest, lowestAround(cloud, middle, down, tilt));
  return lowestAround(cloud, middle, rest.second, kTip).first / rest.first - 1.0;
}

namespace {

constexpr std::size_t kMostPieces = 20000;  ///< that a vantage is looked for with
constexpr int kDirections = 256;

/** rief Directions evenly over the sphere, along a spiral (Fibonacci's). */
std::vector<Vector3> evenDirections() {
  constexpr double kGoldenAngle = 2.39996322972865332;
  std::vector<Vector3> directions;
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kDirections, r = std::sqrt(1.0 - z * z);
    directions.push_back({r * std::cos(kGoldenAngle * i), r * std::sin(kGoldenAngle * i), z});
  }
  return directions;
}

/** rief Every step-th piece, each with a radius as much larger. */
struct Pieces {
  const SphereCloud& cloud;
  std::size_t step;
  double growth;

  explicit Pieces(const SphereCloud& all)
      : cloud(all), step(1 + all.centers.size() / kMostPieces), growth(std::sqrt(double(step))) {}

  /** rief How far in front of a piece a place is; below 0: behind. */
  double height(std::size_t i, const Vector3& place) const {
    return dot(cloud.normals[i], subtract(place, cloud.centers[i]));
  }
  double facing(const Vector3& place) const {
    double sum = 0.0, all = 0.0;
    for (std::size_t i = 0; i < cloud.centers.size(); i += step) {
      all += cloud.weights[i];
      if (height(i, place) > 0.0) sum += cloud.weights[i];
    }
    return sum / all;
  }
  /** rief The mean correction that brings a place before the pieces it is behind. */
  Vector3 correction(const Vector3& place, double least) const {
    Vector3 sum{};
    double weight = 0.0;
    for (std::size_t i = 0; i < cloud.centers.size(); i += step) {
      const double lacking = least - height(i, place);
      if (lacking <= 0.0) continue;
      sum = along(sum, cloud.weights[i] * lacking, cloud.normals[i]);
      weight += cloud.weights[i];
    }
    return weight > 0.0 ? scaled(sum, 1.0 / weight) : sum;
  }
};

/** rief Which pieces are met first from the vantage's place. */
void lookAround(const Pieces& pieces, Vantage& vantage) {
  const SphereCloud& cloud = pieces.cloud;
  vantage.directions = evenDirections();
  vantage.depths.assign(vantage.directions.size(), HUGE_VAL);
  vantage.met.assign(vantage.directions.size(), 0);
  std::vector<double> first(vantage.directions.size(), HUGE_VAL);
  for (std::size_t i = 0; i < cloud.centers.size(); i += pieces.step) {
    const Vector3 seen = subtract(cloud.centers[i], vantage.place);
    const double height = dot(cloud.normals[i], seen);
    const double reach = pieces.growth * cloud.radii[i];
    for (std::size_t k = 0; k < first.size(); ++k) {
      const Vector3& ray = vantage.directions[k];
      const double t = height / dot(cloud.normals[i], ray);
      if (!(t > 0.0) || t >= first[k]) continue;
      const Vector3 off = subtract(scaled(ray, t), seen);
      if (dot(off, off) > reach * reach) continue;
      first[k] = t;
      vantage.met[k] = i;
      vantage.depths[k] = height < 0.0 ? t : HUGE_VAL;
    }
  }
  const auto met = std::count_if(vantage.depths.begin(), vantage.depths.end(),
                                 [](double depth) { return std::isfinite(depth); });
  vantage.surrounded = double(met) / double(first.size());
}

}  // namespace

double Vantage::walledIn(const SphereCloud& cloud, const SignedAxis& up) const {
  constexpr double kBelt = 0.5;  // sine of 30 degrees
  std::array<bool, 24> walls{};
  const std::size_t u = (up.axis + 1) % 3, v = (up.axis + 2) % 3;
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const Vector3& d = directions[k];
    if (std::abs(d[up.axis]) > kBelt || !std::isfinite(depths[k]) ||
        std::abs(cloud.normals[met[k]][up.axis]) > kUpright)
      continue;
    const double turn = std::atan2(d[u], d[v]) / (2.0 * M_PI) + 0.5;
    walls[static_cast<std::size_t>(turn * walls.size()) % walls.size()] = true;
  }
  return double(std::count(walls.begin(), walls.end(), true)) / double(walls.size());
}

double wallsOneWay(const SphereCloud& cloud, const SignedAxis& up) {
  double most = 0.0, walls = 0.0;
  for (int k = 0; k < 8; ++k) {
    const double turn = M_PI * k / 4.0;
    Vector3 direction{};
    direction[(up.axis + 1) % 3] = std::cos(turn);
    direction[(up.axis + 2) % 3] = std::sin(turn);
    double facing = 0.0;
    walls = 0.0;
    for (std::size_t i = 0; i < cloud.normals.size(); ++i) {
      if (std::abs(cloud.normals[i][up.axis]) > kUpright) continue;
      walls += cloud.weights[i];
      if (dot(cloud.normals[i], direction) > 0.0) facing += cloud.weights[i];
    }
    most = std::max(most, facing);
  }
  return walls > 0.0 ? most / walls : 1.0;
}

Vantage findVantage(const SphereCloud& cloud, const Vector3& origin) {
  constexpr int kSteps = 60;
  constexpr double kPlain = 0.97;      // share that faces a place that is good enough
  constexpr double kClearance = 0.02;  // [extent] before the pieces
  const Pieces pieces(cloud);
  const double extent = length(subtract(cloud.high, cloud.low));
  const auto inside = [&cloud](Vector3 p) {
    for (std::size_t a = 0; a < 3; ++a) p[a] = std::clamp(p[a], cloud.low[a], cloud.high[a]);
    return p;
  };
  Vantage best;
  const auto consider = [&](const Vector3& place) {
    const double facing = pieces.facing(place);
    if (facing <= best.facing) return;
    best.place = place;
    best.facing = facing;
  };
  if (inside(origin) == origin) consider(origin);
  Vector3 place = middleOf(cloud);
  for (int step = 0; step < kSteps && best.facing < kPlain; ++step) {
    consider(place);
    place = inside(along(place, 1.5, pieces.correction(place, kClearance * extent)));
  }
  lookAround(pieces, best);
  return best;
}

}  // namespace pcl_slim::detail
