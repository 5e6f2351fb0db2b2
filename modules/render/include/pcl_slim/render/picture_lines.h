// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/image.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief What a line in a picture is. */
enum class PictureLineKind : std::uint8_t {
  kRidge,       ///< crest line: greatest curvature, greatest along its direction
  kRavine,      ///< the same of hollows
  kSuggestive,  ///< suggestive contour: would be a contour from a view nearby
  kContour,     ///< the surface ends there or hides what is behind
};

/** \brief A polyline in a picture; pixel (0, 0) has its centre at (0, 0). */
struct PictureLine {
  PictureLineKind kind = PictureLineKind::kContour;
  bool closed = false;
  std::vector<std::array<float, 2>> points;  ///< pixels, sub-pixel accuracy
  std::vector<float> strength;               ///< in units of the least that is drawn; 4 on contours
};

/** \brief Which lines are looked for and which are kept. */
struct PCL_SLIM_EXPORT PictureLineParams {
  bool crest = false, suggestive = false, contour = false;
  double crest_curvature = 0;        ///< least curvature of a crest line [1/L]; 0: automatic
  double suggestive_derivative = 0;  ///< least derivative of radial curvature [1/L^2]; 0: automatic
  double min_length = 12;            ///< pixels, >= 0
  int threads = 0;                   ///< 0: all cores; never changes the result

  /** \brief Names the first parameter out of range. */
  Error validate() const;
};

/** \brief Columns of a G-buffer that findPictureLines() reads. */
PCL_SLIM_EXPORT unsigned pictureLineColumns(const PictureLineParams& params);

/** \brief Finds lines in what a camera sees of a surface.
 *
 * Crest lines are zeros of the derivative of the greatest curvature along its direction; suggestive
 * contours (DeCarlo, Finkelstein, Rusinkiewicz, Santella 2003) are zeros of the radial curvature
 * where it grows towards the viewer. Both are traced through the pixels by marching squares, kept
 * with hysteresis (a line reaches twice the least) and only where the noise of curvature, as the
 * leaf's radius and number of points make it, does not explain them. Contours follow the pixels'
 * edges, smoothed. O(pixels). Same bytes for any thread count.
 *
 * \param[in] buffer what camera saw, with pictureLineColumns(); \param[in] surface what it shows
 * \return an error for bad parameters, or a buffer that lacks columns or has another size.
 */
PCL_SLIM_EXPORT Result<std::vector<PictureLine>> findPictureLines(const GBuffer& buffer,
                                                                  const Camera& camera,
                                                                  const SLIMSurface& surface,
                                                                  const PictureLineParams& params);

/** \brief A polyline in world coordinates, as crest lines of pcl_slim/features are. */
struct SpaceLine {
  PictureLineKind kind = PictureLineKind::kRidge;
  std::vector<std::array<double, 3>> points;
};

/** \brief The visible parts of lines in space.
 * \param[in] tolerance a line this far behind the picture's depth is still seen [L] */
PCL_SLIM_EXPORT Result<std::vector<PictureLine>> projectLines(const std::vector<SpaceLine>& lines,
                                                              const GBuffer& buffer,
                                                              const Camera& camera,
                                                              const SLIMSurface& surface,
                                                              double tolerance = 0.005);

/** \brief How lines are drawn. */
struct LineStyle {
  double width = 1.6;                     ///< pixels of a line four times as strong as the least
  Color ridge{0.06f, 0.16f, 0.50f};       ///< sRGB
  Color ravine{0.60f, 0.10f, 0.08f};      ///< sRGB
  Color suggestive{0.10f, 0.10f, 0.10f};  ///< sRGB
  Color contour{0.0f, 0.0f, 0.0f};        ///< sRGB
};

/** \brief Draws lines over a picture, anti-aliased; weaker ones are finer, down to .4 of the width,
 * and crossings are no darker than their lines. O(length * width). */
PCL_SLIM_EXPORT Error drawLines(const std::vector<PictureLine>& lines, const LineStyle& style,
                                Image& image);

/** \brief The same lines on a transparent picture, to draw over another one.
 * \param[out] rgba sRGB and how much of the pixel lines cover, four bytes a pixel, rows from the
 * top; drawn over a picture in linear light it gives what the other function draws */
PCL_SLIM_EXPORT Error drawLines(const std::vector<PictureLine>& lines, const LineStyle& style,
                                const ImageSize& size, std::vector<std::uint8_t>& rgba);

}  // namespace pcl_slim
