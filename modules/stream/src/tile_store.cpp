// SPDX-License-Identifier: BSD-3-Clause
// The points of tiles on disk, and what brings them into memory.
#include "tile_store.h"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/core/random.h"

namespace pcl_slim::detail {

namespace {

constexpr const char* kKeptName = "points";

constexpr std::uint64_t kBucketsOfTile = 16;
constexpr std::size_t kBufferBytes = 16 << 20;  ///< of all buffers together ...
constexpr std::size_t kMostBuffer = 96 << 10;   ///< ... of one ...
constexpr std::size_t kLeastBuffer = 4 << 10;   ///< ... and at least

Error changed() {
  return badInput(
      "the cloud's points changed while they were read: leave the file alone, and start again");
}

/** A checksum with more bytes after those it is of (FNV-1a, by words of 32 bits: records are whole
 * words). */
std::uint64_t checksumWith(std::uint64_t checksum, const unsigned char* bytes, std::size_t size) {
  for (std::size_t i = 0; i + 4 <= size; i += 4) {
    std::uint32_t word;
    std::memcpy(&word, bytes + i, sizeof(word));
    checksum = (checksum ^ word) * 0x100000001b3u;
  }
  return checksum;
}

}  // namespace

namespace fs = std::filesystem;

ScratchFile::~ScratchFile() {
  if (file_ >= 0) close(file_);
}

Error ScratchFile::failed(const char* verb, std::uint64_t at, int code) const {
  const bool full = code == ENOSPC || code == EDQUOT || code == EFBIG;
  return {ErrorCode::kIo, std::string("cannot ") + verb + " the " + kind_ + " file in '" + folder_ +
                              "' at byte " + std::to_string(at) + ": " + std::strerror(code) +
                              (full ? "; make room, or name another folder" : "")};
}

/** Checks that the folder exists and has room. */
Error ScratchFile::checkRoom(std::uint64_t bytes) {
  std::error_code code;
  if (!fs::is_directory(folder_, code)) {
    return {ErrorCode::kIo,
            "the " + kind_ + " folder '" + folder_ + "' does not exist; create it first"};
  }
  struct statvfs space = {};
  if (statvfs(folder_.c_str(), &space) != 0) return {};
  const double free = static_cast<double>(space.f_bavail) * static_cast<double>(space.f_frsize);
  if (static_cast<double>(bytes) <= free) return {};
  return {ErrorCode::kIo, "the " + kind_ + " folder '" + folder_ + "' has " +
                              std::to_string(static_cast<std::uint64_t>(free) >> 20) +
                              " MB left where " + std::to_string((bytes >> 20) + 1) +
                              " are needed: make room, or name another folder"};
}

Error ScratchFile::create(const std::string& folder, std::uint64_t bytes) {
  std::error_code code;
  folder_ = folder.empty() ? fs::temp_directory_path(code).string() : folder;
  if (Error error = checkRoom(bytes)) return error;
  std::string name = (fs::path(folder_) / "pcl_slim-XXXXXX").string();
  file_ = mkostemp(name.data(), O_CLOEXEC);
  if (file_ < 0) return failed("create", 0, errno);
  unlink(name.c_str());
  return {};
}

Error ScratchFile::createKept(const std::string& folder, std::uint64_t bytes) {
  if (file_ >= 0) close(file_);
  file_ = -1;
  kind_ = "plan";
  folder_ = folder;
  const std::string name = (fs::path(folder_) / kKeptName).string();
  unlink(name.c_str());
  if (Error error = checkRoom(bytes)) return error;
  file_ = open(name.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  return file_ < 0 ? failed("create", 0, errno) : Error();
}

Error ScratchFile::openKept(const std::string& folder, std::uint64_t bytes) {
  kind_ = "plan";
  folder_ = folder;
  const std::string name = (fs::path(folder_) / kKeptName).string();
  std::error_code code;
  file_ = open(name.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0) return failed("read", 0, errno);
  const std::uint64_t size = fs::file_size(name, code);
  return size == bytes ? Error() : failed("read", size, EIO);
}

Error ScratchFile::write(std::uint64_t at, const void* from, std::size_t bytes) {
  for (std::size_t done = 0; done < bytes;) {
    const ssize_t now = pwrite(file_, static_cast<const char*>(from) + done, bytes - done,
                               static_cast<off_t>(at + done));
    if (now < 0 && errno == EINTR) continue;
    if (now < 0) return failed("write", at + done, errno);
    done += static_cast<std::size_t>(now);
  }
  written_ += bytes;
  return {};
}

Error ScratchFile::read(std::uint64_t at, void* to, std::size_t bytes) const {
  for (std::size_t done = 0; done < bytes;) {
    const ssize_t now =
        pread(file_, static_cast<char*>(to) + done, bytes - done, static_cast<off_t>(at + done));
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) return failed("read", at + done, now < 0 ? errno : EIO);
    done += static_cast<std::size_t>(now);
  }
  read_ += bytes;
  return {};
}

void PointRecord::write(const CloudView& piece, std::size_t i, unsigned char* to) const {
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

CloudView PointRecord::view(const std::vector<unsigned char>& records) const {
  CloudView view;
  view.size = records.size() / bytes();
  view.xyz = records.data();
  view.xyz_stride = view.normal_stride = bytes();
  view.scalar = scalar;
  view.normal = normals ? records.data() + positionBytes() : nullptr;
  return view;
}

std::vector<std::uint32_t> pointsOfCells(const TilePlan& plan) {
  std::vector<std::uint32_t> points;
  for (const TilePlan::Cell& cell : plan.cells) points.push_back(cell.points);
  return points;
}

void TileStore::cut(const TilePlan& plan, const std::vector<std::uint32_t>& points) {
  buckets_.clear();
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

Error TileStore::create(const TilePlan& plan, const std::vector<std::uint32_t>& points,
                        const PointRecord& record, const std::string& folder, bool kept) {
  record_ = record;
  kept_ = kept;
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

Error TileStore::open(const TilePlan& plan, const PointRecord& record, const std::string& folder,
                      const std::vector<std::uint64_t>& checksums) {
  record_ = record;
  cut(plan, pointsOfCells(plan));
  if (Error error = file_.openKept(folder, plan.points * record_.bytes())) return error;
  const Error damaged = badInput("the points kept in '" + folder + "' are damaged");
  if (checksums.size() != buckets_.size()) return damaged;
  std::vector<unsigned char> records;
  for (std::size_t b = 0; b < buckets_.size(); ++b) {
    records.clear();
    if (Error error = read(buckets_[b], records)) return error;
    if (checksumWith(0, records.data(), records.size()) != checksums[b]) return damaged;
  }
  return {};
}

std::vector<std::uint64_t> TileStore::checksums() const {
  std::vector<std::uint64_t> checksums;
  for (const Bucket& bucket : buckets_) checksums.push_back(bucket.checksum);
  return checksums;
}

Error TileStore::add(const CloudView& piece, const std::uint64_t* keys, const CellCounts& cells) {
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

Error TileStore::flush(std::size_t b) {
  Bucket& bucket = buckets_[b];
  const std::size_t step = record_.bytes();
  if (bucket.written + filled_[b] > bucket.points) return changed();
  const std::uint64_t at = (bucket.first_point + bucket.written) * step;
  bucket.written += filled_[b];
  const std::size_t bytes = filled_[b] * step;
  filled_[b] = 0;
  const unsigned char* records = buffers_.data() + b * buffer_points_ * step;
  if (kept_) bucket.checksum = checksumWith(bucket.checksum, records, bytes);
  return file_.write(at, records, bytes);
}

Error TileStore::finish() {
  for (std::size_t b = 0; b < buckets_.size(); ++b) {
    if (Error error = flush(b)) return error;
    if (buckets_[b].written != buckets_[b].points) return changed();
  }
  std::vector<unsigned char>().swap(buffers_);
  std::vector<std::uint32_t>().swap(bucket_of_);
  return {};
}

Error TileStore::read(const Bucket& bucket, std::vector<unsigned char>& records) const {
  const std::size_t before = records.size(), step = record_.bytes();
  records.resize(before + bucket.points * step);
  return file_.read(bucket.first_point * step, records.data() + before, bucket.points * step);
}

namespace {

constexpr double kCellsOfReach = 6.0;
constexpr double kMostCells = 1 << 26;  ///< of a mask: coarser cells where a tile is scattered

/** Marks the neighbours of a column's marked cells. */
void widen(std::vector<std::uint64_t>& column) {
  std::uint64_t carried = 0;  // the last bit of the word before
  for (std::size_t w = 0; w < column.size(); ++w) {
    const std::uint64_t own = column[w];
    const std::uint64_t next = w + 1 < column.size() ? column[w + 1] << 63 : 0;
    column[w] = own | own << 1 | own >> 1 | carried | next;
    carried = own >> 63;
  }
}

std::array<int, 3> placeOf(std::uint64_t code) {
  const auto at = [code](int axis) { return static_cast<int>(gatherBits(code >> axis)); };
  return {at(2), at(1), at(0)};
}

}  // namespace

HaloMask::HaloMask(const TilePlan& plan, const TilePlan::Tile& tile,
                   const AlignedVector<std::uint64_t>& keys, double reach) {
  depth_ = std::clamp(static_cast<int>(std::ceil(std::log2(kCellsOfReach / reach))), 1,
                      kDeepestCell - 1);
  while (!fitBox(plan, tile, reach) && depth_ > 1) --depth_;
  markCore(keys);
  grow(std::ldexp(reach, depth_));
}

/** Sets the box of the mask. \return whether it is of a size to work with. */
bool HaloMask::fitBox(const TilePlan& plan, const TilePlan::Tile& tile, double reach) {
  constexpr int kMost = 1 << kDeepestCell;
  Place low{kMost, kMost, kMost}, high{};
  for (std::size_t c = tile.first_cell; c < tile.end_cell; ++c) {
    const TilePlan::Cell& cell = plan.cells[c];
    const Place p = placeOf(cellOf(cell.first_key, depth_));
    const int wide = std::max(0, depth_ - static_cast<int>(cell.depth));
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a] + (1 << wide) - 1);
    }
  }
  const int margin = static_cast<int>(std::ceil(std::ldexp(reach, depth_))) + 1;
  double cells = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    low_[a] = low[a] - margin;
    size_[a] = high[a] - low[a] + 1 + 2 * margin;
    cells *= size_[a];
  }
  return cells <= kMostCells;
}

void HaloMask::markCore(const AlignedVector<std::uint64_t>& keys) {
  words_ = (static_cast<std::size_t>(size_[2]) + 63) / 64;
  columns_.assign(columnOf(low_[0] + size_[0], low_[1]), 0);
  std::uint64_t last = PointKeys::kLeftOut;
  for (const std::uint64_t key : keys) {
    const std::uint64_t cell = cellOf(key, depth_);
    if (cell != last) {
      const Place p = placeOf(cell);
      const auto z = static_cast<std::size_t>(p[2] - low_[2]);
      columns_[columnOf(p[0], p[1]) + z / 64] |= std::uint64_t{1} << z % 64;
    }
    last = cell;
  }
}

/** The first word of a column. */
std::size_t HaloMask::columnOf(int x, int y) const {
  return (static_cast<std::size_t>(x - low_[0]) * static_cast<std::size_t>(size_[1]) +
          static_cast<std::size_t>(y - low_[1])) *
         words_;
}

bool HaloMask::isMarked(const Place& p) const {
  const auto z = static_cast<std::size_t>(p[2] - low_[2]);
  return (columns_[columnOf(p[0], p[1]) + z / 64] >> z % 64 & 1) != 0;
}

bool HaloMask::inside(const Place& p) const {
  return std::equal(p.begin(), p.end(), low_.begin(), [](int at, int low) { return at >= low; }) &&
         p[0] < low_[0] + size_[0] && p[1] < low_[1] + size_[1] && p[2] < low_[2] + size_[2];
}

/** Marks all cells whose boxes are within a number of cells' widths of a marked one's: every column
 * with a mark, widened along z by what the ball is wide beside it, is added to those around it. */
void HaloMask::grow(double cells) {
  const int most = static_cast<int>(std::ceil(cells)) + 1;
  const auto gap = [](int d) { return std::max(0, std::abs(d) - 1); };
  std::vector<std::vector<std::ptrdiff_t>> beside(static_cast<std::size_t>(most) + 1);
  for (int dx = -most; dx <= most; ++dx) {
    for (int dy = -most; dy <= most; ++dy) {
      const double left = cells * cells - gap(dx) * gap(dx) - gap(dy) * gap(dy);
      if (left < 0) continue;
      const int half = std::min(static_cast<int>(std::sqrt(left)) + 1, most);
      beside[static_cast<std::size_t>(half)].push_back((std::ptrdiff_t{dx} * size_[1] + dy) *
                                                       static_cast<std::ptrdiff_t>(words_));
    }
  }
  const std::vector<std::uint64_t> core = columns_;
  std::vector<std::uint64_t> wide(words_);
  for (std::size_t column = 0; column < core.size(); column += words_) {
    const auto first = core.begin() + static_cast<std::ptrdiff_t>(column);
    const auto end = first + static_cast<std::ptrdiff_t>(words_);
    if (std::all_of(first, end, [](std::uint64_t word) { return word == 0; })) continue;
    std::copy(first, end, wide.begin());
    for (std::size_t half = 0; half < beside.size(); ++half) {
      if (half > 0) widen(wide);
      for (const std::ptrdiff_t offset : beside[half]) {
        std::uint64_t* to = columns_.data() + static_cast<std::ptrdiff_t>(column) + offset;
        for (std::size_t w = 0; w < words_; ++w) to[w] |= wide[w];
      }
    }
  }
}

bool HaloMask::hasCell(std::uint64_t code) const {
  const Place p = placeOf(code);
  return inside(p) && isMarked(p);
}

bool HaloMask::meets(const TilePlan::Cell& cell) const {
  const int depth = static_cast<int>(cell.depth);
  if (depth >= depth_) return holds(cell.first_key);
  const Place first = placeOf(cellOf(cell.first_key, depth_));
  const int width = 1 << (depth_ - depth);
  Place low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::max(first[a], low_[a]);
    high[a] = std::min(first[a] + width, low_[a] + size_[a]);
  }
  for (int x = low[0]; x < high[0]; ++x) {
    for (int y = low[1]; y < high[1]; ++y) {
      for (int z = low[2]; z < high[2]; ++z) {
        if (isMarked({x, y, z})) return true;
      }
    }
  }
  return false;
}

Error TileLoader::loadCore(std::size_t tile, std::vector<unsigned char>& records) const {
  records.clear();
  for (const Bucket& bucket : store_.buckets()) {
    if (bucket.tile != tile) continue;
    if (Error error = store_.read(bucket, records)) return error;
  }
  return {};
}

HaloMask TileLoader::maskOf(std::size_t tile, const std::vector<unsigned char>& records,
                            double reach) const {
  const CloudView view = record().view(records);
  PointKeys keys(frame_, threads_);
  AlignedVector<std::uint64_t> codes = keys.of(view);
  codes.resize(view.count());
  return {plan_, plan_.tiles[tile], codes, reach};
}

std::vector<std::uint64_t> TileLoader::haloCells(std::size_t tile, const HaloMask& mask) const {
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
Error TileLoader::loadSome(const TileStore& store, const Bucket& bucket, const Wanted& wanted,
                           std::vector<unsigned char>& records) const {
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

Error TileLoader::loadHalo(std::size_t tile, const HaloMask& mask,
                           std::vector<unsigned char>& records) const {
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

Error TileLoader::loadCells(std::size_t first, std::size_t end, std::uint64_t thinning,
                            std::vector<unsigned char>& records) const {
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
