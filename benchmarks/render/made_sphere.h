// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "pcl_slim/render/camera.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief What to make of a sphere. */
struct MadeSphere {
  std::size_t leaves = 48000;
  int degree = 2;
  bool cap = false;    ///< only what is within 20 degrees of the viewer's axis
  bool links = false;  ///< internal surfels too, an eighth as many from level to level
};

/** \brief A sphere's surfels at even distances, balls that overlap as those of fitted scans do: a
 * point is in about eleven leaves and in four surfels of an internal level. */
SLIMSurface makeSphere(const MadeSphere& made);

/** \brief The camera before it. \param[in] zoom 1: the whole sphere; larger: a part in the middle
 */
Camera cameraBeforeSphere(int size, double zoom);

}  // namespace pcl_slim
