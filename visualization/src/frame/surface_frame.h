// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/core/error.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/visualization/g_buffer_mapper.h"

namespace pcl_slim::detail {

/** \brief The rasteriser behind a SLIMMapper: the one place that names it. The surface must outlive
 * this object. */
class SurfaceFrames {
 public:
  explicit SurfaceFrames(const SLIMSurface& surface) : renderer_(surface) {}

  Error render(const Camera& camera, const FrameRequest& request, GBuffer& buffer);

 private:
  SurfaceRenderer renderer_;
};

}  // namespace pcl_slim::detail
