// SPDX-License-Identifier: BSD-3-Clause
#include "ranks/fitted_tiles.h"

#include <utility>
#include <vector>

#include "pcl_slim/surface/surface_io.h"
#include "ranks/rank_messages.h"
#include "ranks/statistics_sum.h"

namespace pcl_slim::detail {

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
