// SPDX-License-Identifier: BSD-3-Clause
#include "reference/tile_rasterizer.h"

#include "camera/camera_rays.h"
#include "pcl_slim/core/parallel.h"
#include "reference/tile_passes.h"
#include "tiles/surfel_bins.h"

namespace pcl_slim::detail {
void
renderReference(const SLIMSurface& surface, const Camera& camera, const FrameRules& rules,
                GBuffer& buffer, RenderStatistics& statistics)
{
  const CameraRays rays(camera, surface.info.origin, surface.info.scale);
  const SurfelBins bins = binLeaves(surface, rays, camera.size, rules.shrink, rules.near_plane,
                                    rules.front_only && rules.skip, rules.threads, statistics);
  const FrameContext frame{surface, rays, bins, rules};
  statistics += forEachTile<Tile, RenderStatistics>(
      bins, rules.threads, [&](std::size_t t, Tile& tile, RenderStatistics& counts) {
        tile.begin(frame, camera.size, t);
        for (int layer = 0; layer < kMaxLayers; ++layer) {
          findFirstIntersections(frame, t, tile, counts);
          gatherBlends(frame, t, tile, counts);
          if (!peelUncovered(frame, tile)) break;
        }
        resolveTile(frame, tile, buffer, counts);
      });
}

}  // namespace pcl_slim::detail
