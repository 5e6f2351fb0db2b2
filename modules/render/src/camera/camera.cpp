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
constexpr double kFarOrigin = 0x1p40;  ///< beyond it doubles hardly hold a unit more

bool
isFinite(const Vector3& v)
{
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

/** \brief Per axis, the interval of centres that a view of the whole object frames. */
std::array<std::array<double, 2>, 3>
framedExtent(const std::vector<BoundingSphere>& spheres)
{
  std::array<std::array<double, 2>, 3> extent;
  std::vector<float> values(spheres.size());
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < spheres.size(); ++i) values[i] = spheres[i].center[a];
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

/** \brief Spheres a view of the whole object has to show. */
std::vector<BoundingSphere>
framedSpheres(const std::vector<BoundingSphere>& spheres)
{
  std::vector<BoundingSphere> framed;
  if (spheres.empty()) return framed;
  const auto extent = framedExtent(spheres);
  for (const BoundingSphere& sphere : spheres) {
    bool inside = true;
    for (std::size_t a = 0; a < 3; ++a) {
      inside = inside && sphere.center[a] >= extent[a][0] && sphere.center[a] <= extent[a][1];
    }
    if (inside) framed.push_back(sphere);
  }
  return framed;
}

/** \brief Balls as a frustum with half widths tx, ty at depth 1 sees them: bounds of x - tx z,
 * -x - tx z, y - ty z, -y - ty z and of z in camera axes. */
struct FrustumFit {
  double max_right = -HUGE_VAL, max_left = -HUGE_VAL, max_up = -HUGE_VAL, max_down = -HUGE_VAL;
  double min_depth = HUGE_VAL;

  /** \param[in] reach share of each radius that is to be seen */
  FrustumFit(const std::vector<BoundingSphere>& spheres, double reach, const CameraAxes& axes,
             double tx, double ty)
  {
    const double reach_x = reach * std::sqrt(1.0 + tx * tx),
                 reach_y = reach * std::sqrt(1.0 + ty * ty);
    for (const BoundingSphere& sphere : spheres) {
      const Vector3 c{sphere.center[0], sphere.center[1], sphere.center[2]};
      const double x = dot(c, axes.right), y = dot(c, axes.up), z = dot(c, axes.forward);
      const double r = sphere.radius;
      max_right = std::max(max_right, x - tx * z + reach_x * r);
      max_left = std::max(max_left, -x - tx * z + reach_x * r);
      max_up = std::max(max_up, y - ty * z + reach_y * r);
      max_down = std::max(max_down, -y - ty * z + reach_y * r);
      min_depth = std::min(min_depth, z - r);
    }
  }
};

/** \brief A camera that looks the right way from one world unit off the object's origin. */
Camera
startingCamera(const BoundingSpheres& object, const ViewDirection& direction, const ImageSize& size)
{
  Camera camera;
  camera.size = size;
  camera.up = direction.up;
  camera.look_at = object.origin;
  double farthest = 0;
  for (const double o : object.origin) farthest = std::max(farthest, std::abs(o));
  const double off = farthest < kFarOrigin ? 1.0 : farthest;  // a unit would be lost out there
  camera.position = along(object.origin, off, normalized(direction.towards_viewer));
  return camera;
}

/** \brief Puts the camera at depth z (local), centred on what fit measured. */
void
placeCamera(const BoundingSpheres& object, const CameraAxes& axes, const FrustumFit& fit, double z,
            Camera& camera)
{
  const double x = 0.5 * (fit.max_right - fit.max_left), y = 0.5 * (fit.max_up - fit.max_down);
  const Vector3 eye = along(along(scaled(axes.right, x), y, axes.up), z, axes.forward);
  camera.position = along(object.origin, object.scale, eye);
  camera.look_at = along(camera.position, object.scale, axes.forward);
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
fitCamera(const BoundingSpheres& object, const ViewDirection& direction, const ImageSize& size,
          double fov, double margin)
{
  Camera camera = startingCamera(object, direction, size);
  camera.fov = fov;
  const std::vector<BoundingSphere> framed = framedSpheres(object.spheres);
  if (framed.empty()) return camera;

  const CameraAxes axes(camera);
  const double free = 1.0 - 2.0 * std::clamp(margin, 0.0, 0.4);
  const double ty = std::tan(fov * kPi / 360.0) * free, tx = ty * size.width / size.height;
  const FrustumFit fit(framed, object.seen_radius, axes, tx, ty);
  const double z =
      std::min(-0.5 * (fit.max_right + fit.max_left) / tx, -0.5 * (fit.max_up + fit.max_down) / ty);
  placeCamera(object, axes, fit, z, camera);
  return camera;
}

Camera
fitOrthographicCamera(const BoundingSpheres& object, const ViewDirection& direction,
                      const ImageSize& size, double margin)
{
  Camera camera = startingCamera(object, direction, size);
  camera.projection = Camera::Projection::kOrthographic;
  camera.view_height = object.scale;
  const std::vector<BoundingSphere> framed = framedSpheres(object.spheres);
  if (framed.empty()) return camera;

  const CameraAxes axes(camera);
  const double free = 1.0 - 2.0 * std::clamp(margin, 0.0, 0.4);
  const FrustumFit fit(framed, object.seen_radius, axes, 0.0, 0.0);
  const double width = fit.max_right + fit.max_left, height = fit.max_up + fit.max_down;
  const double local_height = std::max(height, width * size.height / size.width) / free;
  camera.view_height = std::max(local_height, 1e-9) * object.scale;
  placeCamera(object, axes, fit, fit.min_depth - local_height, camera);
  return camera;
}

}  // namespace pcl_slim
