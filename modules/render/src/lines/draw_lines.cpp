// SPDX-License-Identifier: BSD-3-Clause
// Lines of space seen by a camera, and lines drawn into a picture.
#include <algorithm>
#include <cmath>

#include "camera/camera_rays.h"
#include "pcl_slim/render/picture_lines.h"
#include "shading/shading.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr float kFullStrength = 4.0f;

/** Places of points in the picture, and whether the surface hides them. */
class LineView {
 public:
  LineView(const GBuffer& buffer, const Camera& camera, const SLIMSurface& surface,
           double tolerance)
      : buffer_(buffer),
        camera_(camera),
        axes_(camera),
        scale_(surface.info.scale),
        tolerance_(tolerance * surface.info.diagonal) {
    const bool perspective = camera.projection == Camera::Projection::kPerspective;
    const double height =
        perspective ? 2.0 * std::tan(camera.fov * M_PI / 360.0) : camera.view_height;
    pixel_ = height / camera.size.height;
  }

  /** \return whether the point is seen; place is then where. */
  bool see(const Vector3& point, std::array<float, 2>& place) const {
    const Vector3 to = subtract(point, camera_.position);
    const bool perspective = camera_.projection == Camera::Projection::kPerspective;
    const double ahead = dot(to, axes_.forward);
    if (perspective && !(ahead > 0)) return false;
    const double unit = pixel_ * (perspective ? ahead : 1.0);
    const double x = dot(to, axes_.right) / unit + 0.5 * (camera_.size.width - 1);
    const double y = 0.5 * (camera_.size.height - 1) - dot(to, axes_.up) / unit;
    place = {static_cast<float>(x), static_cast<float>(y)};
    const auto column = std::lround(x), row = std::lround(y);
    if (column < 0 || row < 0 || column >= buffer_.width || row >= buffer_.height) return false;
    const double depth = (perspective ? length(to) : ahead) / scale_;
    return depth < tolerance_ + depthAbout(static_cast<int>(column), static_cast<int>(row));
  }

 private:
  /** The greatest depth about a pixel: a line on a contour is not hidden by its own surface. */
  double depthAbout(int column, int row) const {
    float depth = 0;
    for (int y = std::max(0, row - 1); y <= std::min(buffer_.height - 1, row + 1); ++y) {
      for (int x = std::max(0, column - 1); x <= std::min(buffer_.width - 1, column + 1); ++x)
        depth = std::max(depth, buffer_.depth[buffer_.index(x, y)]);
    }
    return depth;
  }

  const GBuffer& buffer_;
  const Camera& camera_;
  CameraAxes axes_;
  double scale_, tolerance_, pixel_ = 1;
};

void appendVisible(const SpaceLine& line, const LineView& view, std::vector<PictureLine>& seen) {
  PictureLine part;
  part.kind = line.kind;
  const auto finish = [&] {
    part.strength.assign(part.points.size(), kFullStrength);
    if (part.points.size() > 1) seen.push_back(part);
    part.points.clear();
  };
  for (const auto& point : line.points) {
    std::array<float, 2> place;
    if (view.see(point, place)) {
      part.points.push_back(place);
    } else {
      finish();
    }
  }
  finish();
}

}  // namespace

Result<std::vector<PictureLine>> projectLines(const std::vector<SpaceLine>& lines,
                                              const GBuffer& buffer, const Camera& camera,
                                              const SLIMSurface& surface, double tolerance) {
  if (Error error = camera.validate()) return error;
  if (buffer.width != camera.size.width || buffer.height != camera.size.height)
    return Error{ErrorCode::kBadArgument,
                 "the G-buffer and the camera differ in size; draw lines with the camera it was "
                 "made by"};
  const LineView view(buffer, camera, surface, tolerance);
  std::vector<PictureLine> seen;
  for (const SpaceLine& line : lines) appendVisible(line, view, seen);
  return seen;
}

namespace {

constexpr float kThinnest = 0.4f;  ///< of the width, of a line just strong enough
constexpr float kFull = 4.0f;      ///< strength from which lines have their whole width

/** How much of each pixel lines of one colour cover. */
class LineMask {
 public:
  LineMask(int width, int height)
      : width_(width), height_(height), cover_(static_cast<std::size_t>(width) * height, 0.0f) {}

  void draw(const PictureLine& line, float width) {
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

  static int clamped(float value, int last) {
    return static_cast<int>(std::clamp(value, 0.0f, static_cast<float>(last)));
  }

  void drawSegment(const Place& a, const Place& b, float half) {
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

  static float distance(const Place& p, const Place& a, const Place& b) {
    const float dx = b[0] - a[0], dy = b[1] - a[1], sq = dx * dx + dy * dy;
    const float t =
        sq > 0 ? std::clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / sq, 0.0f, 1.0f) : 0.0f;
    return std::hypot(a[0] + t * dx - p[0], a[1] + t * dy - p[1]);
  }

  int width_, height_;
  std::vector<float> cover_;
};

void blend(const LineMask& mask, const Color& color, Image& image) {
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
void lay(const LineMask& mask, const Color& color, std::vector<std::array<float, 4>>& glass) {
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
Error drawMasks(const std::vector<PictureLine>& lines, const LineStyle& style, int width,
                int height, const Take& take) {
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

Error drawLines(const std::vector<PictureLine>& lines, const LineStyle& style, Image& image) {
  return drawMasks(lines, style, image.width, image.height,
                   [&](const LineMask& mask, const Color& color) { blend(mask, color, image); });
}

Error drawLines(const std::vector<PictureLine>& lines, const LineStyle& style,
                const ImageSize& size, std::vector<std::uint8_t>& rgba) {
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
