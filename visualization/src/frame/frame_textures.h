// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkNew.h>
#include <cstdint>
#include <vector>

#include "color/color_scale.h"
#include "pcl_slim/render/g_buffer.h"

class vtkOpenGLRenderWindow;
class vtkScalarsToColors;
class vtkShaderProgram;
class vtkTextureObject;
class vtkWindow;

namespace pcl_slim::detail {

/** \brief A G-buffer as the resolve shader reads it; rows from the top. Both back ends make it. */
struct PackedFrame {
  /** Normal in the model's axes; depth along the ray in the model's units, below 0 where the
   * surface is seen from behind, 0 where nothing is met. Four numbers a pixel. */
  std::vector<float> geometry;
  /** k_max and k_min (1/length), radius (length), levelAndResidual(). Four numbers a pixel. */
  std::vector<float> attributes;
  /** Red, green, blue, 255; empty where no colours were requested. Four bytes a pixel. */
  std::vector<std::uint8_t> colors;
};

/** \brief A level and, as its fraction, a residual as a share of the radius, so that both fit into
 * one number. */
float
levelAndResidual(int level, float residual, float radius);

/** \brief Packs a G-buffer. \param[in] scale world units per unit of the buffer. O(pixels). */
void
packFrame(const GBuffer& buffer, double scale, int threads, PackedFrame& frame);

/** \brief The textures the resolve shader reads, on the graphics card. */
class FrameTextures {
 public:
  FrameTextures();
  ~FrameTextures();
  FrameTextures(const FrameTextures&) = delete;
  FrameTextures& operator=(const FrameTextures&) = delete;

  /** \brief A new frame of the CPU's; its attributes follow when a mode needs them. */
  void setFrame(vtkOpenGLRenderWindow* window, const PackedFrame& frame, int width, int height);
  /** \brief Brings the attributes over, unless they are there. */
  void needAttributes(vtkOpenGLRenderWindow* window, const PackedFrame& frame);
  /** \brief Makes room for a frame that the graphics card draws, attributes included, and colours where
   * requested: red, green and blue times a weight, and that weight. */
  void allocate(vtkOpenGLRenderWindow* window, int width, int height, bool with_colors);
  /** \brief Writes the covered pixels of another frame over one that the graphics card drew.
   * \param[in] scale world units per unit of the buffer */
  void fill(const GBuffer& buffer, double scale);
  vtkTextureObject* geometry() const { return geometry_; }
  vtkTextureObject* attributes() const { return attributes_; }
  vtkTextureObject* colors() const { return colors_; }
  /** \brief Samples a table of colours over its scale. */
  void setTable(vtkOpenGLRenderWindow* window, vtkScalarsToColors* table, const ColorScale& scale);

  /** \brief Sets lines over the frame, four bytes a pixel of it. */
  void setLines(vtkOpenGLRenderWindow* window, const std::vector<std::uint8_t>& rgba);
  void dropLines() { has_lines_ = false; }

  /** \brief Makes the textures current; after that they can be set in the program. */
  void activate();
  void tell(vtkShaderProgram* program);
  void deactivate();
  void release(vtkWindow* window);

 private:
  int width_ = 0, height_ = 0;
  bool has_attributes_ = false, has_colors_ = false, has_table_ = false, has_lines_ = false;
  vtkNew<vtkTextureObject> geometry_, attributes_, colors_, table_, lines_;
};

}  // namespace pcl_slim::detail
