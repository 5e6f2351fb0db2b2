// SPDX-License-Identifier: BSD-3-Clause
#include "scratch/tile_store.h"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "pcl_slim/cloud/detail/cloud_reader.h"

namespace pcl_slim::detail {

namespace {

constexpr const char* kKeptName = "points";

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

namespace fs = std::filesystem;

ScratchFile::~ScratchFile()
{
  if (file_ >= 0) close(file_);
}

Error
ScratchFile::failed(const char* verb, std::uint64_t at, int code) const
{
  const bool full = code == ENOSPC || code == EDQUOT || code == EFBIG;
  return {ErrorCode::kIo, std::string("cannot ") + verb + " the scratch file in '" + folder_ +
                              "' at byte " + std::to_string(at) + ": " + std::strerror(code) +
                              (full ? "; make room, or name another folder" : "")};
}

/** Checks that the folder exists and has room. */
Error
ScratchFile::checkRoom(std::uint64_t bytes)
{
  std::error_code code;
  if (!fs::is_directory(folder_, code)) {
    return {ErrorCode::kIo, "the scratch folder '" + folder_ + "' does not exist; create it first"};
  }
  struct statvfs space = {};
  if (statvfs(folder_.c_str(), &space) != 0) return {};
  const double free = static_cast<double>(space.f_bavail) * static_cast<double>(space.f_frsize);
  if (static_cast<double>(bytes) <= free) return {};
  return {ErrorCode::kIo, "the scratch folder '" + folder_ + "' has " +
                              std::to_string(static_cast<std::uint64_t>(free) >> 20) +
                              " MB left where " + std::to_string((bytes >> 20) + 1) +
                              " are needed: make room, or name another folder"};
}

Error
ScratchFile::create(const std::string& folder, std::uint64_t bytes)
{
  std::error_code code;
  folder_ = folder.empty() ? fs::temp_directory_path(code).string() : folder;
  if (Error error = checkRoom(bytes)) return error;
  std::string name = (fs::path(folder_) / "pcl_slim-XXXXXX").string();
  file_ = mkostemp(name.data(), O_CLOEXEC);
  if (file_ < 0) return failed("create", 0, errno);
  unlink(name.c_str());
  return {};
}

Error
ScratchFile::createKept(const std::string& folder, std::uint64_t bytes)
{
  folder_ = folder;
  const std::string name = (fs::path(folder_) / kKeptName).string();
  unlink(name.c_str());
  if (Error error = checkRoom(bytes)) return error;
  file_ = open(name.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  return file_ < 0 ? failed("create", 0, errno) : Error();
}

Error
ScratchFile::openKept(const std::string& folder, std::uint64_t bytes)
{
  folder_ = folder;
  const std::string name = (fs::path(folder_) / kKeptName).string();
  std::error_code code;
  file_ = open(name.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0) return failed("read", 0, errno);
  const std::uint64_t size = fs::file_size(name, code);
  return size == bytes ? Error() : failed("read", size, EIO);
}

Error
ScratchFile::write(std::uint64_t at, const void* from, std::size_t bytes)
{
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

Error
ScratchFile::read(std::uint64_t at, void* to, std::size_t bytes) const
{
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
