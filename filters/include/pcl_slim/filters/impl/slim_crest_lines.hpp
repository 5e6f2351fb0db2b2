// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <new>
#include <vector>

#include "pcl_slim/filters/impl/slim_fit.hpp"
#include "pcl_slim/filters/slim_crest_lines.h"

namespace pcl_slim {

template <typename PointT>
bool SLIMCrestLines<PointT>::compute(CrestLines& lines) {
  const CancellableRun cancellable(this->control_.progress);
  lines = CrestLines();
  this->clearResults();
  fitted_surface_.reset();
  crest_statistics_ = {};
  CloudView view;
  std::vector<float> estimated;
  if (!this->describeInput(view) || !this->describeNormals(view, estimated)) return false;
  CrestRun run;
  run.fit = this->params_;
  run.crest = crest_;
  run.surface = surface_;
  try {
    this->error_ = traceCloud(view, run, lines, &this->control_.progress);
  } catch (const std::bad_alloc&) {
    this->fail(ErrorCode::kBadInput, "not enough memory for this cloud; use fewer points");
  } catch (const std::exception& failure) {
    this->fail(ErrorCode::kBadInput, std::string("the tracing stopped: ") + failure.what());
  }
  this->statistics_ = run.fit_statistics;
  this->input_statistics_ = run.input_statistics;
  if (this->error_) {
    lines = CrestLines();
    return false;
  }
  crest_statistics_ = run.crest_statistics;
  if (!surface_) fitted_surface_ = run.surface;
  return true;
}

template <typename PointT>
bool SLIMCrestLines<PointT>::compute(pcl::PointCloud<PointCrest>& vertices) {
  vertices = pcl::PointCloud<PointCrest>();
  CrestLines lines;
  if (!compute(lines)) return false;
  toPointCloud(lines, vertices);
  vertices.header = input_->header;
  return true;
}

}  // namespace pcl_slim

#define PCL_SLIM_INSTANTIATE_SLIMCrestLines(PointT) \
  template class PCL_SLIM_EXPORT pcl_slim::SLIMCrestLines<PointT>;
