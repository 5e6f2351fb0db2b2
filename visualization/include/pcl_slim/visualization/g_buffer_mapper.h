// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkOpenGLPolyDataMapper.h>

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/visualization/display_mode.h"

class vtkOpenGLRenderWindow;

namespace pcl_slim {

namespace detail {
class FrameTextures;
struct ViewCamera;
}  // namespace detail

/** \brief What lights an object. */
enum class ObjectLight : unsigned char {
  kScene,   ///< the renderer's lights and the actor's vtkProperty, as VTK lights triangles
  kStudio,  ///< the light of pcl_slim_render's pictures, whatever lights the renderer has
};

/** \brief What a mapper drew, and what it did not have to draw again. */
struct FrameStatistics {
  std::uint64_t frames = 0;        ///< times the renderer drew the object
  std::uint64_t rasterized = 0;    ///< times its rays were intersected; else shaded again only
  std::uint64_t tables = 0;        ///< times the table of colours was made
  int coarseness = 1;              ///< of the last frame: rays are this many pixels apart
  int supersampling = 1;           ///< or a pixel has the square of this many
  std::uint64_t lines = 0;         ///< times lines were computed
  double line_seconds = 0.0;       ///< wall time of the last time
  double rasterize_seconds = 0.0;  ///< wall time of the last intersection of rays, upload included
  std::uint64_t covered_pixels = 0;  ///< rays of it that met the object
  bool on_card = false;              ///< the graphics card intersected the rays, not the CPU
};

/** \brief Input of a frame without the camera. */
struct FrameRequest {
  double near_plane = 0.0;  ///< smallest depth, world units
  VisibleSides sides = VisibleSides::kAuto;
  int threads = 0;
  std::vector<HalfSpace> clip_planes;  ///< what is kept, the object's coordinates, unit normals
  double lod = 0.0;        ///< level of detail, pixels from one ray to the next; 0: none
  bool trim = true;        ///< use trim maps
  unsigned columns = 0;    ///< GBufferColumn bits in addition to those of the colours
  bool close_gaps = true;  ///< fill gaps between shrunk balls that rays passed through
};

/** \brief Base of the mappers that draw what has no triangles: rays are intersected on the CPU or
 * the graphics card, and a full-viewport pass resolves the result inside VTK's own fragment shader.
 *
 * VTK's lights (or, by setLight(), the pictures'), vtkProperty (colour, opacity, highlights), the
 * actor's place, depth composition with other actors, depth peeling and hardware picking therefore
 * work as with triangles. The
 * actor's matrix may turn, move and scale alike in all directions; with any other matrix nothing is
 * drawn and getError() reports it. Of a translucent object the front sheet is drawn.
 *
 * The rays' result is kept while camera, size, object and clipping planes stay as they are; a
 * change of mode, range, light or property only shades it again. While the mouse moves, rays
 * are 2 or 4 pixels apart if a full frame takes longer than the frame budget, and coarser surfels
 * replace those smaller than that; the frame that an interactor style draws
 * when the button is released is full again.
 *
 * Methods in VTK's spelling are VTK's own. One object belongs to one render window. VTK's rule for
 * threads applies: call it from the thread of the window.
 */
class PCL_SLIM_EXPORT GBufferMapper : public vtkOpenGLPolyDataMapper {
 public:
  vtkTypeMacro(GBufferMapper, vtkOpenGLPolyDataMapper)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /** \brief What colours show (kShaded); GetLookupTable() then is the table of colours, for a
   * vtkScalarBarActor. \return false, and nothing changes, for what the object does not have. */
  bool setMode(DisplayMode mode);
  DisplayMode getMode() const;
  /** \brief Whether the object can be shown so. */
  virtual bool supports(DisplayMode mode) const = 0;

  /** \brief Curvature of full colour, 1/length or 1/length^2, or residual of full colour; 0
   * (default): such that 95 % of the object's area is inside, whatever part of it is seen. */
  void setRange(double range);
  /** \brief The range given, or the automatic one of the mode that is set. */
  double getRange() const;
  /** \brief Takes the automatic ranges of all modes but levels from what a camera sees now, as
   * pcl_slim_render does for a picture, and keeps them until the object changes. The CPU draws a
   * frame for that. \return false, and nothing changes, where the camera sees nothing. O(pixels +
   * leaves or splats). */
  bool fitRanges(vtkRenderer* renderer, vtkActor* actor);

  /** \brief What lights the object (kScene). The studio's light is that of pcl_slim_render's pictures
   * and pages: it moves with the camera and darkens hollows. Of the actor's vtkProperty its colour
   * (DiffuseColor), opacity and Lighting then count: without lighting, colours are drawn bare. */
  void setLight(ObjectLight light);
  ObjectLight getLight() const;

  /** \brief Strength of the studio's shade in hollows, 0 to 1 (.6). Frames with a ray for every pixel
   * have it; where a processor does the work of the graphics card, frames at rest alone. */
  void setAmbientOcclusion(double strength);
  double getAmbientOcclusion() const;

