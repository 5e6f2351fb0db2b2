// SPDX-License-Identifier: BSD-3-Clause
#include "cover/coverage.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

/** The points of a surfel's ball within a reach that are on its side of the normal bound. */
BallQuery
queryOf(const SurfelRecord& surfel, float reach, const FitSettings& settings)
{
  return {surfel.center, reach, settings.with_normals ? surfel.normal.data() : nullptr,
          settings.min_dot};
}

}  // namespace

void
addCoverage(const PointStore& store, const FitSettings& settings, const SurfelRecord& surfel,
            NearbyBlocks& nearby, float* coverage)
{
  const CoverConstants& constants = settings.constants.cover;
  const bool supported =
      surfel.effective_count > constants.well_supported * numCoefficients(surfel.degree);
  const double alpha = supported ? settings.supported_alpha : settings.alpha;
  const auto reach = static_cast<float>(alpha * surfel.radius);
  kernels::CoverLeaf leaf;
  leaf.ball = queryOf(surfel, reach, settings);
  leaf.frame = LocalFrame({surfel.normal[0], surfel.normal[1], surfel.normal[2]});
  leaf.degree = surfel.degree;
  leaf.support_radius = surfel.radius;
  leaf.to_foot = !settings.paper;
  leaf.c = surfel.c.data();
  leaf.max_residual = settings.residual_bound > 0
                          ? static_cast<float>(settings.residual_bound * surfel.error +
                                               constants.residual_floor * surfel.radius)
                          : surfel.radius;
  kernels::coverPoints(store, nearby.within(surfel.center, reach), leaf, settings.cover_kernel,
                       coverage);
}

void
markBall(const PointStore& store, const FitSettings& settings, const SurfelRecord& surfel,
         std::uint8_t value, NearbyBlocks& nearby, std::uint8_t* marks)
{
  kernels::markPoints(store, nearby.within(surfel.center, surfel.radius),
                      queryOf(surfel, surfel.radius, settings), value, marks);
}

std::uint32_t
markUncovered(const PointStore& store, const FitSettings& settings, std::uint32_t point,
              double reach, std::uint8_t value, NearbyBlocks& nearby, const float* coverage,
              std::uint8_t* marks)
{
  const auto at = store.position(point);
  const std::array<float, 3> center = {static_cast<float>(at[0]), static_cast<float>(at[1]),
                                       static_cast<float>(at[2])};
  std::uint32_t count = 0;
  for (const std::uint32_t block : nearby.within(center, reach)) {
    const std::size_t begin = block * PointStore::kBlock;
    for (std::size_t i = begin; i < std::min(begin + PointStore::kBlock, store.size()); ++i) {
      const auto p = store.position(i);
      if (std::hypot(p[0] - at[0], p[1] - at[1], p[2] - at[2]) > reach) continue;
      if (coverage[i] >= settings.gamma || (marks[i] & value) != 0) continue;
      marks[i] |= value;
      ++count;
    }
  }
  return count;
}

}  // namespace pcl_slim::detail
