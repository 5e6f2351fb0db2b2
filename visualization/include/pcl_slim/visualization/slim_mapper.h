// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>

#include "pcl_slim/core/export.h"
#include "pcl_slim/render/picture_lines.h"
#include "pcl_slim/surface/surface.h"
#include "pcl_slim/visualization/g_buffer_mapper.h"

namespace pcl_slim {

namespace detail {
class CardRasterizer;
class BackendChoice;
class SurfaceFrames;
}  // namespace detail

/** \brief What intersects rays with a surface. */
enum class RayBackend : unsigned char {
  kAuto,  ///< the graphics card, unless its OpenGL is a processor's (llvmpipe, softpipe) or the CPU proves faster
  kCPU,   ///< the rasteriser of pcl_slim_render, vector units and threads
  kOpenGL,  ///< shaders; the CPU still draws what has clipping planes or what the card refuses
};

/** \brief What is under a pixel of a drawn surface; lengths in world units. */
struct SurfacePick {
  std::uint32_t surfel = 0;          ///< index of the leaf of the largest weight
  std::array<double, 3> position{};  ///< blended point, world coordinates of the surface
  std::array<double, 3> normal{};    ///< unit, towards the viewer if seen from both sides
  double mean = 0.0, gauss = 0.0;    ///< 1/length, 1/length^2
  double k_max = 0.0, k_min = 0.0;   ///< 1/length
  int level = 0, degree = 0;         ///< of the surfel
  double radius = 0.0;               ///< of the surfel
  double error = 0.0;                ///< its root-mean-square residual
  double effective_count = 0.0;      ///< number of points behind it
};

/** \brief Draws a SLIM surface, blended per pixel, in any VTK renderer.
 *
 * \code
 * vtkNew<pcl_slim::SLIMMapper> mapper;
 * mapper->setSurface(std::make_shared<pcl_slim::SLIMSurface>(surface));
 * vtkNew<vtkActor> actor;
 * actor->SetMapper(mapper);
 * renderer->AddActor(actor);
 * \endcode
 *
 * See GBufferMapper for what is kept from frame to frame. The picture of a surface from outside
 * is that of renderSurface(), pixel by pixel. Cutting an oriented surface open with clipping
 * planes shows its inner side as well.
 */
class PCL_SLIM_EXPORT SLIMMapper : public GBufferMapper {
 public:
  static SLIMMapper* New();
  vtkTypeMacro(SLIMMapper, GBufferMapper)

  /** \brief The surface to draw, shared and not copied; null: none. It must not change while it is
   * here. A surface that does not pass validate() is refused: false, and none is drawn then.
   * O(leaves). */
  bool setSurface(std::shared_ptr<const SLIMSurface> surface);
  const std::shared_ptr<const SLIMSurface>& getSurface() const { return surface_; }

  /** \brief Returns what is drawn at a pixel. \param[in] x, y display coordinates, from the lower
   * left corner of the window. \return false off the surface. O(leaves). */
  bool pick(vtkRenderer* renderer, vtkActor* actor, int x, int y, SurfacePick& result);

  /** \brief What intersects rays (kAuto); FrameStatistics::on_card has the choice. Pictures of the
   * two differ by rounding. With kAuto the card draws while the fastest of its last three frames at
   * rest takes less than 15 ns a pixel. If it takes longer the CPU draws three, and from then on
   * the faster of the two, which changes only if its last frames at rest take a third longer than
   * the other's took. */
  void setBackend(RayBackend backend);
  RayBackend getBackend() const { return backend_; }

  /** \brief Surfels seen smaller than this many pixels replace their descendants, so that far
   * surfaces cost less; 0 (default): every leaf is drawn. Both back ends; the graphics card then
   * stores internal surfels as well. */
  void setLevelOfDetail(double pixels);
  double getLevelOfDetail() const { return lod_; }

  /** \brief Whether an open surface ends where its data end, by its trim maps (true). */
  void setTrimming(bool trim);
  bool getTrimming() const { return trim_; }

  /** \brief Lines over the surface (none): crest lines, suggestive contours and contours of what
   * the camera sees, as findPictureLines() finds them. They are looked for when the camera rests,
   * and while it moves if that fits into the frame budget; FrameStatistics has the time. With the
   * graphics card the CPU draws the frame that they are looked for in. DisplayMode::kSketch draws
   * lines of every kind on white if no other are set.
   * \return an error, and nothing changes, for parameters out of range. */
  Error setLines(const PictureLineParams& lines, const LineStyle& style = {});
  const PictureLineParams& getLines() const { return lines_; }
  const LineStyle& getLineStyle() const { return line_style_; }

  bool supports(DisplayMode mode) const override;
  void ReleaseGraphicsResources(vtkWindow* window) override;

 protected:
  SLIMMapper();
  ~SLIMMapper() override;

  void complete(FrameRequest& request) const override;
  Error rasterize(const Camera& camera, const FrameRequest& request, GBuffer& buffer) override;
  bool usesCard(vtkOpenGLRenderWindow* window, const FrameRequest& request) override;
  Error drawOnCard(vtkOpenGLRenderWindow* window, const detail::ViewCamera& view,
                   const FrameRequest& request, detail::FrameTextures& textures,
                   std::uint64_t& covered) override;
  void frameMade(const FrameRequest& request, const ImageSize& size, double seconds) override;
  bool wantsLines() const override;
  Error drawLinesOver(const Camera& camera, const FrameRequest& request, const GBuffer* buffer,
                      std::vector<std::uint8_t>& rgba) override;
  double lengthScale() const override;
  std::array<double, 2> automaticRange(DisplayMode mode) const override;

 private:
  SLIMMapper(const SLIMMapper&) = delete;
  void operator=(const SLIMMapper&) = delete;

  PictureLineParams linesShown() const;

  std::shared_ptr<const SLIMSurface> surface_;
  std::unique_ptr<detail::SurfaceFrames> frames_;
  std::unique_ptr<detail::CardRasterizer> card_;
  std::unique_ptr<detail::BackendChoice> choice_;
  RayBackend backend_ = RayBackend::kAuto;
  double lod_ = 0.0;
  bool trim_ = true;
  PictureLineParams lines_;
  LineStyle line_style_;
  bool card_fails_ = false;                                      ///< and has reported it once
  mutable std::map<DisplayMode, std::array<double, 2>> ranges_;  ///< those requested so far
};

}  // namespace pcl_slim
