// SPDX-License-Identifier: BSD-3-Clause
// Rays of a camera, where balls land in its picture, and which blocks of a surface it needs.
#include "camera/camera_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/render/frame_blocks.h"
#include "pcl_slim/surface/detail/detail_sizes.h"

namespace pcl_slim::detail {
namespace {

/** \brief floor() kept inside the range of pixel coordinates. */
int pixelOf(double coordinate, int size) {
  return static_cast<int>(std::floor(std::clamp(coordinate, -2.0, size + 2.0)));
}

}  // namespace

FrameView::FrameView(const Camera& camera, const Vector3& origin, double scale)
    : perspective(camera.projection == Camera::Projection::kPerspective),
      width(camera.size.width),
      height(camera.size.height) {
  const CameraAxes axes(camera);
  for (std::size_t a = 0; a < 3; ++a) {
    const double position = (camera.position[a] - origin[a]) / scale;
    eye[a] = static_cast<float>(position);
    eye_rest[a] = static_cast<float>(position - eye[a]);
    right[a] = static_cast<float>(axes.right[a]);
    up[a] = static_cast<float>(axes.up[a]);
    forward[a] = static_cast<float>(axes.forward[a]);
  }
  const double view_height =
      perspective ? 2.0 * std::tan(camera.fov * M_PI / 360.0) : camera.view_height / scale;
  pixel = static_cast<float>(view_height / height);
  center_x = static_cast<float>(0.5 * (width - 1) - camera.pixel_offset[0]);
  center_y = static_cast<float>(0.5 * (height - 1) - camera.pixel_offset[1]);
}

CameraAxes::CameraAxes(const Camera& camera) {
  forward = normalized(subtract(camera.look_at, camera.position));
  right = normalized(cross(forward, camera.up));
  up = cross(right, forward);
}

CameraRays::CameraRays(const Camera& camera, const Vector3& origin, double scale)
    : axes_(camera),
      eye_(scaled(subtract(camera.position, origin), 1.0 / scale)),
      perspective_(camera.projection == Camera::Projection::kPerspective),
      width_(camera.size.width),
      height_(camera.size.height) {
  const double view_height =
      perspective_ ? 2.0 * std::tan(camera.fov * M_PI / 360.0) : camera.view_height / scale;
  pixel_ = view_height / height_;
  center_x_ = 0.5 * (width_ - 1) - camera.pixel_offset[0];
  center_y_ = 0.5 * (height_ - 1) - camera.pixel_offset[1];
}

Ray CameraRays::ray(int x, int y) const {
  const auto [px, py] = inPlane(x, y);
  const Vector3 offset = along(scaled(axes_.right, px), py, axes_.up);
  if (!perspective_) return {along(eye_, 1.0, offset), axes_.forward};
  return {eye_, normalized(along(axes_.forward, 1.0, offset))};
}

double CameraRays::pixelLength(const Vector3& point) const {
  if (!perspective_) return pixel_;
  return pixel_ * std::max(0.0, dot(subtract(point, eye_), axes_.forward));
}

double CameraRays::nearestDepth(const Vector3& center, double radius) const {
  const Vector3 to_center = subtract(center, eye_);
  return (perspective_ ? length(to_center) : dot(to_center, axes_.forward)) - radius;
}

Vector3 CameraRays::directionTo(const Vector3& point) const {
  return perspective_ ? normalized(subtract(point, eye_)) : axes_.forward;
}

double CameraRays::halfAngle(const Vector3& center, double radius) const {
  if (!perspective_) return 0.0;
  const double distance = length(subtract(center, eye_));
  return distance > radius ? std::asin(radius / distance) : M_PI / 2.0;
}

std::array<double, 2> CameraRays::planeRange(double offset, double depth, double radius) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (!perspective_) return {offset - radius, offset + radius};
  const double distance = std::hypot(offset, depth);
  if (distance <= radius) return {-kInfinity, kInfinity};
  const double angle = std::atan2(offset, depth), half = std::asin(radius / distance);
  if (angle - half >= M_PI / 2.0 || angle + half <= -M_PI / 2.0) return {kInfinity, -kInfinity};
  return {angle - half <= -M_PI / 2.0 ? -kInfinity : std::tan(angle - half),
          angle + half >= M_PI / 2.0 ? kInfinity : std::tan(angle + half)};
}

PixelRect CameraRays::pixelsOfBall(const Vector3& center, double radius) const {
  const Vector3 p = subtract(center, eye_);
  const double depth = dot(p, axes_.forward);
  if (depth + radius <= 0.0) return {};
  const auto [left, right] = planeRange(dot(p, axes_.right), depth, radius);
  const auto [low, high] = planeRange(dot(p, axes_.up), depth, radius);
  if (left > right || low > high) return {};
  PixelRect rect;
  rect.x0 = std::max(0, pixelOf(left / pixel_ + center_x_, width_));
  rect.x1 = std::min(width_ - 1, pixelOf(right / pixel_ + center_x_, width_) + 1);
  rect.y0 = std::max(0, pixelOf(center_y_ - high / pixel_, height_));
  rect.y1 = std::min(height_ - 1, pixelOf(center_y_ - low / pixel_, height_) + 1);
  return rect;
}

}  // namespace pcl_slim::detail

namespace pcl_slim {

using namespace detail;

namespace {

bool reaches(const SLIMSurface& s, std::size_t i, const SlimBlock& block) {
  const float center[3] = {s.cx[i], s.cy[i], s.cz[i]};
  bool meets = true;
  for (std::size_t a = 0; a < 3; ++a) {
    meets = meets && center[a] + s.radius[i] >= block.low[a] &&
            center[a] - s.radius[i] <= block.high[a];
  }
  return meets;
}

/** Finest level that the surfels above a tile have in it; 0: none. */
int finestLevel(const SLIMSurface& s, const SlimBlock& block) {
  int finest = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const std::uint64_t key = mortonCode(s.cx[i], s.cy[i], s.cz[i]);
    if (key >= block.first_key && key < block.end_key) finest = std::max<int>(finest, s.level[i]);
  }
  return finest;
}

}  // namespace

std::vector<bool> blocksOfFrame(const SlimDirectory& directory, const SLIMSurface& coarse,
                                const Camera& camera, double lod) {
  const DetailSizes sizes(coarse);
  const SurfaceInfo& info = directory.info;
  const CameraRays rays(camera, info.origin, info.scale);
  std::vector<bool> drawn_whole(coarse.size());  // drawn in place of all below it
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    const Vector3 center{coarse.cx[i], coarse.cy[i], coarse.cz[i]};
    drawn_whole[i] = rays.nearestDepth(center, double{coarse.radius[i]}) > 0.0 &&
                     double{sizes.own[i]} < 0.5 * lod * rays.pixelLength(center);
  }
  std::vector<bool> needed;
  for (const SlimBlock& block : directory.blocks) {
    const int finest = finestLevel(coarse, block);
    bool needs = finest == 0;
    for (std::size_t i = 0; i < coarse.size() && !needs; ++i)
      needs = !drawn_whole[i] && coarse.level[i] >= finest && reaches(coarse, i, block);
    needed.push_back(needs || block.isCoarse());
  }
  return needed;
}

}  // namespace pcl_slim
