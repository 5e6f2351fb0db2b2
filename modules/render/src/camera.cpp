// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/camera.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "camera_rays.h"

namespace pcl_slim {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kMaxSide = 32768;

bool
isFinite(const Vector3& v)
{
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

/** \brief Per axis, the interval of centres that a view of the whole object frames. */
std::array<std::array<double, 2>, 3>
framedExtent(const SLIMSurface& surface, const std::vector<std::size_t>& leaves)
{
  std::array<std::array<double, 2>, 3> extent;
  const std::vector<float>* columns[3] = {&surface.cx, &surface.cy, &surface.cz};
  std::vector<float> values(leaves.size());
  for (int a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < leaves.size(); ++i) values[i] = (*columns[a])[leaves[i]];
    const auto quantile = [&](double share) {
      const auto k = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
      std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(k),
                       values.end());
      return static_cast<double>(values[k]);
    };
    const double low = quantile(0.01), high = quantile(0.99), slack = high - low;
    extent[a] = {low - slack - 1e-3, high + slack + 1e-3};
  }
  return extent;
}

/** \brief Balls as a frustum sees them: tight bounds along two axes and depth. */
struct FrustumFit {
  double max_right, max_left, max_up, max_down;  // max of x - tx z, -x - tx z, y - ty z, -y - ty z

  FrustumFit()
  {
    max_right = max_left = max_up = max_down = -std::numeric_limits<double>::infinity();
  }

  void add(double x, double y, double z, double radius, double tx, double ty)
  {
    const double rx = radius * std::sqrt(1.0 + tx * tx), ry = radius * std::sqrt(1.0 + ty * ty);
    max_right = std::max(max_right, x - tx * z + rx);
    max_left = std::max(max_left, -x - tx * z + rx);
    max_up = std::max(max_up, y - ty * z + ry);
    max_down = std::max(max_down, -y - ty * z + ry);
  }
};

}  // namespace

Error
Camera::validate() const
{
  const auto bad = [](const char* what) { return Error{ErrorCode::kBadArgument, what}; };
  if (size.width < 1 || size.height < 1 || size.width > kMaxSide || size.height > kMaxSide) {
    return bad("the picture's width and height must be 1 to 32768 pixels");
  }
  if (!isFinite(position) || !isFinite(look_at) || !isFinite(up)) {
    return bad("the camera's position, target and up vector must be finite numbers");
  }
  const Vector3 view = subtract(look_at, position);
  if (!(length(view) > 0.0)) return bad("the camera's position and target must differ");
  if (!(length(cross(normalized(view), normalized(up))) > 1e-6)) {
    return bad("the camera's up vector must not be zero or point along the viewing direction");
  }
  if (projection == Projection::kPerspective && !(fov > 0.0 && fov < 180.0)) {
    return bad("the camera's field of view must be between 0 and 180 degrees");
  }
  if (projection == Projection::kOrthographic &&
      !(view_height > 0.0 && std::isfinite(view_height))) {
    return bad("the orthographic view height must be positive");
  }
  return {};
}

Camera
fitCamera(const SLIMSurface& surface, const ViewDirection& direction, const ImageSize& size,
          double fov, double margin)
{
  Camera camera;
  camera.size = size;
  camera.fov = fov;
  camera.up = direction.up;
  const Vector3 origin = surface.info.origin;
  const Vector3 towards = normalized(direction.towards_viewer);
  camera.look_at = origin;
  camera.position = along(origin, 1.0, towards);
  std::vector<std::size_t> leaves;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.isLeaf(i)) leaves.push_back(i);
  }
  if (leaves.empty()) return camera;

  const CameraAxes axes(camera);
  const auto extent = framedExtent(surface, leaves);
  const double free = 1.0 - 2.0 * std::clamp(margin, 0.0, 0.4);
  const double ty = std::tan(fov * kPi / 360.0) * free, tx = ty * size.width / size.height;
  // A leaf is seen about as far as it covers, not to the rim of its support.
  const double reach = 0.5 * surface.info.cover_radius;
  FrustumFit fit;
  for (const std::size_t i : leaves) {
    const Vector3 c{surface.cx[i], surface.cy[i], surface.cz[i]};
    const bool framed = c[0] >= extent[0][0] && c[0] <= extent[0][1] && c[1] >= extent[1][0] &&
                        c[1] <= extent[1][1] && c[2] >= extent[2][0] && c[2] <= extent[2][1];
    if (!framed) continue;
    fit.add(dot(c, axes.right), dot(c, axes.up), dot(c, axes.forward), reach * surface.radius[i],
            tx, ty);
  }
  const double x = 0.5 * (fit.max_right - fit.max_left), y = 0.5 * (fit.max_up - fit.max_down);
  const double z =
      std::min(-0.5 * (fit.max_right + fit.max_left) / tx, -0.5 * (fit.max_up + fit.max_down) / ty);
  Vector3 eye = along(along(scaled(axes.right, x), y, axes.up), z, axes.forward);
  const double scale = surface.info.scale;
  camera.position = along(origin, scale, eye);
  camera.look_at = along(camera.position, scale, axes.forward);
  return camera;
}

}  // namespace pcl_slim
