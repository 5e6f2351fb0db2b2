// SPDX-License-Identifier: BSD-3-Clause
#include "frame/frame.h"

#include <vtkOpenGLRenderWindow.h>
#include <vtkScalarsToColors.h>
#include <vtkShaderProgram.h>
#include <vtkTextureObject.h>
#include <vtk_glew.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {
namespace {

void packPixel(const GBuffer& buffer, std::size_t pixel, float scale, float* geometry,
               float* attributes) {
  if (!buffer.covered(pixel)) {
    for (int k = 0; k < 4; ++k) geometry[k] = attributes[k] = 0.0f;
    return;
  }
  const auto& n = buffer.normal[pixel];
  for (std::size_t k = 0; k < 3; ++k) geometry[k] = n[k];
  geometry[3] = buffer.depth[pixel] * scale * (buffer.back_face[pixel] ? -1.0f : 1.0f);
  attributes[0] = buffer.principal.empty() ? 0.0f : buffer.principal[pixel][0] / scale;
  attributes[1] = buffer.principal.empty() ? 0.0f : buffer.principal[pixel][1] / scale;
  attributes[2] = buffer.radius.empty() ? 0.0f : buffer.radius[pixel] * scale;
  const float residual = buffer.residual.empty() ? 0.0f : buffer.residual[pixel];
  attributes[3] = buffer.level.empty()
                      ? 0.0f
                      : levelAndResidual(buffer.level[pixel], residual, buffer.radius[pixel]);
}

void upload(vtkOpenGLRenderWindow* window, int width, int height, int type, const void* data,
            vtkTextureObject* texture) {
  texture->SetContext(window);
  texture->Create2DFromRaw(static_cast<unsigned>(width), static_cast<unsigned>(height), 4, type,
                           const_cast<void*>(data));
}

void setSampling(vtkTextureObject* texture, int filter) {
  texture->SetMinificationFilter(filter);
  texture->SetMagnificationFilter(filter);
  texture->SetWrapS(vtkTextureObject::ClampToEdge);
  texture->SetWrapT(vtkTextureObject::ClampToEdge);
}

}  // namespace

float levelAndResidual(int level, float residual, float radius) {
  const float share = radius > 0.0f ? std::clamp(residual / radius, 0.0f, 0.999f) : 0.0f;
  return static_cast<float>(level) + share;
}

void packFrame(const GBuffer& buffer, double scale, int threads, PackedFrame& frame) {
  const std::size_t pixels = buffer.numPixels();
  const bool colored = !buffer.color.empty();
  frame.geometry.resize(4 * pixels);
  frame.attributes.resize(4 * pixels);
  frame.colors.assign(colored ? 4 * pixels : 0, 255);
  parallelFor(pixels, threads, 16384, [&](std::size_t pixel, int) {
    packPixel(buffer, pixel, static_cast<float>(scale), frame.geometry.data() + 4 * pixel,
              frame.attributes.data() + 4 * pixel);
    for (std::size_t k = 0; colored && k < 3; ++k) {
      frame.colors[4 * pixel + k] =
          static_cast<std::uint8_t>(std::lround(255.0f * buffer.color[pixel][k]));
    }
  });
}

FrameTextures::FrameTextures() {
  setSampling(geometry_, vtkTextureObject::Nearest);
  setSampling(attributes_, vtkTextureObject::Nearest);
  setSampling(colors_, vtkTextureObject::Nearest);
  setSampling(lines_, vtkTextureObject::Nearest);
  setSampling(table_, vtkTextureObject::Linear);
}

FrameTextures::~FrameTextures() = default;

void FrameTextures::setFrame(vtkOpenGLRenderWindow* window, const PackedFrame& frame, int width,
                             int height) {
  width_ = width;
  height_ = height;
  upload(window, width, height, VTK_FLOAT, frame.geometry.data(), geometry_);
  has_attributes_ = false;
  has_colors_ = !frame.colors.empty();
  if (has_colors_) {
    colors_->ResetFormatAndType();
    upload(window, width, height, VTK_UNSIGNED_CHAR, frame.colors.data(), colors_);
  }
}

void FrameTextures::needAttributes(vtkOpenGLRenderWindow* window, const PackedFrame& frame) {
  if (has_attributes_) return;
  upload(window, width_, height_, VTK_FLOAT, frame.attributes.data(), attributes_);
  has_attributes_ = true;
}

