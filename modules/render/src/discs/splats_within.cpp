// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/disc_rasterizer.h"

namespace pcl_slim {

SplatSet
splatsWithin(const SplatSet& splats, const std::vector<HalfSpace>& cuts)
{
  const auto lies = [&](std::size_t i) {
    const Vector3 center{splats.origin[0] + double{splats.x[i]},
                         splats.origin[1] + double{splats.y[i]},
                         splats.origin[2] + double{splats.z[i]}};
    return std::all_of(cuts.begin(), cuts.end(),
                       [&](const HalfSpace& cut) { return dot(cut.normal, center) >= cut.offset; });
  };
  SplatSet kept = splats;
  std::size_t n = 0;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    if (!lies(i)) continue;
    for (auto column :
         {&SplatSet::x, &SplatSet::y, &SplatSet::z, &SplatSet::nx, &SplatSet::ny, &SplatSet::nz,
          &SplatSet::radius, &SplatSet::confidence, &SplatSet::normal_variance}) {
      (kept.*column)[n] = (splats.*column)[i];
    }
    kept.rgb[n] = splats.rgb[i];
    kept.kept[n] = splats.kept[i];
    if (!splats.gradient.empty()) kept.gradient[n] = splats.gradient[i];
    ++n;
  }
  kept.resize(n, !splats.gradient.empty());
  return kept;
}

}  // namespace pcl_slim
