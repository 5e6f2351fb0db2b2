// SPDX-License-Identifier: BSD-3-Clause
#include "tiles/tile_loader.h"

#include <algorithm>

#include "pcl_slim/cloud/detail/cloud_reader.h"

namespace pcl_slim::detail {

Error
TileLoader::loadCore(std::size_t tile, std::vector<unsigned char>& records) const
{
  records.clear();
  for (const Bucket& bucket : store_.buckets()) {
    if (bucket.tile != tile) continue;
    if (Error error = store_.read(bucket, records)) return error;
  }
  return {};
}

HaloMask
TileLoader::maskOf(std::size_t tile, const std::vector<unsigned char>& records, double reach) const
{
  const CloudView view = record().view(records);
  PointKeys keys(frame_, threads_);
  AlignedVector<std::uint64_t> codes = keys.of(view);
  codes.resize(view.count());
  return {plan_, plan_.tiles[tile], codes, reach};
}

std::vector<std::uint64_t>
TileLoader::haloCells(std::size_t tile, const HaloMask& mask) const
{
  const TilePlan::Tile& own = plan_.tiles[tile];
  std::vector<std::uint64_t> cells;
  for (std::size_t c = 0; c < plan_.cells.size(); ++c) {
    const bool outside = c < own.first_cell || c >= own.end_cell;
    if (outside && mask.meets(plan_.cells[c])) cells.push_back(c);
  }
  return cells;
}

/** Appends the points of a bucket that are wanted(key, position). */
template <typename Wanted>
Error
TileLoader::loadSome(const TileStore& store, const Bucket& bucket, const Wanted& wanted,
                     std::vector<unsigned char>& records) const
{
  const std::size_t step = record().bytes();
  std::vector<unsigned char> read;
  if (Error error = store.read(bucket, read)) return error;
  const CloudView view = record().view(read);
  const CloudReader reader(view);
  PointKeys keys(frame_, threads_);
  const AlignedVector<std::uint64_t>& codes = keys.of(view);
  for (std::size_t i = 0; i < view.count(); ++i) {
    if (!wanted(codes[i], reader.position(i))) continue;
    const auto from = read.begin() + static_cast<std::ptrdiff_t>(i * step);
    records.insert(records.end(), from, from + static_cast<std::ptrdiff_t>(step));
  }
  return {};
}

Error
TileLoader::loadHalo(std::size_t tile, const HaloMask& mask,
                     std::vector<unsigned char>& records) const
{
  const auto inMask = [&](std::uint64_t key, const auto&) { return mask.holds(key); };
  for (const TileStore* store : {&store_, &halo_}) {
    for (const Bucket& bucket : store->buckets()) {
      if (bucket.tile == tile) continue;
      bool meets = false;
      for (std::size_t c = bucket.first_cell; c < bucket.end_cell && !meets; ++c)
        meets = mask.meets(plan_.cells[c]);
      if (!meets) continue;
      if (Error error = loadSome(*store, bucket, inMask, records)) return error;
    }
  }
  return {};
}

Error
TileLoader::loadCells(std::size_t first, std::size_t end, std::uint64_t thinning,
                      std::vector<unsigned char>& records) const
{
  const std::uint64_t begin_key = plan_.cells[first].first_key;
  const std::uint64_t last_key = plan_.cells[end - 1].first_key;
  const int below = 3 * (kDeepestCell - static_cast<int>(plan_.cells[end - 1].depth));
  const auto wanted = [&](std::uint64_t key, const std::array<double, 3>& p) {
    return key >= begin_key && (key < last_key || (key - last_key) >> below == 0) &&
           (thinning == 1 || placeHash(p) % thinning == 0);
  };
  for (const Bucket& bucket : store_.buckets()) {
    if (bucket.end_cell <= first || bucket.first_cell >= end) continue;
    if (Error error = loadSome(store_, bucket, wanted, records)) return error;
  }
  return {};
}

}  // namespace pcl_slim::detail
