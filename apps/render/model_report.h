// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include "common/progress_bar.h"
#include "common/report.h"
#include "pcl_slim/render/disc_rasterizer.h"
#include "pcl_slim/render/ray_tracer.h"
#include "pcl_slim/render/render_params.h"
#include "render/model.h"

namespace pcl_slim {

/** \brief Adds what a surface is and what its pictures cost and left out to a report. */
void
reportSurface(const Model& model, const RenderStatistics& counts, nlohmann::ordered_json& json);

/** \brief The same of splats. */
void
reportSplats(const Model& model, const DiscRenderStatistics& counts, nlohmann::ordered_json& json);

/** \brief The same of traced pictures of either. */
void
reportTraced(const Model& model, const TraceStatistics& counts, nlohmann::ordered_json& json);

/** \brief Loads a model, or of a surface in blocks those that are wanted, and says so; borders as the picture is
 * to have them. */
Result<Model>
loadDrawn(const std::string& path, const BlockWish& wish, bool trim, double hole, int threads,
          Console& console, Report& report);

}  // namespace pcl_slim
