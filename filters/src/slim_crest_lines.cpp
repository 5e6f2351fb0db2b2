// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/slim_crest_lines.hpp"

#include <utility>

#include "pcl_slim/query/cloud_projection.h"
#include "pcl_slim/query/projection.h"

namespace pcl_slim {

namespace {

Error checkSupport(const Projection& projection) {
  const auto points = static_cast<double>(projection.position.size());
  const double supported = points - static_cast<double>(projection.num_unsupported);
  if (supported >= kLeastSharedSupport * points) return {};
  return {
      ErrorCode::kBadArgument,
      "the surface supports less than a tenth of the points: it is of another cloud or faces the "
      "other way; give this cloud's"};
}

}  // namespace

Error traceCloud(const CloudView& cloud, CrestRun& run, CrestLines& lines, Progress* progress) {
  lines = CrestLines();
  if (Error error = run.fit.validate()) return error;
  if (Error error = run.crest.validate()) return error;
  Result<PointStore> store = PointStore::build(cloud, run.fit.threads);
  if (!store) return store.error();
  run.input_statistics = store->statistics();
  const bool given = run.surface != nullptr;
  if (given) {
    if (Error error = run.surface->validate()) return error;
  } else {
    auto made = std::make_shared<SLIMSurface>();
    Error error = fitSurface(*store, run.fit, *made, &run.fit_statistics, progress);
    if (error) return error;
    run.surface = std::move(made);
  }
  ProjectionParams how;
  how.extremality = true;
  how.sharp_features = run.fit.sharp_features;
  how.paper_mode = run.surface->info.paper_mode;
  how.threads = run.fit.threads;
  Projection projection;
  if (Error error = projectPoints(*store, *run.surface, how, projection, progress)) return error;
  if (given) {
    if (Error error = checkSupport(projection)) return error;
  }
  CrestParams crest = run.crest;
  crest.threads = run.fit.threads;
  Error error = traceCrestLines(*store, projection, *run.surface, crest, lines,
                                &run.crest_statistics, progress);
  // Checked after the last progress report: a caller who cancels wants no result.
  if (!error && progress != nullptr && progress->cancelled()) {
    error = {ErrorCode::kCancelled, "the tracing of lines was cancelled"};
  }
  if (error) lines = CrestLines();
  return error;
}

}  // namespace pcl_slim

PCL_SLIM_INSTANTIATE_SLIMCrestLines(pcl::PointXYZ)
    PCL_SLIM_INSTANTIATE_SLIMCrestLines(pcl::PointXYZI)
        PCL_SLIM_INSTANTIATE_SLIMCrestLines(pcl::PointXYZRGB)
            PCL_SLIM_INSTANTIATE_SLIMCrestLines(pcl::PointXYZRGBA)
                PCL_SLIM_INSTANTIATE_SLIMCrestLines(pcl::PointNormal)
                    PCL_SLIM_INSTANTIATE_SLIMCrestLines(pcl::PointXYZINormal)
                        PCL_SLIM_INSTANTIATE_SLIMCrestLines(pcl::PointXYZRGBNormal)
