// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/camera.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "camera/bulk.h"
#include "camera/camera_rays.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

using namespace detail;
namespace {

constexpr int kMaxSide = 32768;
constexpr double kFarOrigin = 0x1p40;  ///< beyond it doubles hardly resolve a unit

/** \brief The free area of the picture on the plane at depth 1: its extent to either side. */
struct Opening {
  double left, right, vertical;

  /** \brief A share of the whole, which is as wide as width to height; right_margin is left out. */
  Opening(double half_height, const ImageSize& size, double margin, double right_margin)
  {
    const double free = 1.0 - 2.0 * std::clamp(margin, 0.0, 0.4);
    vertical = half_height * free;
    left = vertical * size.width / size.height;
    right = left * (1.0 - 2.0 * std::clamp(right_margin, 0.0, 0.4));
  }
};

/** \brief Balls in a frustum with the given openings at depth 1: bounds of x - right z,
 * -x - left z, y - vertical z, -y - vertical z and of z in camera axes. */
struct FrustumFit {
  double max_right = -HUGE_VAL, max_left = -HUGE_VAL, max_up = -HUGE_VAL, max_down = -HUGE_VAL;
  double min_depth = HUGE_VAL;

  /** \param[in] reach share of each radius that is to be seen */
  FrustumFit(const std::vector<BoundingSphere>& spheres, double reach, const CameraAxes& axes,
             const Opening& open)
  {
    const auto sloped = [reach](double slope) { return reach * std::sqrt(1.0 + slope * slope); };
    const double reach_left = sloped(open.left), reach_right = sloped(open.right),
                 reach_y = sloped(open.vertical);
    for (const BoundingSphere& sphere : spheres) {
      const Vector3 c{sphere.center[0], sphere.center[1], sphere.center[2]};
      const double x = dot(c, axes.right), y = dot(c, axes.up), z = dot(c, axes.forward);
      const double r = sphere.radius;
      max_right = std::max(max_right, x - open.right * z + reach_right * r);
      max_left = std::max(max_left, -x - open.left * z + reach_left * r);
      max_up = std::max(max_up, y - open.vertical * z + reach_y * r);
      max_down = std::max(max_down, -y - open.vertical * z + reach_y * r);
      min_depth = std::min(min_depth, z - r);
    }
  }
};

/** \brief What a picture has to show. */
std::vector<BoundingSphere>
framedSpheres(const BoundingSpheres& object)
{
  return object.no_strays ? object.spheres : bulkOf(object.spheres);
}

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

/** \brief Puts the camera at depth z (local), centred on what fit measured but for a shift to the
 * right. */
void
placeCamera(const BoundingSpheres& object, const CameraAxes& axes, const FrustumFit& fit, double z,
            double shift, Camera& camera)
{
  const double x = 0.5 * (fit.max_right - fit.max_left + shift),
               y = 0.5 * (fit.max_up - fit.max_down);
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

bool
mayBeSeen(const Camera& camera, const std::array<std::array<double, 3>, 2>& box)
{
  constexpr double kSlack = 2.0;  // pixels: frames of -aa are shifted
  const CameraAxes axes(camera);
  const bool perspective = camera.projection == Camera::Projection::kPerspective;
  const double half = perspective ? std::tan(camera.fov * M_PI / 360.0) : 0.5 * camera.view_height;
  const double up = half * (1.0 + 2.0 * kSlack / camera.size.height);
  const double right = half * (camera.size.width + 2.0 * kSlack) / camera.size.height;
  int beyond[5] = {};  // corners behind the eye, and beyond each side of the picture
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const Vector3 p{box[corner & 1][0], box[corner >> 1 & 1][1], box[corner >> 2 & 1][2]};
    const Vector3 seen = subtract(p, camera.position);
    const double x = dot(seen, axes.right), y = dot(seen, axes.up), z = dot(seen, axes.forward);
    const double reach = perspective ? z : 1.0;
    const bool out[5] = {z<0.0, x> right * reach, -x > right * reach, y > up * reach,
                         -y > up * reach};
    for (std::size_t k = 0; k < 5; ++k) beyond[k] += out[k];
  }
  return *std::max_element(beyond, beyond + 5) < 8;
}

Camera
fitCamera(const BoundingSpheres& object, const ViewDirection& direction, const ImageSize& size,
          double fov, double margin, double right_margin)
{
  Camera camera = startingCamera(object, direction, size);
  camera.fov = fov;
  const std::vector<BoundingSphere> framed = framedSpheres(object);
  if (framed.empty()) return camera;

  const CameraAxes axes(camera);
  const Opening open(std::tan(fov * M_PI / 360.0), size, margin, right_margin);
  const FrustumFit fit(framed, object.seen_radius, axes, open);
  const double z = std::min(-(fit.max_right + fit.max_left) / (open.left + open.right),
                            -0.5 * (fit.max_up + fit.max_down) / open.vertical);
  placeCamera(object, axes, fit, z, (open.right - open.left) * z, camera);
  return camera;
}

Camera
fitOrthographicCamera(const BoundingSpheres& object, const ViewDirection& direction,
                      const ImageSize& size, double margin, double right_margin)
{
  Camera camera = startingCamera(object, direction, size);
  camera.projection = Camera::Projection::kOrthographic;
  camera.view_height = object.scale;
  const std::vector<BoundingSphere> framed = framedSpheres(object);
  if (framed.empty()) return camera;

  const CameraAxes axes(camera);
  const Opening open(1.0, size, margin, right_margin);
  const FrustumFit fit(framed, object.seen_radius, axes, {0.0, size, margin, right_margin});
  const double width = fit.max_right + fit.max_left, height = fit.max_up + fit.max_down;
  const double half = std::max(0.5 * height / open.vertical, width / (open.left + open.right));
  camera.view_height = std::max(2.0 * half, 1e-9) * object.scale;
  placeCamera(object, axes, fit, fit.min_depth - 2.0 * half, (open.left - open.right) * half,
              camera);
  return camera;
}

}  // namespace pcl_slim
