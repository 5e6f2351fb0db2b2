// SPDX-License-Identifier: BSD-3-Clause
// The balls of an object, and the view of it that a picture shows if none is given.
#include "pcl_slim/render/auto_view.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/bounding_spheres.h"

namespace pcl_slim {
namespace {

constexpr float kLeastRadius = 1e-3f;  ///< of the extent: a cloud that is one point is seen as well

/** \brief Middle and diagonal of the discs' centres, relative to their origin. */
struct CenterBox {
  std::array<double, 3> middle{};
  double diagonal = 0.0;

  explicit CenterBox(const SplatSet& splats) {
    const std::vector<float>* const columns[3] = {&splats.x, &splats.y, &splats.z};
    double diagonal_sq = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto [low, high] = std::minmax_element(columns[a]->begin(), columns[a]->end());
      middle[a] = 0.5 * (double{*low} + *high);
      diagonal_sq += (double{*high} - *low) * (double{*high} - *low);
    }
    diagonal = std::sqrt(diagonal_sq);
  }
};

}  // namespace

BoundingSpheres spheresOf(const SLIMSurface& surface) {
  BoundingSpheres object;
  object.origin = surface.info.origin;
  object.scale = surface.info.scale;
  object.diagonal = surface.info.diagonal;
  // A leaf is seen about as far as it covers, not to the rim of its support.
  object.seen_radius = 0.5 * surface.info.cover_radius;
  object.oriented = surface.info.oriented;
  object.spheres.reserve(surface.size());
  const bool above_leaves = surface.numLeaves() == 0 && !surface.child_begin.empty();
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const bool ends = above_leaves && surface.child_begin[i] == surface.child_begin[i + 1];
    if (!surface.isLeaf(i) && !ends) continue;
    object.spheres.push_back({{surface.cx[i], surface.cy[i], surface.cz[i]},
                              surface.radius[i],
                              {surface.nx[i], surface.ny[i], surface.nz[i]},
                              std::max(1.0f, surface.effective_count[i])});
  }
  return object;
}

BoundingSpheres spheresOf(const SplatSet& splats) {
  BoundingSpheres object;
  object.origin = splats.origin;
  object.seen_radius = 0.5;
  if (splats.empty()) return object;

  const CenterBox box(splats);
  for (std::size_t a = 0; a < 3; ++a) object.origin[a] += box.middle[a];
  const double widest = *std::max_element(splats.radius.begin(), splats.radius.end());
  const double extent = std::max(box.diagonal, widest);
  object.scale = extent > 0.0 ? extent : 1.0;
  const auto local = [&](float value, std::size_t axis) {
    return static_cast<float>((value - box.middle[axis]) / object.scale);
  };
  object.spheres.reserve(splats.size());
  for (std::size_t i = 0; i < splats.size(); ++i) {
    object.spheres.push_back(
        {{local(splats.x[i], 0), local(splats.y[i], 1), local(splats.z[i], 2)},
         std::max(kLeastRadius, static_cast<float>(splats.radius[i] / object.scale)),
         {splats.nx[i], splats.ny[i], splats.nz[i]},
         std::max(1.0f, splats.confidence[i])});
  }
  return object;
}

namespace {

constexpr double kClearlyLonger = 1.1;  ///< y over z, for a cloud to count as upright along y
constexpr double kOpenBelow = 0.1;      ///< mean normals that decide which of two axes is up
constexpr double kBase = 0.03;          ///< least difference of two axes' baseShare()
constexpr double kOneSided = 0.15;      ///< length of the mean normal across the upward axis
constexpr double kQuarterView = 30.0;   ///< azimuth in degrees
constexpr double kCameraFacing = 0.4;   ///< mean normal along -z of a scan in camera axes
constexpr double kClosed = 0.2;         ///< mean normal below which an object is closed
constexpr double kInside = 0.6;    ///< flux inwards, over its bound, of what surrounds its viewer
constexpr double kTilt = 14.0;     ///< [degrees] most tilt of an upright object in its file
constexpr double kTip = 10.0;      ///< [degrees] tilt at which its middle must rise
constexpr double kStands = 0.02;   ///< [height] least rise of the middle of an upright object
constexpr double kUpright = 1.05;  ///< least height of an upright object over its least extent
constexpr double kElongated = 1.3,
                 kSquare = 1.1;  ///< ratio of a map's deviations: turned in full, not

/** \brief Spheres as weighted points: each weighs the scanned points behind it, which a surface and
 * the splats of one scan have in common. */
struct SphereCloud {
  std::vector<Vector3> centers, normals;
  std::vector<double> weights;
  double total = 0.0;
  Vector3 low{}, high{};  ///< bounds of the central 98 % on each axis
  Vector3 deviation{};    ///< standard deviation along each axis, inside those bounds
  Vector3 mean_normal{0.0, 0.0, 0.0};

