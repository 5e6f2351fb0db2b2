// SPDX-License-Identifier: BSD-3-Clause
// Colours and standard errors of a surface at lists of places.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <deque>
#include <vector>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/surface_probe.h"

namespace pcl_slim {

namespace {

/** Up to kMost places of a list, in the surface's local units, with the normals there. */
struct PlaceRun {
  std::size_t begin, count;
  std::array<Vector3, SurfaceProbe::kMost> places, sides;
};

/** Calls visit(probe, run) for all places, a run at a time, on several threads. */
template <typename Visit>
void forRuns(const ProbeIndex& index, const std::vector<Vector3>& positions,
             const std::vector<std::array<float, 3>>& normals, int threads, const Visit& visit) {
  constexpr std::size_t kRun = SurfaceProbe::kMost;
  const SurfaceInfo& info = index.surface().info;
  threads = resolveThreads(threads);
  std::deque<SurfaceProbe> probes;
  for (int t = 0; t < threads; ++t) probes.emplace_back(index);
  parallelFor((positions.size() + kRun - 1) / kRun, threads, 64, [&](std::size_t r, int thread) {
    PlaceRun run;
    run.begin = r * kRun;
    run.count = std::min(kRun, positions.size() - run.begin);
    for (std::size_t i = 0; i < run.count; ++i) {
      const auto& n = normals[run.begin + i];
      run.sides[i] = {n[0], n[1], n[2]};
      run.places[i] = scaled(subtract(positions[run.begin + i], info.origin), 1 / info.scale);
    }
    SurfaceProbe& probe = probes[static_cast<std::size_t>(thread)];
    probe.restart(0);
    visit(probe, run);
  });
}

}  // namespace

std::vector<std::array<std::uint8_t, 3>> surfaceColors(
    const SLIMSurface& surface, const std::vector<Vector3>& positions,
    const std::vector<std::array<float, 3>>& normals, int threads) {
  if (!surface.hasColors()) return {};
  std::vector<std::array<std::uint8_t, 3>> made(positions.size(), {255, 255, 255});
  const ProbeIndex index(surface);
  forRuns(index, positions, normals, threads, [&](SurfaceProbe& probe, const PlaceRun& run) {
    std::array<std::array<float, 3>, SurfaceProbe::kMost> colors;
    probe.colors(run.places.data(), run.sides.data(), run.count, colors.data());
    for (std::size_t i = 0; i < run.count; ++i) {
      for (std::size_t c = 0; c < 3 && colors[i][c] >= 0; ++c)
        made[run.begin + i][c] = static_cast<std::uint8_t>(std::lround(colors[i][c]));
    }
  });
  return made;
}

std::vector<StandardErrors> surfaceErrors(const SLIMSurface& surface,
                                          const std::vector<Vector3>& positions,
                                          const std::vector<std::array<float, 3>>& normals,
                                          int threads) {
  std::vector<StandardErrors> made(positions.size());
  threads = resolveThreads(threads);
  const ProbeIndex index(surface, ProbeUse::kSamples, true, threads);
  const auto scale = static_cast<float>(surface.info.scale);
  forRuns(index, positions, normals, threads, [&](SurfaceProbe& probe, const PlaceRun& run) {
    std::array<ProbeSample, SurfaceProbe::kMost> samples;
    ProbeRequest request;
    request.positions = run.places.data();
    request.count = run.count;
    request.sides = run.sides.data();
    request.errors = true;
    probe.evaluate(request, samples.data());
    for (std::size_t i = 0; i < run.count; ++i) {
      const StandardErrors& local = samples[i].errors;
      made[run.begin + i] = {local.position * scale, local.normal, local.curvature / scale};
    }
  });
  return made;
}

}  // namespace pcl_slim
