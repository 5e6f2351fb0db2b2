// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "pcl_slim/core/progress.h"
#include "scan/fit_job.h"

namespace pcl_slim {

/** \brief A fit in a thread of its own, apart from the window's. The scan must outlive it. */
class FitTask {
 public:
  FitTask(const FitJob& job, const CloudFile& cloud);
  /** \brief Stops the fit and waits for it. */
  ~FitTask();
  FitTask(const FitTask&) = delete;
  FitTask& operator=(const FitTask&) = delete;

  bool finished() const { return finished_.load(); }
  /** \brief Share done; \param[out] stage what runs now. */
  float progress(std::string& stage) const;

  /** \brief Once finished: what was wrong, or nothing. */
  const Error& error() const { return error_; }
  std::shared_ptr<const SLIMSurface> surface() const { return surface_; }

 private:
  void run();

  FitJob job_;
  const CloudFile& cloud_;
  std::shared_ptr<SLIMSurface> surface_ = std::make_shared<SLIMSurface>();
  Error error_;
  std::atomic<bool> finished_{false};
  mutable std::mutex mutex_;  ///< of fraction and stage
  float fraction_ = 0.0f;
  std::string stage_ = "preparing";
  Progress progress_;
  std::thread thread_;  ///< last: all else is there when it starts
};

}  // namespace pcl_slim
