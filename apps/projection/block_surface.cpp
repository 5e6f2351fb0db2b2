// SPDX-License-Identifier: BSD-3-Clause
#include "projection/block_surface.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "pcl_slim/cloud/morton.h"

namespace pcl_slim {

namespace {

constexpr double kCopies = 2;  ///< of a block: the one that is kept, and its part of the surface
constexpr std::size_t kRun = 1024;  ///< points along the curve that are looked at together

}  // namespace

bool BlockSurface::open(const std::string& path) {
  path_ = path;
  if (reader_.open(path)) return false;
  for (const SlimBlock& block : reader_.directory().blocks)
    boxes_.push_back(reader_.directory().boxOf(block));
  return true;
}

/** Adds the blocks whose boxes contain some of the points. */
template <typename Rows>
void BlockSurface::addBlocks(const CloudView& cloud, const Rows& rows, Blocks& blocks) const {
  for (const std::int32_t row : rows) {
    const auto p = cloud.position(static_cast<std::size_t>(row));
    for (std::size_t b = 0; b < boxes_.size(); ++b) {
      if (!blocks[b] && !reader_.directory().blocks[b].isCoarse() && boxesMeet(boxes_[b], {p, p}))
        blocks[b] = true;
    }
  }
}

double BlockSurface::bytesOf(const Blocks& blocks) const {
  double bytes = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const SlimBlock& block = reader_.directory().blocks[b];
    if (blocks[b]) bytes += kCopies * static_cast<double>(reader_.directory().memoryOf(block));
  }
  return bytes;
}

BlockSurface::Part BlockSurface::partOf(const CloudView& cloud) const {
  std::vector<std::int32_t> rows(cloud.size);
  std::iota(rows.begin(), rows.end(), 0);
  Part all = none();
  addBlocks(cloud, rows, all.blocks);
  return all;
}

std::vector<BlockSurface::Part> BlockSurface::partsOf(const CloudView& cloud) const {
  const Part all = partOf(cloud);
  if (bytesOf(all.blocks) <= most_bytes_) return {all};
  std::vector<std::int32_t> order(cloud.size);
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::uint64_t> keys;
  const SurfaceInfo& info = reader_.directory().info;
  for (const std::int32_t row : order) {
    auto p = cloud.position(static_cast<std::size_t>(row));
    for (std::size_t a = 0; a < 3; ++a) p[a] = (p[a] - info.origin[a]) / info.scale;
    keys.push_back(mortonCode(p[0], p[1], p[2]));
  }
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return keys[static_cast<std::size_t>(a)] < keys[static_cast<std::size_t>(b)];
  });
  std::vector<Part> parts;
  for (auto at = order.begin(); at != order.end();) {
    const auto left = static_cast<std::size_t>(order.end() - at);
    const std::vector<std::int32_t> run(at, at + static_cast<std::ptrdiff_t>(std::min(kRun, left)));
    at += static_cast<std::ptrdiff_t>(run.size());
    Blocks with = parts.empty() ? none().blocks : parts.back().blocks;
    addBlocks(cloud, run, with);
    if (parts.empty() || bytesOf(with) > most_bytes_) {
      parts.push_back(none());
      with.assign(boxes_.size(), false);
      addBlocks(cloud, run, with);
    }
    parts.back().blocks = std::move(with);
    parts.back().rows.insert(parts.back().rows.end(), run.begin(), run.end());
  }
  for (Part& part : parts) std::sort(part.rows.begin(), part.rows.end());
  return parts;
}

Result<SLIMSurface> BlockSurface::load(const Part& part) {
  const double bytes = bytesOf(part.blocks);
  const auto count = std::count(part.blocks.begin(), part.blocks.end(), true);
  if (bytes > most_bytes_) {
    const std::string what = std::to_string(count) + " blocks of '" + path_ + "'";
    if (Error error = checkMemory(bytes, what, "fit the surface by smaller -tile_points"))
      return error;
  }
  // What is kept for later parts may take half of what there is room for, as the surface is a copy.
  const double most = std::min(most_bytes_ / kCopies, 1e18);
  return reader_.load(part.blocks, static_cast<std::uint64_t>(most));
}

void BlockSurface::reportBlocks(Console& console, Report& report) const {
  const std::size_t all = boxes_.size(), read = reader_.blocksRead();
  report.set("surface_blocks", {{"count", all}, {"read", read}});
  console.note("  " + std::to_string(read) + " of " + std::to_string(all) +
               " blocks of the surface were read");
}

}  // namespace pcl_slim
