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

namespace {

constexpr int kCells = 40;  ///< along the longest extent

/** \brief Sums of places and normals in the cells of a grid, by the way that the normals face. */
class CellSums {
 public:
  explicit CellSums(const std::vector<BoundingSphere>& spheres);

  /** \brief Adds places all over a disc, a cell apart. */
  void addDisc(const Vector3& center, const Vector3& normal, double radius);
  void moveTo(SphereCloud& cloud) const;
  double cell() const { return cell_; }

 private:
  struct Sum {
    float place[3] = {}, normal[3] = {}, count = 0.0f;
  };

  void add(const Vector3& place, const Vector3& normal);

  Vector3 low_{};
  double cell_ = 1.0;
  std::array<std::size_t, 3> size_{};
  std::vector<Sum> sums_;
};

CellSums::CellSums(const std::vector<BoundingSphere>& spheres) {
  Bounds box;
  for (const BoundingSphere& sphere : spheres)
    box.add({sphere.center[0], sphere.center[1], sphere.center[2]});
  const Vector3 extent = subtract(box.high, box.low);
  const double longest = std::max({extent[0], extent[1], extent[2]});
  if (longest > 0.0) cell_ = longest / kCells;
  for (std::size_t a = 0; a < 3; ++a) {
    size_[a] = 3 + static_cast<std::size_t>(extent[a] / cell_);
    low_[a] = box.low[a] - cell_;
  }
  sums_.resize(6 * size_[0] * size_[1] * size_[2]);
}

void CellSums::add(const Vector3& place, const Vector3& normal) {
  std::size_t at = 0, axis = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double x = (place[a] - low_[a]) / cell_;
    if (!(x >= 0.0) || x >= double(size_[a])) return;
    at = at * size_[a] + static_cast<std::size_t>(x);
    if (std::abs(normal[a]) > std::abs(normal[axis])) axis = a;
  }
  Sum& sum = sums_[6 * at + 2 * axis + (normal[axis] < 0.0 ? 1 : 0)];
  for (std::size_t a = 0; a < 3; ++a) {
    sum.place[a] += static_cast<float>(place[a]);
    sum.normal[a] += static_cast<float>(normal[a]);
  }
  sum.count += 1.0f;
}

void CellSums::addDisc(const Vector3& center, const Vector3& normal, double radius) {
  const Vector3 any = std::abs(normal[0]) < 0.6 ? Vector3{1.0, 0.0, 0.0} : Vector3{0.0, 1.0, 0.0};
  const Vector3 u = normalized(cross(normal, any)), v = cross(normal, u);
  const int reach = static_cast<int>(std::min(radius / cell_, double(kCells)));
  for (int i = -reach; i <= reach; ++i) {
    for (int k = -reach; k <= reach; ++k) {
      if (double(i) * i + double(k) * k > double(reach) * reach) continue;
      add(along(along(center, i * cell_, u), k * cell_, v), normal);
    }
  }
}

void CellSums::moveTo(SphereCloud& cloud) const {
  for (const Sum& sum : sums_) {
    if (sum.count == 0.0f) continue;
    Vector3 place, normal;
    for (std::size_t a = 0; a < 3; ++a) {
      place[a] = sum.place[a] / sum.count;
      normal[a] = sum.normal[a];
    }
    cloud.centers.push_back(place);
    cloud.normals.push_back(normalized(normal));
  }
}

}  // namespace

SphereCloud::SphereCloud(const BoundingSpheres& object) {
  const std::vector<BoundingSphere> framed = framedSpheres(object);
  if (framed.empty()) return;
  CellSums cells(framed);
  for (const BoundingSphere& sphere : framed) {
    const auto &c = sphere.center, &n = sphere.normal;
    cells.addDisc({c[0], c[1], c[2]}, {n[0], n[1], n[2]}, object.seen_radius * sphere.radius);
  }
  cells.moveTo(*this);
  radius = cells.cell();
  for (const Vector3& normal : normals)
    mean_normal = along(mean_normal, 1.0 / double(normals.size()), normal);
  for (std::size_t axis = 0; axis < 3; ++axis) measureAxis(axis);
}

void SphereCloud::measureAxis(std::size_t axis) {
  std::vector<double> values;
  for (const Vector3& center : centers) values.push_back(center[axis]);
  std::sort(values.begin(), values.end());
  const std::size_t rim = values.size() / 100;
  low[axis] = values[rim];
  high[axis] = values[values.size() - 1 - rim];
  double sum = 0.0, sum_sq = 0.0, count = 0.0;
  for (std::size_t i = rim; i < values.size() - rim; ++i) {
    const double x = values[i] - low[axis];
    sum += x;
    sum_sq += x * x;
    count += 1.0;
  }
  const double mean = sum / count;
  deviation[axis] = std::sqrt(std::max(0.0, sum_sq / count - mean * mean));
}

