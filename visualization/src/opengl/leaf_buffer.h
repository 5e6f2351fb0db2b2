// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkNew.h>

#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/surface/surface.h"

class vtkOpenGLBufferObject;
class vtkOpenGLRenderWindow;
class vtkTextureObject;
class vtkWindow;

namespace pcl_slim::detail {

/** \brief Texels of four numbers a leaf of a surface takes on the graphics card: centre and radius,
 * normal and weight, the frame's u axis with the level and, as its fraction, the residual in radii;
 * then the coefficients. */
constexpr int
texelsOfLeaf(int degree)
{
  return 3 + (numCoefficients(degree) + 3) / 4;
}

/** \brief A surface's leaves, texelsOfLeaf(info.degree) texels each. O(leaves). */
std::vector<float>
packLeaves(const SLIMSurface& surface);

/** \brief Those on the graphics card, as a texture of one dimension. */
class LeafBuffer {
 public:
  LeafBuffer();
  ~LeafBuffer();
  LeafBuffer(const LeafBuffer&) = delete;
  LeafBuffer& operator=(const LeafBuffer&) = delete;

  /** \brief Brings the leaves over, unless they are there. \return an error where the card takes no
   * texture so long. */
  Error upload(vtkOpenGLRenderWindow* window, const SLIMSurface& surface);
  /** \brief Lets the next upload() bring leaves over again. */
  void forget() { there_ = false; }
  void release(vtkWindow* window);

  vtkTextureObject* texture() const { return texture_; }
  int leaves() const { return leaves_; }

 private:
  bool there_ = false;
  int leaves_ = 0;
  vtkNew<vtkOpenGLBufferObject> buffer_;
  vtkNew<vtkTextureObject> texture_;
};

}  // namespace pcl_slim::detail
