// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "pcl_slim/render/picture_lines.h"
#include "shading/linear_light.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr float kThinnest = 0.4f;  ///< of the width, of a line just strong enough
constexpr float kFull = 4.0f;      ///< strength from which lines have their whole width

/** How much of each pixel lines of one colour cover. */
class LineMask {
 public:
  LineMask(int width, int height)
      : width_(width), height_(height), cover_(static_cast<std::size_t>(width) * height, 0.0f)
  {
  }

  void draw(const PictureLine& line, float width)
  {
    const std::size_t n = line.points.size();
    for (std::size_t i = 0; i + 1 < n + (line.closed ? 1 : 0); ++i) {
      const std::size_t j = (i + 1) % n;
      const float strength = 0.5f * (line.strength[i] + line.strength[j]);
      const float share = kThinnest + (1.0f - kThinnest) * std::min(1.0f, strength / kFull);
      drawSegment(line.points[i], line.points[j], 0.5f * width * share);
    }
  }

  float cover(std::size_t pixel) const { return cover_[pixel]; }

 private:
  using Place = std::array<float, 2>;

  static int clamped(float value, int last)
  {
    return static_cast<int>(std::clamp(value, 0.0f, static_cast<float>(last)));
  }

  void drawSegment(const Place& a, const Place& b, float half)
  {
    const float reach = half + 1.0f;
    const int x0 = clamped(std::floor(std::min(a[0], b[0]) - reach), width_ - 1);
    const int x1 = clamped(std::ceil(std::max(a[0], b[0]) + reach), width_ - 1);
    const int y0 = clamped(std::floor(std::min(a[1], b[1]) - reach), height_ - 1);
    const int y1 = clamped(std::ceil(std::max(a[1], b[1]) + reach), height_ - 1);
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const Place p = {static_cast<float>(x), static_cast<float>(y)};
        const float cover = std::min(half, 0.5f) + half - distance(p, a, b);
        float& pixel = cover_[static_cast<std::size_t>(y) * width_ + x];
        pixel = std::max(pixel, std::clamp(cover, 0.0f, 1.0f));
      }
    }
  }

  static float distance(const Place& p, const Place& a, const Place& b)
  {
    const float dx = b[0] - a[0], dy = b[1] - a[1], sq = dx * dx + dy * dy;
    const float t =
        sq > 0 ? std::clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / sq, 0.0f, 1.0f) : 0.0f;
    return std::hypot(a[0] + t * dx - p[0], a[1] + t * dy - p[1]);
  }

  int width_, height_;
  std::vector<float> cover_;
};

void
blend(const LineMask& mask, const Color& color, Image& image)
{
  const Color ink = toLinear(color);
  for (std::size_t i = 0; i < image.rgb.size() / 3; ++i) {
    const float cover = mask.cover(i);
    if (!(cover > 0)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint8_t& channel = image.rgb[3 * i + k];
      const float paper = linearFromSrgb(static_cast<float>(channel) / 255.0f);
      channel = toByte(paper + cover * (ink[k] - paper));
    }
  }
}

/** Blends one colour over the pixels of glass, both in linear light. */
void
lay(const LineMask& mask, const Color& color, std::vector<std::array<float, 4>>& glass)
{
  const Color ink = toLinear(color);
  for (std::size_t i = 0; i < glass.size(); ++i) {
    const float cover = mask.cover(i), below = (1.0f - cover) * glass[i][3];
    if (!(cover > 0)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      glass[i][k] = (cover * ink[k] + below * glass[i][k]) / (cover + below);
    }
    glass[i][3] = cover + below;
  }
}

/** Draws each colour's lines and passes their masks to take, the topmost last. */
template <typename Take>
Error
drawMasks(const std::vector<PictureLine>& lines, const LineStyle& style, int width, int height,
          const Take& take)
{
  if (!(style.width > 0) || !std::isfinite(style.width))
    return {ErrorCode::kBadArgument, "the width of lines must be above 0"};
  const std::pair<PictureLineKind, Color> kinds[] = {
      {PictureLineKind::kSuggestive, style.suggestive},
      {PictureLineKind::kRavine, style.ravine},
      {PictureLineKind::kRidge, style.ridge},
      {PictureLineKind::kContour, style.contour}};
  for (const auto& [kind, color] : kinds) {
    LineMask mask(width, height);
    bool any = false;
    for (const PictureLine& line : lines) {
      if (line.kind != kind || line.points.empty()) continue;
      mask.draw(line, static_cast<float>(style.width));
      any = true;
    }
    if (any) take(mask, color);
  }
  return {};
}

}  // namespace

Error
drawLines(const std::vector<PictureLine>& lines, const LineStyle& style, Image& image)
{
  return drawMasks(lines, style, image.width, image.height,
                   [&](const LineMask& mask, const Color& color) { blend(mask, color, image); });
}

Error
drawLines(const std::vector<PictureLine>& lines, const LineStyle& style, const ImageSize& size,
          std::vector<std::uint8_t>& rgba)
{
  const auto pixels = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
  std::vector<std::array<float, 4>> glass(pixels, {0.0f, 0.0f, 0.0f, 0.0f});
  Error error =
      drawMasks(lines, style, size.width, size.height,
                [&](const LineMask& mask, const Color& color) { lay(mask, color, glass); });
  rgba.assign(4 * pixels, 0);
  for (std::size_t i = 0; i < pixels; ++i) {
    if (!(glass[i][3] > 0)) continue;
    for (std::size_t k = 0; k < 3; ++k) rgba[4 * i + k] = toByte(glass[i][k]);
    rgba[4 * i + 3] = static_cast<std::uint8_t>(std::lround(255.0f * glass[i][3]));
  }
  return error;
}

}  // namespace pcl_slim
