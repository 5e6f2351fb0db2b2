// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>

#include "pcl_slim/core/export.h"
#include "pcl_slim/render/bounding_spheres.h"
#include "pcl_slim/render/camera.h"

namespace pcl_slim {

/** \brief Which world axis points upwards in a picture. */
enum class UpAxis : unsigned char { kAuto, kX, kY, kZ, kMinusX, kMinusY, kMinusZ };

/** \brief "z", "-y" ..., as the option -up takes them. */
PCL_SLIM_EXPORT std::string nameOf(UpAxis axis);

/** \brief View from an azimuth and an elevation around an upright object.
 *
 * Azimuth 0 is the front: the viewer is at -y when z, -z, x or -x is up, at +z when y is up, at -z
 * when -y is up; positive azimuths turn the viewer to the right. Elevation 90 looks straight down.
 * \param[in] up kAuto counts as kZ; \param[in] azimuth, elevation degrees
 */
PCL_SLIM_EXPORT ViewDirection viewFromAngles(UpAxis up, double azimuth, double elevation);

/** \brief A viewer amid a scene, world coordinates. */
struct Standpoint {
  std::array<double, 3> place{};
  ViewDirection direction;
};

/** \brief A view of an object, as a person would choose it. */
struct SceneView {
  ViewDirection direction;                  ///< of the whole
  UpAxis axis = UpAxis::kZ;                 ///< which is up
  std::array<double, 3> up{0.0, 0.0, 1.0};  ///< its direction
  bool opens = false;  ///< a room looked into from above: to be drawn without its near side
  std::optional<Standpoint> amid;  ///< the better view of what a scanner saw all around it
  std::string from;                ///< for messages: "from the front-right"
};

/** \brief Chooses a view of an object by its shape and by the sides that its normals face.
 *
 * Up is, in this order: z in map coordinates (both horizontal ones beyond 100 diagonals); -y, or y,
 * where a camera at the world's origin that looks along z, or against it, sees the cloud; of z, y,
 * -y and -z the one below which a scene that was seen from one side or from inside has the largest
 * floor, is lower than wide, and away from which nobody looked; of y and z the one along which an
 * object is flat, stays in balance, is clearly longer, was not measured from below, or has a flat
 * base; else z.
 *
 * The viewer is where the camera was; before the side that was scanned, the higher, the more of it
 * faces up; above terrain, across its longer side; above a room, which is drawn without its near
 * side; amid what a station saw all around; else before the object, 30 degrees to the right and 18
 * above. The same for surfaces, splats and meshes of one scan, up to what they show of it.
 * O(spheres log spheres). \param[in] up kAuto: to be chosen, too
 */
PCL_SLIM_EXPORT SceneView chooseView(const BoundingSpheres& object, UpAxis up = UpAxis::kAuto);

/** \brief The upward axis of chooseView(). */
PCL_SLIM_EXPORT UpAxis guessUpAxis(const BoundingSpheres& object);

/** \brief The camera of a view: amid the scene, or where the whole object is framed by fitCamera().
 * \param[in] fov vertical, in degrees; 0: 60 amid a scene, else 30 */
PCL_SLIM_EXPORT Camera cameraFor(const SceneView& view, const BoundingSpheres& object,
                                 const ImageSize& size, double fov = 0.0, double margin = 0.04,
                                 double right_margin = 0.0);

}  // namespace pcl_slim
