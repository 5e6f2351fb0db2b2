// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/camera.h"

#include <algorithm>
#include <vector>

#include "camera/camera_rays.h"

namespace pcl_slim {

using namespace detail;
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

/** \brief Leaves a view of the whole object has to show. */
std::vector<std::size_t>
framedLeaves(const SLIMSurface& surface)
{
  std::vector<std::size_t> leaves, framed;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.isLeaf(i)) leaves.push_back(i);
  }
  if (leaves.empty()) return framed;
  const auto extent = framedExtent(surface, leaves);
  for (const std::size_t i : leaves) {
    const float c[3] = {surface.cx[i], surface.cy[i], surface.cz[i]};
    bool inside = true;
    for (std::size_t a = 0; a < 3; ++a) {
      inside = inside && c[a] >= extent[a][0] && c[a] <= extent[a][1];
    }
    if (inside) framed.push_back(i);
  }
  return framed;
}

/** \brief Balls as a frustum with half widths tx, ty at depth 1 sees them: bounds of x - tx z,
 * -x - tx z, y - ty z, -y - ty z and of z in camera axes. */
struct FrustumFit {
  double max_right = -HUGE_VAL, max_left = -HUGE_VAL, max_up = -HUGE_VAL, max_down = -HUGE_VAL;
  double min_depth = HUGE_VAL;

  FrustumFit(const SLIMSurface& surface, const std::vector<std::size_t>& leaves,
             const CameraAxes& axes, double tx, double ty)
  {
    // A leaf is seen about as far as it covers, not to the rim of its support.
    const double reach = 0.5 * surface.info.cover_radius;
    const double reach_x = reach * std::sqrt(1.0 + tx * tx),
                 reach_y = reach * std::sqrt(1.0 + ty * ty);
    for (const std::size_t i : leaves) {
      const Vector3 c{surface.cx[i], surface.cy[i], surface.cz[i]};
      const double x = dot(c, axes.right), y = dot(c, axes.up), z = dot(c, axes.forward);
      const double r = surface.radius[i];
      max_right = std::max(max_right, x - tx * z + reach_x * r);
      max_left = std::max(max_left, -x - tx * z + reach_x * r);
      max_up = std::max(max_up, y - ty * z + reach_y * r);
      max_down = std::max(max_down, -y - ty * z + reach_y * r);
      min_depth = std::min(min_depth, z - r);
    }
  }
};

/** \brief A camera that looks the right way from one world unit off the surface's origin. */
Camera
startingCamera(const SLIMSurface& surface, const ViewDirection& direction, const ImageSize& size)
{
  Camera camera;
  camera.size = size;
  camera.up = direction.up;
  camera.look_at = surface.info.origin;
  camera.position = along(surface.info.origin, 1.0, normalized(direction.towards_viewer));
  return camera;
}

/** \brief Puts the camera at depth z (local), centred on what fit measured. */
void
placeCamera(const SLIMSurface& surface, const CameraAxes& axes, const FrustumFit& fit, double z,
            Camera& camera)
{
  const double x = 0.5 * (fit.max_right - fit.max_left), y = 0.5 * (fit.max_up - fit.max_down);
  const Vector3 eye = along(along(scaled(axes.right, x), y, axes.up), z, axes.forward);
  camera.position = along(surface.info.origin, surface.info.scale, eye);
  camera.look_at = along(camera.position, surface.info.scale, axes.forward);
}

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
  Camera camera = startingCamera(surface, direction, size);
  camera.fov = fov;
  const std::vector<std::size_t> leaves = framedLeaves(surface);
  if (leaves.empty()) return camera;

  const CameraAxes axes(camera);
  const double free = 1.0 - 2.0 * std::clamp(margin, 0.0, 0.4);
  const double ty = std::tan(fov * kPi / 360.0) * free, tx = ty * size.width / size.height;
  const FrustumFit fit(surface, leaves, axes, tx, ty);
  const double z =
      std::min(-0.5 * (fit.max_right + fit.max_left) / tx, -0.5 * (fit.max_up + fit.max_down) / ty);
  placeCamera(surface, axes, fit, z, camera);
  return camera;
}

Camera
fitOrthographicCamera(const SLIMSurface& surface, const ViewDirection& direction,
                      const ImageSize& size, double margin)
{
  Camera camera = startingCamera(surface, direction, size);
  camera.projection = Camera::Projection::kOrthographic;
  camera.view_height = surface.info.scale;
  const std::vector<std::size_t> leaves = framedLeaves(surface);
  if (leaves.empty()) return camera;

  const CameraAxes axes(camera);
  const double free = 1.0 - 2.0 * std::clamp(margin, 0.0, 0.4);
  const FrustumFit fit(surface, leaves, axes, 0.0, 0.0);
  const double width = fit.max_right + fit.max_left, height = fit.max_up + fit.max_down;
  const double local_height = std::max(height, width * size.height / size.width) / free;
  camera.view_height = std::max(local_height, 1e-9) * surface.info.scale;
  placeCamera(surface, axes, fit, fit.min_depth - local_height, camera);
  return camera;
}

}  // namespace pcl_slim
