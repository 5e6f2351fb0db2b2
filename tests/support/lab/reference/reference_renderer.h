// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::lab {

/** \brief Draws what SurfaceRenderer draws, to compare with: in double, leaf by leaf and ray by
 * ray. Slow. RenderParams::lod is refused. */
class ReferenceRenderer {
 public:
  /** \brief The surface must outlive this object. */
  explicit ReferenceRenderer(const SLIMSurface& surface);
  ~ReferenceRenderer();

  /** \brief As SurfaceRenderer::render(). */
  Error render(const Camera& camera, const RenderParams& params, GBuffer& buffer,
               RenderStatistics* statistics = nullptr);

 private:
  Error check(const Camera& camera, const RenderParams& params) const;

  struct State;
  std::unique_ptr<State> state_;
};

/** \brief A single frame. */
Error renderReference(const SLIMSurface& surface, const Camera& camera, const RenderParams& params,
                      GBuffer& buffer, RenderStatistics* statistics = nullptr);

}  // namespace pcl_slim::lab
