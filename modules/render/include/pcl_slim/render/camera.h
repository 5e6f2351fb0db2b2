// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/render/bounding_spheres.h"

namespace pcl_slim {

/** \brief Size of a picture in pixels. */
struct ImageSize {
  int width = 800;
  int height = 600;
};

/** \brief A pinhole or parallel camera in world coordinates (double throughout).
 *
 * Pixel (0, 0) is the upper left one; rays pass through pixel centres. Depth is the distance
 * along the ray, whose direction has unit length.
 */
struct PCL_SLIM_EXPORT Camera {
  /** \brief How rays leave the camera: from its position, or in parallel. */
  enum class Projection : unsigned char { kPerspective, kOrthographic };

  Projection projection = Projection::kPerspective;
  std::array<double, 3> position{0.0, 0.0, 1.0};
  std::array<double, 3> look_at{0.0, 0.0, 0.0};
  std::array<double, 3> up{0.0, 1.0, 0.0};  ///< any length, not along the viewing direction
  double fov = 30.0;                        ///< perspective: vertical opening in degrees, (0, 180)
  double view_height = 1.0;                 ///< orthographic: world height of the picture, > 0
  ImageSize size;                           ///< 1 ... 32768 pixels a side
  std::array<double, 2> pixel_offset{0.0, 0.0};  ///< shift of all rays, pixels (supersampling)

  /** \brief Names the first value that makes no camera. */
  Error validate() const;
};

/** \brief Whether a camera may see something of a box in world coordinates; errs on the visible
 * side. */
PCL_SLIM_EXPORT bool mayBeSeen(const Camera& camera,
                               const std::array<std::array<double, 3>, 2>& box);

/** \brief Directions in which a camera looks: from the object to the viewer, and upwards. */
struct ViewDirection {
  std::array<double, 3> towards_viewer{0.0, -1.0, 0.0};
  std::array<double, 3> up{0.0, 0.0, 1.0};
};

/** \brief A perspective camera that sees every sphere of an object, as large as the picture allows.
 *
 * Spheres outside the bulk (beyond half its extent past the 5th and 95th percentile of the points,
 * along each axis) are not framed, so that neither a stray point nor the far end of a lidar's scan
 * shrinks the object to a dot; nor are separate pieces of less than 1 % of the points. An empty
 * object gives a camera at one world unit from its origin. O(spheres).
 * \param[in] margin share of the picture left free on each side, [0, 0.4];
 * \param[in] right_margin additional share of its width left free on the right, [0, 0.4]: for a bar
 */
PCL_SLIM_EXPORT Camera fitCamera(const BoundingSpheres& object, const ViewDirection& direction,
                                 const ImageSize& size, double fov = 30.0, double margin = 0.04,
                                 double right_margin = 0.0);

/** \brief The same for parallel projection. */
PCL_SLIM_EXPORT Camera fitOrthographicCamera(const BoundingSpheres& object,
                                             const ViewDirection& direction, const ImageSize& size,
                                             double margin = 0.04, double right_margin = 0.0);

}  // namespace pcl_slim
