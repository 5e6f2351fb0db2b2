// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/render/disc_rasterizer.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/image.h"
#include "pcl_slim/render/surface_renderer.h"

namespace pcl_slim {

/** \brief What a picture shows. */
enum class ShadingMode : unsigned char {
  kShaded,  ///< clay under a head light and a key light
  kNormal,  ///< rgb = n / 2 + 1/2, world axes
  kMean,    ///< mean curvature, blue (hollow) through grey (flat) to red (bulging)
  kLevel,   ///< level of the leaf of the largest weight, one colour each
  kSize,    ///< its radius, blue large to red small (the paper's Fig. 1)
  kColor,   ///< colours of discs
};

/** \brief The mode of a name such as "shaded", or nothing. */
std::optional<ShadingMode>
shadingModeOf(const std::string& name);

/** \brief Parameters of shade() and renderPicture(). */
struct ShadingParams {
  ShadingMode mode = ShadingMode::kShaded;
  bool lighting = true;      ///< false: colours as they are, no light and no shade
  double range = 0.0;        ///< > 0: curvature of full red, 1/world length; 0: from the picture
  double percentile = 0.95;  ///< share of pixels inside an automatic range, (0, 1]
  double ambient_occlusion = 0.6;   ///< strength of the shade in hollows, [0, 1]
  bool gradient_background = true;  ///< soft grey gradient instead of white
  int threads = 0;                  ///< 0: all cores; never changes the result
  int supersampling = 2;            ///< renderPicture: N x N rays a pixel, 1 ... 8

  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

/** \brief Ranges the colours span; taken from one buffer, then kept for others. */
struct ShadingRange {
  double curvature = 1.0;                     ///< |H| of full colour, 1/local length
  double radius_min = 0.0, radius_max = 1.0;  ///< local lengths of full red and full blue
};

/** \brief Robust colour ranges of a G-buffer. O(covered pixels).
 * \param[in] scale world units per local unit */
ShadingRange
rangeOf(const GBuffer& buffer, const ShadingParams& params, double scale);

/** \brief Shades a G-buffer to linear light, one colour a pixel, background included.
 * \param[in] scale world units per local unit, as SurfaceInfo::scale */
std::vector<Color>
shadeLinear(const GBuffer& buffer, const Camera& camera, const ShadingParams& params,
            const ShadingRange& range);

/** \brief Shades a G-buffer to a picture. Its size must be the camera's; kColor wants a buffer with
 * colours. */
Result<Image>
shade(const GBuffer& buffer, const Camera& camera, const ShadingParams& params, double scale = 1.0);

/** \brief A finished picture: supersampling^2 shifted renderings, averaged in linear light.
 *
 * Memory is that of one G-buffer, whatever the supersampling. Same bytes for any thread count.
 * kColor is refused: a surface has no colours.
 */
Result<Image>
renderPicture(const SLIMSurface& surface, const Camera& camera, const RenderParams& render_params,
              const ShadingParams& shading_params, RenderStatistics* statistics = nullptr);

/** \brief The same of coloured discs. kMean and kLevel are refused: discs have neither. */
Result<Image>
renderPicture(const SplatSet& splats, const Camera& camera, const DiscRenderParams& render_params,
              const ShadingParams& shading_params, DiscRenderStatistics* statistics = nullptr);

}  // namespace pcl_slim
