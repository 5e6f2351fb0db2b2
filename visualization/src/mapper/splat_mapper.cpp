// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/visualization/splat_mapper.h"

#include <vtkObjectFactory.h>
#include <vtkPolyData.h>

#include <algorithm>

#include "export/leaf_points.h"
#include "pcl_slim/render/disc_rasterizer.h"

namespace pcl_slim {

using namespace detail;

vtkStandardNewMacro(SplatMapper)

bool
SplatMapper::setSplats(std::shared_ptr<const SplatSet> splats)
{
  const bool usable = !splats || !validateDiscs(*splats);
  splats_ = usable ? std::move(splats) : nullptr;
  std::array<double, 6> bounds{};
  const vtkSmartPointer<vtkPolyData> points = splatPoints(splats_.get(), bounds);
  objectChanged(points, bounds);
  return usable;
}

bool
SplatMapper::supports(DisplayMode mode) const
{
  return mode == DisplayMode::kShaded || mode == DisplayMode::kNormal ||
         mode == DisplayMode::kSize || mode == DisplayMode::kReflection ||
         mode == DisplayMode::kColor;
}

Error
SplatMapper::rasterize(const Camera& camera, const FrameRequest& request, GBuffer& buffer)
{
  buffer.resize(camera.size.width, camera.size.height);
  if (!splats_ || splats_->empty()) return {};
  DiscRenderParams params;
  params.sides = request.sides;
  params.near_plane = request.near_plane;
  params.threads = request.threads;
  if (request.clip_planes.empty()) return renderDiscs(*splats_, camera, params, buffer);
  return renderDiscs(splatsWithin(*splats_, request.clip_planes), camera, params, buffer);
}

std::array<double, 2>
SplatMapper::automaticRange(DisplayMode /*mode*/) const
{
  if (!splats_ || splats_->empty()) return {0.5, 1.0};
  std::vector<float> radii = splats_->radius;
  std::sort(radii.begin(), radii.end());
  const auto at = [&](double share) {
    return double{radii[static_cast<std::size_t>(share * static_cast<double>(radii.size() - 1))]};
  };
  const double high = at(0.98);
  return {std::max(at(0.02), 1e-6 * high), high > 0.0 ? high : 1.0};
}

}  // namespace pcl_slim
