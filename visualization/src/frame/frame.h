// SPDX-License-Identifier: BSD-3-Clause
// A frame: the view that it is of, what its rays met, its textures, and the shader that draws them.
#pragma once

#include <vtkNew.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "color/color_scale.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/visualization/g_buffer_mapper.h"

class vtkActor;
class vtkMapper;
class vtkOpenGLRenderWindow;
class vtkRenderer;
class vtkScalarsToColors;
class vtkShaderProgram;
class vtkTextureObject;
class vtkWindow;

namespace pcl_slim::detail {

/** \brief A 4 x 4 matrix, rows first, that acts on columns. */
using Matrix4 = std::array<double, 16>;

/** \brief A view as OpenGL has it. */
struct GLView {
  Matrix4 model_to_view;      ///< a rotation, a scale alike in all directions and a shift
  Matrix4 projection;         ///< a pinhole or a parallel one; off the axis and of any aspect
  int width = 0, height = 0;  ///< of the viewport, pixels
};

/** \brief The same view as a rasteriser's camera, and the way back for a shader.
 *
 * A ray at normalised device coordinates (x, y) meets the plane at unit depth (a pinhole), or any
 * plane (parallel), at view coordinates (x_scale x + x_shift, y_scale y + y_shift). A point at
 * depth t of its ray is at view-space distance view_scale t + start.
 */
struct ViewCamera {
  Camera camera;  ///< in the model's coordinates
  bool parallel = false;
  double x_scale = 1.0, x_shift = 0.0, y_scale = 1.0, y_shift = 0.0;
  double view_scale = 1.0;                ///< view-space length of a unit of the model
  double start = 0.0;                     ///< parallel: where rays begin
  std::array<double, 9> rotation{};       ///< model to view, rows first
  double near_plane = 0.0;                ///< model units along the ray
  double texels_x = 1.0, texels_y = 1.0;  ///< of the camera's picture, per viewport pixel
};

/** \brief Translates a view. \param[in] near_distance view-space distance of the near plane, of a
 * parallel view also below 0; \param[in] spacing viewport pixels from one ray to the next: a
 * whole number, or 1 over one.
 * \return an error for a matrix with shear, mirror or unequal scales, which no camera has. */
Error translateView(const GLView& view, double near_distance, double spacing, ViewCamera& result);

/** \brief The camera of the one ray through pixel (column, row) of another, rows from the top. */
Camera cameraOfPixel(const Camera& camera, double column, double row);

/** \brief An object's view in a renderer, and the distance of the near plane where it matters. */
struct VtkView {
  GLView gl;
  double near_distance = 0.0;  ///< view-space distance at which rays may begin
};

/** \brief What the renderer's camera sees of an actor through a viewport of some size.
 * \param[in] bounds of the object in its own coordinates: an object behind the near plane as a
 * whole is not cut by it, however the plane moves. */
VtkView viewOf(vtkRenderer* renderer, vtkActor* actor, const std::array<double, 6>& bounds,
               int width, int height);

/** \brief A mapper's clipping planes (world coordinates of the scene) in the actor's own. */
std::vector<HalfSpace> clipPlanesOf(vtkMapper* mapper, vtkActor* actor);

/** \brief Whether the window's user is moving something with the mouse just now. */
bool isInteracting(vtkRenderer* renderer);

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
float levelAndResidual(int level, float residual, float radius);

/** \brief Packs a G-buffer. \param[in] scale world units per unit of the buffer. O(pixels). */
void packFrame(const GBuffer& buffer, double scale, int threads, PackedFrame& frame);

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
  /** \brief Makes room for a frame that the graphics card draws, attributes included, and colours
   * where requested: red, green and blue times a weight, and that weight. */
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

/** \brief All that decides what a frame's rays meet, except their distance. */
struct FrameKey {
  Matrix4 model_to_view{};
  std::array<double, 7> projection{};  ///< without the depth range, which moves no ray
  int width = 0, height = 0;
  double near_distance = 0.0;
  std::vector<double> planes;
  VisibleSides sides = VisibleSides::kAuto;
  double lod = 0.0;  ///< of a frame at rest
  bool trim = true;
  bool colored = false;      ///< the frame has the colours of a surface
  bool close_gaps = false;   ///< a frame with its gaps closed is one without as well
  std::uint64_t object = 0;  ///< counts changes of the object

  FrameKey() = default;
  FrameKey(const VtkView& view, const FrameRequest& request, std::uint64_t object_count);

  bool operator==(const FrameKey& other) const;
};

/** \brief What the rays of the last frame met, kept until something moves. */
class CachedFrame {
 public:
  using Rasterize = std::function<Error(const Camera&, const FrameRequest&, GBuffer&)>;
  /** Draws on the graphics card and counts the covered pixels. */
  using DrawOnCard = std::function<Error(const ViewCamera&, const FrameRequest&, std::uint64_t&)>;

  /** \brief Whether a frame at least as fine is there. */
  bool holds(const FrameKey& key, double spacing) const;

