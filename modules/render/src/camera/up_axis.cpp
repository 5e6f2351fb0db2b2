// SPDX-License-Identifier: BSD-3-Clause
// Which of the six directions along the axes is up in an object, and how it was seen.
#include "camera/up_axis.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pcl_slim::detail {
namespace {

constexpr SignedAxis kYUp{1, 1.0}, kZUp{2, 1.0}, kYDown{1, -1.0}, kZDown{2, -1.0};

constexpr double kOneSided = 0.4;  ///< mean normal of what was seen from one side
constexpr double kClosed = 0.2;    ///< mean normal below which an object is closed
constexpr double kUneven = 0.12;   ///< mean normal to one side of an object seen better from there
constexpr double kFloor = 0.1;     ///< share of the area that makes a floor

/** \brief True when both extents across an axis are at least four times as long. */
bool isFlatAlong(const SphereCloud& cloud, std::size_t axis) {
  const double across = std::min(cloud.deviation[(axis + 1) % 3], cloud.deviation[(axis + 2) % 3]);
  return cloud.deviation[axis] < 0.25 * across;
}

/** \brief Share of the area that is level where an axis is upright. */
double levelShare(const SphereCloud& cloud, std::size_t axis) {
  double share = 0.0;
  for (const double sign : {1.0, -1.0})
    share += cloud.flatShare({axis, sign}, 1.0) + cloud.shelfShare({axis, sign}) +
             cloud.flatShare({axis, sign}, -1.0);
  return share;
}

/** \brief Map coordinates: both horizontal ones far from 0, many times the cloud's size. */
bool isGeoreferenced(const BoundingSpheres& object) {
  const double far = 100.0 * object.diagonal * object.scale;
  return std::abs(object.origin[0]) > far && std::abs(object.origin[1]) > far;
}

/** \brief True when the world's origin sees the cloud as a camera that looks along z (way 1) or
 * against it (-1): in front, at ranges a camera has, in a cone of ordinary width that the cloud
 * fills around the axis. */
bool seenFromOrigin(const SphereCloud& cloud, const Vector3& origin, double way) {
  std::vector<double> slopes_x, slopes_y, depths;
  for (std::size_t i = 0; i < cloud.centers.size(); ++i) {
    const Vector3 p = subtract(cloud.centers[i], origin);
    const double depth = way * p[2];
    if (!(depth > 0.0)) return false;
    for (const double side : {-0.5, 0.5}) {
      slopes_x.push_back((p[0] + side * cloud.radius) / depth);
      slopes_y.push_back((p[1] + side * cloud.radius) / depth);
    }
    depths.push_back(depth);
  }
  const auto bulk = [](std::vector<double>& values) {
    std::sort(values.begin(), values.end());
    const std::size_t rim = values.size() / 50;
    return std::array<double, 2>{values[rim], values[values.size() - 1 - rim]};
  };
  const auto spans = [](const std::array<double, 2>& slopes) {
    return slopes[0] > -1.2 && slopes[0] < -0.1 && slopes[1] > 0.1 && slopes[1] < 1.2 &&
           slopes[1] - slopes[0] > 0.3;
  };
  const auto range = bulk(depths);
  return range[0] > 0.08 * range[1] && spans(bulk(slopes_x)) && spans(bulk(slopes_y));
}

/** \brief Whether a closed object is in balance along an axis but would fall over along the other
 * one; at once, if it is flattest the way that it is in balance. */
bool standsAlong(const SphereCloud& cloud, const SignedAxis& axis, const SignedAxis& other) {
  constexpr double kStands = 0.02;   // [height] least rise of the middle of an upright object
  constexpr double kUpright = 1.05;  // least height of an upright object over its least extent
  if (length(cloud.mean_normal) > kClosed) return false;
  const double rise = standing(cloud, axis), other_rise = standing(cloud, other);
  const double least = std::min({cloud.extent(0), cloud.extent(1), cloud.extent(2)});
  const bool upright = cloud.extent(axis.axis) > kUpright * least;
  return rise > kStands && other_rise < (upright ? 0.5 * kStands : 0.0);
}

/** \brief Up in an object seen from most sides: y or z. */
SignedAxis upOfObject(const SphereCloud& cloud) {
  constexpr double kClearlyLonger = 1.14;
  constexpr double kOpenBelow = 0.1;  // mean normals that decide which of two axes is up
  constexpr double kBase = 0.03;      // least difference of two axes' flat ends
  constexpr double kLevel = 0.5;      // share of the area of a table that is level
  if (isFlatAlong(cloud, 2) || levelShare(cloud, 2) > kLevel) return kZUp;
  if (isFlatAlong(cloud, 1) || levelShare(cloud, 1) > kLevel) return kYUp;
  if (standsAlong(cloud, kYUp, kZUp)) return kYUp;
  if (standsAlong(cloud, kZUp, kYUp)) return kZUp;
  if (cloud.extent(1) > kClearlyLonger * cloud.extent(2)) return kYUp;
  if (cloud.extent(2) > kClearlyLonger * cloud.extent(1)) return kZUp;
  // Neither is clearly longer: an upright object is not measured from below, or it has a flat base.
  const double open_y = cloud.mean_normal[1], open_z = cloud.mean_normal[2];
  if (std::abs(open_y - open_z) > kOpenBelow) return open_y > open_z ? kYUp : kZUp;
  const auto base = [&cloud](const SignedAxis& up) {
    return cloud.flatShare(up, -1.0) + cloud.flatShare(up, 1.0);
  };
  return base(kYUp) > base(kZUp) + kBase ? kYUp : kZUp;
}

/** \brief Up in what was seen from one side or from inside: the largest floor decides, with what is
 * level above it, then the axis along which the scene is lower. What most of the scene faces is up
 * only if it is a floor. Files have z up more often than y, and these more often than y down, as in
 * a camera's axes, which then sees the scene along z as well, or z down. */
SignedAxis upOfScene(const SphereCloud& cloud, bool inside) {
  struct Candidate {
    SignedAxis up;
    double usual;
  };
  const bool before_camera = cloud.mean_normal[2] < -0.15;
  const std::array<Candidate, 4> candidates = {
      {{kZUp, 0.10}, {kYUp, 0.06}, {kYDown, before_camera ? 0.11 : 0.02}, {kZDown, 0.0}}};
  const double longest = std::max({cloud.extent(0), cloud.extent(1), cloud.extent(2)});
  SignedAxis best = kZUp;
  double most = -HUGE_VAL;
  for (const Candidate& candidate : candidates) {
    const SignedAxis& up = candidate.up;
    if (up.axis == 1 && up.sign < 0 && !before_camera && !inside) continue;
    const double floor = cloud.flatShare(up, 1.0);
    const double shelves = cloud.shelfShare(up) - cloud.shelfShare({up.axis, -up.sign});
    double score =
        candidate.usual + floor + shelves + 0.2 * (1.0 - cloud.extent(up.axis) / longest);
    if (floor < kFloor) score -= 0.5 * std::abs(up.of(cloud.mean_normal));
    if (score <= most) continue;
    most = score;
    best = up;
  }
  return best;
}

/** \brief A flat sheet is ground unless it faces against y, as a house's front does. */
SignedAxis upOfSheet(const SphereCloud& cloud, std::size_t axis) {
  if (axis == 0) return kZUp;
  if (axis == 2) return cloud.mean_normal[2] < 0.0 ? kZDown : kZUp;
  return cloud.mean_normal[1] < 0.0 ? kZUp : kYUp;
}

/** \brief Up of what was seen from one side. */
SignedAxis upOfSide(const SphereCloud& cloud) {
  for (const std::size_t axis : {2u, 1u, 0u}) {
    if (isFlatAlong(cloud, axis)) return upOfSheet(cloud, axis);
  }
  return upOfScene(cloud, false);
}

}  // namespace

