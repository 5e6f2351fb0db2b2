// SPDX-License-Identifier: BSD-3-Clause
#include "opengl/card_targets.h"

#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkTextureObject.h>
#include <vtk_glew.h>

#include <algorithm>
#include <vector>

namespace pcl_slim::detail {
namespace {

void
allocate(vtkOpenGLRenderWindow* window, int width, int height, int numbers,
         vtkTextureObject* texture)
{
  texture->SetContext(window);
  texture->SetMinificationFilter(vtkTextureObject::Nearest);
  texture->SetMagnificationFilter(vtkTextureObject::Nearest);
  texture->Allocate2D(static_cast<unsigned>(width), static_cast<unsigned>(height), numbers,
                      VTK_FLOAT);
  texture->Deactivate();
}

}  // namespace

CardTargets::CardTargets() = default;
CardTargets::~CardTargets() = default;

void
CardTargets::resize(vtkOpenGLRenderWindow* window, int width, int height)
{
  const bool fits = first->GetHandle() != 0 && static_cast<int>(first->GetWidth()) == width &&
                    static_cast<int>(first->GetHeight()) == height;
  if (fits) return;
  for (auto& texture : nearest) allocate(window, width, height, 1, texture);
  for (vtkTextureObject* texture : {first.Get(), met.Get()}) {
    allocate(window, width, height, 1, texture);
  }
  for (auto& texture : sums) allocate(window, width, height, 4, texture);
  if (frame_buffer_ == 0) glGenFramebuffers(1, &frame_buffer_);
  if (depth_buffer_ == 0) glGenRenderbuffers(1, &depth_buffer_);
  glBindRenderbuffer(GL_RENDERBUFFER, depth_buffer_);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, width, height);
  glBindRenderbuffer(GL_RENDERBUFFER, 0);
}

Error
CardTargets::drawInto(std::initializer_list<vtkTextureObject*> textures, bool with_depth)
{
  constexpr unsigned kMost = 5;
  glBindFramebuffer(GL_FRAMEBUFFER, frame_buffer_);
  std::vector<GLenum> attached;
  for (vtkTextureObject* texture : textures) {
    attached.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(attached.size()));
    glFramebufferTexture2D(GL_FRAMEBUFFER, attached.back(), GL_TEXTURE_2D, texture->GetHandle(), 0);
  }
  for (auto i = static_cast<GLenum>(attached.size()); i < kMost; ++i) {
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0 + i, GL_TEXTURE_2D, 0, 0);
  }
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
                            with_depth ? depth_buffer_ : 0);
  glDrawBuffers(static_cast<GLsizei>(attached.size()), attached.data());
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE) return {};
  return {ErrorCode::kBadArgument,
          "the graphics card cannot draw into textures of floats; draw on the CPU"};
}

void
CardTargets::clearDepth(float depth)
{
  glClearBufferfv(GL_DEPTH, 0, &depth);
}

void
CardTargets::release(vtkWindow* window)
{
  for (auto& texture : nearest) texture->ReleaseGraphicsResources(window);
  for (auto& texture : sums) texture->ReleaseGraphicsResources(window);
  first->ReleaseGraphicsResources(window);
  met->ReleaseGraphicsResources(window);
  if (frame_buffer_ != 0) glDeleteFramebuffers(1, &frame_buffer_);
  if (depth_buffer_ != 0) glDeleteRenderbuffers(1, &depth_buffer_);
  frame_buffer_ = depth_buffer_ = 0;
}

struct CardState::Saved {
  vtkOpenGLState* state;
  vtkOpenGLState::ScopedglViewport viewport;
  vtkOpenGLState::ScopedglBlendFuncSeparate blend;
  vtkOpenGLState::ScopedglColorMask color_mask;
  vtkOpenGLState::ScopedglDepthMask depth_mask;
  vtkOpenGLState::ScopedglDepthFunc depth_function;
  vtkOpenGLState::ScopedglEnableDisable depth_test, blending, scissor, culling, stencil;
  GLint draw_buffer = 0, read_buffer = 0, vertices = 0, equation = GL_FUNC_ADD,
        alpha_equation = GL_FUNC_ADD;

  explicit Saved(vtkOpenGLState* s)
      : state(s),
        viewport(s),
        blend(s),
        color_mask(s),
        depth_mask(s),
        depth_function(s),
        depth_test(s, GL_DEPTH_TEST),
        blending(s, GL_BLEND),
        scissor(s, GL_SCISSOR_TEST),
        culling(s, GL_CULL_FACE),
        stencil(s, GL_STENCIL_TEST)
  {
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draw_buffer);
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read_buffer);
    glGetIntegerv(GL_VERTEX_ARRAY_BINDING, &vertices);
    glGetIntegerv(GL_BLEND_EQUATION_RGB, &equation);
    glGetIntegerv(GL_BLEND_EQUATION_ALPHA, &alpha_equation);
  }
};

CardState::CardState(vtkOpenGLRenderWindow* window) : saved_(new Saved(window->GetState()))
{
  for (const GLenum what :
       {GL_DEPTH_TEST, GL_BLEND, GL_SCISSOR_TEST, GL_CULL_FACE, GL_STENCIL_TEST}) {
    saved_->state->vtkglDisable(what);
  }
  saved_->state->vtkglColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  saved_->state->vtkglDepthMask(GL_TRUE);
}

CardState::~CardState()
{
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(saved_->draw_buffer));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(saved_->read_buffer));
  glBindVertexArray(static_cast<GLuint>(saved_->vertices));
  saved_->state->vtkglBlendEquationSeparate(static_cast<unsigned>(saved_->equation),
                                            static_cast<unsigned>(saved_->alpha_equation));
  delete saved_;
}

}  // namespace pcl_slim::detail
