// SPDX-License-Identifier: BSD-3-Clause
// A surface on the graphics card: its surfels there, what the passes draw into, and the rasteriser.
#pragma once

#include <vtkNew.h>

#include <array>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "frame/frame.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/surface/surface.h"
#include "pcl_slim/surface/surfel_color.h"
#include "pcl_slim/visualization/g_buffer_mapper.h"

class vtkOpenGLBufferObject;
class vtkOpenGLRenderWindow;
class vtkShaderProgram;
class vtkTextureObject;
class vtkWindow;

namespace pcl_slim::detail {

/** \brief Texels of four numbers a surfel of a surface takes on the graphics card: centre and
 * radius; normal and weight; the frame's u axis with the level and, as its fraction, the residual
 * in radii; where its trim map begins and the level of detail's sizes; then the coefficients; then,
 * of a coloured surface, the terms of its colour, red, green and blue of each, and two numbers for
 * where its texture is. */
constexpr int texelsOfLeaf(int degree, bool colored = false) {
  return 4 + (numCoefficients(degree) + 3) / 4 + (colored ? (3 * kColorTerms + 2 + 3) / 4 : 0);
}

struct LeafTexels;

/** \brief A surface's surfels on the graphics card, the trim maps of the open ones and the colours
 * of those with textures, as textures of one dimension. */
class LeafBuffer {
 public:
  LeafBuffer();
  ~LeafBuffer();
  LeafBuffer(const LeafBuffer&) = delete;
  LeafBuffer& operator=(const LeafBuffer&) = delete;

  /** \brief Uploads the surfels, unless that is done. \param[in] with_internal internal ones
   * too. \return an error where the card takes no texture of that size. */
  Error upload(vtkOpenGLRenderWindow* window, const SLIMSurface& surface, bool with_internal);
  /** \brief Lets the next upload() bring surfels over again. */
  void forget() { there_ = false; }
  void release(vtkWindow* window);

  vtkTextureObject* texture() const { return texture_; }
  vtkTextureObject* trims() const { return trims_; }
  /** \brief Those of surfels; only where the surface has some. */
  vtkTextureObject* colors() const { return colors_; }
  int leaves() const { return leaves_; }
  int surfels() const { return surfels_; }  ///< leaves, which come first, and internal ones

 private:
  Error store(vtkOpenGLRenderWindow* window, const LeafTexels& texels);

  bool there_ = false, internal_there_ = false;
  int leaves_ = 0, surfels_ = 0;
  vtkNew<vtkOpenGLBufferObject> buffer_, trim_buffer_, color_buffer_;
  vtkNew<vtkTextureObject> texture_, trims_, colors_;
};

/** \brief What the passes draw into, and its frame buffer. */
class CardTargets {
 public:
  CardTargets();
  ~CardTargets();
  CardTargets(const CardTargets&) = delete;
  CardTargets& operator=(const CardTargets&) = delete;

  void resize(vtkOpenGLRenderWindow* window, int width, int height);
  /** \brief Lets the next pass draw into these textures, and into a depth buffer if requested. */
  Error drawInto(std::initializer_list<vtkTextureObject*> textures, bool with_depth = false);
  /** \brief Fills the buffer of depths that the next pass draws into. */
  static void clearDepth(float depth);
  void release(vtkWindow* window);

  std::array<vtkNew<vtkTextureObject>, 2> nearest;  ///< where rays begin; below 0: done
  vtkNew<vtkTextureObject> first;                   ///< depth of the first intersection
  vtkNew<vtkTextureObject> met;                     ///< that of the blend that is shown
  std::array<vtkNew<vtkTextureObject>, 5> sums;

 private:
  unsigned frame_buffer_ = 0, depth_buffer_ = 0;
};

/** \brief Keeps VTK's state of OpenGL while own passes run: frame buffer, viewport, blending, depth
 * and masks are as before when it ends. */
class CardState {
 public:
  explicit CardState(vtkOpenGLRenderWindow* window);
  ~CardState();
  CardState(const CardState&) = delete;
  CardState& operator=(const CardState&) = delete;

 private:
  struct Saved;
  Saved* saved_;
};

/** \brief The graphics card's rasteriser of a surface: fills the textures that the CPU's frame is
 * uploaded to otherwise. Pass 1 and pass 2 as in the paper; rays whose blend is not covered go
 * through both again behind it. */
class CardRasterizer {
 public:
  /** \brief What to draw, which must stay until another is set; null: nothing. */
  void setSurface(const SLIMSurface* surface);

  /** \brief Draws a frame. \param[out] covered pixels whose rays met the surface.
   * \return an error where the card lacks what this takes; nothing is drawn then. */
  Error draw(vtkOpenGLRenderWindow* window, const ViewCamera& view, const FrameRequest& request,
             FrameTextures& frame, std::uint64_t& covered);
  static constexpr float kNothing = 3e38f;  ///< depth where no ray has met anything
  /** \brief Depths of the last frame's first intersections, rows from the top. */
  void readMet(std::vector<float>& depths) const;
  void release(vtkWindow* window);

  /** \brief Whether a window's OpenGL runs on a processor, where the other back end is faster. */
  static bool isSoftware();

 private:
  struct Pass;
  struct FrameValues;

  Error drawPasses(Pass& pass, FrameTextures& frame, std::uint64_t& covered);
  Error findFirst(Pass& pass, int from);
  Error blend(Pass& pass);
  Error writeResult(Pass& pass, int from, FrameTextures& frame, std::uint64_t& covered);
  Error peel(Pass& pass, int from, std::uint64_t& left);
  Error nameLeaves(Pass& pass, FrameTextures& frame);
  Error addColors(Pass& pass, FrameTextures& frame);
  std::uint64_t countDrawn();

  const SLIMSurface* surface_ = nullptr;
  LeafBuffer leaves_;
  CardTargets targets_;
  unsigned vertices_ = 0, query_ = 0;
};

}  // namespace pcl_slim::detail
