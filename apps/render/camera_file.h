// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/render/camera.h"

namespace pcl_slim {

/** \brief A camera as text: position, target and upward direction in world coordinates, then the
 * field of view in degrees; of a parallel one the height of the view and the word "parallel"
 * instead. Commas between, no spaces. The picture's size is not part of it. */
std::string cameraText(const Camera& camera);

/** \brief Whether a text has the form of a camera, right or wrong, rather than that of a path. */
bool looksLikeCamera(const std::string& text);

/** \brief Reads what cameraText() wrote. \param[in] fov taken where the text ends before it. */
Result<Camera> cameraFromText(const std::string& text, double fov);

/** \brief Writes a camera as a line of text. */
Error saveCamera(const std::string& path, const Camera& camera);

/** \brief Reads what saveCamera() wrote. */
Result<Camera> loadCamera(const std::string& path);

}  // namespace pcl_slim
