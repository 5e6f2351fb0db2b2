// SPDX-License-Identifier: BSD-3-Clause
// What a cover has made and taken.
#include <algorithm>

#include "cover/level_cover.h"

namespace pcl_slim::detail {

void
LevelCover::countBytes()
{
  std::uint64_t bytes = outputs_.capacity() * sizeof(Output);
  for (const auto& worker : workers_) bytes += worker->arena.capacity() * sizeof(SurfelRecord);
  bytes += coverage_.size() * sizeof(float) + marks_.size() +
           active_.capacity() * sizeof(std::uint32_t) + cells_.memoryBytes();
  peak_bytes_ = std::max(peak_bytes_, bytes);
}

std::vector<LevelCover::Piece>
LevelCover::pieces() const
{
  std::vector<Piece> pieces;
  std::size_t first = 0;
  for (const Output& output : outputs_) {
    const SurfelRecord* records = worker(output.thread).arena.data();
    if (output.begin == output.end) continue;
    pieces.push_back({records + output.begin, records + output.end, first});
    first += output.end - output.begin;
  }
  return pieces;
}

BallCounters
LevelCover::counters() const
{
  BallCounters sum;
  for (const auto& worker : workers_) {
    const BallCounters counters = worker->fitter.counters();
    sum.gathered += counters.gathered;
    sum.split_sheets += counters.split_sheets;
    sum.tried += counters.tried;
    sum.lines += counters.lines;
    sum.fits += counters.fits;
  }
  return sum;
}

}  // namespace pcl_slim::detail
