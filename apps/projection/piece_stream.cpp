// SPDX-License-Identifier: BSD-3-Clause
#include "projection/piece_stream.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/scan/scan.h"

namespace pcl_slim {

namespace {

/** Rows of a piece; results depend on it by rounding alone. */
constexpr std::uint64_t kMostRows = 1 << 19;
constexpr double kBytesOfProjection = 220;  ///< per row of a piece, without the copies of the row
constexpr double kCopiesOfRow = 5;

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

/** Rows of a piece: no more than a tile's points. */
std::size_t PieceStream::rows() const {
  return static_cast<std::size_t>(
      std::min({kMostRows, std::max<std::uint64_t>(1, job_.tiles.points), reader_.size()}));
}

/** Opens the scan's rows for reading. */
Error PieceStream::openRows(Console& console) {
  const std::string& output = job_.files.output;
  if (const std::string form = lowerExtension(output); form != ".pcd" && form != ".ply") {
    return {ErrorCode::kBadArgument, "'" + output + "' cannot be written in pieces, as this " +
                                         "scan is; name a .pcd or .ply file"};
  }
  if (Error error = reader_.open(job_.files.input)) return error;
  open_ = true;
  job_.in_pieces = true;
  job_.projection.planes = false;
  const double row = kBytesOfProjection + kCopiesOfRow * static_cast<double>(reader_.layout().step);
  if (Error error = checkMemory(row * static_cast<double>(rows()),
                                "projecting " + std::to_string(rows()) + " points"))
    return error;
  blocks_.setMostBytes(memoryLeft() - row * static_cast<double>(rows()));
  if (!job_.tiles.asked && !job_.surface.empty())
    console.note("  the scan is large: it is projected in pieces");
  noteWhatIsNotKept(output, reader_.height() > 1, reader_.layout().sensor.has_value(), console);
  return {};
}

Error PieceStream::open(Console& console) {
  if (!job_.surface.empty()) {
    if (isStream(job_.files.input) && !job_.tiles.asked) return {};
    const Result<RecordLayout> layout = recordLayoutOf(job_.files.input, false);
    if (!layout) return job_.tiles.asked ? layout.error() : Error();
    const bool wanted = job_.tiles.asked || isRawPointFile(job_.files.input) ||
                        wantsTiles(layout->count, job_.tiles);
    return wanted && job_.tiles.points > 0 ? openRows(console) : Error();
  }
  if (Error error = openForTiles(job_.files.input, job_.fit, job_.tiles, console, source_))
    return error;
  return source_ ? openRows(console) : Error();
}

/** Reads a surface; of one in blocks only what all blocks have in common. */
Error PieceStream::readWholeOrHead(Console& console, Report& report, SLIMSurface& surface) {
  console.begin("Loading " + job_.surface);
  const bool in_blocks = blocks_.open(job_.surface);
  Result<SLIMSurface> loaded = in_blocks ? blocks_.load(blocks_.none()) : loadSurface(job_.surface);
  if (!loaded) return console.failed(loaded.error());
  surface = std::move(*loaded);
  report.time("surface", console.seconds());
  reportSurface(job_.surface, surface, report);
  console.done(in_blocks ? counted(blocks_.count(), "block")
                         : std::to_string(surface.size()) + " surfels");
  return {};
}

Exit PieceStream::run(MakeFields fields, Console& console, Report& report) {
  TiledSurface made;
  SLIMSurface& surface = made.surface;
  if (!source_) {
    if (Error error = readWholeOrHead(console, report, surface)) return Exit::usage(error);
  }
  if (source_) {
    if (Error error = fitByTiles(*source_, job_.fit, job_.tiles, console, report, nullptr, made))
      return exitOfTiles(error);
  }
  if (Error error = writer_.open(job_.files.output, reader_.width(), reader_.height()))
    return exitOfTiles(error);
  if (Error error = projectRows(fields, surface, console, report)) return exitOfTiles(error);
  return saveOutput(
      job_.files.output, job_.files.json, [&] { return writer_.finish(); },
      std::to_string(reader_.size()) + " points", console, report);
}

Result<CloudProjection> PieceStream::project(const CloudFile& cloud,
                                             const SLIMSurface& surface) const {
  if (cloud.num_non_finite == cloud.size()) return CloudProjection::ofNothing(cloud.size());
  FitParams fit = job_.fit.params;
  if (!fit.viewpoint) fit.viewpoint = reader_.layout().sensor;
  // Whether a given surface supports the scan is decided by all pieces together: projectRows().
  return projectScan(cloud.view(job_.fit.use_normals), surface, SurfaceOrigin::kFitted, fit,
                     job_.projection);
}

void PieceStream::count(const CloudProjectionStatistics& piece) {
  sum_.points += piece.points;
  sum_.moved += piece.moved;
  sum_.unsupported += piece.unsupported;
  sum_.non_finite += piece.non_finite;
  sum_.rms_displacement +=
      piece.rms_displacement * piece.rms_displacement * static_cast<double>(piece.moved);
  sum_.max_displacement = std::max(sum_.max_displacement, piece.max_displacement);
}

/** Some points on the surface. */
Result<PointFile> PieceStream::brought(MakeFields fields, const CloudFile& cloud,
                                       const SLIMSurface& surface) {
  const Result<CloudProjection> projection = project(cloud, surface);
  if (!projection) return projection.error();
  count(projection->statistics());
  return fields(cloud.file, *projection, job_);
}

/** A piece on the surface, of which blocks are read as its points need them. */
Result<PointFile> PieceStream::brought(MakeFields fields, PointFile piece,
                                       const SLIMSurface& surface) {
  const Result<CloudFile> cloud = asCloudFile(std::move(piece), job_.files.input);
  if (!cloud) return cloud.error();
  if (!blocks_.isOpen()) return brought(fields, *cloud, surface);
  PointFile all;
  for (const BlockSurface::Part& part : blocks_.partsOf(cloud->view())) {
    const Result<SLIMSurface> near = blocks_.load(part);
    if (!near) return near.error();
    if (part.rows.empty()) return brought(fields, *cloud, *near);
    const Result<CloudFile> some = asCloudFile(rowsOf(cloud->file, part.rows), job_.files.input);
    if (!some) return some.error();
    const Result<PointFile> made = brought(fields, *some, *near);
    if (!made) return made.error();
    putRows(*made, part.rows, cloud->size(), all);
  }
  return all;
}

Error PieceStream::projectRows(MakeFields fields, const SLIMSurface& surface, Console& console,
                               Report& report) {
  console.begin("Projecting");
  for (std::uint64_t done = 0; done < reader_.size();) {
    if (console.interrupted()) return console.failed(stopped());
    console.progress().report(
        static_cast<float>(static_cast<double>(done) / static_cast<double>(reader_.size())),
        "projecting");
    PointFile piece;
    if (Error error = reader_.next(rows(), piece)) return console.failed(error);
    done += numPoints(piece.cloud);
    const Result<PointFile> made = brought(fields, std::move(piece), surface);
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
  printProjection(sum_, console);
  if (blocks_.isOpen()) blocks_.reportBlocks(console, report);
  return {};
}

}  // namespace pcl_slim
