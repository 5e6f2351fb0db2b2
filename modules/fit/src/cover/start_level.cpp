// SPDX-License-Identifier: BSD-3-Clause
#include "fit_steps.h"

#include <algorithm>
#include <vector>

namespace pcl_slim::detail {

int
startLevel(const PointStore& store, const FitSettings& settings)
{
  if (settings.paper) return 1;
  const CoverConstants& constants = settings.constants.cover;
  const std::size_t samples = std::min(constants.start_samples, store.size());
  const auto most =
      static_cast<std::size_t>(settings.start_share * static_cast<double>(store.size()));
  std::vector<std::uint32_t> blocks;
  int level = 1;
  const auto isLast = [&](int k) { return !settings.resolves(k + 1) || !settings.allows(k + 1); };
  for (; level < constants.last_start && !isLast(level); ++level) {
    std::size_t crowded = 0;
    for (std::size_t s = 0; s < samples; ++s) {
      const auto p = store.position((2 * s + 1) * store.size() / (2 * samples));
      const float center[3] = {static_cast<float>(p[0]), static_cast<float>(p[1]),
                               static_cast<float>(p[2])};
      blocks.clear();
      // Blocks stand for their points: enough for a choice between factors of 1.6.
      store.tree().blocksInBall(center, static_cast<float>(settings.levelRadius(level)), blocks);
      crowded +=
          blocks.size() * PointStore::kBlock > most + constants.start_slack * PointStore::kBlock;
    }
    if (2 * crowded <= samples) return level;
  }
  return level;
}

}  // namespace pcl_slim::detail
