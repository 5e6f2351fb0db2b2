// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/surface_renderer.h"

#include <vector>

#include "fast/fast_rasterizer.h"
#include "pcl_slim/core/parallel.h"
#include "shading/shading.h"
#include "tiles/tiles.h"
#include "tracer/tracer.h"

namespace pcl_slim {

using namespace detail;

struct SurfaceRenderer::State {
  const SLIMSurface& surface;
  Error defect;  ///< of the surface
  std::unique_ptr<FastRasterizer> fast;
  SurfacePainter painter;
  GapCloser gaps;
};

namespace {

/** \brief Looks up the residual of every covered pixel's leaf. */
void lookUpResiduals(const SLIMSurface& surface, int threads, GBuffer& buffer) {
  parallelFor(buffer.numPixels(), threads, 16384, [&](std::size_t pixel, int) {
    buffer.residual[pixel] = buffer.covered(pixel) ? surface.error[buffer.surfel[pixel]] : 0.0f;
  });
}

}  // namespace

SurfaceRenderer::SurfaceRenderer(const SLIMSurface& surface, int threads)
    : state_(new State{surface, surface.validate(), nullptr, SurfacePainter(surface),
                       GapCloser(surface)}) {
  if (!state_->defect) {
    state_->fast = std::make_unique<FastRasterizer>(surface, resolveThreads(threads));
  }
}

SurfaceRenderer::~SurfaceRenderer() = default;
SurfaceRenderer::SurfaceRenderer(SurfaceRenderer&&) noexcept = default;
SurfaceRenderer& SurfaceRenderer::operator=(SurfaceRenderer&&) noexcept = default;

const SLIMSurface& SurfaceRenderer::surface() const {
  static const SLIMSurface none;
  return state_ ? state_->surface : none;
}

/** \brief Names what keeps a frame from being drawn. */
Error SurfaceRenderer::check(const Camera& camera, const RenderParams& params) const {
  if (Error error = camera.validate()) return error;
  if (Error error = params.validate()) return error;
  if (!state_) return badInput("the renderer has been moved from; make a new one");
  return state_->defect;
}

Error SurfaceRenderer::closeGaps(const Camera& camera, const RenderParams& params,
                                 GBuffer& buffer) {
  Error error = check(camera, params);
  if (!error && (buffer.width != camera.size.width || buffer.height != camera.size.height)) {
    error = badInput("the frame's size is not the camera's; draw it by that camera");
  }
  if (error) {
    buffer.resize(0, 0);
    return error;
  }
  std::vector<std::size_t> drawn;
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    if (buffer.covered(i)) drawn.push_back(i);
  }
  const int threads = resolveThreads(params.threads);
  if (closesGaps(params)) state_->gaps.close(camera, params, threads, buffer);
  for (const std::size_t i : drawn) buffer.surfel[i] = GBuffer::kNothing;
  if (params.columns & kResidualColumn) lookUpResiduals(state_->surface, threads, buffer);
  if (params.columns & kColorColumn) state_->painter.paint(camera, threads, buffer);
  return {};
}

Error SurfaceRenderer::render(const Camera& camera, const RenderParams& params, GBuffer& buffer,
                              RenderStatistics* statistics) {
  if (Error error = check(camera, params)) {
    buffer.resize(0, 0);
    return error;
  }
  const FrameRules rules(state_->surface.info, params);
  const bool with_place = (params.columns & kColorColumn) != 0;
  const unsigned columns = params.columns | (with_place ? unsigned{kPositionColumn} : 0u);
  RenderStatistics counts;
  buffer.reserve(camera.size.width, camera.size.height, columns);
  state_->fast->draw(camera, rules, columns, buffer, counts);
  const int threads = resolveThreads(params.threads);
  if (closesGaps(params)) {
    RenderParams wanted = params;
    wanted.columns = columns;
    counts.closed_pixels = state_->gaps.close(camera, wanted, threads, buffer);
    counts.covered_pixels += counts.closed_pixels;
  }
  if (columns & kResidualColumn) lookUpResiduals(state_->surface, threads, buffer);
  if (columns & kColorColumn) state_->painter.paint(camera, threads, buffer);
  if (statistics) *statistics = counts;
  return {};
}

Error renderSurface(const SLIMSurface& surface, const Camera& camera, const RenderParams& params,
                    GBuffer& buffer, RenderStatistics* statistics) {
  return SurfaceRenderer(surface, params.threads).render(camera, params, buffer, statistics);
}

}  // namespace pcl_slim