Upright findUpright(const SphereCloud& cloud, const BoundingSpheres& object,
                    const SignedAxis* given) {
  constexpr double kFaces = 0.8;     // share that faces a place from which all was seen
  constexpr double kEnclosed = 0.8;  // share of directions that a room fills
  constexpr double kAround = 0.7;    // share of the horizon where a station sees walls
  Upright found;
  const auto upOr = [given](const SignedAxis& up) { return given != nullptr ? *given : up; };
  const Vector3 origin = scaled(object.origin, -1.0 / object.scale);
  const double one_sided = length(cloud.mean_normal);
  if (isGeoreferenced(object)) return {upOr(kZUp), SceneKind::kGround, {}};
  if (given == nullptr && one_sided > kClosed) {
    for (const double way : {1.0, -1.0}) {
      // Files in camera axes may have turned sides; against z, the sides are the only evidence.
      const bool faces = way * cloud.mean_normal[2] < 0.0;
      if ((faces || way > 0.0) && seenFromOrigin(cloud, origin, way))
        return {way > 0.0 ? kYDown : kYUp, SceneKind::kCamera, {}};
    }
  }
  found.vantage = findVantage(cloud, origin);
  if (found.vantage.facing > kFaces) {
    const bool room = found.vantage.surrounded > kEnclosed;
    found.up = upOr(upOfScene(cloud, room));
    found.kind = room ? SceneKind::kInside : SceneKind::kStation;
    if (room || found.vantage.walledIn(cloud, found.up) > kAround) return found;
  }
  if (one_sided > kOneSided) {
    found.up = upOr(upOfSide(cloud));
    const bool ground =
        found.up.of(cloud.mean_normal) > 0.7 * one_sided && isFlatAlong(cloud, found.up.axis);
    found.kind = ground ? SceneKind::kGround : SceneKind::kOneSide;
    return found;
  }
  found.up = upOr(upOfObject(cloud));
  const double upwards = found.up.of(cloud.mean_normal);
  const double sideways = std::sqrt(std::max(0.0, one_sided * one_sided - upwards * upwards));
  found.kind = isFlatAlong(cloud, found.up.axis) ? SceneKind::kGround
               : sideways > kUneven              ? SceneKind::kOneSide
                                                 : SceneKind::kObject;
  return found;
}

}  // namespace pcl_slim::detail