void FrameTextures::allocate(vtkOpenGLRenderWindow* window, int width, int height,
                             bool with_colors) {
  width_ = width;
  height_ = height;
  for (vtkTextureObject* texture : {geometry_.Get(), attributes_.Get(), colors_.Get()}) {
    if (texture == colors_ && !with_colors) continue;
    // Colours may have been bytes.
    if (texture == colors_) texture->ResetFormatAndType();
    texture->SetContext(window);
    texture->Allocate2D(static_cast<unsigned>(width), static_cast<unsigned>(height), 4, VTK_FLOAT);
    texture->Deactivate();
  }
  has_attributes_ = true;
  has_colors_ = with_colors;
}

void FrameTextures::fill(const GBuffer& buffer, double scale) {
  std::array<float, 4> geometry{}, attributes{};
  const auto fillOf = [&](vtkTextureObject* texture, const auto& texelOf) {
    texture->Activate();
    for (int y = 0; y < buffer.height; ++y) {
      for (int x = 0; x < buffer.width; ++x) {
        const std::size_t pixel = buffer.index(x, y);
        if (!buffer.covered(pixel)) continue;
        packPixel(buffer, pixel, static_cast<float>(scale), geometry.data(), attributes.data());
        const std::array<float, 4> texel = texelOf(pixel);
        glTexSubImage2D(GL_TEXTURE_2D, 0, x, y, 1, 1, GL_RGBA, GL_FLOAT, texel.data());
      }
    }
    texture->Deactivate();
  };
  fillOf(geometry_, [&](std::size_t) { return geometry; });
  fillOf(attributes_, [&](std::size_t) { return attributes; });
  if (!has_colors_) return;
  fillOf(colors_, [&](std::size_t pixel) {
    const auto& c = buffer.color[pixel];
    return std::array<float, 4>{c[0], c[1], c[2], 1.0f};
  });
}

void FrameTextures::setTable(vtkOpenGLRenderWindow* window, vtkScalarsToColors* table,
                             const ColorScale& scale) {
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < scale.texels; ++i) {
    const double x = scale.texels > 1 ? i / (scale.texels - 1.0) : 0.5;
    const double value = scale.logarithm ? scale.low * std::pow(scale.high / scale.low, x)
                                         : scale.low + x * (scale.high - scale.low);
    const unsigned char* rgba = table->MapValue(value);
    texels.insert(texels.end(), rgba, rgba + 4);
  }
  upload(window, scale.texels, 1, VTK_UNSIGNED_CHAR, texels.data(), table_);
  has_table_ = true;
}

void FrameTextures::setLines(vtkOpenGLRenderWindow* window, const std::vector<std::uint8_t>& rgba) {
  upload(window, width_, height_, VTK_UNSIGNED_CHAR, rgba.data(), lines_);
  has_lines_ = true;
}

void FrameTextures::activate() {
  geometry_->Activate();
  if (has_attributes_) attributes_->Activate();
  if (has_colors_) colors_->Activate();
  if (has_table_) table_->Activate();
  if (has_lines_) lines_->Activate();
}

void FrameTextures::tell(vtkShaderProgram* program) {
  const int unit = geometry_->GetTextureUnit();
  // A sampler of a texture that no mode reads now has to name some texture of its type.
  program->SetUniformi("slimGeometry", unit);
  program->SetUniformi("slimAttributes", has_attributes_ ? attributes_->GetTextureUnit() : unit);
  program->SetUniformi("slimColors", has_colors_ ? colors_->GetTextureUnit() : unit);
  program->SetUniformi("slimTable", has_table_ ? table_->GetTextureUnit() : unit);
  program->SetUniformi("slimLines", has_lines_ ? lines_->GetTextureUnit() : unit);
  program->SetUniformi("slimHasLines", has_lines_);
}

void FrameTextures::deactivate() {
  geometry_->Deactivate();
  if (has_attributes_) attributes_->Deactivate();
  if (has_colors_) colors_->Deactivate();
  if (has_table_) table_->Deactivate();
  if (has_lines_) lines_->Deactivate();
}

void FrameTextures::release(vtkWindow* window) {
  for (vtkTextureObject* texture :
       {geometry_.Get(), attributes_.Get(), colors_.Get(), table_.Get(), lines_.Get()}) {
    texture->ReleaseGraphicsResources(window);
  }
  has_attributes_ = has_colors_ = has_table_ = has_lines_ = false;
}

