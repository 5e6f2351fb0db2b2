// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/image.h"
#include "pcl_slim/render/ray_tracer.h"
#include "pcl_slim/render/shading.h"

namespace pcl_slim {

/** \brief Direction towards a light, unit, world axes: azimuth 0 and elevation 0 are the viewer's
 * own place; positive azimuths turn to the viewer's right, positive elevations up. Degrees. */
PCL_SLIM_EXPORT std::array<double, 3> lightDirection(const Camera& camera, double azimuth,
                                                     double elevation);

/** \brief The two lights of traced pictures: a strong warm one from above on the left and a weaker
 * cool one from the right, both with soft rims. They move with the camera. */
PCL_SLIM_EXPORT std::vector<RayLight> defaultLights(const Camera& camera);

/** \brief Shades a traced frame to linear light: clay, or the object's own colours, under the
 * frame's lights where these reach, and under an even sky that occlusion dims.
 * \param[in] params ambient_occlusion, gradient_background, threads */
PCL_SLIM_EXPORT std::vector<Color> shadeTraced(const GBuffer& buffer, const LightBuffer& light,
                                               const Camera& camera,
                                               const std::vector<RayLight>& lights,
                                               const ShadingParams& params);

/** \brief A finished ray-traced picture: supersampling^2 shifted frames, averaged in linear light.
 *
 * Without lights in trace_params those of defaultLights() shine. The mode of shading_params is
 * kShaded or kColor: the colours of discs or of a coloured surface. Same bytes for any thread
 * count.
 * \return also an error when progress was cancelled. */
PCL_SLIM_EXPORT Result<Image> renderTracedPicture(RayTracer& tracer, const Camera& camera,
                                                  const TraceParams& trace_params,
                                                  const ShadingParams& shading_params,
                                                  TraceStatistics* statistics = nullptr,
                                                  Progress* progress = nullptr);

}  // namespace pcl_slim
