// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "common/program.h"
#include "pcl_slim/render/disc_rasterizer.h"
#include "pcl_slim/render/ray_tracer.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/render/shading.h"
#include "render/model.h"

namespace pcl_slim {

/** \brief Medians over warm frames of one ray a pixel. */
struct FrameSeconds {
  double frame = 0.0;  ///< from the camera to a G-buffer with what the mode needs
  double shade = 0.0;  ///< from there to a picture
};

/** \brief Times frames after a first one that does not count; each camera is shifted by a part of a
 * pixel against the last, so that nothing repeats. \param[in] repeat at least 1 */
Result<FrameSeconds>
timeFrames(SurfaceRenderer& renderer, const Camera& camera, const RenderParams& params,
           const ShadingParams& shading, int repeat);

/** \brief Adds what a surface is and what its pictures cost and left out to a report. */
void
reportSurface(const Model& model, const RenderStatistics& counts, nlohmann::ordered_json& json);

/** \brief The same of splats. */
void
reportSplats(const Model& model, const DiscRenderStatistics& counts, nlohmann::ordered_json& json);

/** \brief The same of traced pictures of either. */
void
reportTraced(const Model& model, const TraceStatistics& counts, nlohmann::ordered_json& json);

/** \brief Loads a model, or only the wanted blocks of a surface in blocks, and prints it; borders as the picture is
 * to have them. */
Result<Model>
loadDrawn(const std::string& path, const BlockWish& wish, bool trim, double hole, int threads,
          Console& console, Report& report);

}  // namespace pcl_slim
