// SPDX-License-Identifier: BSD-3-Clause
#include "scratch/tile_store.h"

#include <algorithm>
#include <cstring>

#include "pcl_slim/cloud/detail/cloud_reader.h"

namespace pcl_slim::detail {

namespace {

constexpr std::uint64_t kBucketsOfTile = 16;
constexpr std::size_t kBufferBytes = 16 << 20;  ///< of all buffers together ...
constexpr std::size_t kMostBuffer = 96 << 10;   ///< ... of one ...
constexpr std::size_t kLeastBuffer = 4 << 10;   ///< ... and at least

Error
changed()
{
  return badInput(
      "the cloud's points changed while they were read: leave the file alone, and start again");
}

}  // namespace

void
PointRecord::write(const CloudView& piece, std::size_t i, unsigned char* to) const
{
  const CloudReader reader(piece);
  const std::size_t input = piece.inputIndex(i);
  const auto p = reader.position(input);
  if (scalar == CloudView::Scalar::kFloat) {
    const float q[3] = {static_cast<float>(p[0]), static_cast<float>(p[1]),
                        static_cast<float>(p[2])};
    std::memcpy(to, q, sizeof(q));
  } else {
    std::memcpy(to, p.data(), 3 * sizeof(double));
  }
  if (!normals) return;
  const auto n = reader.givenNormal(input);
  std::memcpy(to + positionBytes(), n.data(), 3 * sizeof(float));
}

CloudView
PointRecord::view(const std::vector<unsigned char>& records) const
{
  CloudView view;
  view.size = records.size() / bytes();
  view.xyz = records.data();
  view.xyz_stride = view.normal_stride = bytes();
  view.scalar = scalar;
  view.normal = normals ? records.data() + positionBytes() : nullptr;
  return view;
}

std::vector<std::uint32_t>
pointsOfCells(const TilePlan& plan)
{
  std::vector<std::uint32_t> points;
  for (const TilePlan::Cell& cell : plan.cells) points.push_back(cell.points);
  return points;
}

void
TileStore::cut(const TilePlan& plan, const std::vector<std::uint32_t>& points)
{
  std::uint64_t first_point = 0;
  for (std::size_t t = 0; t < plan.tiles.size(); ++t) {
    const TilePlan::Tile& tile = plan.tiles[t];
    const std::uint64_t most = tile.points / kBucketsOfTile + 1;
    for (std::size_t cell = tile.first_cell; cell < tile.end_cell;) {
      Bucket bucket;
      bucket.first_cell = cell;
      bucket.tile = t;
      bucket.first_point = first_point;
      while (cell < tile.end_cell && bucket.points < most) bucket.points += points[cell++];
      if (bucket.points == 0) continue;
      bucket.end_cell = cell;
      first_point += bucket.points;
      buckets_.push_back(bucket);
    }
  }
}

Error
TileStore::create(const TilePlan& plan, const std::vector<std::uint32_t>& points,
                  const PointRecord& record, const std::string& folder, bool kept)
{
  record_ = record;
  cut(plan, points);
  std::uint64_t all = 0;
  bucket_of_.assign(plan.cells.size(), 0);
  for (std::size_t b = 0; b < buckets_.size(); ++b) {
    for (std::size_t c = buckets_[b].first_cell; c < buckets_[b].end_cell; ++c)
      bucket_of_[c] = static_cast<std::uint32_t>(b);
    all += buckets_[b].points * record_.bytes();
  }
  const std::size_t bytes = std::clamp(kBufferBytes / std::max<std::size_t>(1, buckets_.size()),
                                       kLeastBuffer, kMostBuffer);
  buffer_points_ = bytes / record_.bytes();
  buffers_.resize(buckets_.size() * buffer_points_ * record_.bytes());
  filled_.assign(buckets_.size(), 0);
  return kept ? file_.createKept(folder, all) : file_.create(folder, all);
}

Error
TileStore::open(const TilePlan& plan, const PointRecord& record, const std::string& folder)
{
  record_ = record;
  cut(plan, pointsOfCells(plan));
  return file_.openKept(folder, plan.points * record_.bytes());
}

Error
TileStore::add(const CloudView& piece, const std::uint64_t* keys, const CellCounts& cells)
{
  const std::size_t step = record_.bytes();
  for (std::size_t i = 0; i < piece.count(); ++i) {
    if (keys[i] == PointKeys::kLeftOut) continue;
    const std::size_t b = bucket_of_[cells.numberOf(keys[i])];
    record_.write(piece, i, buffers_.data() + (b * buffer_points_ + filled_[b]) * step);
    if (++filled_[b] < buffer_points_) continue;
    if (Error error = flush(b)) return error;
  }
  return {};
}

Error
TileStore::flush(std::size_t b)
{
  Bucket& bucket = buckets_[b];
  const std::size_t step = record_.bytes();
  if (bucket.written + filled_[b] > bucket.points) return changed();
  const std::uint64_t at = (bucket.first_point + bucket.written) * step;
  bucket.written += filled_[b];
  const std::size_t bytes = filled_[b] * step;
  filled_[b] = 0;
  return file_.write(at, buffers_.data() + b * buffer_points_ * step, bytes);
}

Error
TileStore::finish()
{
  for (std::size_t b = 0; b < buckets_.size(); ++b) {
    if (Error error = flush(b)) return error;
    if (buckets_[b].written != buckets_[b].points) return changed();
  }
  std::vector<unsigned char>().swap(buffers_);
  std::vector<std::uint32_t>().swap(bucket_of_);
  return {};
}

Error
TileStore::read(const Bucket& bucket, std::vector<unsigned char>& records) const
{
  const std::size_t before = records.size(), step = record_.bytes();
  records.resize(before + bucket.points * step);
  return file_.read(bucket.first_point * step, records.data() + before, bucket.points * step);
}

}  // namespace pcl_slim::detail
