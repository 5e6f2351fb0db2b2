// SPDX-License-Identifier: BSD-3-Clause
#include "view/fit_task.h"

#include <new>
#include <utility>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/fit/fit_colors.h"

namespace pcl_slim {

FitTask::FitTask(const FitJob& job, const CloudFile& cloud)
    : job_(job),
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
      })
{
}

FitTask::~FitTask()
{
  progress_.cancel();
  thread_.join();
}

float
FitTask::progress(std::string& stage) const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  stage = stage_;
  return fraction_;
}

void
FitTask::run()
{
  const bool with_normals = job_.use_normals || job_.normal_neighbours > 0;
  Result<PointStore> store = PointStore::build(cloud_.view(with_normals), job_.params.threads);
  if (!store) {
    error_ = store.error();
    return;
  }
  error_ = fitSurface(*store, job_.params, *surface_, nullptr, &progress_);
  if (!error_ && job_.color)
    error_ = fitColors(*store, cloud_.view(), colorsOf(cloud_), job_.params.threads, *surface_);
}

}  // namespace pcl_slim
