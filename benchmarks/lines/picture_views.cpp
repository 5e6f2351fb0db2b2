// SPDX-License-Identifier: BSD-3-Clause
#include "picture_views.h"

#include <cmath>
#include <utility>

namespace pcl_slim::lines_bench {

Error renderView(SurfaceRenderer& renderer, const PictureLineParams& params, PictureView& view) {
  RenderParams rendering;
  rendering.threads = params.threads;
  rendering.close_gaps = true;
  rendering.columns = pictureLineColumns(params) | kPositionColumn;
  return renderer.render(view.camera, rendering, view.buffer);
}

bool placeOnSurface(const SLIMSurface& surface, const GBuffer& buffer,
                    const std::array<float, 2>& place, Vector3& world) {
  const int x = static_cast<int>(std::floor(place[0])), y = static_cast<int>(std::floor(place[1]));
  if (x < 0 || y < 0 || x + 1 >= buffer.width || y + 1 >= buffer.height) return false;
  const double fx = place[0] - x, fy = place[1] - y;
  const double shares[] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
  world = surface.info.origin;
  for (int corner = 0; corner < 4; ++corner) {
    const std::size_t i = buffer.index(x + corner % 2, y + corner / 2);
    if (!buffer.covered(i)) return false;
    for (std::size_t a = 0; a < 3; ++a)
      world[a] += shares[corner] * surface.info.scale * buffer.position[i][a];
  }
  return true;
}

std::vector<SpaceLine> crestLinesInSpace(const SLIMSurface& surface, const PictureView& view) {
  std::vector<SpaceLine> placed;
  for (const PictureLine& line : view.lines) {
    if (line.kind != PictureLineKind::kRidge && line.kind != PictureLineKind::kRavine) continue;
    SpaceLine space{line.kind, {}};
    Vector3 world;
    for (const auto& place : line.points) {
      if (placeOnSurface(surface, view.buffer, place, world)) space.points.push_back(world);
    }
    placed.push_back(std::move(space));
  }
  return placed;
}

}  // namespace pcl_slim::lines_bench
