// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>

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
  const Result<DescribedCloud> cloud = describeCloud(this->cloudInput(), this->params_);
  if (!cloud) return this->fail(cloud.error().code, cloud.error().message);
  TracedScan traced;
  const SurfaceConstPtr given = given_surface_;
  const FitParams fit = this->params_;
  const CrestParams crest = crest_;
  const bool done = this->guarded("the tracing", "use fewer points", [&] {
    return traceScanLines(cloud->view, given.get(), fit, crest, traced, &this->control_.progress);
  });
  this->statistics_ = traced.fitted.statistics;
  this->input_statistics_ = traced.fitted.store.statistics();
  if (!done) return false;
  lines = std::move(traced.lines);
  crest_statistics_ = traced.statistics;
  if (!given) fitted_surface_ = std::make_shared<SLIMSurface>(std::move(traced.fitted.surface));
  return true;
}

template <typename PointT>
bool SLIMCrestLines<PointT>::compute(pcl::PointCloud<PointCrest>& vertices) {
  vertices = pcl::PointCloud<PointCrest>();
  CrestLines lines;
  const auto input = input_;
  if (!compute(lines)) return false;
  toPointCloud(lines, vertices);
  vertices.header = input->header;
  return true;
}

}  // namespace pcl_slim

#define PCL_SLIM_INSTANTIATE_SLIMCrestLines(PointT) \
  template class PCL_SLIM_EXPORT pcl_slim::SLIMCrestLines<PointT>;
