// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/query/surface_colors.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/query/surface_probe.h"

namespace pcl_slim {

std::vector<std::array<std::uint8_t, 3>>
surfaceColors(const SLIMSurface& surface, const std::vector<Vector3>& positions,
              const std::vector<std::array<float, 3>>& normals, int threads)
{
  constexpr std::size_t kRun = SurfaceProbe::kMost;
  if (!surface.hasColors()) return {};
  std::vector<std::array<std::uint8_t, 3>> made(positions.size(), {255, 255, 255});
  const ProbeIndex index(surface);
  threads = resolveThreads(threads);
  std::deque<SurfaceProbe> probes;
  for (int t = 0; t < threads; ++t) probes.emplace_back(index);
  parallelFor((positions.size() + kRun - 1) / kRun, threads, 64, [&](std::size_t run, int thread) {
    const std::size_t begin = run * kRun, count = std::min(kRun, positions.size() - begin);
    std::array<Vector3, kRun> places, sides;
    for (std::size_t i = 0; i < count; ++i) {
      const auto& n = normals[begin + i];
      sides[i] = {n[0], n[1], n[2]};
      places[i] =
          scaled(subtract(positions[begin + i], surface.info.origin), 1 / surface.info.scale);
    }
    SurfaceProbe& probe = probes[static_cast<std::size_t>(thread)];
    std::array<std::array<float, 3>, kRun> colors;
    probe.restart(0);
    probe.colors(places.data(), sides.data(), count, colors.data());
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < 3 && colors[i][c] >= 0; ++c)
        made[begin + i][c] = static_cast<std::uint8_t>(std::lround(colors[i][c]));
    }
  });
  return made;
}

}  // namespace pcl_slim
