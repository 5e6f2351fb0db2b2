// SPDX-License-Identifier: BSD-3-Clause
// Levels above the tiles' first, from a sample of the cloud.
#include <algorithm>

#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/core/random.h"
#include "stream_state.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::uint64_t kLeastSample = 1 << 19;  ///< points
constexpr std::uint64_t kPointsPerTile =
    4000;  ///< gives a tile's first ball 80, up to a tile's points in all

}  // namespace

/** Points that one of the sample represents. */
std::uint64_t
detail::StreamState::coarseThinning() const
{
  const std::uint64_t wanted =
      std::max(kLeastSample, std::min(params.tile_points, kPointsPerTile * plan.tiles.size()));
  return std::max<std::uint64_t>(1, plan.points / wanted);
}

/** Adds a share of a tile's points, chosen by their places. */
void
detail::StreamState::addSample(const std::vector<unsigned char>& core,
                               std::vector<unsigned char>& sample) const
{
  const std::size_t step = store.record().bytes();
  const CloudView view = store.record().view(core);
  const CloudReader reader(view);
  const std::uint64_t thinning = coarseThinning();
  for (std::size_t i = 0; i < view.count(); ++i) {
    if (placeHash(reader.position(i)) % thinning != 0) continue;
    const auto from = core.begin() + static_cast<std::ptrdiff_t>(i * step);
    sample.insert(sample.end(), from, from + static_cast<std::ptrdiff_t>(step));
  }
}

/** First level of the tile at a Morton code; between two tiles the finer one's. */
int
detail::StreamState::firstLevelAt(std::uint64_t key) const
{
  const auto next =
      std::upper_bound(plan.tiles.begin(), plan.tiles.end(), key,
                       [](std::uint64_t k, const TilePlan::Tile& t) { return k < t.first_key; });
  const auto after = static_cast<std::size_t>(next - plan.tiles.begin());
  const int before = after > 0 ? first_levels[after - 1] : 0;
  const bool inside = after > 0 && key < plan.tiles[after - 1].end_key;
  return inside || next == plan.tiles.end() ? before : std::max(before, first_levels[after]);
}

/** Fits the levels that no tile has; where a tile begins with a coarse level, what is below it is dropped. */
Error
detail::StreamState::fitCoarse(const std::vector<unsigned char>& sample)
{
  CoarseJob job;
  for (const int level : first_levels) job.last_level = std::max(job.last_level, level - 1);
  job.traits = traits;
  job.thinning = coarseThinning();
  if (sample.empty()) return {};  // of other ranks than the first
  const Result<PointStore> points = PointStore::build(store.record().view(sample), frame, threads);
  if (!points) return points.error();
  SLIMSurface all;
  if (Error error = fitCoarseLevels(*points, params.fit, job, all)) return error;
  coarse.info = all.info;
  for (std::size_t i = 0, begin = 0; i <= all.size(); ++i) {
    const bool kept =
        i < all.size() && all.level[i] < firstLevelAt(mortonCode(all.cx[i], all.cy[i], all.cz[i]));
    if (kept) continue;
    if (begin < i) coarse.append(all.slice(begin, i));
    begin = i + 1;
  }
  coarse.info.num_points = plan.points;
  return {};
}

}  // namespace pcl_slim
