// SPDX-License-Identifier: BSD-3-Clause
#include "projection/piece_job.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/memory_limit.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace {

constexpr std::uint64_t kMostRows = 1
                                    << 19;  ///< of a piece; results depend on it by rounding alone
constexpr double kBytesOfProjection = 220;  ///< a row of a piece, beside copies of the row itself
constexpr double kCopiesOfRow = 5;

CloudProjectionParams
projectionParams(const ProjectionJob& job, const SLIMSurface& surface, const RecordLayout& layout)
{
  CloudProjectionParams params;
  params.projection = job.projection;
  params.projection.threads = job.fit.params.threads;
  params.projection.sharp_features = job.fit.params.sharp_features;
  params.projection.paper_mode = surface.info.paper_mode;
  params.has_viewpoint = job.fit.params.has_viewpoint || layout.sensor.has_value();
  for (std::size_t a = 0; a < 3; ++a) {
    params.viewpoint[a] = job.fit.params.has_viewpoint || !layout.sensor
                              ? job.fit.params.viewpoint[a]
                              : (*layout.sensor)[a];
  }
  return params;
}

}  // namespace

/** Rows of a piece: no more than a tile's points. */
std::size_t
PieceJob::rows() const
{
  return static_cast<std::size_t>(
      std::min({kMostRows, std::max<std::uint64_t>(1, tiles_.points), reader_.size()}));
}

/** Opens the scan's rows for reading. */
Result<bool>
PieceJob::openRows(Console& console)
{
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
  if (!tiles_.asked && !job_.surface.empty())
    console.note("  the scan is large: it is projected in pieces");
  noteWhatIsNotKept(output, reader_.height() > 1, reader_.layout().sensor.has_value(), console);
  return true;
}

Result<bool>
PieceJob::open(Console& console)
{
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

Error
PieceJob::run(SLIMSurface& surface, Console& console, Report& report, ScanResult& result)
{
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

Result<CloudProjection>
PieceJob::project(const CloudFile& cloud, const SLIMSurface& surface) const
{
  if (cloud.num_non_finite == cloud.size()) return CloudProjection::ofNothing(cloud.size());
  return CloudProjection::make(cloud.view(job_.fit.use_normals), surface,
                               projectionParams(job_, surface, reader_.layout()));
}

void
PieceJob::count(const CloudProjectionStatistics& piece)
{
  sum_.points += piece.points;
  sum_.moved += piece.moved;
  sum_.unsupported += piece.unsupported;
  sum_.non_finite += piece.non_finite;
  sum_.rms_displacement +=
      piece.rms_displacement * piece.rms_displacement * static_cast<double>(piece.moved);
  sum_.max_displacement = std::max(sum_.max_displacement, piece.max_displacement);
}

Error
PieceJob::projectRows(const SLIMSurface& surface, Console& console, Report& report)
{
  const Stopwatch watch;
  console.begin("Projecting");
  const auto failed = [&console](Error error) {
    console.failed();
    return error;
  };
  for (std::uint64_t done = 0; done < reader_.size();) {
    if (console.interrupted())
      return failed({ErrorCode::kCancelled, "stopped; nothing is written"});
    console.progress().report(
        static_cast<float>(static_cast<double>(done) / static_cast<double>(reader_.size())),
        "projecting");
    PointFile piece;
    if (Error error = reader_.next(rows(), piece)) return failed(error);
    Result<CloudFile> cloud = asCloudFile(std::move(piece), job_.files.input);
    if (!cloud) return failed(cloud.error());
    done += cloud->size();
    const Result<CloudProjection> projection = project(*cloud, surface);
    if (!projection) return failed(projection.error());
    count(projection->statistics());
    const PointFile made = make_output_(cloud->file, *projection, chosen_, job_.fit.params.threads);
    if (Error error = writer_.add(made)) return failed(error);
  }
  const auto moved = static_cast<double>(std::max<std::uint64_t>(sum_.moved, 1));
  sum_.rms_displacement = std::sqrt(sum_.rms_displacement / moved);
  if (sum_.points == sum_.non_finite) return failed(CloudView::nothingFinite());
  const auto finite = static_cast<double>(sum_.moved + sum_.unsupported);
  if (!job_.surface.empty() && static_cast<double>(sum_.moved) < kLeastSharedSupport * finite) {
    return failed(badInput("the surface supports " + std::to_string(sum_.moved) + " of " +
                           std::to_string(sum_.moved + sum_.unsupported) +
                           " points: it is of another cloud or faces the other way; give this "
                           "cloud's"));
  }
  report.time("project", watch.seconds());
  reportProjection(sum_, report);
  console.done(watch.seconds(), std::to_string(sum_.moved) + " points");
  return {};
}

}  // namespace pcl_slim
