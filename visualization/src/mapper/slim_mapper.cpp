// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/visualization/slim_mapper.h"

#include <vtkObjectFactory.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <cmath>

#include "color/surface_ranges.h"
#include "export/leaf_points.h"
#include "frame/frame_textures.h"
#include "frame/surface_frame.h"
#include "opengl/card_rasterizer.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

using namespace detail;

vtkStandardNewMacro(SLIMMapper)

SLIMMapper::SLIMMapper() = default;
SLIMMapper::~SLIMMapper() = default;

bool
SLIMMapper::setSurface(std::shared_ptr<const SLIMSurface> surface)
{
  const bool usable = !surface || !surface->validate();
  surface_ = usable ? std::move(surface) : nullptr;
  frames_ = surface_ ? std::make_unique<SurfaceFrames>(*surface_) : nullptr;
  // Another surface may have the place in memory that this one had.
  if (card_) card_->setSurface(nullptr);
  card_fails_ = false;
  ranges_.clear();
  std::array<double, 6> bounds{};
  const vtkSmartPointer<vtkPolyData> points = leafPoints(surface_.get(), bounds);
  objectChanged(points, bounds);
  return usable;
}

bool
SLIMMapper::supports(DisplayMode mode) const
{
  return mode != DisplayMode::kColor || (surface_ && surface_->hasColors());
}

Error
SLIMMapper::rasterize(const Camera& camera, const FrameRequest& request, GBuffer& buffer)
{
  if (frames_) return frames_->render(camera, request, buffer);
  buffer.resize(camera.size.width, camera.size.height);
  return {};
}

void
SLIMMapper::setBackend(RayBackend backend)
{
  if (backend == backend_) return;
  backend_ = backend;
  card_fails_ = false;
  dropFrame();
}

void
SLIMMapper::setLevelOfDetail(double pixels)
{
  constexpr double kMost = 1024.0;  // as RenderParams takes
  pixels = std::isfinite(pixels) ? std::clamp(pixels, 0.0, kMost) : 0.0;
  if (pixels == lod_) return;
  lod_ = pixels;
  Modified();
}

void
SLIMMapper::setTrimming(bool trim)
{
  if (trim == trim_) return;
  trim_ = trim;
  Modified();
}

void
SLIMMapper::complete(FrameRequest& request) const
{
  request.lod = lod_;
  request.trim = trim_;
  request.columns = pictureLineColumns(linesShown());
  if (getMode() == DisplayMode::kColor) request.columns |= kColorColumn;
}

Error
SLIMMapper::setLines(const PictureLineParams& lines, const LineStyle& style)
{
  if (Error error = lines.validate()) return error;
  std::vector<std::uint8_t> none;
  if (Error error = drawLines({}, style, {1, 1}, none)) return error;
  lines_ = lines;
  line_style_ = style;
  dropLines();
  return {};
}

/** \brief The kinds that are drawn in the mode that is set. */
PictureLineParams
SLIMMapper::linesShown() const
{
  PictureLineParams shown = lines_;
  const bool any = lines_.crest || lines_.suggestive || lines_.contour;
  if (!any && getMode() == DisplayMode::kSketch) {
    shown.crest = shown.suggestive = shown.contour = true;
  }
  return shown;
}

bool
SLIMMapper::wantsLines() const
{
  const PictureLineParams shown = linesShown();
  return surface_ && (shown.crest || shown.suggestive || shown.contour);
}

Error
SLIMMapper::drawLinesOver(const Camera& camera, const FrameRequest& request, const GBuffer* buffer,
                          std::vector<std::uint8_t>& rgba)
{
  PictureLineParams shown = linesShown();
  shown.threads = request.threads;
  const unsigned needed = pictureLineColumns(shown);
  GBuffer own;
  if (!buffer || (request.columns & needed) != needed) {
    FrameRequest with_columns = request;
    with_columns.columns = needed;
    if (Error error = rasterize(camera, with_columns, own)) return error;
    buffer = &own;
  }
  auto lines = findPictureLines(*buffer, camera, *surface_, shown);
  return lines ? drawLines(*lines, line_style_, camera.size, rgba) : lines.error();
}

bool
SLIMMapper::usesCard(vtkOpenGLRenderWindow* /*window*/, const FrameRequest& request)
{
  if (!surface_ || card_fails_ || !request.clip_planes.empty()) return false;
  if (backend_ == RayBackend::kAuto) return !CardRasterizer::isSoftware();
  return backend_ == RayBackend::kOpenGL;
}

Error
SLIMMapper::drawOnCard(vtkOpenGLRenderWindow* window, const ViewCamera& view,
                       const FrameRequest& request, FrameTextures& textures, std::uint64_t& covered)
{
  if (!card_) card_ = std::make_unique<CardRasterizer>();
  card_->setSurface(surface_.get());
  Error error = card_->draw(window, view, request, textures, covered);
  card_fails_ = static_cast<bool>(error);
  if (error || covered == 0 || !request.close_gaps || request.lod > 0.0 || !request.trim) {
    return error;
  }
  GBuffer gaps;
  error = frames_->closeGaps(view.camera, request, card_->met(), gaps);
  const std::size_t filled = error ? 0 : gaps.numCovered();
  if (filled == 0) return error;
  PackedFrame packed;
  packFrame(gaps, lengthScale(), resolveThreads(request.threads), packed);
  textures.fill(gaps, packed);
  covered += filled;
  return {};
}

void
SLIMMapper::ReleaseGraphicsResources(vtkWindow* window)
{
  if (card_) card_->release(window);
  Superclass::ReleaseGraphicsResources(window);
}

double
SLIMMapper::lengthScale() const
{
  return surface_ ? surface_->info.scale : 1.0;
}

std::array<double, 2>
SLIMMapper::automaticRange(DisplayMode mode) const
{
  const auto known = ranges_.find(mode);
  if (known != ranges_.end()) return known->second;
  return ranges_[mode] = surface_ ? surfaceRange(*surface_, mode) : std::array<double, 2>{0.5, 1.0};
}

bool
SLIMMapper::pick(vtkRenderer* renderer, vtkActor* actor, int x, int y, SurfacePick& result)
{
  result = {};
  GBuffer pixel;
  if (!surface_ || !castRay(renderer, actor, x, y, pixel)) return false;
  const SLIMSurface& surface = *surface_;
  const double scale = surface.info.scale;
  const std::size_t i = result.surfel = pixel.surfel[0];
  for (std::size_t k = 0; k < 3; ++k) {
    result.position[k] = surface.info.origin[k] + scale * double{pixel.position[0][k]};
    result.normal[k] = pixel.normal[0][k];
  }
  result.mean = pixel.mean_curvature[0] / scale;
  result.gauss = pixel.gaussian_curvature[0] / (scale * scale);
  result.k_max = pixel.principal[0][0] / scale;
  result.k_min = pixel.principal[0][1] / scale;
  result.level = surface.level[i];
  result.degree = surface.degree[i];
  result.radius = surface.radius[i] * scale;
  result.error = surface.error[i] * scale;
  result.effective_count = surface.effective_count[i];
  return true;
}

}  // namespace pcl_slim
