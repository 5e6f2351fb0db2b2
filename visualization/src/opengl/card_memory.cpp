// SPDX-License-Identifier: BSD-3-Clause
#include <vtkOpenGLBufferObject.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkTextureObject.h>
#include <vtk_glew.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "frame/frame.h"
#include "opengl/card_rasterizer.h"
#include "pcl_slim/surface/detail/detail_sizes.h"
#include "pcl_slim/surface/detail/trim_tables.h"

namespace pcl_slim::detail {

/** \brief A surface as the shaders read it. */
struct LeafTexels {
  /** texelsOfLeaf() texels for each leaf and, behind all leaves, for each internal surfel if they
   * were requested. The fourth texel of one: the begin of its trim map in 4096 words, what that
   * leaves over times TrimMap::kMostSide plus the map's side less 1, or -1 of a closed one; its own
   * and its parents' DetailSizes. Balls of internal surfels are drawn larger than their radius. */
  std::vector<float> surfels;
  /** Texels of the surfels' textures, red, green, blue and one byte more of each: cards have no
   * buffers of three bytes. Two numbers behind the terms of a colour are where its texture begins,
   * in 65536 texels, and what that leaves over times 256 plus its side; 0 where there is none. */
  std::vector<std::uint8_t> colors;
  /** Words of TrimTable, row by row; one word at least, as a buffer cannot be empty. */
  std::vector<std::int32_t> trim_words;
  std::size_t leaves = 0, all = 0;  ///< surfels in the texels
};

namespace {

// Begins of maps and textures are in two floats, both exact.
constexpr std::size_t kWordsOfUnit = 4096;
constexpr std::size_t kTexelsOfUnit = 65536, kSides = 256;
static_assert(SurfelTexture::kMostSide < kSides && kTexelsOfUnit * kSides <= 1u << 24);

/** \brief Appends one surfel after another. */
class Packer {
 public:
  Packer(const SLIMSurface& surface, LeafTexels& texels)
      : surface_(surface),
        trims_(surface),
        sizes_(surface),
        length_(4 *
                static_cast<std::size_t>(texelsOfLeaf(surface.info.degree, surface.hasColors()))),
        texels_(texels) {}

  /** \param[in] scale of its ball; the surface in it stays the same */
  void add(std::size_t i, float scale) {
    std::vector<float>& to = texels_.surfels;
    const SLIMSurface& s = surface_;
    const LocalFrame frame({s.nx[i], s.ny[i], s.nz[i]});
    const double weight = s.info.paper_mode ? 1.0 : s.varianceWeight(i);
    const std::size_t end = to.size() + length_;
    to.insert(to.end(), {s.cx[i], s.cy[i], s.cz[i], scale * s.radius[i]});
    for (const double value : frame.w) to.push_back(static_cast<float>(value));
    to.push_back(static_cast<float>(weight));
    for (const double value : frame.u) to.push_back(static_cast<float>(value));
    to.push_back(levelAndResidual(s.level[i], s.error[i], s.radius[i]));
    addTrim(trims_.of(i));
    to.push_back(sizes_.own[i]);
    to.push_back(sizes_.parent[i]);
    addCoefficients(i, scale);
    const std::size_t colors =
        end - length_ + 4 * static_cast<std::size_t>(texelsOfLeaf(s.info.degree));
    to.resize(colors, 0.0f);
    if (s.hasColors()) {
      addColor(i, scale);
      addTexture(s.texture(i));
    }
    to.resize(end, 0.0f);
  }

 private:
  void addCoefficients(std::size_t i, float scale) {
    const float* c = surface_.coefficientsOf(i);
    const int degree = surface_.info.degree;
    float power = 1.0f / scale;  // of a radius that large, at height 0
    for (int n = 0, k = 0; n <= degree; ++n, power *= scale) {
      for (int j = 0; j <= n; ++j, ++k) texels_.surfels.push_back(power * c[k]);
    }
  }

  void addColor(std::size_t i, float scale) {
    const ColorPolynomial color = decodeColor(surface_.colors.data() + i * kColorBytes);
    float power = 1.0f;
    for (int n = 0, k = 0; n <= kColorDegree; ++n, power *= scale) {
      for (int j = 0; j <= n; ++j, ++k) {
        for (const float value : color[static_cast<std::size_t>(k)])
          texels_.surfels.push_back(power * value);
      }
    }
  }

  void addTexture(const SurfelTexture& texture) {
    if (texture.empty()) return;
    std::vector<std::uint8_t>& to = texels_.colors;
    const std::size_t begin = to.size() / 4, side = static_cast<std::size_t>(texture.side);
    texels_.surfels.push_back(static_cast<float>(begin / kTexelsOfUnit));
    texels_.surfels.push_back(static_cast<float>(begin % kTexelsOfUnit * kSides + side));
    for (std::size_t k = 0; k < side * side; ++k) {
      const std::uint8_t* rgb = texture.rgb + 3 * k;
      to.insert(to.end(), {rgb[0], rgb[1], rgb[2], 255});
    }
  }

  void addTrim(const TrimTable& table) {
    const std::size_t begin = texels_.trim_words.size(), unit = begin / kWordsOfUnit;
    const auto last = static_cast<int>(table.last);
    const float rest =
        table.closed() ? -1.0f
                       : static_cast<float>(begin % kWordsOfUnit * TrimMap::kMostSide) + table.last;
    texels_.surfels.insert(texels_.surfels.end(), {static_cast<float>(unit), rest});
    if (table.closed()) return;
    texels_.trim_words.insert(texels_.trim_words.end(), table.words,
                              table.words + table.words_per_row * (last + 1));
  }

