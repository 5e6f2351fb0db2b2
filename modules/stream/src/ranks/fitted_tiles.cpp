// SPDX-License-Identifier: BSD-3-Clause
#include "ranks/fitted_tiles.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcl_slim/surface/surface_io.h"
#include "ranks/rank_messages.h"

namespace pcl_slim::detail {
namespace {

constexpr std::uint64_t FitStatistics::*kCounts[] = {&FitStatistics::points,
                                                     &FitStatistics::outliers,
                                                     &FitStatistics::leaves,
                                                     &FitStatistics::internals,
                                                     &FitStatistics::support_limited,
                                                     &FitStatistics::reduced_degree,
                                                     &FitStatistics::uncovered,
                                                     &FitStatistics::unsupported,
                                                     &FitStatistics::skipped_normals,
                                                     &FitStatistics::split_sheets,
                                                     &FitStatistics::fits,
                                                     &FitStatistics::fell_by_support,
                                                     &FitStatistics::fell_by_pivot,
                                                     &FitStatistics::line_balls,
                                                     &FitStatistics::gathered,
                                                     &FitStatistics::never_gathered,
                                                     &FitStatistics::unresolved,
                                                     &FitStatistics::open_leaves,
                                                     &FitStatistics::trim_candidates};

constexpr double FitSeconds::*kSeconds[] = {&FitSeconds::outliers, &FitSeconds::noise,
                                            &FitSeconds::cover, &FitSeconds::trim};

}  // namespace

void
StatisticsSum::add(const FitStatistics& tile, const SLIMSurface& surface)
{
  for (const auto count : kCounts) sum_.*count += tile.*count;
  for (const auto seconds : kSeconds) sum_.seconds.*seconds += tile.seconds.*seconds;
  sum_.least_pivot = std::min(sum_.least_pivot, tile.least_pivot);
  sum_.working_bytes = std::max(sum_.working_bytes, tile.working_bytes);
  sum_.first_level = any_ ? std::min(sum_.first_level, tile.first_level) : tile.first_level;
  sum_.levels_skipped = sum_.first_level - 1;
  sum_.last_level = std::max(sum_.last_level, tile.last_level);
  sum_.threads = tile.threads;
  sum_.penalty = tile.penalty;
  sum_.t_mdl = tile.t_mdl;
  auto& levels = sum_.leaves_per_level;
  levels.resize(std::max(levels.size(), tile.leaves_per_level.size()));
  for (std::size_t k = 0; k < tile.leaves_per_level.size(); ++k)
    levels[k] += tile.leaves_per_level[k];
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!surface.isLeaf(i)) continue;
    const double weight = surface.effective_count[i], error = surface.error[i];
    weight_ += weight;
    square_ += weight * error * error;
  }
  sum_.rms_error = weight_ > 0 ? std::sqrt(square_ / weight_) / surface.info.diagonal : 0.0;
  any_ = true;
}

std::vector<double>
packedStatistics(const FitStatistics& tile)
{
  std::vector<double> numbers{tile.least_pivot,
                              static_cast<double>(tile.first_level),
                              static_cast<double>(tile.last_level),
                              tile.penalty,
                              tile.t_mdl,
                              static_cast<double>(tile.working_bytes)};
  for (const auto count : kCounts) numbers.push_back(static_cast<double>(tile.*count));
  return numbers;
}

FitStatistics
unpackedStatistics(const std::vector<double>& numbers, const SLIMSurface& surface)
{
  FitStatistics tile;
  tile.least_pivot = numbers[0];
  tile.first_level = static_cast<int>(numbers[1]);
  tile.last_level = static_cast<int>(numbers[2]);
  tile.penalty = numbers[3];
  tile.t_mdl = numbers[4];
  tile.working_bytes = static_cast<std::uint64_t>(numbers[5]);
  std::size_t next = 6;
  for (const auto count : kCounts) tile.*count = static_cast<std::uint64_t>(numbers[next++]);
  tile.leaves_per_level.assign(static_cast<std::size_t>(tile.last_level) + 1, 0);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const std::size_t level = surface.level[i];
    if (surface.isLeaf(i) && level < tile.leaves_per_level.size()) ++tile.leaves_per_level[level];
  }
  return tile;
}

std::size_t
numPackedStatistics()
{
  return packedStatistics({}).size();
}

Ranks::Bytes
packedTile(const FittedTile& made)
{
  Ranks::Bytes bytes;
  for (const double number : packedStatistics(made.statistics)) appendBytes(number, bytes);
  appendBytes(static_cast<double>(made.halo_points), bytes);
  const std::vector<unsigned char> slim = encodeSlim(made.surface);
  bytes.insert(bytes.end(), slim.begin(), slim.end());
  return bytes;
}

Error
unpackTile(const Ranks::Bytes& bytes, FittedTile& made)
{
  const std::size_t head = (numPackedStatistics() + 1) * sizeof(double);
  if (bytes.size() < head) return badInput("a fitted tile is not whole: fit it again");
  const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(head);
  std::vector<double> numbers = valuesOf<double>({bytes.begin(), middle});
  Result<SLIMSurface> surface = decodeSlim(bytes.data() + head, bytes.size() - head);
  if (!surface) return surface.error();
  made.halo_points = static_cast<std::uint64_t>(numbers.back());
  made.surface = std::move(*surface);
  made.statistics = unpackedStatistics(numbers, made.surface);
  return {};
}

Error
FittedTiles::add(std::size_t tile, const FittedTile& made, const std::string& folder)
{
  if (places_.empty()) {
    if (Error error = file_.create(folder, 0)) return error;
  }
  const Ranks::Bytes bytes = packedTile(made);
  places_[tile] = {end_, bytes.size()};
  end_ += bytes.size();
  return file_.write(places_[tile].at, bytes.data(), bytes.size());
}

Error
FittedTiles::read(std::size_t tile, Ranks::Bytes& bytes) const
{
  const Place& place = places_.at(tile);
  bytes.resize(place.bytes);
  return file_.read(place.at, bytes.data(), bytes.size());
}

}  // namespace pcl_slim::detail
