// SPDX-License-Identifier: BSD-3-Clause
// What the fits of tiles have made: summed, packed as bytes for other ranks, and kept in files for
// a later run.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/surface/surface_io.h"
#include "stream_state.h"

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

void StatisticsSum::add(const FitStatistics& tile, const SLIMSurface& surface) {
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

namespace {

/** A tile's counts as numbers, to be kept with its surfels. */
std::vector<double> packedStatistics(const FitStatistics& tile) {
  std::vector<double> numbers{tile.least_pivot,
                              static_cast<double>(tile.first_level),
                              static_cast<double>(tile.last_level),
                              tile.penalty,
                              tile.t_mdl,
                              static_cast<double>(tile.working_bytes)};
  for (const auto count : kCounts) numbers.push_back(static_cast<double>(tile.*count));
  return numbers;
}

/** The inverse, with leaves_per_level counted on the surfels. */
FitStatistics unpackedStatistics(const std::vector<double>& numbers, const SLIMSurface& surface) {
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

/** A tile's surfels and statistics as bytes, without its times. */
Ranks::Bytes packedTile(const FittedTile& made) {
  Ranks::Bytes bytes;
  for (const double number : packedStatistics(made.statistics)) appendBytes(number, bytes);
  appendBytes(static_cast<double>(made.halo_points), bytes);
  const std::vector<unsigned char> slim = encodeSlim(made.surface);
  bytes.insert(bytes.end(), slim.begin(), slim.end());
  return bytes;
}

}  // namespace

Error unpackTile(const Ranks::Bytes& bytes, FittedTile& made) {
  const std::size_t head = (packedStatistics({}).size() + 1) * sizeof(double);
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

Error FittedTiles::add(std::size_t tile, const FittedTile& made, const std::string& folder) {
  if (places_.empty()) {
    if (Error error = file_.create(folder, 0)) return error;
  }
  const Ranks::Bytes bytes = packedTile(made);
  places_[tile] = {end_, bytes.size()};
  end_ += bytes.size();
  return file_.write(places_[tile].at, bytes.data(), bytes.size());
}

Error FittedTiles::read(std::size_t tile, Ranks::Bytes& bytes) const {
  const Place& place = places_.at(tile);
  bytes.resize(place.bytes);
  return file_.read(place.at, bytes.data(), bytes.size());
}

// Files of one machine, or of alike ones: numbers are stored as in memory, behind a magic word, an
// identity and a checksum.

namespace {

constexpr char kMagic[] = "pcl_slim tiles 6\n";

using Bytes = std::vector<unsigned char>;

std::uint64_t checksum(const Bytes& bytes, std::size_t size) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3u;
  return hash;
}

/** Numbers to bytes, and back: one list of what is kept, for both ways. */
class Writer {
 public:
  template <typename T>
  void operator()(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* from = reinterpret_cast<const unsigned char*>(&value);
    bytes.insert(bytes.end(), from, from + sizeof(T));
  }
  template <typename T>
  void operator()(const std::vector<T>& values) {
    (*this)(std::uint64_t{values.size()});
    for (const T& value : values) (*this)(value);
  }
  Bytes bytes;
};

class Reader {
 public:
  Reader(const Bytes& bytes, std::size_t at, std::size_t end) : bytes_(bytes), at_(at), end_(end) {}

  template <typename T>
  void operator()(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    good = good && end_ - at_ >= sizeof(T);
    if (!good) return;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
  }
  template <typename T>
  void operator()(std::vector<T>& values) {
    std::uint64_t count = 0;
    (*this)(count);
    good = good && count <= (end_ - at_) / sizeof(T);
    if (!good) return;
    values.resize(static_cast<std::size_t>(count));
    for (T& value : values) (*this)(value);
  }
  bool good = true;

 private:
  const Bytes& bytes_;
  std::size_t at_, end_;
};

template <typename Plan, typename Visit>
void visitPlan(Plan& p, Visit& visit) {
  visit(p.frame.origin);
  visit(p.frame.scale);
  visit(p.frame.diagonal);
  visit(p.frame.bulk_diagonal);
  visit(p.frame.center_grid);
  visit(p.frame.bulk_center);
  visit(p.frame.bulk_reach);
  visit(p.frame.bulk_between);
  visit(p.frame.with_normals);
  visit(p.record.scalar);
  visit(p.record.normals);
  visit(p.traits);
  visit(p.noise.lambda);
  visit(p.noise.sides.source);
  visit(p.noise.noise.patches);
  visit(p.noise.noise.error);
  visit(p.noise.noise.correlation);
  visit(p.noise.noise.correlation_error);
  visit(p.noise.noise.line);
  visit(p.noise.noise.step);
  visit(p.noise.noise.neighbors);
  visit(p.noise.noise.varies);
  visit(p.noise.noise.normal_error);
  visit(p.noise.noise.normals_follow_points);
  visit(p.points);
  visit(p.thinning);
  visit(p.plan.cells);
  visit(p.first_levels);
  visit(p.halos);
  visit(p.balls);
  visit(p.checksums);
}

/** Puts the magic word and the identity before what is kept, and a checksum behind it. */
Error saveKept(const std::string& path, const std::string& identity, const Bytes& payload) {
  Writer out;
  out.bytes.assign(kMagic, kMagic + sizeof(kMagic) - 1);
  out(std::vector<char>(identity.begin(), identity.end()));
  out.bytes.insert(out.bytes.end(), payload.begin(), payload.end());
  out(checksum(out.bytes, out.bytes.size()));
  return writeFile(path, out.bytes.data(), out.bytes.size());
}

/** \\return where what is kept begins, 0 for a file that is not whole or of another identity. */
std::size_t openKept(const std::string& path, const std::string& identity, Bytes& bytes) {
  Result<Bytes> read = readFile(path);
  constexpr std::size_t kHead = sizeof(kMagic) - 1;
  if (!read || read->size() < kHead + 2 * sizeof(std::uint64_t)) return 0;
  bytes = std::move(*read);
  const std::size_t end = bytes.size() - sizeof(std::uint64_t);
  std::uint64_t sum = 0;
  std::memcpy(&sum, bytes.data() + end, sizeof(sum));
  if (std::memcmp(bytes.data(), kMagic, kHead) != 0 || checksum(bytes, end) != sum) return 0;
  std::vector<char> own;
  Reader in(bytes, kHead, end);
  in(own);
  if (!in.good || std::string(own.begin(), own.end()) != identity) return 0;
  return kHead + sizeof(std::uint64_t) + own.size();
}

std::string planPath(const std::string& folder) {
  return folder + "/plan";
}

std::string tilePath(const std::string& folder, std::size_t tile) {
  return folder + "/tile-" + std::to_string(tile);
}

}  // namespace

Error savePlan(const std::string& folder, const std::string& identity, const KeptPlan& plan) {
  Writer out;
  visitPlan(plan, out);
  return saveKept(planPath(folder), identity, out.bytes);
}

bool loadPlan(const std::string& folder, const std::string& identity, KeptPlan& plan) {
  Bytes bytes;
  const std::size_t begin = openKept(planPath(folder), identity, bytes);
  if (begin == 0) return false;
  Reader in(bytes, begin, bytes.size() - sizeof(std::uint64_t));
  visitPlan(plan, in);
  return in.good;
}

Error saveTile(const std::string& folder, const std::string& identity, std::size_t tile,
               const FittedTile& made) {
  return saveKept(tilePath(folder, tile), identity, packedTile(made));
}

bool loadTile(const std::string& folder, const std::string& identity, std::size_t tile,
              FittedTile& made) {
  Bytes bytes;
  const std::size_t begin = openKept(tilePath(folder, tile), identity, bytes);
  if (begin == 0) return false;
  const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(begin);
  made.kept = !unpackTile({first, bytes.end() - sizeof(std::uint64_t)}, made);
  return made.kept;
}

}  // namespace pcl_slim::detail
