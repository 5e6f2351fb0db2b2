// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Noise that neighbours share": residuals of cubics on patches of one size.
#include "noise/patch_scale.h"

#include <algorithm>

#include "noise/patch_cells.h"
#include "noise/patch_noise.h"
#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim::detail {

namespace {

/** Every second point of a store. \param[in] first 0 or 1 */
PointStore
everySecond(const PointStore& store, std::size_t first, int threads)
{
  std::vector<std::uint32_t> dropped;
  dropped.reserve(store.size() / 2 + 1);
  for (std::size_t i = 1 - first; i < store.size(); i += 2)
    dropped.push_back(static_cast<std::uint32_t>(i));
  return store.without(dropped, threads);
}

}  // namespace

double
PatchScale::power(std::size_t place) const
{
  // Of the points left out as many share with a point as their part of all of them.
  const double sharing = 1 + static_cast<double>(stride) * (shared[place] - 1);
  return variances[place] * std::max(1.0, sharing);
}

ThinnedPlaces::ThinnedPlaces(const PointStore& store, std::size_t count) : whole_(store)
{
  count = std::min(count, store.size());
  for (std::size_t s = 0; s < count; ++s)
    places_.push_back((2 * s + 1) * store.size() / (2 * count));
}

void
ThinnedPlaces::thinTo(std::size_t stride, int threads)
{
  for (; stride_ < stride; stride_ *= 2) {
    const std::size_t before = stride_ == 1 ? 1 : parts_.size();
    const std::size_t parts = stride_ < kFirst ? 1 : std::min(2 * before, kParts);
    std::vector<PointStore> thinner;
    for (std::size_t p = 0; p < parts; ++p)
      thinner.push_back(everySecond(storeOf(p % before), p / before, threads));
    parts_ = std::move(thinner);
    for (std::size_t s = 0; s < places_.size(); ++s)
      places_[s] = std::min(places_[s] / 2, parts_[s % parts_.size()].size() - 1);
  }
}

PatchScale
measureScale(ThinnedPlaces& points, std::size_t k, const NoiseConstants& constants, int threads,
             const PatchScale* narrower)
{
  PatchScale scale;
  scale.k = k;
  scale.stride = patchStride(k, constants);
  points.thinTo(scale.stride, threads);
  scale.variances.resize(points.size());
  scale.shared.resize(points.size());
  scale.radii.resize(points.size());
  points.forEach(threads, [&](const PointStore& store, NeighborSearch& search, std::size_t place,
                              std::size_t s) {
    thread_local PatchCubic cubic;
    const double factor = narrower ? static_cast<double>(k) / static_cast<double>(narrower->k) : 0;
    const double about = narrower ? probableSquare(narrower->radii[s], factor) : 0;
    const bool fits =
        fitPatch(store, search, place, k / scale.stride, constants, cubic, scale.radii[s], about);
    scale.variances[s] = fits ? cubic.variance : -1;
    scale.shared[s] = fits ? sharedInPatch(cubic, constants.shared.cells) : -1;
  });
  return scale;
}

PatchScale
measureScale(const PointStore& store, std::size_t k, const NoiseConstants& constants, int threads)
{
  ThinnedPlaces points(store, constants.shared.places);
  return measureScale(points, k, constants, threads);
}

double
levelOf(const PatchScale& scale, const NoiseConstants& constants)
{
  std::vector<double> variances = scale.variances;
  return uncutVariance(trimmedMean(variances, constants.shared.trim), median(scale.radii));
}

double
correlationOf(const PatchScale& scale, const NoiseConstants& constants)
{
  std::vector<double> shared = scale.shared;
  const std::size_t looked_at = scale.k / scale.stride;
  const double points =
      static_cast<double>(looked_at) / static_cast<double>(constants.shared.cells);
  const double among = squareThatShares(trimmedMean(shared, constants.shared.trim), points);
  return 1 + static_cast<double>(scale.stride) * (among - 1);
}

}  // namespace pcl_slim::detail
