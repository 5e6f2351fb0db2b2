// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "pcl_slim/core/srgb.h"
#include "pcl_slim/query/surface_probe.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/render/detail/light.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/image.h"
#include "pcl_slim/render/shading.h"

namespace pcl_slim::detail {

inline Color toLinear(const Color& s) {
  return {linearFromSrgb(s[0]), linearFromSrgb(s[1]), linearFromSrgb(s[2])};
}

/** \brief Linear light of an empty pixel: white, or a grey that darkens downwards. */
inline Color backgroundAt(const ShadingParams& params, int y, int height) {
  if (!params.gradient_background) return {1.0f, 1.0f, 1.0f};
  const float t = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
  const float level = static_cast<float>(kPaper[0]) - static_cast<float>(kPaper[1]) * t * t;
  return toLinear({level, level, level + static_cast<float>(kPaper[2])});
}

/** \brief Linear light to an 8-bit sRGB channel. */
inline std::uint8_t toByte(float linear) {
  const float s = srgbFromLinear(std::clamp(linear, 0.0f, 1.0f));
  return static_cast<std::uint8_t>(std::lround(255.0f * s));
}

/** \brief The number that a mode shows at a covered pixel, in world units. */
double valueAt(const GBuffer& buffer, std::size_t pixel, ShadingMode mode, double scale);

/** \brief The level at a share of a range of levels. */
std::uint32_t levelAtShare(const ShadingRange& range, double share);

/** \brief The colour of a share of the range, 0 its lower end. */
Color colorAtShare(const ShadingParams& params, const ShadingRange& range, double share);

/** \brief The colour of a value. */
Color colorOf(const ShadingParams& params, const ShadingRange& range, double value);

/** \brief Whether a picture has a shade in its hollows. */
bool wantsAmbientOcclusion(const ShadingParams& params);

/** \brief A colour bar in the margin at the right of a picture; places and sizes in pixels. Text is
 * as large as the picture has room for, 11 pixels and more. */
struct BarLayout {
  double em;                     ///< size of the font
  int left, top, width, height;  ///< of the colours
  int paper_left, paper_top;     ///< of the paper behind them and their text

  explicit BarLayout(const ImageSize& size);

  bool fits = false;
};

/** \brief Pixels from left to before right, from top to before bottom. */
struct PixelBox {
  int left, top, right, bottom;
};

/** \brief Of colour bars and legends: letters, frames and ticks, and the paper behind them, which
 * covers the picture by a share. */
constexpr Color kBarInk{0.1f, 0.1f, 0.1f}, kBarFrame{0.25f, 0.25f, 0.25f},
    kBarPaper{1.0f, 1.0f, 1.0f};
constexpr float kBarPaperShare = 0.85f;

/** \brief Mixes a share of a colour into the pixels of a box; those outside of the picture are left
 * out. O(pixels). */
void fillBox(Image& image, const PixelBox& box, const Color& color, float share);

/** \brief Fills the colours of a frame from those of a surface's leaves, at the positions and with
 * the normals of its pixels. Its index is built for the first frame with colours. */
class SurfacePainter {
 public:
  /** \brief The surface must outlive this object. */
  explicit SurfacePainter(const SLIMSurface& surface) : surface_(surface) {}

  /** \brief \param[in] camera of the frame \param[in,out] buffer with positions and depths; its colours are set, white where a pixel is in no
   * leaf's ball, and none are set for a surface without. O(covered pixels times leaves near them).
   */
  void paint(const Camera& camera, int threads, GBuffer& buffer);

 private:
  const SLIMSurface& surface_;
  std::unique_ptr<ProbeIndex> index_;
};

}  // namespace pcl_slim::detail
