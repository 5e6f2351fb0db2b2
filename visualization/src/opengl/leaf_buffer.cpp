// SPDX-License-Identifier: BSD-3-Clause
#include "opengl/leaf_buffer.h"

#include <vtkOpenGLBufferObject.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkTextureObject.h>
#include <vtk_glew.h>

#include <algorithm>

#include "frame/packed_frame.h"

namespace pcl_slim::detail {

std::vector<float>
packLeaves(const SLIMSurface& surface)
{
  const std::size_t length = 4 * static_cast<std::size_t>(texelsOfLeaf(surface.info.degree));
  std::vector<float> texels;
  texels.reserve(surface.numLeaves() * length);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!surface.isLeaf(i)) continue;
    const std::array<double, 3> normal{surface.nx[i], surface.ny[i], surface.nz[i]};
    const LocalFrame frame(normal);
    const double weight = surface.info.paper_mode ? 1.0 : surface.varianceWeight(i);
    const std::size_t end = texels.size() + length;
    texels.insert(texels.end(), {surface.cx[i], surface.cy[i], surface.cz[i], surface.radius[i]});
    for (const double value : frame.w) texels.push_back(static_cast<float>(value));
    texels.push_back(static_cast<float>(weight));
    for (const double value : frame.u) texels.push_back(static_cast<float>(value));
    texels.push_back(levelAndResidual(surface.level[i], surface.error[i], surface.radius[i]));
    const float* c = surface.coefficientsOf(i);
    texels.insert(texels.end(), c, c + surface.stride());
    texels.resize(end, 0.0f);
  }
  return texels;
}

LeafBuffer::LeafBuffer() = default;
LeafBuffer::~LeafBuffer() = default;

Error
LeafBuffer::upload(vtkOpenGLRenderWindow* window, const SLIMSurface& surface)
{
  if (there_) return {};
  const std::vector<float> texels = packLeaves(surface);
  GLint most = 0;
  window->GetState()->vtkglGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  if (texels.size() / 4 > static_cast<std::size_t>(std::max(0, most))) {
    return {ErrorCode::kBadArgument,
            "the graphics card takes no surface of so many leaves; draw it on the CPU"};
  }
  leaves_ = static_cast<int>(surface.numLeaves());
  if (leaves_ == 0) return {};
  buffer_->Upload(texels, vtkOpenGLBufferObject::TextureBuffer);
  texture_->SetContext(window);
  const bool made = texture_->CreateTextureBuffer(static_cast<unsigned>(texels.size() / 4), 4,
                                                  VTK_FLOAT, buffer_);
  if (!made) return {ErrorCode::kBadArgument, "the graphics card has no texture buffers"};
  there_ = true;
  return {};
}

void
LeafBuffer::release(vtkWindow* window)
{
  texture_->ReleaseGraphicsResources(window);
  buffer_->ReleaseGraphicsResources();
  there_ = false;
}

}  // namespace pcl_slim::detail
