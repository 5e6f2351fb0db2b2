// SPDX-License-Identifier: BSD-3-Clause
// A surface on the graphics card: its surfels there, what the passes draw into, their shaders, and
// the rasteriser.
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
 * of a coloured surface, the terms of its colour, red, green and blue of each. */
constexpr int texelsOfLeaf(int degree, bool colored = false) {
  return 4 + (numCoefficients(degree) + 3) / 4 + (colored ? (3 * kColorTerms + 3) / 4 : 0);
}

struct LeafTexels;

/** \brief A surface's surfels on the graphics card, and the trim maps of the open ones, as textures
 * of one dimension. */
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
  int leaves() const { return leaves_; }
  int surfels() const { return surfels_; }  ///< leaves, which come first, and internal ones

 private:
  Error store(vtkOpenGLRenderWindow* window, const LeafTexels& texels);

  bool there_ = false, internal_there_ = false;
  int leaves_ = 0, surfels_ = 0;
  vtkNew<vtkOpenGLBufferObject> buffer_, trim_buffer_;
  vtkNew<vtkTextureObject> texture_, trims_;
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

/** \brief GLSL of the camera: uniforms and the ray through a fragment. */
extern const char* const kCameraGlsl;
/** \brief GLSL of a leaf: its texels, its polynomial along a ray, and that one's roots. */
extern const char* const kLeafGlsl;

// The passes of a frame, for VTK and for pages (web/bundle.cmake reads them). They take the numbers
// of FrameConstant by name, and slimTexel() and slimTrimWord() from whoever stores the surface.
extern const char* const kSurfel;     ///< vertex: what a surfel counts for, where its trim map is
extern const char* const kTrims;      ///< lookup in trim maps
extern const char* const kFirstPass;  ///< first hits
extern const char* const kBlended;    ///< what the next two have in common
extern const char* const kBlendPass;  ///< sums over the leaves at a first hit
extern const char* const kLeafPass;   ///< the leaf of the largest weight
extern const char* const kColorPass;  ///< sums of colours over the leaves at the blend
extern const char* const kSums;       ///< a pixel's sums, and whether its leaves cover the blend
extern const char* const kResult;     ///< normal, depth and curvatures of the sums
extern const char* const kPeel;       ///< where uncovered rays begin once more

// The passes of Ohtake, Belyaev, Alexa 2005, section 3, in GLSL 1.50, each leaf a rectangle around
// its ball and each pixel a ray. The rules are those of the reference rasteriser, in float.

/** \brief Vertices of a leaf's rectangle, the leaf being the instance. */
std::string leafVertexShader();
/** \brief Vertices of the whole frame. */
std::string frameVertexShader();

/** \brief Pass 1: depth of a leaf's first root inside its shrunk ball, for blending by minimum. */
std::string firstPassShader();
/** \brief Pass 2: what a leaf adds to the sums of a pixel, for blending by addition. */
std::string blendPassShader();
/** \brief Radius, level and residual of the leaf of the largest weight, by a depth test. */
std::string leafPassShader();
/** \brief What a leaf adds to the colour of the blend that is shown: weighted red, green, blue and
 * the weight, for blending by addition. */
std::string colorPassShader();
/** \brief Sums to normal, depth and curvatures, where the leaves cover the blend. */
std::string resultShader();
/** \brief Where rays whose blend is not covered begin again behind it. */
std::string peelShader();

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
