// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkNew.h>

#include <array>
#include <initializer_list>

#include "pcl_slim/core/error.h"

class vtkOpenGLRenderWindow;
class vtkTextureObject;
class vtkWindow;

namespace pcl_slim::detail {

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

}  // namespace pcl_slim::detail
