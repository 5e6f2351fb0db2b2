// SPDX-License-Identifier: BSD-3-Clause
#include "view/fit_task.h"

#include <new>
#include <utility>

#include "pcl_slim/fit/fit.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/scan/scan.h"
#include "pcl_slim/scan/uncertainty.h"
#include "pcl_slim/surface/surface_components.h"

namespace pcl_slim {

FitTask::FitTask(const FitJob& job, double min_component, const CloudFile& cloud, bool uncertainty)
    : job_(job),
      min_component_(min_component),
      uncertainty_(uncertainty),
      cloud_(cloud),
      progress_([this](float fraction, const char* stage) {
        const std::lock_guard<std::mutex> lock(mutex_);
        fraction_ = fraction;
        stage_ = stage;
      }),
      thread_([this] {
        try {
          run();
        } catch (const std::bad_alloc&) {
          error_ = {ErrorCode::kBadInput, "not enough memory; show a smaller scan"};
        }
        finished_.store(true);
      }) {}

FitTask::~FitTask() {
  progress_.cancel();
  wait();
}

void FitTask::wait() {
  if (thread_.joinable()) thread_.join();
}

float FitTask::progress(std::string& stage) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  stage = stage_;
  return fraction_;
}

void FitTask::run() {
  const bool with_normals = job_.use_normals || job_.normal_neighbours > 0;
  FittedScan fitted;
  std::string note;  // about a sensor's noise of frames of another size, which is not used
  error_ = fitScan({cloud_.view(with_normals), job_.color ? colorsOf(cloud_) : ColorView()},
                   paramsFor(job_, cloud_, note), fitted, &progress_);
  *surface_ = std::move(fitted.surface);
  sensor_noise_ = fitted.statistics.noise.sensor_noise;
  const PointTable& points = cloud_.file.cloud;
  if (sensor_noise_ && points.height > 1) {
    sensor_noise_->columns = points.width;
    sensor_noise_->rows = points.height;
  }
  if (!error_) dropComponents(min_component_, *surface_, job_.params.threads);
  if (error_ || !uncertainty_) return;
  const auto painted = paintUncertainty(*surface_, {}, perceptualColor, job_.params.threads);
  if (!painted) error_ = painted.error();
}

namespace {

/** Whether the noise of a fit is measured, so that the next frame can use it. */
bool measuresNoise(const FitParams& params) {
  const bool given = params.lambda || params.noise || params.noise_model ||
                     params.noise_correlation || params.local_noise;
  return !given && !params.paper_mode && !params.hasThreshold();
}

}  // namespace

FrameSequence::FrameSequence(std::vector<std::string> files, const FitJob& job,
                             double min_component, bool uncertainty, Console& console,
                             Report& report)
    : files_(std::move(files)),
      job_(job),
      min_component_(min_component),
      uncertainty_(uncertainty),
      console_(console),
      report_(report) {
  job_.params.keep_sensor_noise = job_.same_sensor.value_or(true) && measuresNoise(job_.params);
}

void FrameSequence::start(std::size_t index) {
  task_.reset();
  index_ = index % files_.size();
  Result<CloudFile> cloud = loadScan(file(), job_, console_, report_);
  error_ = cloud ? Error() : cloud.error();
  if (!cloud) return;
  cloud_ = std::make_unique<CloudFile>(std::move(*cloud));
  task_ = std::make_unique<FitTask>(job_, min_component_, *cloud_, uncertainty_);
}

void FrameSequence::startNext() {
  if (task_ && !task_->error() && task_->sensorNoise()) {
    const SensorNoise& noise = *task_->sensorNoise();
    if (noise.rows > 0 || job_.same_sensor.value_or(false)) job_.params.sensor_noise = noise;
  }
  start(index_ + 1);
}

}  // namespace pcl_slim