  /** \brief N x N rays a pixel of frames at rest, 1 (default) to 4, averaged as in pictures; silhouettes
   * then are smooth as well. Under the studio's light and without lines; others have one. A finer
   * frame is kept when fewer rays are set. */
  void setSupersampling(int rays);
  int getSupersampling() const;

  /** \brief Longest time for a frame while the mouse moves, milliseconds (50); 0: any. */
  void setFrameBudget(double milliseconds);
  double getFrameBudget() const;

  /** \brief Sides of the object to draw (kAuto). */
  void setSides(VisibleSides sides);
  VisibleSides getSides() const;

  /** \brief Threads for rays; 0 (default): all cores. Never changes the picture. */
  void setNumberOfThreads(int threads);
  int getNumberOfThreads() const;

  const FrameStatistics& getStatistics() const;
  /** \brief Why the last frame is empty; no error after a good one. */
  const Error& getError() const;

  /** \brief What a camera sees through one pixel of a viewport: one ray, drawn on the CPU.
   * \param[in] x, y display coordinates, from the lower left corner of the window, as
   * vtkRenderWindowInteractor gives them; \param[out] pixel a buffer of one pixel.
   * \return false where the ray meets nothing. O(leaves or splats). */
  bool castRay(vtkRenderer* renderer, vtkActor* actor, int x, int y, GBuffer& pixel);

  // VTK's own ------------------------------------------------------------------------------------
  void RenderPieceDraw(vtkRenderer* renderer, vtkActor* actor) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;

 protected:
  GBufferMapper();
  ~GBufferMapper() override;

  /** \brief Adds what the object alone knows of to a frame's request, lengths in pixels of the
   * window. */
  virtual void complete(FrameRequest& request) const;
  /** \brief Intersects the rays of a camera with the object. */
  virtual Error rasterize(const Camera& camera, const FrameRequest& request, GBuffer& buffer) = 0;
  /** \brief Whether the graphics card intersects the rays of such a frame. The window's context is
   * current. */
  virtual bool usesCard(vtkOpenGLRenderWindow* window, const FrameRequest& request);
  /** \brief Does it, into the textures that otherwise receive a frame of the CPU. After
   * an error the CPU draws. */
  virtual Error drawOnCard(vtkOpenGLRenderWindow* window, const detail::ViewCamera& view,
                           const FrameRequest& request, detail::FrameTextures& textures,
                           std::uint64_t& covered);
  /** \brief Learns how long a frame took that shows something, until the card had it;
   * getStatistics() has which back end made it. \param[in] size rays */
  virtual void frameMade(const FrameRequest& request, const ImageSize& size, double seconds);
  /** \brief To be called when frames are to be made in another way. */
  void dropFrame();
  /** \brief Whether lines are drawn over a frame. */
  virtual bool wantsLines() const;
  /** \brief Draws them. \param[in] buffer what the CPU drew, or null; \param[out] rgba four bytes a
   * pixel of the camera's, see drawLines() */
  virtual Error drawLinesOver(const Camera& camera, const FrameRequest& request,
                              const GBuffer* buffer, std::vector<std::uint8_t>& rgba);
  /** \brief To be called when other lines are to be drawn over the same frames. */
  void dropLines();
  /** \brief World units per unit of the buffer's lengths. */
  virtual double lengthScale() const = 0;
  /** \brief Values of the first and last colour of a mode that shows numbers. */
  virtual std::array<double, 2> automaticRange(DisplayMode mode) const = 0;

  /** \brief To be called when the object has changed: bounds given, empty ones for no object. */
  void objectChanged(vtkPolyData* points, const std::array<double, 6>& bounds);

  void ComputeBounds() override;
  void UpdateBufferObjects(vtkRenderer* renderer, vtkActor* actor) override;
  void GetShaderTemplate(std::map<vtkShader::Type, vtkShader*> shaders, vtkRenderer* renderer,
                         vtkActor* actor) override;
  void ReplaceShaderValues(std::map<vtkShader::Type, vtkShader*> shaders, vtkRenderer* renderer,
                           vtkActor* actor) override;
  void SetCameraShaderParameters(vtkOpenGLHelper& primitive, vtkRenderer* renderer,
                                 vtkActor* actor) override;

 private:
  GBufferMapper(const GBufferMapper&) = delete;
  void operator=(const GBufferMapper&) = delete;

  std::array<double, 2> unsetRange() const;
  bool requestOf(vtkRenderer* renderer, vtkActor* actor, int width, int height,
                 detail::ViewCamera& view, FrameRequest& request);
  bool prepareFrame(vtkRenderer* renderer, vtkActor* actor);
  Error makeFrame(vtkOpenGLRenderWindow* window, FrameRequest request, double spacing);
  void uploadFrame(vtkOpenGLRenderWindow* window);
  void updateTable();
  void prepareLines(vtkRenderer* renderer);

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pcl_slim
