// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_work.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include <pcl_slim/filters/table/scan_work.h>

namespace pcl_slim_ros {

using pcl_slim::Error;
using pcl_slim::ErrorCode;
using pcl_slim::PointTable;
using pcl_slim::Progress;
using pcl_slim::Result;
using pcl_slim::ScanTable;

namespace {

constexpr const char* kSensorAtOrigin =
    "the sensor is at the origin of the messages' frame, and normals without a known side face it";

/** The points as modules work on them, with what is known of the sensor. */
Result<ScanTable> scanOf(PointTable points, bool sensor_at_origin) {
  Result<ScanTable> scan = ScanTable::from(std::move(points));
  if (scan && sensor_at_origin) scan->sensor = {0, 0, 0};
  return scan;
}

/** Fits a surface, moves the points onto it or not, and adds normals and curvatures. */
class SurfaceWork : public CloudWork {
 public:
  explicit SurfaceWork(bool move) : move_(move) {}

  NodeParameters parameters() override {
    NodeParameters all = fitNodeParameters(params_.fit);
    all.push_back(
        switchParameter("use_normals", "use the points' own normals", &params_.use_normals));
    all.push_back(switchParameter("sensor_at_origin", kSensorAtOrigin, &sensor_at_origin_));
    all.push_back(switchParameter(
        "keep_noise",
        "the noise of a message is that of the one before while its residuals agree with it",
        &keep_noise_));
    if (move_)
      all.push_back(switchParameter(
          "normals", "add normal_x normal_y normal_z of the surface, and PCL's curvature",
          &params_.normals));
    all.push_back(switchParameter("curvatures",
                                  "add k1 k2 mean_curvature gaussian_curvature of the surface",
                                  &params_.curvatures));
    return all;
  }

  Error validate() const override { return params_.fit.validate(); }

  Result<CloudOutput> process(PointTable points, Progress* progress) const override {
    const Result<ScanTable> scan = scanOf(std::move(points), sensor_at_origin_);
    if (!scan) return scan.error();
    const pcl_slim::ScanWorkParams params = withNoise(scan->points);
    auto done = move_ ? pcl_slim::smoothScan(*scan, params, progress)
                      : pcl_slim::normalsOfScan(*scan, params, progress);
    if (!done) return done.error();
    keepNoise(done->fit.noise.sensor_noise, scan->points);
    return CloudOutput{std::move(done->points), done->is_dense, std::move(done->warning)};
  }

 private:
  /** The parameters, with the noise of the sensor if an earlier message of this size showed it. */
  pcl_slim::ScanWorkParams withNoise(const PointTable& points) const {
    pcl_slim::ScanWorkParams params = params_;
    const pcl_slim::FitParams& fit = params.fit;
    const bool given = fit.noise || fit.lambda || fit.noise_model || fit.noise_correlation ||
                       fit.local_noise || fit.hasThreshold() || fit.paper_mode;
    params.fit.keep_sensor_noise = keep_noise_ && !given;
    if (params.fit.keep_sensor_noise && sensor_noise_ &&
        sensor_noise_->hasSize(points.width, points.height))
      params.fit.sensor_noise = sensor_noise_;
    return params;
  }

  void keepNoise(const std::optional<pcl_slim::SensorNoise>& noise,
                 const PointTable& points) const {
    if (!noise) return;
    sensor_noise_ = noise;
    const bool organised = points.height > 1;
    sensor_noise_->columns = organised ? points.width : 0;
    sensor_noise_->rows = organised ? points.height : 0;
  }

  bool move_;
  bool sensor_at_origin_ = true;
  bool keep_noise_ = true;
  pcl_slim::ScanWorkParams params_;
  mutable std::optional<pcl_slim::SensorNoise> sensor_noise_;  ///< of the last message
};

/** Samples the points into discs. */
class SplatWork : public CloudWork {
 public:
  NodeParameters parameters() override;

  Error validate() const override {
    if (params_.max_splats > 0 && params_.target_error > 0)
      return {ErrorCode::kBadArgument, "max_splats and target_error are two targets: give one"};
    return params_.validate();
  }

  Result<CloudOutput> process(PointTable points, Progress* progress) const override {
    const Result<ScanTable> scan = scanOf(std::move(points), sensor_at_origin_);
    if (!scan) return scan.error();
    auto splats = pcl_slim::splatsOfScan(*scan, params_, use_normals_, nullptr, progress);
    if (!splats) return splats.error();
    return CloudOutput{std::move(*splats), true, {}};
  }

