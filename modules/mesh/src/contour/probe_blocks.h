// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/query/surface_probe.h"

namespace pcl_slim::detail {

/** A surface with what all steps of an extraction need to evaluate it. */
struct ProbeField {
  const ProbeIndex& index;
  double margin;  ///< how far around sixteen places leaves are looked for ahead, local units
  int threads;
};

/** Calls body(probe, first, count) for each sixteen of some places, which are in Morton order. Runs of
 * them that share the leaves found begin at fixed places: results are the same for any number of threads. */
template <typename Body>
void
forProbeBlocks(const ProbeField& field, std::size_t places, const Body& body)
{
  constexpr std::size_t kBlock = SurfaceProbe::kMost, kRun = 64 * kBlock;
  std::vector<std::unique_ptr<SurfaceProbe>> probes(static_cast<std::size_t>(field.threads));
  parallelFor((places + kRun - 1) / kRun, field.threads, 1, [&](std::size_t run, int thread) {
    auto& probe = probes[static_cast<std::size_t>(thread)];
    if (!probe) probe = std::make_unique<SurfaceProbe>(field.index);
    probe->restart(field.margin);
    const std::size_t end = std::min(places, (run + 1) * kRun);
    for (std::size_t first = run * kRun; first < end; first += kBlock) {
      body(*probe, first, std::min(kBlock, end - first));
    }
  });
}

}  // namespace pcl_slim::detail