  explicit SphereCloud(const std::vector<BoundingSphere>& spheres);
  void measureAxis(std::size_t axis);
  /** \brief Share of the area that is flat at the lower end of an axis: the object's base. */
  double baseShare(std::size_t axis) const;
  bool empty() const { return centers.empty(); }
  double extent(std::size_t axis) const { return high[axis] - low[axis]; }
};

SphereCloud::SphereCloud(const std::vector<BoundingSphere>& spheres) {
  for (const BoundingSphere& sphere : spheres) {
    const auto &c = sphere.center, &n = sphere.normal;
    const double weight = sphere.points;
    centers.push_back({c[0], c[1], c[2]});
    normals.push_back({n[0], n[1], n[2]});
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

double SphereCloud::baseShare(std::size_t axis) const {
  constexpr double kFacing = 0.94, kNearEnd = 0.06;
  const double end = low[axis] + kNearEnd * extent(axis);
  double area = 0.0;
  for (std::size_t i = 0; i < centers.size(); ++i) {
    if (centers[i][axis] < end && std::abs(normals[i][axis]) > kFacing) area += weights[i];
  }
  return area / total;
}

Vector3 middleOf(const SphereCloud& cloud) {
  Vector3 middle{};
  for (std::size_t i = 0; i < cloud.centers.size(); ++i)
    middle = along(middle, cloud.weights[i] / cloud.total, cloud.centers[i]);
  return middle;
}

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

/** \brief How far the middle of an object must rise, over its height, for the object to tip: more
 * than 0 if it is in balance on the lower end of an axis, up to kTilt degrees off. O(spheres). */
double standing(const SphereCloud& cloud, std::size_t axis) {
  const Vector3 middle = middleOf(cloud);
  Vector3 down{};
  down[axis] = -1.0;
  std::pair<double, Vector3> rest{heightAbove(cloud, middle, down), down};
  for (double tilt = 2.0; tilt <= kTilt; tilt += 2.0)
    rest = std::min(rest, lowestAround(cloud, middle, down, tilt));
  return lowestAround(cloud, middle, rest.second, kTip).first / rest.first - 1.0;
}

/** \brief Whether a closed object is in balance along an axis, higher than it is deep, but would
 * fall over along the other one. */
bool standsAlong(const SphereCloud& cloud, std::size_t axis, std::size_t other) {
  const double least = std::min({cloud.extent(0), cloud.extent(1), cloud.extent(2)});
  return length(cloud.mean_normal) < kClosed && cloud.extent(axis) > kUpright * least &&
         standing(cloud, axis) > kStands && standing(cloud, other) < 0.5 * kStands;
}

/** \brief Flux of the normals about the middle over its bound: -1 for the inside of a sphere. */
double fluxOutwards(const SphereCloud& cloud) {
  const Vector3 middle = middleOf(cloud);
  double flux = 0.0, bound = 0.0;
  for (std::size_t i = 0; i < cloud.centers.size(); ++i) {
    const Vector3 away = subtract(cloud.centers[i], middle);
    flux += cloud.weights[i] * dot(away, cloud.normals[i]);
    bound += cloud.weights[i] * length(away);
  }
  return bound > 0.0 ? flux / bound : 0.0;
}

/** \brief A closed object whose normals face its inside. */
bool facesInside(const SphereCloud& cloud) {
  return !cloud.empty() && length(cloud.mean_normal) < kClosed && fluxOutwards(cloud) < -kInside;
}

/** \brief True when all extents but the one along axis are at least four times as long. */
bool isFlatAlong(const SphereCloud& cloud, std::size_t axis) {
  const double across = std::min(cloud.deviation[(axis + 1) % 3], cloud.deviation[(axis + 2) % 3]);
  return cloud.deviation[axis] < 0.25 * across;
}

/** \brief True when the world's origin sees the cloud as a depth camera would: in front along z,
 * at ranges a camera has, in a cone of ordinary width that the cloud fills around the axis. */
bool seenByDepthCamera(const SphereCloud& cloud, const BoundingSpheres& object) {
  const Vector3 origin = scaled(object.origin, 1.0 / object.scale);
  std::vector<double> slopes_x, slopes_y, depths;
  for (const Vector3& c : cloud.centers) {
    const Vector3 p = along(c, 1.0, origin);
    if (!(p[2] > 0.0)) return false;
    slopes_x.push_back(p[0] / p[2]);
    slopes_y.push_back(p[1] / p[2]);
    depths.push_back(p[2]);
  }
  const auto bulk = [](std::vector<double>& values) {
    std::sort(values.begin(), values.end());
    const std::size_t rim = values.size() / 50;
    return std::array<double, 2>{values[rim], values[values.size() - 1 - rim]};
  };
  const auto spans = [](const std::array<double, 2>& slopes) {
    return slopes[0] > -1.2 && slopes[0] < -0.15 && slopes[1] > 0.15 && slopes[1] < 1.2;
  };
  const auto range = bulk(depths);
  return range[0] > 0.08 * range[1] && spans(bulk(slopes_x)) && spans(bulk(slopes_y));
}

/** \brief Map coordinates: both horizontal ones far from 0, many times the cloud's size. */
bool isGeoreferenced(const BoundingSpheres& object) {
  const double far = 100.0 * object.diagonal * object.scale;
  return std::abs(object.origin[0]) > far && std::abs(object.origin[1]) > far;
}

/** \brief Terrain with its objects: map coordinates, or a cloud that is flat along its upward
 * axis. */
bool liesOnGround(const SphereCloud& cloud, const BoundingSpheres& object, std::size_t up) {
  return isFlatAlong(cloud, up) || (up == 2 && isGeoreferenced(object));
}

struct Upright {
  Vector3 up, front, right;
};

/** \brief Axes of a camera: x right, y down, z forward. */
constexpr Upright kCameraUpright{{0.0, -1.0, 0.0}, {0.0, 0.0, -1.0}, {1.0, 0.0, 0.0}};

Upright uprightOf(UpAxis axis) {
  switch (axis) {
    case UpAxis::kX: return {{1.0, 0.0, 0.0}, {0.0, -1.0, 0.0}, {0.0, 0.0, -1.0}};
    case UpAxis::kY: return {{0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}};
    default: return {{0.0, 0.0, 1.0}, {0.0, -1.0, 0.0}, {1.0, 0.0, 0.0}};
  }
}

std::size_t indexOf(UpAxis axis) {
  return axis == UpAxis::kX ? 0 : axis == UpAxis::kY ? 1 : 2;
}

/** \brief Azimuth in degrees from which horizontal extents look widest, in (-60, 120]; the less,
 * the more alike they are: a map about as long as wide is seen from the front. */
double widestAzimuth(const SphereCloud& cloud, const Upright& frame) {
  double rr = 0.0, ff = 0.0, rf = 0.0, mean_r = 0.0, mean_f = 0.0;
  for (std::size_t i = 0; i < cloud.centers.size(); ++i) {
    const double w = cloud.weights[i] / cloud.total;
    const double r = dot(cloud.centers[i], frame.right), f = dot(cloud.centers[i], frame.front);
    mean_r += w * r;
    mean_f += w * f;
    rr += w * r * r;
    ff += w * f * f;
    rf += w * r * f;
  }
  rr -= mean_r * mean_r;
  ff -= mean_f * mean_f;
  rf -= mean_r * mean_f;
  // The viewer looks along the axis of least variance.
  const double angle =
      0.5 * std::atan2(2.0 * rf, ff - rr) * 180.0 / M_PI;  // of the long axis, from front
  double azimuth = angle + 90.0;
  if (azimuth > 120.0) azimuth -= 180.0;
  const double middle = 0.5 * (rr + ff), spread = std::hypot(0.5 * (ff - rr), rf);
  const double ratio = std::sqrt((middle + spread) / std::max(middle - spread, 1e-30));
  return azimuth * std::clamp((ratio - kSquare) / (kElongated - kSquare), 0.0, 1.0);
}

ViewDirection viewFrom(const Upright& frame, double azimuth, double elevation) {
  const double a = azimuth * M_PI / 180.0, e = elevation * M_PI / 180.0;
  const Vector3 level = along(scaled(frame.front, std::cos(a)), std::sin(a), frame.right);
  // The picture's upward direction is the derivative by elevation, which is never degenerate.
  return {along(scaled(level, std::cos(e)), std::sin(e), frame.up),
          along(scaled(level, -std::sin(e)), std::cos(e), frame.up)};
}

/** \brief A viewer's position; angles in degrees. */
struct Stand {
  Upright frame;
  double azimuth = 0.0, elevation = 0.0;
};

UpAxis guessUpAxis(const SphereCloud& cloud, const BoundingSpheres& object) {
  if (cloud.empty() || isFlatAlong(cloud, 2) || isGeoreferenced(object)) return UpAxis::kZ;
  if (isFlatAlong(cloud, 1)) return UpAxis::kY;
  if (facesInside(cloud))  // a room is lower than it is wide
    return kClearlyLonger * cloud.extent(1) < cloud.extent(2) ? UpAxis::kY : UpAxis::kZ;
  if (standsAlong(cloud, 1, 2)) return UpAxis::kY;
  if (standsAlong(cloud, 2, 1)) return UpAxis::kZ;
  if (cloud.extent(1) > kClearlyLonger * cloud.extent(2)) return UpAxis::kY;
  if (cloud.extent(2) > kClearlyLonger * cloud.extent(1)) return UpAxis::kZ;
  // Neither is clearly longer: an upright object is not measured from below, or it has a flat base.
  const double open_y = cloud.mean_normal[1], open_z = cloud.mean_normal[2];
  if (object.oriented && std::abs(open_y - open_z) > kOpenBelow) {
    return open_y > open_z ? UpAxis::kY : UpAxis::kZ;
  }
  return cloud.baseShare(1) > cloud.baseShare(2) + kBase ? UpAxis::kY : UpAxis::kZ;
}

Stand chooseStand(const BoundingSpheres& object, UpAxis up) {
  const SphereCloud cloud(object.spheres);
  const bool is_auto = up == UpAxis::kAuto;
  if (cloud.empty()) return {uprightOf(up), kQuarterView, 18.0};
  if (is_auto && !isFlatAlong(cloud, 2) && seenByDepthCamera(cloud, object)) {
    return {kCameraUpright, 0.0, 7.0};
  }
  const UpAxis axis = is_auto ? guessUpAxis(cloud, object) : up;
  const Upright frame = uprightOf(axis);
  if (liesOnGround(cloud, object, indexOf(axis))) return {frame, widestAzimuth(cloud, frame), 42.0};
  if (facesInside(cloud)) return {frame, kQuarterView, 35.0};
  const bool camera_axes = is_auto && axis == UpAxis::kY && cloud.mean_normal[2] < -kCameraFacing;
  const Upright seen_from = camera_axes ? kCameraUpright : frame;
  const double facing_front = dot(cloud.mean_normal, seen_from.front);
  const double facing_right = dot(cloud.mean_normal, seen_from.right);
  if (!object.oriented || std::hypot(facing_front, facing_right) < kOneSided) {
    return {frame, kQuarterView, 18.0};
  }
  return {seen_from, std::atan2(facing_right, facing_front) * 180.0 / M_PI + 15.0, 12.0};
}

}  // namespace

ViewDirection viewFromAngles(UpAxis up, double azimuth, double elevation) {
  return viewFrom(uprightOf(up), azimuth, elevation);
}

UpAxis guessUpAxis(const BoundingSpheres& object) {
  return guessUpAxis(SphereCloud(object.spheres), object);
}

ViewDirection chooseView(const BoundingSpheres& object, UpAxis up) {
  const Stand stand = chooseStand(object, up);
  return viewFrom(stand.frame, stand.azimuth, stand.elevation);
}

bool isSeenFromInside(const BoundingSpheres& object) {
  return facesInside(SphereCloud(object.spheres));
}

std::array<double, 3> upwardsIn(const BoundingSpheres& object, UpAxis up) {
  return chooseStand(object, up).frame.up;
}

}  // namespace pcl_slim