 private:
  bool use_normals_ = true;
  bool sensor_at_origin_ = true;
  pcl_slim::SplatParams params_;
};

NodeParameters SplatWork::parameters() {
  pcl_slim::SplatParams& p = params_;
  using pcl_slim::RadiusRule;
  using pcl_slim::SplatColor;
  constexpr double kMany = 1e18;
  return {
      numberParameter("initial",
                      "cells of the initial grid along the longest side; 0: about 50 points a cell",
                      &p.initial_resolution, 0, pcl_slim::RootGrid::kMaxResolution),
      numberParameter("geo", "deviation of unit normals from which a cell is divided",
                      &p.geometric_error, 0, 1e6),
      numberParameter(
          "color", "deviation of CIELAB / 100 from which a cell is divided; 1: colour is ignored",
          &p.color_error, 0, 1e6),
      numberParameter("min_points", "cells of fewer points stay whole", &p.min_points, 0,
                      0xffffffffu),
      numberParameter("max_depth",
                      "halvings of an initial cell at most; 0: the initial grid itself",
                      &p.max_depth, 0, 1000000),
      numberParameter("max_splats",
                      "the best picture by at most this number of splats, in place of geo and "
                      "color; 0: off",
                      &p.max_splats, 0, kMany),
      numberParameter("target_error", "mean colour difference (Delta E) to reach, likewise; 0: off",
                      &p.target_error, 0, 1e6),
      switchParameter("paper",
                      "the published method: large discs, the kept points' own colours, no noise "
                      "guard",
                      &p.paper_mode),
      choiceParameter(
          "colors", "colour of a splat; gradient adds nine fields", {"mean", "gradient", "own"},
          [&p](std::size_t i) {
            p.color = std::array{SplatColor::kMean, SplatColor::kGradient, SplatColor::kOwn}[i];
          }),
      choiceParameter("radius", "how large discs become", {"density", "neighbours", "corner"},
                      [&p](std::size_t i) {
                        p.radius = std::array{RadiusRule::kDensity, RadiusRule::kNeighbors,
                                              RadiusRule::kCorner}[i];
                      }),
      switchParameter("remove_noise", "take measured noise off deviations", &p.remove_noise),
      switchParameter("use_normals", "use the points' own normals", &use_normals_),
      numberParameter("estimate_normals",
                      "about how many neighbours give each normal of points without",
                      &p.normal_neighbors, 3, 10000),
      switchParameter("sensor_at_origin", kSensorAtOrigin, &sensor_at_origin_),
      placeParameter("viewpoint", "what estimated normals face, in the messages' frame",
                     &p.viewpoint),
      numberParameter("threads", "threads, 0: all cores; never changes the result", &p.threads, 0,
                      4096)};
}

}  // namespace

std::unique_ptr<CloudWork> makeSmoothing() {
  return std::make_unique<SurfaceWork>(true);
}

std::unique_ptr<CloudWork> makeNormals() {
  return std::make_unique<SurfaceWork>(false);
}

std::unique_ptr<CloudWork> makeSplats() {
  return std::make_unique<SplatWork>();
}

/** Of which parameters at most one may differ from its default, and more do. */
static Error checkExclusive(const std::set<std::string>& given) {
  for (const auto& names : pcl_slim::exclusiveFitParameters()) {
    std::string both;
    int count = 0;
    for (const char* name : names) {
      if (given.count(name) == 0) continue;
      both += (count++ > 0 ? " and " : "") + std::string(name);
    }
    if (count > 1) return {ErrorCode::kBadArgument, both + " exclude each other: give one"};
  }
  return {};
}

Result<std::shared_ptr<const CloudWork>> makeWork(MakeWork make, const NamedValues& values) {
  std::set<std::string> changed;
  std::shared_ptr<CloudWork> work = make();
  for (const NodeParameter& parameter : work->parameters()) {
    const auto given = std::find_if(values.begin(), values.end(), [&](const auto& value) {
      return value.first == parameter.name;
    });
    // Defaults are in place, and taking one may undo another parameter of the same rule.
    if (given == values.end() || given->second == parameter.value) continue;
    if (given->second.index() != parameter.value.index())
      return Error{ErrorCode::kBadArgument, "the parameter " + parameter.name +
                                                " has another type: give that of its default"};
    if (Error error = parameter.take(given->second)) return error;
    changed.insert(parameter.name);
  }
  if (Error error = checkExclusive(changed)) return error;
  if (Error error = work->validate()) return error;
  return std::shared_ptr<const CloudWork>(std::move(work));
}

}  // namespace pcl_slim_ros