double SphereCloud::flatShare(const SignedAxis& up, double side) const {
  double share = 0.0;
  for (std::size_t i = 0; i < centers.size(); ++i) {
    if (heightOf(centers[i], up) < kEnd * extent(up.axis) && side * up.of(normals[i]) > kLevel)
      share += 1.0;
  }
  return share / double(centers.size());
}

double SphereCloud::shelfShare(const SignedAxis& up) const {
  const double end = kEnd * extent(up.axis);
  double share = 0.0;
  for (std::size_t i = 0; i < centers.size(); ++i) {
    const double height = heightOf(centers[i], up);
    if (height > end && height < extent(up.axis) - end && up.of(normals[i]) > kLevel) share += 1.0;
  }
  return share / double(centers.size());
}

Vector3 middleOf(const SphereCloud& cloud) {
  Vector3 middle{};
  for (const Vector3& center : cloud.centers)
    middle = along(middle, 1.0 / double(cloud.centers.size()), center);
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

constexpr int kDirections = 256;

/** \brief Directions evenly over the sphere, along a spiral (Fibonacci's). */
std::vector<Vector3> evenDirections() {
  constexpr double kGoldenAngle = 2.39996322972865332;
  std::vector<Vector3> directions;
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kDirections, r = std::sqrt(1.0 - z * z);
    directions.push_back({r * std::cos(kGoldenAngle * i), r * std::sin(kGoldenAngle * i), z});
  }
  return directions;
}

/** \brief How far in front of a piece a place is; below 0: behind. */
double inFront(const SphereCloud& cloud, std::size_t i, const Vector3& place) {
  return dot(cloud.normals[i], subtract(place, cloud.centers[i]));
}

double shareFacing(const SphereCloud& cloud, const Vector3& place) {
  double facing = 0.0;
  for (std::size_t i = 0; i < cloud.centers.size(); ++i) facing += inFront(cloud, i, place) > 0.0;
  return facing / double(cloud.centers.size());
}

/** \brief The mean correction that brings a place before the pieces it is behind. */
Vector3 correction(const SphereCloud& cloud, const Vector3& place, double least) {
  Vector3 sum{};
  double count = 0.0;
  for (std::size_t i = 0; i < cloud.centers.size(); ++i) {
    const double lacking = least - inFront(cloud, i, place);
    if (lacking <= 0.0) continue;
    sum = along(sum, lacking, cloud.normals[i]);
    count += 1.0;
  }
  return count > 0.0 ? scaled(sum, 1.0 / count) : sum;
}

/** \brief Which pieces are met first from the vantage's place. */
void lookAround(const SphereCloud& cloud, Vantage& vantage) {
  vantage.directions = evenDirections();
  vantage.depths.assign(vantage.directions.size(), HUGE_VAL);
  vantage.met.assign(vantage.directions.size(), 0);
  std::vector<double> first(vantage.directions.size(), HUGE_VAL);
  for (std::size_t i = 0; i < cloud.centers.size(); ++i) {
    const Vector3 seen = subtract(cloud.centers[i], vantage.place);
    const double height = dot(cloud.normals[i], seen);
    for (std::size_t k = 0; k < first.size(); ++k) {
      const Vector3& ray = vantage.directions[k];
      const double t = height / dot(cloud.normals[i], ray);
      if (!(t > 0.0) || t >= first[k]) continue;
      const Vector3 off = subtract(scaled(ray, t), seen);
      if (dot(off, off) > cloud.radius * cloud.radius) continue;
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

Vantage findVantage(const SphereCloud& cloud, const Vector3& origin) {
  constexpr int kSteps = 60;
  constexpr double kPlain = 0.97;      // share that faces a place that is good enough
  constexpr double kClearance = 0.02;  // [extent] before the pieces
  const double extent = length(subtract(cloud.high, cloud.low));
  const auto inside = [&cloud](Vector3 p) {
    for (std::size_t a = 0; a < 3; ++a) p[a] = std::clamp(p[a], cloud.low[a], cloud.high[a]);
    return p;
  };
  Vantage best;
  const auto consider = [&](const Vector3& place) {
    const double facing = shareFacing(cloud, place);
    if (facing <= best.facing) return;
    best.place = place;
    best.facing = facing;
  };
  if (inside(origin) == origin) consider(origin);
  Vector3 place = middleOf(cloud);
  for (int step = 0; step < kSteps && best.facing < kPlain; ++step) {
    consider(place);
    place = inside(along(place, 1.5, correction(cloud, place, kClearance * extent)));
  }
  lookAround(cloud, best);
  return best;
}

}  // namespace pcl_slim::detail
