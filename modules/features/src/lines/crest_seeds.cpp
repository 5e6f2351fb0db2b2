// SPDX-License-Identifier: BSD-3-Clause
#include "lines/crest_seeds.h"

#include <algorithm>
#include <tuple>

#include "lines/crest_field.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kStride = 4;     ///< stored points are tried in steps of this ...
constexpr std::size_t kNeighbors = 8;  ///< ... against this number of neighbours
constexpr std::size_t kSlice = 256;    ///< points looked at in one piece of work
constexpr double kSameSheet = 0.2;     ///< least cosine between two neighbours' normals

Vector3
toVector(const std::array<float, 3>& a)
{
  return {a[0], a[1], a[2]};
}

class SeedFinder {
 public:
  SeedFinder(const PointStore& store, const Projection& projection, const SLIMSurface& surface)
      : projection_(projection), factor_(store.scale() / surface.info.scale)
  {
    for (std::size_t a = 0; a < 3; ++a) {
      shift_[a] = (store.origin()[a] - surface.info.origin[a]) / surface.info.scale;
    }
  }

  /** Adds the seed between two points, if a line of that type passes between them. */
  void tryPair(std::size_t i, std::size_t j, CrestType type, std::vector<CrestSeed>& seeds) const
  {
    if (projection_.supported[j] == 0) return;
    const Vector3 n = toVector(projection_.normal[i]), m = toVector(projection_.normal[j]);
    const double facing = dot(n, m);
    if (std::abs(facing) < kSameSheet) return;
    const CrestSide a = crestSide(projection_.principal[i], type, false);
    const CrestSide b = crestSide(projection_.principal[j], type, facing < 0);
    if (!(a.k > std::abs(a.other) && b.k > std::abs(b.other))) return;
    const Vector3 ta = toVector(a.t), tb = toVector(b.t);
    const Vector3 &p = projection_.position[i], &q = projection_.position[j];
    const double ahead = dot(subtract(q, p), ta);
    const double ea = ahead < 0 ? -a.e : a.e;
    const double eb = (ahead < 0) != (dot(ta, tb) < 0) ? -b.e : b.e;
    if (!(ea > 0 && eb <= 0)) return;
    const double share = ea / (ea - eb);
    const Vector3 between = along(p, share, subtract(q, p));
    CrestSeed seed;
    for (std::size_t c = 0; c < 3; ++c) seed.position[c] = shift_[c] + factor_ * between[c];
    seed.normal = share < 0.5 ? n : scaled(m, facing < 0 ? -1.0 : 1.0);
    seed.t = share < 0.5 ? ta : tb;
    seed.k = (a.k + share * (b.k - a.k)) / factor_;
    seeds.push_back(seed);
  }

 private:
  const Projection& projection_;
  double factor_;
  Vector3 shift_{};
};

}  // namespace

std::vector<std::vector<CrestSeed>>
findCrestSeeds(const PointStore& store, const Projection& projection, const SLIMSurface& surface,
               int threads, Progress* progress)
{
  const SeedFinder finder(store, projection, surface);
  const std::size_t points = (store.size() + kStride - 1) / kStride;
  const std::size_t slices = (points + kSlice - 1) / kSlice;
  std::vector<std::vector<std::vector<CrestSeed>>> found(
      2, std::vector<std::vector<CrestSeed>>(slices));
  parallelFor(slices, threads, 1, [&](std::size_t slice, int) {
    if (progress != nullptr && progress->cancelled()) return;
    NeighborSearch search(store);
    std::vector<std::uint32_t> neighbors;
    std::vector<float> distances_sq;
    const std::size_t end = std::min((slice + 1) * kSlice, points);
    for (std::size_t s = slice * kSlice; s < end; ++s) {
      const std::size_t i = s * kStride;
      if (projection.supported[i] == 0) continue;
      search.nearest(i, kNeighbors + 1, neighbors, distances_sq);
      for (const std::uint32_t j : neighbors) {
        if (j == i) continue;
        finder.tryPair(i, j, CrestType::kRidge, found[0][slice]);
        finder.tryPair(i, j, CrestType::kRavine, found[1][slice]);
      }
    }
  });
  std::vector<std::vector<CrestSeed>> seeds(2);
  if (progress != nullptr && progress->cancelled()) return seeds;
  for (std::size_t type = 0; type < 2; ++type) {
    for (const auto& slice : found[type]) {
      seeds[type].insert(seeds[type].end(), slice.begin(), slice.end());
    }
    std::sort(seeds[type].begin(), seeds[type].end(), [](const CrestSeed& a, const CrestSeed& b) {
      return std::tie(b.k, a.position) < std::tie(a.k, b.position);
    });
  }
  return seeds;
}

}  // namespace pcl_slim::detail