namespace {

/** \brief Normalised device coordinates of a rectangle that contains every covered pixel. */
std::array<float, 4> coveredRectangle(const GBuffer& buffer) {
  int x0 = buffer.width, x1 = -1, y0 = buffer.height, y1 = -1;
  const auto met = [](std::uint32_t surfel) { return surfel != GBuffer::kNothing; };
  for (int y = 0; y < buffer.height; ++y) {
    const std::uint32_t* row = buffer.surfel.data() + buffer.index(0, y);
    const std::uint32_t* first = std::find_if(row, row + buffer.width, met);
    if (first == row + buffer.width) continue;
    int last = buffer.width - 1;
    while (!met(row[last])) --last;
    x0 = std::min(x0, static_cast<int>(first - row));
    x1 = std::max(x1, last);
    y0 = std::min(y0, y);
    y1 = y;
  }
  const auto ndc = [](int texel, int count) {
    const float x = static_cast<float>(texel) / static_cast<float>(count);
    return std::clamp(2.0f * x - 1.0f, -1.0f, 1.0f);
  };
  // Texels more on each side for what is interpolated between rays, and for lines on the
  // silhouette.
  constexpr int kMore = 2;
  return {ndc(x0 - kMore, buffer.width), -ndc(y1 + 1 + kMore, buffer.height),
          ndc(x1 + 1 + kMore, buffer.width), -ndc(y0 - kMore, buffer.height)};
}

}  // namespace

FrameKey::FrameKey(const VtkView& view, const FrameRequest& request, std::uint64_t object_count)
    : model_to_view(view.gl.model_to_view),
      width(view.gl.width),
      height(view.gl.height),
      near_distance(view.near_distance),
      sides(request.sides),
      lod(request.lod),
      trim(request.trim),
      colored((request.columns & kColorColumn) != 0),
      close_gaps(request.close_gaps),
      object(object_count) {
  const Matrix4& p = view.gl.projection;
  projection = {p[0], p[2], p[3], p[5], p[6], p[7], p[15]};
  for (const HalfSpace& plane : request.clip_planes) {
    planes.insert(planes.end(), plane.normal.begin(), plane.normal.end());
    planes.push_back(plane.offset);
  }
}

bool FrameKey::operator==(const FrameKey& other) const {
  return model_to_view == other.model_to_view && projection == other.projection &&
         width == other.width && height == other.height && near_distance == other.near_distance &&
         planes == other.planes && sides == other.sides && lod == other.lod && trim == other.trim &&
         colored == other.colored && object == other.object;
}

bool CachedFrame::holds(const FrameKey& key, double spacing) const {
  return valid_ && key == key_ && spacing_ <= spacing && (key_.close_gaps || !key.close_gaps);
}

/** \brief Converts a request to a camera whose rays are several pixels apart. */
Error CachedFrame::begin(const VtkView& view, double spacing, FrameRequest& request) {
  valid_ = false;
  if (Error error = translateView(view.gl, view.near_distance, spacing, view_)) return error;
  request.near_plane = view_.near_plane;
  request.lod /= spacing;
  // A frame that has to hurry shows nothing that falls between its rays.
  if (spacing > 1.0) request.lod = std::max(request.lod, 1.0);
  return {};
}

Error CachedFrame::make(const VtkView& view, FrameKey key, double spacing, FrameRequest request,
                        double scale, const Rasterize& rasterize) {
  const Clock::time_point start = Clock::now();
  if (Error error = begin(view, spacing, request)) return error;
  if (Error error = rasterize(view_.camera, request, buffer_)) return error;
  packFrame(buffer_, scale, resolveThreads(request.threads), packed_);
  rectangle_ = coveredRectangle(buffer_);
  covered_ = buffer_.numCovered();
  finish(std::move(key), spacing, start);
  return {};
}

Error CachedFrame::makeOnCard(const VtkView& view, FrameKey key, double spacing,
                              FrameRequest request, const DrawOnCard& draw) {
  const Clock::time_point start = Clock::now();
  if (Error error = begin(view, spacing, request)) return error;
  if (Error error = draw(view_, request, covered_)) return error;
  rectangle_ = {-1.0f, -1.0f, 1.0f, 1.0f};
  finish(std::move(key), spacing, start);
  return {};
}

void CachedFrame::finish(FrameKey key, double spacing, Clock::time_point start) {
  key_ = std::move(key);
  spacing_ = spacing;
  valid_ = true;
  seconds_ = std::chrono::duration<double>(Clock::now() - start).count();
  full_seconds_ = seconds_ * spacing * spacing;
}

void CachedFrame::clear() {
  valid_ = false;
  full_seconds_ = 0.0;
  covered_ = 0;
}

int CachedFrame::coarsenessFor(double milliseconds) const {
  for (const int step : {1, 2}) {
    if (full_seconds_ * 1000.0 <= milliseconds * step * step) return step;
  }
  return 4;
}

}  // namespace pcl_slim::detail
