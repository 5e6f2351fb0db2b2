// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "frame/view_camera.h"
#include "opengl/card_targets.h"
#include "opengl/leaf_buffer.h"
#include "pcl_slim/visualization/g_buffer_mapper.h"

class vtkShaderProgram;

namespace pcl_slim::detail {

class FrameTextures;

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
