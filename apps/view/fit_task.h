// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/fit/sensor_noise.h"
#include "pcl_slim/surface/surface.h"
#include "scan/fit_job.h"

namespace pcl_slim {

/** \brief A fit in a thread of its own, apart from the window's. The scan must outlive it. */
class FitTask {
 public:
  /** \param[in] min_component points; what is connected to fewer is not shown \param[in]
   * uncertainty paints the surface with its standard error */
  FitTask(const FitJob& job, double min_component, const CloudFile& cloud, bool uncertainty);
  /** \brief Stops the fit and waits for it. */
  ~FitTask();
  FitTask(const FitTask&) = delete;
  FitTask& operator=(const FitTask&) = delete;

  bool finished() const { return finished_.load(); }
  /** \brief Returns when the fit has finished. */
  void wait();
  /** \brief Share done; \param[out] stage what runs now. */
  float progress(std::string& stage) const;

  /** \brief Once finished: what was wrong, or nothing. */
  const Error& error() const { return error_; }
  std::shared_ptr<const SLIMSurface> surface() const { return surface_; }
  /** \brief The noise of the sensor, for its next frame, where the job keeps it. */
  const std::optional<SensorNoise>& sensorNoise() const { return sensor_noise_; }

 private:
  void run();

  FitJob job_;
  double min_component_;
  bool uncertainty_;
  const CloudFile& cloud_;
  std::shared_ptr<SLIMSurface> surface_ = std::make_shared<SLIMSurface>();
  std::optional<SensorNoise> sensor_noise_;
  Error error_;
  std::atomic<bool> finished_{false};
  mutable std::mutex mutex_;  ///< of fraction and stage
  float fraction_ = 0.0f;
  std::string stage_ = "preparing";
  Progress progress_;
  std::thread thread_;  ///< last: all else is there when it starts
};

/** \brief The frames of a sensor, fitted one after the other: while one is shown the next one is fitted.
 * Each uses the noise of the one before while its residuals agree with it. */
class FrameSequence {
 public:
  /** \param[in] files of the frames, one at least \param[in] min_component, uncertainty as of a
   * FitTask \param[in] console, report of the frames loaded */
  FrameSequence(std::vector<std::string> files, const FitJob& job, double min_component,
                bool uncertainty, Console& console, Report& report);

  /** \brief Loads a frame and starts its fit; after the last one comes the first. O(points). */
  void start(std::size_t index);
  /** \brief Hands the noise on, and starts the next frame. */
  void startNext();

  std::size_t size() const { return files_.size(); }
  std::size_t index() const { return index_; }
  const std::string& file() const { return files_[index_]; }
  const FitJob& job() const { return job_; }
  const CloudFile& cloud() const { return *cloud_; }
  /** \brief Why the frame could not be loaded or, once it is fitted, not be fitted. */
  Error error() const { return task_ ? task_->error() : error_; }
  /** \brief The fit of the frame; null if it could not be loaded. */
  const FitTask* task() const { return task_.get(); }
  /** \brief Returns when the frame is fitted. */
  void wait() {
    if (task_) task_->wait();
  }

 private:
  std::vector<std::string> files_;
  FitJob job_;
  double min_component_;
  bool uncertainty_;
  Console& console_;
  Report& report_;
  std::size_t index_ = 0;
  Error error_;  ///< of loading the frame
  std::unique_ptr<CloudFile> cloud_;
  std::unique_ptr<FitTask> task_;  ///< last: it reads the cloud
};

}  // namespace pcl_slim
