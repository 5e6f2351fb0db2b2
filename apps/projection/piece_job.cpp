// SPDX-License-Identifier: BSD-3-Clause
#include "projection/projection_job.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace {

constexpr double kCopies = 2;  ///< of a block: the one that is kept, and its part of the surface
constexpr std::size_t kRun = 1024;  ///< points along the curve that are looked at together

constexpr std::uint64_t kMostRows = 1
                                    << 19;  ///< of a piece; results depend on it by rounding alone
constexpr double kBytesOfProjection = 220;  ///< per row of a piece, without the copies of the row
constexpr double kCopiesOfRow = 5;

CloudProjectionParams projectionParams(const ProjectionJob& job, const SLIMSurface& surface,
                                       const RecordLayout& layout) {
  CloudProjectionParams params;
  params.projection = job.projection;
  params.projection.threads = job.fit.params.threads;
  params.projection.sharp_features = job.fit.params.sharp_features;
  params.projection.paper_mode = surface.info.paper_mode;
  params.viewpoint = job.fit.params.viewpoint ? job.fit.params.viewpoint : layout.sensor;
  return params;
}

/** Some rows of a file. */
PointFile rowsOf(const PointFile& file, const std::vector<std::int32_t>& rows) {
  PointFile some = file;
  const std::size_t step = file.cloud.point_step;
  some.cloud.data.clear();
  for (const std::int32_t row : rows) {
    const auto from =
        file.cloud.data.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(row) * step);
    some.cloud.data.insert(some.cloud.data.end(), from, from + static_cast<std::ptrdiff_t>(step));
  }
  some.cloud.width = static_cast<std::uint32_t>(rows.size());
  some.cloud.height = 1;
  return some;
}

/** Moves rows to their places among all rows of the cloud. */
void putRows(const PointFile& some, const std::vector<std::int32_t>& rows, std::size_t count,
             PointFile& all) {
  const std::size_t step = some.cloud.point_step;
  if (all.cloud.data.empty()) {
    all = some;
    all.cloud.data.assign(count * step, 0);
    all.cloud.width = static_cast<std::uint32_t>(count);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto from = some.cloud.data.begin() + static_cast<std::ptrdiff_t>(i * step);
    std::copy_n(from, step,
                all.cloud.data.begin() +
                    static_cast<std::ptrdiff_t>(static_cast<std::size_t>(rows[i]) * step));
  }
}

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
  report.json()["surface_blocks"] = {{"count", all}, {"read", read}};
  console.note("  " + std::to_string(read) + " of " + std::to_string(all) +
               " blocks of the surface were read");
}

/** Rows of a piece: no more than a tile's points. */
std::size_t PieceJob::rows() const {
  return static_cast<std::size_t>(
      std::min({kMostRows, std::max<std::uint64_t>(1, tiles_.points), reader_.size()}));
}

/** Opens the scan's rows for reading. */
Result<bool> PieceJob::openRows(Console& console) {
  const std::string& output = job_.files.output;
  if (const std::string form = lowerExtension(output); form != ".pcd" && form != ".ply") {
    return Error{ErrorCode::kBadArgument, "'" + output + "' cannot be written in pieces, as this " +
                                              "scan is; name a .pcd or .ply file"};
  }
  if (Error error = reader_.open(job_.files.input)) return error;
  const double row = kBytesOfProjection + kCopiesOfRow * static_cast<double>(reader_.layout().step);
  if (Error error = checkMemory(row * static_cast<double>(rows()),
                                "projecting " + std::to_string(rows()) + " points"))
    return error;
  blocks_.setMostBytes(memoryLeft() - row * static_cast<double>(rows()));
  if (!tiles_.asked && !job_.surface.empty())
    console.note("  the scan is large: it is projected in pieces");
  noteWhatIsNotKept(output, reader_.height() > 1, reader_.layout().sensor.has_value(), console);
  return true;
}

Result<bool> PieceJob::open(Console& console) {
  tiles_.max_memory = job_.files.max_memory;
  if (job_.mesh) {
    if (!tiles_.asked) return false;
    return Error{ErrorCode::kBadArgument, "-mesh is not possible by tiles: give -tile_points 0"};
  }
  if (!job_.surface.empty()) {
    const Result<RecordLayout> layout = recordLayoutOf(job_.files.input, false);
    if (!layout) return tiles_.asked ? Result<bool>(layout.error()) : Result<bool>(false);
    const bool wanted =
        tiles_.asked || isRawPointFile(job_.files.input) || wantsTiles(layout->count, tiles_);
    return wanted && tiles_.points > 0 ? openRows(console) : Result<bool>(false);
  }
  if (Error error = openForTiles(job_.files.input, job_.fit, tiles_, console, source_))
    return error;
  return source_ ? openRows(console) : Result<bool>(false);
}

