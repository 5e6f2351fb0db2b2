// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/deviation_legend.h"
#include "pcl_slim/render/picture_lines.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/splat/splat_set.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief What a page has in addition to the picture that it opens with. */
struct PageParams {
  std::string title = "surface";
  std::array<double, 3> up{0.0, 0.0, 1.0};   ///< dragging turns the object about this direction
  double precision = 896.0;                  ///< of encodeWebSurface()
  int color_error = 2;                       ///< of encodeWebSurface()
  std::vector<SpaceLine> lines;              ///< to draw over the surface, world coordinates
  std::optional<DeviationScale> deviations;  ///< what the model's own colours mean: adds a legend
};

/** \brief One HTML file that shows a surface. Any browser with WebGL 2 opens it, without network.
 *
 * It opens with the picture of renderPicture() and lets its reader turn it, clip it, measure in it, change
 * its mode and read positions, normals and curvatures. camera.size sets the shape of the still picture that is
 * shown where WebGL 2 is missing. Cuts are refused.
 * \return the file's text: 40 bytes a surfel of degree 4, 12 more with colours, 6 a point with textures, and some 100 KB. The same for every run. */
PCL_SLIM_EXPORT Result<std::string> encodePage(const SLIMSurface& surface, const Camera& camera,
                                               const RenderParams& rendering,
                                               const ShadingParams& shading,
                                               const PageParams& params);

/** \brief The same for coloured discs, some 15 bytes each; params.precision means nothing. */
PCL_SLIM_EXPORT Result<std::string> encodePage(const SplatSet& splats, const Camera& camera,
                                               const DiscRenderParams& rendering,
                                               const ShadingParams& shading,
                                               const PageParams& params);

}  // namespace pcl_slim
