// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/common/point_tests.h>
#include <pcl/console/print.h>

#include <algorithm>
#include <memory>

#include "pcl_slim/filters/cloud_description.h"
#include "pcl_slim/filters/color_octree_splat_sampler.h"
#include "pcl_slim/filters/impl/color_view.hpp"
#include "pcl_slim/filters/io/splat_conversion.h"

#ifndef PCL_SLIM_PCL_POINTS_ONLY
#include <pcl/filters/impl/filter_indices.hpp>

#include "pcl_slim/filters/impl/cloud_description.hpp"
#endif

namespace pcl_slim {

template <typename PointT>
ColorOctreeSplatSampler<PointT>::ColorOctreeSplatSampler(bool extract_removed_indices)
    : pcl::FilterIndices<PointT>(extract_removed_indices) {
  this->filter_name_ = "ColorOctreeSplatSampler";
}

// PCL's filters share the removed indices with their copies; ours do not.
template <typename PointT>
ColorOctreeSplatSampler<PointT>::ColorOctreeSplatSampler(const ColorOctreeSplatSampler& other)
    : pcl::FilterIndices<PointT>(other),
      ColorOctreeSplatSamplerBase(other),
      normals_(other.normals_),
      search_(other.search_) {
  removed_indices_.reset(new pcl::Indices(*other.removed_indices_));
}

template <typename PointT>
ColorOctreeSplatSampler<PointT>& ColorOctreeSplatSampler<PointT>::operator=(
    const ColorOctreeSplatSampler& other) {
  if (this == &other) return *this;
  pcl::FilterIndices<PointT>::operator=(other);
  ColorOctreeSplatSamplerBase::operator=(other);
  normals_ = other.normals_;
  search_ = other.search_;
  removed_indices_.reset(new pcl::Indices(*other.removed_indices_));
  return *this;
}

template <typename PointT>
bool ColorOctreeSplatSampler<PointT>::sample(SplatSet& splats) {
  splats = SplatSet();
  clearResults();
  FitParams params;
  params.viewpoint = params_.viewpoint;
  CloudInput<PointT> input;
  input.cloud = input_;
  if (use_indices_) input.indices = indices_;
  input.normals = normals_;
  if (search_ && !pcl::traits::has_normal<PointT>::value) {
    input.search = search_;
    input.normal_neighbours = params_.normal_neighbors;
    params.threads = params_.threads;
  }
  const Result<DescribedCloud> cloud = describeCloud(input, params);
  if (!cloud) return fail(cloud.error().code, cloud.error().message);
  return run(cloud->view, colorsOfPoints(*input_), splats);
}

template <typename PointT>
bool ColorOctreeSplatSampler<PointT>::sample(pcl::PointCloud<pcl::PointSurfel>& splats) {
  splats = pcl::PointCloud<pcl::PointSurfel>();
  SplatSet set;
  const auto input = input_;
  if (!sample(set)) return false;
  toPCL(set, {}, splats);
  splats.header = input->header;
  splats.sensor_origin_ = input->sensor_origin_;
  splats.sensor_orientation_ = input->sensor_orientation_;
  return true;
}

template <typename PointT>
bool ColorOctreeSplatSampler<PointT>::filter(pcl::Indices& indices) {
  indices.clear();
  applyFilter(indices);
  return !error_;
}

template <typename PointT>
bool ColorOctreeSplatSampler<PointT>::filter(PointCloud& output) {
  clearResults();
  removed_indices_->clear();
  if (!input_ || input_->empty()) {
    output = PointCloud();
    SplatSet none;
    sample(none);  // finds what is wrong
    complain();
    return false;
  }
  // Keeping the organization uses the removed indices; PCL would warn that it needs them.
  const bool extract = extract_removed_indices_;
  if (this->keep_organized_) extract_removed_indices_ = true;
  PointCloud filtered;
  pcl::FilterIndices<PointT>::filter(filtered);
  extract_removed_indices_ = extract;
  if (error_) filtered = PointCloud();
  output = std::move(filtered);
  return !error_;
}

template <typename PointT>
void ColorOctreeSplatSampler<PointT>::complain() const {
  if (error_.code == ErrorCode::kCancelled) return;
  PCL_ERROR("[pcl_slim::%s::filter] %s\n", this->getClassName().c_str(), error_.message.c_str());
}

template <typename PointT>
void ColorOctreeSplatSampler<PointT>::applyFilter(pcl::Indices& indices) {
  indices.clear();
  removed_indices_->clear();
  SplatSet splats;
  const auto input = input_;
  const auto chosen_indices = indices_;
  const bool done = sample(splats);
  input_ = input;  // PCL's filter() reads both next
  indices_ = chosen_indices;
  if (!done) {
    complain();
    return;
  }
  std::vector<bool> kept(input_->size(), false);
  for (const std::uint32_t i : splats.kept) kept[i] = true;
  const bool chosen = use_indices_ && indices_;
  const std::size_t count = chosen ? indices_->size() : input_->size();
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = chosen ? (*indices_)[k] : static_cast<pcl::index_t>(k);
    const auto at = static_cast<std::size_t>(i);
    // Points that are not finite belong to neither side.
    const bool out = kept[at] == negative_ || !pcl::isXYZFinite((*input_)[at]);
    if (!out) {
      indices.push_back(i);
    } else if (extract_removed_indices_) {
      removed_indices_->push_back(i);
    }
  }
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
}

}  // namespace pcl_slim

#define PCL_SLIM_INSTANTIATE_ColorOctreeSplatSampler(PointT) \
  template class PCL_SLIM_EXPORT pcl_slim::ColorOctreeSplatSampler<PointT>;
