// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/color_octree_splat_sampler_base.h"

#include <array>
#include <tuple>

#include "input_types.h"
#include "pcl_slim/filters/impl/color_octree_splat_sampler.hpp"

namespace pcl_slim {

void ColorOctreeSplatSamplerBase::setViewPoint(double x, double y, double z) {
  params_.viewpoint = std::array<double, 3>{x, y, z};
}

bool ColorOctreeSplatSamplerBase::getViewPoint(double& x, double& y, double& z) const {
  if (!params_.viewpoint) return false;
  std::tie(x, y, z) = std::tuple_cat(*params_.viewpoint);
  return true;
}

void ColorOctreeSplatSamplerBase::clearResults() {
  ControlledRun::clearResults();
  statistics_ = {};
}

bool ColorOctreeSplatSamplerBase::run(const CloudView& cloud, const ColorView& colors,
                                      SplatSet& splats) {
  const CancellableRun cancellable(control_.progress);
  const SplatParams params = params_;
  const bool done = guarded("the sampling", "sample fewer points", [&] {
    return sampleSplats(cloud, colors, params, splats, &statistics_, &control_.progress);
  });
  if (done)
    warnOfSides(statistics_.sides, statistics_.normals);
  else
    splats = SplatSet();
  return done;
}

}  // namespace pcl_slim

// The class of all point types it is compiled for.
PCL_SLIM_FOR_INPUT_TYPES(PCL_SLIM_INSTANTIATE_ColorOctreeSplatSampler)
