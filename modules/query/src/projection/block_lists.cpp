// SPDX-License-Identifier: BSD-3-Clause
#include "projection/block_lists.h"

#include "pcl_slim/core/parallel.h"
#include "projection/placement.h"

namespace pcl_slim::detail {

namespace {

/** A run of the leaves, and the blocks that each of them meets. */
struct Slice {
  std::size_t first, last;               ///< places in the list of leaves
  std::vector<std::uint32_t> hits;       ///< blocks, leaf by leaf
  std::vector<std::uint32_t> hit_begin;  ///< where each leaf's hits begin, and where the last ends
  std::vector<std::uint32_t> at;  ///< of each block: its number of hits, then a place to write
};

void
findBlocks(const PointStore& store, const SLIMSurface& surface,
           const std::vector<std::uint32_t>& leaves, Slice& slice)
{
  const Placement placement(store, surface);
  for (std::size_t j = slice.first; j < slice.last; ++j) {
    const auto center = placement.center(surface, leaves[j]);
    const float at[3] = {static_cast<float>(center[0]), static_cast<float>(center[1]),
                         static_cast<float>(center[2])};
    slice.hit_begin.push_back(static_cast<std::uint32_t>(slice.hits.size()));
    store.tree().blocksInBall(at, placement.radius(surface, leaves[j]), slice.hits);
  }
  slice.hit_begin.push_back(static_cast<std::uint32_t>(slice.hits.size()));
  slice.at.assign(store.numBlocks(), 0);
  for (const std::uint32_t block : slice.hits) ++slice.at[block];
}

/** Turns the slices' counts into places: block by block, and within a block slice by slice, so that
 * its leaves ascend. \return where each block begins, and the end. */
std::vector<std::uint32_t>
placeSlices(std::size_t blocks, std::vector<Slice>& slices)
{
  std::vector<std::uint32_t> begin(blocks + 1);
  std::uint32_t total = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    begin[b] = total;
    for (Slice& slice : slices) {
      const std::uint32_t count = slice.at[b];
      slice.at[b] = total;
      total += count;
    }
  }
  begin[blocks] = total;
  return begin;
}

void
writeLeaves(Slice& slice, std::vector<std::uint32_t>& leaves)
{
  for (std::size_t j = 0; j + 1 < slice.hit_begin.size(); ++j) {
    for (std::uint32_t h = slice.hit_begin[j]; h < slice.hit_begin[j + 1]; ++h) {
      leaves[slice.at[slice.hits[h]]++] = static_cast<std::uint32_t>(slice.first + j);
    }
  }
}

}  // namespace

BlockLists
listLeaves(const PointStore& store, const SLIMSurface& surface,
           const std::vector<std::uint32_t>& leaves, int threads)
{
  // As many slices as threads: each finds its blocks, all are counted, then each writes its own.
  std::vector<Slice> slices(static_cast<std::size_t>(threads));
  for (std::size_t s = 0; s < slices.size(); ++s) {
    slices[s].first = leaves.size() * s / slices.size();
    slices[s].last = leaves.size() * (s + 1) / slices.size();
  }
  parallelFor(slices.size(), threads, 1,
              [&](std::size_t s, int) { findBlocks(store, surface, leaves, slices[s]); });
  BlockLists lists;
  lists.begin = placeSlices(store.numBlocks(), slices);
  lists.leaves.resize(lists.begin.back());
  parallelFor(slices.size(), threads, 1,
              [&](std::size_t s, int) { writeLeaves(slices[s], lists.leaves); });
  return lists;
}

}  // namespace pcl_slim::detail
