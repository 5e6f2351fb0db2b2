// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/color_octree_splat_sampler_base.h"

#include <cmath>

#include "input_types.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/filters/impl/color_octree_splat_sampler.hpp"

namespace pcl_slim {

void ColorOctreeSplatSamplerBase::setViewPoint(double x, double y, double z) {
  has_viewpoint_ = true;
  params_.viewpoint[0] = x;
  params_.viewpoint[1] = y;
  params_.viewpoint[2] = z;
}

bool ColorOctreeSplatSamplerBase::getViewPoint(double& x, double& y, double& z) const {
  if (!has_viewpoint_) return false;
  x = params_.viewpoint[0];
  y = params_.viewpoint[1];
  z = params_.viewpoint[2];
  return true;
}

void ColorOctreeSplatSamplerBase::clearResults() {
  ControlledRun::clearResults();
  statistics_ = {};
}

bool ColorOctreeSplatSamplerBase::run(const CloudView& cloud, const ColorView& colors,
                                      const float sensor[3], SplatSet& splats) {
  const CancellableRun cancellable(control_.progress);
  SplatParams params = params_;
  const bool known = isFinite(sensor);
  for (int a = 0; a < 3 && !has_viewpoint_; ++a) params.viewpoint[a] = known ? sensor[a] : 0.0;
  CloudView view = cloud;
  if (has_viewpoint_) view.sensors = nullptr;
  const bool done = guarded("the sampling", "sample fewer points", [&] {
    return sampleSplats(view, colors, params, splats, &statistics_, &control_.progress);
  });
  if (!done) splats = SplatSet();
  return done;
}

}  // namespace pcl_slim

// The class of all point types it is compiled for.
PCL_SLIM_FOR_INPUT_TYPES(PCL_SLIM_INSTANTIATE_ColorOctreeSplatSampler)
