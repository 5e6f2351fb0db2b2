// SPDX-License-Identifier: BSD-3-Clause
#define PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/slim_fit.hpp"

#include <pcl/console/print.h>
#include <pcl/point_types.h>
#include <algorithm>
#include <array>
#include <exception>
#include <new>
#include <pcl/impl/instantiate.hpp>
#include <tuple>
#include <utility>

#include "pcl_slim/filters/controlled_run.h"
#include "pcl_slim/filters/slim_fit_base.h"

namespace pcl_slim {

void ControlledRun::clearResults() {
  error_ = {};
  clearWarning();
}

void ControlledRun::clearWarning() {
  warning_.clear();
  printed_.clear();
}

void ControlledRun::addWarning(const std::string& sentence) {
  if (warning_.find(sentence) != std::string::npos) return;  // of a second fit
  warning_ += (warning_.empty() ? "" : "; ") + sentence;
}

void ControlledRun::warn(const std::string& sentence) {
  addWarning(sentence);
  if (printed_.find(sentence) != std::string::npos) return;
  printed_ += (printed_.empty() ? "" : "; ") + sentence;
}

void ControlledRun::printWarning(const char* verb) const {
  if (!printed_.empty()) PCL_WARN("[pcl_slim::%s] %s\n", verb, printed_.c_str());
}

bool ControlledRun::fail(ErrorCode code, const std::string& message) {
  error_ = {code, message};
  return false;
}

void ControlledRun::warnOfSides(SideSource source, const NormalAgreement& normals) try {
  for (const std::string& note : sideNotes(source, normals, "setViewPoint(x, y, z)"))
    addWarning(note);
} catch (const std::bad_alloc&) {
  // The result is there; short of memory, it comes without the warning.
}

bool ControlledRun::guardedCall(const char* work, const char* remedy, Error (*call)(const void*),
                                const void* body) {
  try {
    error_ = call(body);
    // Checked after the last progress report: a caller who cancels gets no result.
    if (!error_ && control_.progress.cancelled()) {
      fail(ErrorCode::kCancelled, std::string(work) + " was cancelled");
    }
  } catch (const std::bad_alloc&) {
    fail(ErrorCode::kBadInput, std::string("not enough memory for this cloud; ") + remedy);
  } catch (const std::exception& failure) {
    fail(ErrorCode::kBadInput, std::string(work) + " stopped: " + failure.what());
  } catch (...) {
    fail(ErrorCode::kBadInput,
         std::string(work) + " stopped: the progress callback threw what is no std::exception");
  }
  return !error_;
}

void SLIMFitBase::setViewPoint(double x, double y, double z) {
  params_.viewpoint = std::array<double, 3>{x, y, z};
  sensors_.reset();
}

bool SLIMFitBase::getViewPoint(double& x, double& y, double& z) const {
  if (!params_.viewpoint) return false;
  std::tie(x, y, z) = std::tuple_cat(*params_.viewpoint);
  return true;
}

void SLIMFitBase::clearResults() {
  ControlledRun::clearResults();
  statistics_ = {};
  outliers_.clear();
  input_statistics_ = {};
}

Error SLIMFitBase::fitAndKeep(const ScanView& scan, const FitParams& params, FittedScan& fitted) {
  if (params.sharp_features && scan.points.normal == nullptr) {
    warn(
        "sharp features have no effect without normals; set some, or estimate them: "
        "setNormalEstimationNeighbors(30)");
  }
  Error error = fitScan(scan, params, fitted, &control_.progress);
  statistics_ = fitted.statistics;
  if (!error && params.keep_sensor_noise && statistics_.noise.sensor_noise)
    params_.sensor_noise = statistics_.noise.sensor_noise;
  input_statistics_ = fitted.store.statistics();
  outliers_.clear();
  for (const std::uint32_t i : statistics_.outlier_points)
    outliers_.push_back(
        static_cast<std::int32_t>(scan.points.inputIndex(fitted.store.orderOfStore()[i])));
  std::sort(outliers_.begin(), outliers_.end());
  warnOfSides(statistics_.sides.source, statistics_.sides.normals);
  return error;
}

bool SLIMFitBase::run(const ScanView& scan, FitParams params, SLIMSurface& surface) {
  const CancellableRun cancellable(control_.progress);
  FittedScan fitted;
  const bool done =
      guarded("the fit", "fit fewer points", [&] { return fitAndKeep(scan, params, fitted); });
  surface = done ? std::move(fitted.surface) : SLIMSurface();
  return done;
}

}  // namespace pcl_slim

#define PCL_INSTANTIATE_SLIMFit PCL_SLIM_INSTANTIATE_SLIMFit
PCL_INSTANTIATE(SLIMFit, PCL_XYZ_POINT_TYPES)
