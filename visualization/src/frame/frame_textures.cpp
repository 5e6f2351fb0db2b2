// SPDX-License-Identifier: BSD-3-Clause
#include "frame/frame_textures.h"

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

void
packPixel(const GBuffer& buffer, std::size_t pixel, float scale, float* geometry, float* attributes)
{
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

void
upload(vtkOpenGLRenderWindow* window, int width, int height, int type, const void* data,
       vtkTextureObject* texture)
{
  texture->SetContext(window);
  texture->Create2DFromRaw(static_cast<unsigned>(width), static_cast<unsigned>(height), 4, type,
                           const_cast<void*>(data));
}

void
setSampling(vtkTextureObject* texture, int filter)
{
  texture->SetMinificationFilter(filter);
  texture->SetMagnificationFilter(filter);
  texture->SetWrapS(vtkTextureObject::ClampToEdge);
  texture->SetWrapT(vtkTextureObject::ClampToEdge);
}

}  // namespace

float
levelAndResidual(int level, float residual, float radius)
{
  const float share = radius > 0.0f ? std::clamp(residual / radius, 0.0f, 0.999f) : 0.0f;
  return static_cast<float>(level) + share;
}

void
packFrame(const GBuffer& buffer, double scale, int threads, PackedFrame& frame)
{
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

FrameTextures::FrameTextures()
{
  setSampling(geometry_, vtkTextureObject::Nearest);
  setSampling(attributes_, vtkTextureObject::Nearest);
  setSampling(colors_, vtkTextureObject::Nearest);
  setSampling(lines_, vtkTextureObject::Nearest);
  setSampling(table_, vtkTextureObject::Linear);
}

FrameTextures::~FrameTextures() = default;

void
FrameTextures::setFrame(vtkOpenGLRenderWindow* window, const PackedFrame& frame, int width,
                        int height)
{
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

void
FrameTextures::needAttributes(vtkOpenGLRenderWindow* window, const PackedFrame& frame)
{
  if (has_attributes_) return;
  upload(window, width_, height_, VTK_FLOAT, frame.attributes.data(), attributes_);
  has_attributes_ = true;
}

void
FrameTextures::allocate(vtkOpenGLRenderWindow* window, int width, int height, bool with_colors)
{
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

void
FrameTextures::fill(const GBuffer& buffer, double scale)
{
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

void
FrameTextures::setTable(vtkOpenGLRenderWindow* window, vtkScalarsToColors* table,
                        const ColorScale& scale)
{
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

void
FrameTextures::setLines(vtkOpenGLRenderWindow* window, const std::vector<std::uint8_t>& rgba)
{
  upload(window, width_, height_, VTK_UNSIGNED_CHAR, rgba.data(), lines_);
  has_lines_ = true;
}

void
FrameTextures::activate()
{
  geometry_->Activate();
  if (has_attributes_) attributes_->Activate();
  if (has_colors_) colors_->Activate();
  if (has_table_) table_->Activate();
  if (has_lines_) lines_->Activate();
}

void
FrameTextures::tell(vtkShaderProgram* program)
{
  const int unit = geometry_->GetTextureUnit();
  // A sampler of a texture that no mode reads now has to name some texture of its type.
  program->SetUniformi("slimGeometry", unit);
  program->SetUniformi("slimAttributes", has_attributes_ ? attributes_->GetTextureUnit() : unit);
  program->SetUniformi("slimColors", has_colors_ ? colors_->GetTextureUnit() : unit);
  program->SetUniformi("slimTable", has_table_ ? table_->GetTextureUnit() : unit);
  program->SetUniformi("slimLines", has_lines_ ? lines_->GetTextureUnit() : unit);
  program->SetUniformi("slimHasLines", has_lines_);
}

void
FrameTextures::deactivate()
{
  geometry_->Deactivate();
  if (has_attributes_) attributes_->Deactivate();
  if (has_colors_) colors_->Deactivate();
  if (has_table_) table_->Deactivate();
  if (has_lines_) lines_->Deactivate();
}

void
FrameTextures::release(vtkWindow* window)
{
  for (vtkTextureObject* texture :
       {geometry_.Get(), attributes_.Get(), colors_.Get(), table_.Get(), lines_.Get()}) {
    texture->ReleaseGraphicsResources(window);
  }
  has_attributes_ = has_colors_ = has_table_ = has_lines_ = false;
}

}  // namespace pcl_slim::detail
