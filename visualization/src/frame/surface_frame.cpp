// SPDX-License-Identifier: BSD-3-Clause
#include "frame/surface_frame.h"

namespace pcl_slim::detail {

Error
SurfaceFrames::render(const Camera& camera, const FrameRequest& request, GBuffer& buffer)
{
  RenderParams params;
  params.sides = request.sides;
  params.near_plane = request.near_plane;
  params.threads = request.threads;
  params.columns =
      kPositionColumn | kCurvatureColumn | kLeafColumns | kResidualColumn | request.columns;
  params.lod = request.lod;
  params.trim = request.trim;
  params.cuts = request.clip_planes;
  params.close_gaps = true;
  return renderer_.render(camera, params, buffer);
}

}  // namespace pcl_slim::detail