Error PieceJob::run(SLIMSurface& surface, Console& console, Report& report, ScanResult& result) {
  if (source_) {
    if (Error error = fitByTiles(*source_, job_.fit, tiles_, console, report, surface))
      return error;
    if (console.interrupted()) return {ErrorCode::kCancelled, "stopped; nothing is written"};
  }
  if (Error error = writer_.open(job_.files.output, reader_.width(), reader_.height()))
    return error;
  if (Error error = projectRows(surface, console, report)) return error;
  result.save = [this] { return writer_.finish(); };
  result.detail = std::to_string(reader_.size()) + " points";
  return {};
}

Result<CloudProjection> PieceJob::project(const CloudFile& cloud,
                                          const SLIMSurface& surface) const {
  if (cloud.num_non_finite == cloud.size()) return CloudProjection::ofNothing(cloud.size());
  return CloudProjection::make(cloud.view(job_.fit.use_normals), surface,
                               projectionParams(job_, surface, reader_.layout()));
}

void PieceJob::count(const CloudProjectionStatistics& piece) {
  sum_.points += piece.points;
  sum_.moved += piece.moved;
  sum_.unsupported += piece.unsupported;
  sum_.non_finite += piece.non_finite;
  sum_.rms_displacement +=
      piece.rms_displacement * piece.rms_displacement * static_cast<double>(piece.moved);
  sum_.max_displacement = std::max(sum_.max_displacement, piece.max_displacement);
}

/** Some points on the surface. */
Result<PointFile> PieceJob::brought(const CloudFile& cloud, const SLIMSurface& surface) {
  const Result<CloudProjection> projection = project(cloud, surface);
  if (!projection) return projection.error();
  count(projection->statistics());
  return make_output_(cloud.file, *projection, chosen_, job_.fit.params.threads);
}

/** A piece on the surface, of which blocks are read as its points need them. */
Result<PointFile> PieceJob::brought(PointFile piece, const SLIMSurface& surface) {
  const Result<CloudFile> cloud = asCloudFile(std::move(piece), job_.files.input);
  if (!cloud) return cloud.error();
  if (!blocks_.isOpen()) return brought(*cloud, surface);
  PointFile all;
  for (const BlockSurface::Part& part : blocks_.partsOf(cloud->view())) {
    const Result<SLIMSurface> near = blocks_.load(part);
    if (!near) return near.error();
    if (part.rows.empty()) return brought(*cloud, *near);
    const Result<CloudFile> some = asCloudFile(rowsOf(cloud->file, part.rows), job_.files.input);
    if (!some) return some.error();
    const Result<PointFile> made = brought(*some, *near);
    if (!made) return made.error();
    putRows(*made, part.rows, cloud->size(), all);
  }
  return all;
}

Error PieceJob::projectRows(const SLIMSurface& surface, Console& console, Report& report) {
  console.begin("Projecting");
  for (std::uint64_t done = 0; done < reader_.size();) {
    if (console.interrupted())
      return console.failed({ErrorCode::kCancelled, "stopped; nothing is written"});
    console.progress().report(
        static_cast<float>(static_cast<double>(done) / static_cast<double>(reader_.size())),
        "projecting");
    PointFile piece;
    if (Error error = reader_.next(rows(), piece)) return console.failed(error);
    done += numPoints(piece.cloud);
    const Result<PointFile> made = brought(std::move(piece), surface);
    if (!made) return console.failed(made.error());
    if (Error error = writer_.add(*made)) return console.failed(error);
  }
  const auto moved = static_cast<double>(std::max<std::uint64_t>(sum_.moved, 1));
  sum_.rms_displacement = std::sqrt(sum_.rms_displacement / moved);
  if (sum_.points == sum_.non_finite) return console.failed(CloudView::nothingFinite());
  const auto finite = static_cast<double>(sum_.moved + sum_.unsupported);
  if (!job_.surface.empty() && static_cast<double>(sum_.moved) < kLeastSharedSupport * finite) {
    return console.failed(
        badInput("the surface supports " + std::to_string(sum_.moved) + " of " +
                 std::to_string(sum_.moved + sum_.unsupported) +
                 " points: it is of another cloud or faces the other way; give this "
                 "cloud's"));
  }
  report.time("project", console.seconds());
  reportProjection(sum_, report);
  console.done(std::to_string(sum_.moved) + " points");
  if (blocks_.isOpen()) blocks_.reportBlocks(console, report);
  return {};
}

}  // namespace pcl_slim
