// SPDX-License-Identifier: BSD-3-Clause
#include "frame/surface_frame.h"

#include "pcl_slim/render/tile_rasterizer.h"

namespace pcl_slim::detail {

Error
SurfaceFrames::render(const Camera& camera, const FrameRequest& request, GBuffer& buffer) const
{
  RenderParams params;
  params.sides = request.sides;
  params.near_plane = request.near_plane;
  params.threads = request.threads;
  params.cuts = request.clip_planes;
  return renderSurface(surface_, camera, params, buffer);
}

}  // namespace pcl_slim::detail