  /** \brief Makes a frame. \param[in] request near_plane is filled in here, and lod is brought to
   * the rays' distance; \param[in] scale of the lengths that rasterize writes. After an error there
   * is none. */
  Error make(const VtkView& view, FrameKey key, double spacing, FrameRequest request, double scale,
             const Rasterize& rasterize);

  /** \brief Makes a frame that stays on the graphics card: packed() is of no use then. */
  Error makeOnCard(const VtkView& view, FrameKey key, double spacing, FrameRequest request,
                   const DrawOnCard& draw);

  /** \brief Forgets the frame and how long it took. */
  void clear();

  /** \brief The distance of rays [pixels] at which a frame takes no longer than this. */
  int coarsenessFor(double milliseconds) const;

  const ViewCamera& view() const { return view_; }
  /** \brief The frame of the CPU itself. */
  const GBuffer& buffer() const { return buffer_; }
  const PackedFrame& packed() const { return packed_; }
  int width() const { return buffer_.width; }
  int height() const { return buffer_.height; }
  /** \brief The distance of its rays [pixels]. */
  double spacing() const { return spacing_; }
  double seconds() const { return seconds_; }
  std::uint64_t coveredPixels() const { return covered_; }
  /** \brief Left, bottom, right, top of all covered pixels, normalised device coordinates. */
  const std::array<float, 4>& rectangle() const { return rectangle_; }

 private:
  using Clock = std::chrono::steady_clock;

  Error begin(const VtkView& view, double spacing, FrameRequest& request);
  void finish(FrameKey key, double spacing, Clock::time_point start);

  bool valid_ = false;
  FrameKey key_;
  double spacing_ = 1.0;
  double seconds_ = 0.0;       ///< what the frame took
  double full_seconds_ = 0.0;  ///< about what a frame with a ray for every pixel takes
  std::uint64_t covered_ = 0;
  ViewCamera view_;
  GBuffer buffer_;
  PackedFrame packed_;
  std::array<float, 4> rectangle_{};
};

/** \brief How fast one back end has drawn its last full frames of a surface. */
class FramePace {
 public:
  /** \brief Counts a frame. \param[in] seconds of wall time */
  void add(double seconds, std::size_t pixels) {
    constexpr std::size_t kFewest = 10000;  // small frames do not predict large ones
    if (pixels < kFewest) return;
    last_[frames_ % last_.size()] = seconds / static_cast<double>(pixels);
    ++frames_;
  }

  /** \brief Whether frames enough are counted: the first one also compiles shaders or makes an
   * index. */
  bool isKnown() const { return frames_ >= last_.size(); }
  /** \brief Seconds a pixel of the fastest of the last three frames, once they are known. */
  double secondsPerPixel() const { return *std::min_element(last_.begin(), last_.end()); }

 private:
  std::array<double, 3> last_{};
  std::size_t frames_ = 0;
};

/** \brief Which of the two back ends draws a surface: the graphics card while it is fast or not yet
 * known to be slow; once it is slow the CPU, until its pace is known as well, and from then on the
 * faster of the two. */
class BackendChoice {
 public:
  /** \brief Counts a full frame. The card draws nothing that is cut open, for which the CPU takes
   * longer: such frames are not counted. \param[in] seconds of wall time until the card has it */
  void add(bool on_card, const FrameRequest& request, double seconds, std::size_t pixels) {
    if (!request.close_gaps || !request.clip_planes.empty()) return;
    (on_card ? card_ : cpu_).add(seconds, pixels);
  }

  /** \brief Whether the graphics card is to draw the next frame. */
  bool prefersCard() {
    constexpr double kFast = 1.5e-8;  // 14 ms a frame of 1280 x 720
    if (!card_.isKnown() || card_.secondsPerPixel() < kFast) return on_card_ = true;
    if (!cpu_.isKnown()) return on_card_ = false;
    // Frames vary by as much while the camera turns: what is faster by less is no reason to change
    // again.
    const double gain = settled_ ? 0.75 : 1.0;
    const double ratio = cpu_.secondsPerPixel() / card_.secondsPerPixel();
    settled_ = true;
    return on_card_ = on_card_ ? ratio >= gain : ratio * gain > 1.0;
  }

 private:
  FramePace card_, cpu_;
  bool on_card_ = true, settled_ = false;
};

/** \brief Vertex shader: a rectangle of the viewport from gl_VertexID. */
const char* resolveVertexShader();

/** \brief Puts the resolve of a packed frame into VTK's fragment shader of polygons, before VTK
 * itself replaces the rest: vertexVC, normalVCVSOutput, gl_FragDepth and the colours. */
void insertResolve(std::string& fragment_shader);

/** \brief Sets the program's values of rays, projection and cuts. */
void tellView(const ViewCamera& view, const GLView& seen, const std::vector<HalfSpace>& planes,
              vtkShaderProgram* program);

}  // namespace pcl_slim::detail
