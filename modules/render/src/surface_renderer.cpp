// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/surface_renderer.h"

#include "fast/fast_rasterizer.h"
#include "pcl_slim/core/parallel.h"
#include "reference/tile_rasterizer.h"
#include "tiles/frame_rules.h"

namespace pcl_slim {

using namespace detail;

struct SurfaceRenderer::State {
  const SLIMSurface& surface;
  Error defect;  ///< of the surface
  std::unique_ptr<FastRasterizer> fast;
};

SurfaceRenderer::SurfaceRenderer(const SLIMSurface& surface, int threads)
    : state_(new State{surface, surface.validate(), nullptr})
{
  if (!state_->defect) {
    state_->fast = std::make_unique<FastRasterizer>(surface, resolveThreads(threads));
  }
}

SurfaceRenderer::~SurfaceRenderer() = default;
SurfaceRenderer::SurfaceRenderer(SurfaceRenderer&&) noexcept = default;
SurfaceRenderer&
SurfaceRenderer::operator=(SurfaceRenderer&&) noexcept = default;

const SLIMSurface&
SurfaceRenderer::surface() const
{
  return state_->surface;
}

Error
SurfaceRenderer::render(const Camera& camera, const RenderParams& params, GBuffer& buffer,
                        RenderStatistics* statistics)
{
  const auto refused = [&](const Error& error) {
    buffer.resize(0, 0);
    return error;
  };
  if (Error error = camera.validate()) return refused(error);
  if (Error error = params.validate()) return refused(error);
  if (state_->defect) return refused(state_->defect);
  const FrameRules rules(state_->surface.info, params);
  RenderStatistics counts;
  if (params.reference || !params.cuts.empty()) {
    buffer.resize(camera.size.width, camera.size.height, params.columns);
    renderReference(state_->surface, camera, rules, buffer, counts);
  } else {
    buffer.reserve(camera.size.width, camera.size.height, params.columns);
    state_->fast->draw(camera, rules, params.columns, buffer, counts);
  }
  if (statistics) *statistics = counts;
  return {};
}

Error
renderSurface(const SLIMSurface& surface, const Camera& camera, const RenderParams& params,
              GBuffer& buffer, RenderStatistics* statistics)
{
  return SurfaceRenderer(surface, params.threads).render(camera, params, buffer, statistics);
}

}  // namespace pcl_slim
