// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/render/disc_rasterizer.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/image.h"
#include "pcl_slim/render/surface_renderer.h"

namespace pcl_slim {

/** \brief What a picture shows. */
enum class ShadingMode : unsigned char {
  kShaded,    ///< clay under a head light and a key light
  kNormal,    ///< rgb = n / 2 + 1/2, world axes
  kMean,      ///< mean curvature
  kGaussian,  ///< Gaussian curvature
  kKMax,      ///< the larger principal curvature
  kKMin,      ///< the smaller one
  kLevel,     ///< level of the leaf of the largest weight, one colour each
  kSize,      ///< its radius, blue large to red small (the paper's Fig. 1)
  kError,     ///< its residual, root mean square: the noise and what the polynomial cannot follow
  kReflection,  ///< stripes of light far away as the surface mirrors them: they break where normals do
  kColor,       ///< colours of discs or of a coloured surface
  kUncertainty,  ///< those that a surface was painted with by its standard error, with a colour bar
};

/** \brief The name of a mode, as shadingModeOf() takes it. */
PCL_SLIM_EXPORT std::string nameOf(ShadingMode mode);

/** \brief Colours of a mode that shows numbers. */
enum class ColorMap : unsigned char {
  kAuto,        ///< diverging for curvatures, perceptual for residuals, the paper's for sizes
  kDiverging,   ///< blue through grey at the middle of the range to red
  kPerceptual,  ///< dark blue to light yellow, evenly
};

/** \brief The mode of a name such as "shaded", or nothing. */
PCL_SLIM_EXPORT std::optional<ShadingMode> shadingModeOf(const std::string& name);

/** \brief Parameters of shade() and renderPicture(). */
struct PCL_SLIM_EXPORT ShadingParams {
  ShadingMode mode = ShadingMode::kShaded;
  bool lighting = true;           ///< false: colours as they are, no light and no shade
  std::array<double, 2> range{};  ///< world units that the colours span; equal: from the picture
  double percentile = 0.95;       ///< share of pixels inside an automatic range, (0, 1]
  ColorMap map = ColorMap::kAuto;
  bool color_bar = false;  ///< draw the range with its numbers and unit into the picture
  std::string unit;  ///< of length, for the bar: up to eight letters such as mm or µm, or none
  double ambient_occlusion = 0.6;   ///< strength of the shade in hollows, [0, 1]
  bool gradient_background = true;  ///< soft grey gradient instead of white
  int threads = 0;                  ///< 0: all cores; never changes the result
  int supersampling = 2;            ///< renderPicture: N x N rays a pixel, 1 ... 8

  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

/** \brief What the colours of a mode that shows numbers or levels span, in world units. */
struct ShadingRange {
  double low = 0.0, high = 1.0;
  bool logarithmic = false;  ///< then both are positive
};

/** \brief Whether a mode shows numbers: curvatures, sizes, residuals and standard errors. */
PCL_SLIM_EXPORT bool showsNumbers(ShadingMode mode);

/** \brief Whether a mode has a colour bar: those that show numbers, and levels. */
PCL_SLIM_EXPORT bool hasColorBar(ShadingMode mode);

/** \brief The given range, or a robust one of a G-buffer; of levels half a level past those it
 * shows. O(covered pixels).
 * \param[in] scale world units per local unit, as SurfaceInfo::scale */
PCL_SLIM_EXPORT ShadingRange rangeOf(const GBuffer& buffer, const ShadingParams& params,
                                     double scale);

/** \brief GBufferColumn bits that a picture needs. */
PCL_SLIM_EXPORT unsigned columnsFor(const ShadingParams& params);

/** \brief Share of a picture's width that its colour bar takes up at the right; 0 where there is no
 * room for one. */
PCL_SLIM_EXPORT double colorBarShare(const ImageSize& size);

/** \brief Draws a range, its numbers and its unit into the right margin of a picture. */
PCL_SLIM_EXPORT void addColorBar(const ShadingParams& params, const ShadingRange& range,
                                 Image& image);

/** \brief Shades a G-buffer to linear light, one colour a pixel, background included.
 * \param[in] scale world units per local unit, as SurfaceInfo::scale */
PCL_SLIM_EXPORT std::vector<Color> shadeLinear(const GBuffer& buffer, const Camera& camera,
                                               const ShadingParams& params,
                                               const ShadingRange& range, double scale = 1.0);

/** \brief Shades a G-buffer to a picture. Its size must be the camera's; kColor needs a buffer with
 * colours. */
PCL_SLIM_EXPORT Result<Image> shade(const GBuffer& buffer, const Camera& camera,
                                    const ShadingParams& params, double scale = 1.0);

/** \brief A finished picture: supersampling^2 shifted renderings, averaged in linear light.
 *
 * Memory is that of one G-buffer, whatever the supersampling. Same bytes for any thread count.
 * kColor is refused where the surface has no colours.
 */
PCL_SLIM_EXPORT Result<Image> renderPicture(const SLIMSurface& surface, const Camera& camera,
                                            const RenderParams& render_params,
                                            const ShadingParams& shading_params,
                                            RenderStatistics* statistics = nullptr);

/** \brief The same with a renderer that is kept; columns are chosen by the mode. */
PCL_SLIM_EXPORT Result<Image> renderPicture(SurfaceRenderer& renderer, const Camera& camera,
                                            const RenderParams& render_params,
                                            const ShadingParams& shading_params,
                                            RenderStatistics* statistics = nullptr);

/** \brief The same of coloured discs. Curvatures, levels and residuals are refused: discs have
 * none. */
PCL_SLIM_EXPORT Result<Image> renderPicture(const SplatSet& splats, const Camera& camera,
                                            const DiscRenderParams& render_params,
                                            const ShadingParams& shading_params,
                                            DiscRenderStatistics* statistics = nullptr);

}  // namespace pcl_slim
