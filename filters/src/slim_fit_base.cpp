// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/slim_fit_base.h"

#include <exception>
#include <new>

namespace pcl_slim {

void
SLIMFitBase::setViewPoint(double x, double y, double z)
{
  params_.has_viewpoint = true;
  params_.viewpoint[0] = x;
  params_.viewpoint[1] = y;
  params_.viewpoint[2] = z;
}

bool
SLIMFitBase::getViewPoint(double& x, double& y, double& z) const
{
  if (!params_.has_viewpoint) return false;
  x = params_.viewpoint[0];
  y = params_.viewpoint[1];
  z = params_.viewpoint[2];
  return true;
}

void
SLIMFitBase::clearResults()
{
  statistics_ = {};
  input_statistics_ = {};
  error_ = {};
}

bool
SLIMFitBase::fail(ErrorCode code, const std::string& message)
{
  error_ = {code, message};
  return false;
}

bool
SLIMFitBase::run(const CloudView& cloud, SLIMSurface& surface)
{
  const CancellableRun cancellable(control_.progress);
  error_ = params_.validate();
  if (error_) return false;
  try {
    const Result<PointStore> store = PointStore::build(cloud, params_.threads);
    if (!store) return fail(store.error().code, store.error().message);
    input_statistics_ = store->statistics();
    error_ = fitSurface(*store, params_, surface, &statistics_, &control_.progress);
    // Asked for after the last place where the fit looks: whoever cancels wants no surface.
    if (!error_ && control_.progress.cancelled())
      fail(ErrorCode::kCancelled, "the fit was cancelled");
  } catch (const std::bad_alloc&) {
    fail(ErrorCode::kBadInput, "not enough memory for this cloud; fit fewer points");
  } catch (const std::exception& failure) {
    fail(ErrorCode::kBadInput, std::string("the fit stopped: ") + failure.what());
  }
  if (error_) surface = SLIMSurface();
  return !error_;
}

}  // namespace pcl_slim
