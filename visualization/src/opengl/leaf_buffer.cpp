// SPDX-License-Identifier: BSD-3-Clause
#include "opengl/leaf_buffer.h"

#include <vtkOpenGLBufferObject.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkTextureObject.h>
#include <vtk_glew.h>

#include <algorithm>
#include <cmath>

#include "frame/frame_textures.h"
#include "pcl_slim/surface/detail/detail_sizes.h"
#include "pcl_slim/surface/detail/trim_tables.h"

namespace pcl_slim::detail {
namespace {

constexpr std::size_t kWordsOfUnit = 4096;  ///< begins of maps in two floats, both exact

/** \brief Appends one surfel after another. */
class Packer {
 public:
  Packer(const SLIMSurface& surface, LeafTexels& texels)
      : surface_(surface),
        trims_(surface),
        sizes_(surface),
        length_(4 *
                static_cast<std::size_t>(texelsOfLeaf(surface.info.degree, surface.hasColors()))),
        texels_(texels)
  {
  }

  /** \param[in] scale of its ball; the surface in it stays the same */
  void add(std::size_t i, float scale)
  {
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
    if (s.hasColors()) addColor(i, scale);
    to.resize(end, 0.0f);
  }

 private:
  void addCoefficients(std::size_t i, float scale)
  {
    const float* c = surface_.coefficientsOf(i);
    const int degree = surface_.info.degree;
    float power = 1.0f / scale;  // of a radius that large, at height 0
    for (int n = 0, k = 0; n <= degree; ++n, power *= scale) {
      for (int j = 0; j <= n; ++j, ++k) texels_.surfels.push_back(power * c[k]);
    }
  }

  void addColor(std::size_t i, float scale)
  {
    const ColorPolynomial color = decodeColor(surface_.colors.data() + i * kColorBytes);
    float power = 1.0f;
    for (int n = 0, k = 0; n <= kColorDegree; ++n, power *= scale) {
      for (int j = 0; j <= n; ++j, ++k) {
        for (const float value : color[static_cast<std::size_t>(k)])
          texels_.surfels.push_back(power * value);
      }
    }
  }

  void addTrim(const TrimTable& table)
  {
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

}  // namespace

LeafTexels
packLeaves(const SLIMSurface& surface, bool with_internal)
{
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
  return texels;
}

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
