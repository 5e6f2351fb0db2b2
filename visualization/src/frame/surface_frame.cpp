// SPDX-License-Identifier: BSD-3-Clause
#include "frame/surface_frame.h"

namespace pcl_slim::detail {

namespace {

RenderParams
paramsOf(const FrameRequest& request)
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
  params.close_gaps = request.close_gaps;
  return params;
}

}  // namespace

Error
SurfaceFrames::render(const Camera& camera, const FrameRequest& request, GBuffer& buffer)
{
  return renderer_.render(camera, paramsOf(request), buffer);
}

Error
SurfaceFrames::closeGaps(const Camera& camera, const FrameRequest& request,
                         const std::vector<std::uint8_t>& met, GBuffer& buffer)
{
  const RenderParams params = paramsOf(request);
  buffer.resize(camera.size.width, camera.size.height, params.columns);
  for (std::size_t i = 0; i < met.size(); ++i) {
    if (met[i]) buffer.surfel[i] = 0;
  }
  return renderer_.closeGaps(camera, params, buffer);
}

}  // namespace pcl_slim::detail
