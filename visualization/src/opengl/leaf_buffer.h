// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkNew.h>

#include "opengl/leaf_texels.h"
#include "pcl_slim/core/error.h"

class vtkOpenGLBufferObject;
class vtkOpenGLRenderWindow;
class vtkTextureObject;
class vtkWindow;

namespace pcl_slim::detail {

/** \brief A surface's surfels on the graphics card, and the trim maps of the open ones, as textures
 * of one dimension. */
class LeafBuffer {
 public:
  LeafBuffer();
  ~LeafBuffer();
  LeafBuffer(const LeafBuffer&) = delete;
  LeafBuffer& operator=(const LeafBuffer&) = delete;

  /** \brief Brings the surfels over, unless they are there. \param[in] with_internal internal ones
   * too. \return an error where the card takes no texture so long. */
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
