// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkNew.h>

#include <cstdint>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/surface/surface.h"
#include "pcl_slim/surface/surfel_color.h"

class vtkOpenGLBufferObject;
class vtkOpenGLRenderWindow;
class vtkTextureObject;
class vtkWindow;

namespace pcl_slim::detail {

/** \brief Texels of four numbers a surfel of a surface takes on the graphics card: centre and
 * radius; normal and weight; the frame's u axis with the level and, as its fraction, the residual in
 * radii; where its trim map begins and the level of detail's sizes; then the coefficients; then, of a
 * coloured surface, the terms of its colour, red, green and blue of each. */
constexpr int
texelsOfLeaf(int degree, bool colored = false)
{
  return 4 + (numCoefficients(degree) + 3) / 4 + (colored ? (3 * kColorTerms + 3) / 4 : 0);
}

/** \brief A surface as the shaders read it. */
struct LeafTexels {
  /** texelsOfLeaf() texels for each leaf and, behind all leaves, for each internal
   * surfel if they were requested. The fourth texel of one: the begin of its trim map in 4096 words,
   * what that leaves over times TrimMap::kMostSide plus the map's side less 1, or -1 of a closed one; its own
   * and its parents' DetailSizes. Balls of internal surfels are
   * drawn larger than their radius. */
  std::vector<float> surfels;
  /** Words of TrimTable, row by row; one word at least, as a buffer cannot be empty. */
  std::vector<std::int32_t> trim_words;
  std::size_t leaves = 0, all = 0;  ///< surfels in the texels
};

/** \brief Packs a surface. \param[in] with_internal internal surfels too, which a level of detail
 * needs. O(surfels + links). */
LeafTexels
packLeaves(const SLIMSurface& surface, bool with_internal);

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

}  // namespace pcl_slim::detail
