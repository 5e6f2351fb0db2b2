// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/frame_blocks.h"

#include <algorithm>

#include "camera/camera_rays.h"
#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/surface/detail/detail_sizes.h"

namespace pcl_slim {

using namespace detail;

namespace {

bool
reaches(const SLIMSurface& s, std::size_t i, const SlimBlock& block)
{
  const float center[3] = {s.cx[i], s.cy[i], s.cz[i]};
  bool meets = true;
  for (std::size_t a = 0; a < 3; ++a) {
    meets = meets && center[a] + s.radius[i] >= block.low[a] &&
            center[a] - s.radius[i] <= block.high[a];
  }
  return meets;
}

/** Finest level that the surfels above a tile have in it; 0: none. */
int
finestLevel(const SLIMSurface& s, const SlimBlock& block)
{
  int finest = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const std::uint64_t key = mortonCode(s.cx[i], s.cy[i], s.cz[i]);
    if (key >= block.first_key && key < block.end_key) finest = std::max<int>(finest, s.level[i]);
  }
  return finest;
}

}  // namespace

std::vector<bool>
blocksOfFrame(const SlimDirectory& directory, const SLIMSurface& coarse, const Camera& camera,
              double lod)
{
  const DetailSizes sizes(coarse);
  const SurfaceInfo& info = directory.info;
  const CameraRays rays(camera, info.origin, info.scale);
  std::vector<bool> drawn_whole(coarse.size());  // drawn in place of all below it
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    const Vector3 center{coarse.cx[i], coarse.cy[i], coarse.cz[i]};
    drawn_whole[i] = rays.nearestDepth(center, double{coarse.radius[i]}) > 0.0 &&
                     double{sizes.own[i]} < 0.5 * lod * rays.pixelLength(center);
  }
  std::vector<bool> needed;
  for (const SlimBlock& block : directory.blocks) {
    const int finest = finestLevel(coarse, block);
    bool needs = finest == 0;
    for (std::size_t i = 0; i < coarse.size() && !needs; ++i)
      needs = !drawn_whole[i] && coarse.level[i] >= finest && reaches(coarse, i, block);
    needed.push_back(needs || block.isCoarse());
  }
  return needed;
}

}  // namespace pcl_slim