  const SLIMSurface& surface_;
  TrimTables trims_;
  DetailSizes sizes_;
  std::size_t length_;
  LeafTexels& texels_;
};

/** \brief Packs a surface. \param[in] with_internal internal surfels too, which a level of detail
 * needs. O(surfels + links). */
LeafTexels packLeaves(const SLIMSurface& surface, bool with_internal) {
  LeafTexels texels;
  texels.leaves = surface.numLeaves();
  texels.all = with_internal ? surface.size() : texels.leaves;
  texels.surfels.reserve(
      texels.all * 4 *
      static_cast<std::size_t>(texelsOfLeaf(surface.info.degree, surface.hasColors())));
  Packer packer(surface, texels);
  // Internal surfels overlap far less than leaves: their balls are so large that what rays meet of
  // them in pass 1 is the whole of what was fitted.
  constexpr double kMost = 0.95;
  const auto internal =
      static_cast<float>(kMost / std::clamp(surface.info.cover_radius, 0.05, kMost));
  for (const bool leaves : {true, false}) {
    for (std::size_t i = 0; (leaves || with_internal) && i < surface.size(); ++i) {
      if (surface.isLeaf(i) == leaves) packer.add(i, leaves ? 1.0f : internal);
    }
  }
  if (texels.trim_words.empty()) texels.trim_words.push_back(0);
  // Internal surfels alone may have textures.
  if (surface.hasTextures() && texels.colors.empty()) texels.colors.resize(4);
  return texels;
}

}  // namespace

LeafBuffer::LeafBuffer() = default;
LeafBuffer::~LeafBuffer() = default;

Error LeafBuffer::upload(vtkOpenGLRenderWindow* window, const SLIMSurface& surface,
                         bool with_internal) {
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

Error LeafBuffer::store(vtkOpenGLRenderWindow* window, const LeafTexels& texels) {
  GLint most = 0;
  window->GetState()->vtkglGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  if (std::max({texels.surfels.size() / 4, texels.trim_words.size(), texels.colors.size() / 4}) >
      static_cast<std::size_t>(std::max(0, most))) {
    return {ErrorCode::kBadArgument,
            "the graphics card takes no surface of so many leaves or so fine textures; draw it on "
            "the CPU"};
  }
  buffer_->Upload(texels.surfels, vtkOpenGLBufferObject::TextureBuffer);
  trim_buffer_->Upload(texels.trim_words, vtkOpenGLBufferObject::TextureBuffer);
  texture_->SetContext(window);
  trims_->SetContext(window);
  // Of itself VTK would have the shader read whole numbers as floats.
  trims_->SetInternalFormat(GL_R32I);
  bool made = texture_->CreateTextureBuffer(static_cast<unsigned>(texels.surfels.size() / 4), 4,
                                            VTK_FLOAT, buffer_) &&
              trims_->CreateTextureBuffer(static_cast<unsigned>(texels.trim_words.size()), 1,
                                          VTK_INT, trim_buffer_);
  if (texels.colors.empty()) {  // those of another surface are no longer needed
    colors_->ReleaseGraphicsResources(window);
    color_buffer_->ReleaseGraphicsResources();
  } else {
    color_buffer_->Upload(texels.colors, vtkOpenGLBufferObject::TextureBuffer);
    colors_->SetContext(window);
    colors_->SetInternalFormat(GL_RGBA8);
    made = made && colors_->CreateTextureBuffer(static_cast<unsigned>(texels.colors.size() / 4), 4,
                                                VTK_UNSIGNED_CHAR, color_buffer_);
  }
  return made ? Error{}
              : Error{ErrorCode::kBadArgument, "the graphics card has no texture buffers"};
}

void LeafBuffer::release(vtkWindow* window) {
  for (vtkTextureObject* texture : {texture_.Get(), trims_.Get(), colors_.Get()}) {
    texture->ReleaseGraphicsResources(window);
  }
  for (vtkOpenGLBufferObject* buffer : {buffer_.Get(), trim_buffer_.Get(), color_buffer_.Get()}) {
    buffer->ReleaseGraphicsResources();
  }
  there_ = false;
}

namespace {

void allocate(vtkOpenGLRenderWindow* window, int width, int height, int numbers,
              vtkTextureObject* texture) {
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

void CardTargets::resize(vtkOpenGLRenderWindow* window, int width, int height) {
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

Error CardTargets::drawInto(std::initializer_list<vtkTextureObject*> textures, bool with_depth) {
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

void CardTargets::clearDepth(float depth) {
  glClearBufferfv(GL_DEPTH, 0, &depth);
}

void CardTargets::release(vtkWindow* window) {
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
        stencil(s, GL_STENCIL_TEST) {
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draw_buffer);
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read_buffer);
    glGetIntegerv(GL_VERTEX_ARRAY_BINDING, &vertices);
    glGetIntegerv(GL_BLEND_EQUATION_RGB, &equation);
    glGetIntegerv(GL_BLEND_EQUATION_ALPHA, &alpha_equation);
  }
};

CardState::CardState(vtkOpenGLRenderWindow* window) : saved_(new Saved(window->GetState())) {
  for (const GLenum what :
       {GL_DEPTH_TEST, GL_BLEND, GL_SCISSOR_TEST, GL_CULL_FACE, GL_STENCIL_TEST}) {
    saved_->state->vtkglDisable(what);
  }
  saved_->state->vtkglColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  saved_->state->vtkglDepthMask(GL_TRUE);
}

CardState::~CardState() {
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(saved_->draw_buffer));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(saved_->read_buffer));
  glBindVertexArray(static_cast<GLuint>(saved_->vertices));
  saved_->state->vtkglBlendEquationSeparate(static_cast<unsigned>(saved_->equation),
                                            static_cast<unsigned>(saved_->alpha_equation));
  delete saved_;
}

}  // namespace pcl_slim::detail
