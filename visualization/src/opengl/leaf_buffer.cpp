// SPDX-License-Identifier: BSD-3-Clause
#include "opengl/leaf_buffer.h"

#include <vtkOpenGLBufferObject.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkTextureObject.h>
#include <vtk_glew.h>

#include <algorithm>

namespace pcl_slim::detail {

LeafBuffer::LeafBuffer() = default;
LeafBuffer::~LeafBuffer() = default;

Error
LeafBuffer::upload(vtkOpenGLRenderWindow* window, const SLIMSurface& surface, bool with_internal)
{
  if (there_ && (internal_there_ || !with_internal)) return {};
  leaves_ = surfels_ = 0;
  const LeafTexels texels = packLeaves(surface, with_internal);
  if (texels.leaves == 0) return {};
  if (Error error = store(window, texels)) return error;
  leaves_ = static_cast<int>(texels.leaves);
  surfels_ = static_cast<int>(texels.all);
  there_ = true;
  internal_there_ = with_internal;
  return {};
}

Error
LeafBuffer::store(vtkOpenGLRenderWindow* window, const LeafTexels& texels)
{
  GLint most = 0;
  window->GetState()->vtkglGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  if (std::max(texels.surfels.size() / 4, texels.trim_words.size()) >
      static_cast<std::size_t>(std::max(0, most))) {
    return {ErrorCode::kBadArgument,
            "the graphics card takes no surface of so many leaves; draw it on the CPU"};
  }
  buffer_->Upload(texels.surfels, vtkOpenGLBufferObject::TextureBuffer);
  trim_buffer_->Upload(texels.trim_words, vtkOpenGLBufferObject::TextureBuffer);
  texture_->SetContext(window);
  trims_->SetContext(window);
  // Of itself VTK would have the shader read whole numbers as floats.
  trims_->SetInternalFormat(GL_R32I);
  const bool made = texture_->CreateTextureBuffer(static_cast<unsigned>(texels.surfels.size() / 4),
                                                  4, VTK_FLOAT, buffer_) &&
                    trims_->CreateTextureBuffer(static_cast<unsigned>(texels.trim_words.size()), 1,
                                                VTK_INT, trim_buffer_);
  return made ? Error{}
              : Error{ErrorCode::kBadArgument, "the graphics card has no texture buffers"};
}

void
LeafBuffer::release(vtkWindow* window)
{
  for (vtkTextureObject* texture : {texture_.Get(), trims_.Get()}) {
    texture->ReleaseGraphicsResources(window);
  }
  for (vtkOpenGLBufferObject* buffer : {buffer_.Get(), trim_buffer_.Get()}) {
    buffer->ReleaseGraphicsResources();
  }
  there_ = false;
}

}  // namespace pcl_slim::detail
