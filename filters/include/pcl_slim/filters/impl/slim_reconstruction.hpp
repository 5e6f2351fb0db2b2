// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/console/print.h>

#include <utility>
#include <vector>

#include "pcl_slim/filters/cloud_description.h"
#include "pcl_slim/filters/impl/color_view.hpp"
#include "pcl_slim/filters/io/mesh_conversion.h"
#include "pcl_slim/filters/slim_reconstruction.h"

#ifndef PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/cloud_description.hpp"
#endif

namespace pcl_slim {

template <typename PointT>
bool SLIMReconstruction<PointT>::run() {
  clearMesh();
  const Result<DescribedCloud> cloud = describeCloud<PointT>(
      {input_, use_indices_ ? indices_ : nullptr, normals_, nullptr, 0, sensors_, frames_},
      params_);
  const bool done = cloud ? makeMesh({cloud->view, colorsOfPoints(*input_)})
                          : fail(cloud.error().code, cloud.error().message);
  if (!done && error_.code != ErrorCode::kCancelled) {
    PCL_ERROR("[pcl_slim::SLIMReconstruction::reconstruct] %s\n", error_.message.c_str());
  }
  if (done) printWarning("SLIMReconstruction::reconstruct");
  return done;
}

template <typename PointT>
void SLIMReconstruction<PointT>::reconstruct(pcl::PolygonMesh& output) {
  output = pcl::PolygonMesh();
  if (input_) output.header = input_->header;
  performReconstruction(output);
}

template <typename PointT>
void SLIMReconstruction<PointT>::reconstruct(PointCloud& points,
                                             std::vector<pcl::Vertices>& polygons) {
  polygons.clear();
  const auto input = input_;
  const bool own = input.get() == &points;  // stays until it is read, and where there is no mesh
  if (!own) points = PointCloud();
  PointCloud made;
  if (input) made.header = points.header = input->header;
  performReconstruction(made, polygons);
  if (!own || !error_) points = std::move(made);
}

template <typename PointT>
void SLIMReconstruction<PointT>::performReconstruction(pcl::PolygonMesh& output) {
  const pcl::PCLHeader header = output.header;
  output = pcl::PolygonMesh();
  output.header = header;
  if (!run()) return;
  output = toPolygonMesh(mesh_, compute_curvature_);
  output.header = output.cloud.header = header;
}

template <typename PointT>
void SLIMReconstruction<PointT>::performReconstruction(PointCloud& points,
                                                       std::vector<pcl::Vertices>& polygons) {
  points.clear();
  polygons.clear();
  if (!run()) return;
  points.resize(mesh_.vertices.size());
  std::vector<float> variation;
  if constexpr (pcl::traits::has_curvature<PointT>::value) variation = vertexVariation();
  for (std::size_t v = 0; v < points.size(); ++v) {
    PointT& p = points[v];
    p.x = static_cast<float>(mesh_.vertices[v][0]);
    p.y = static_cast<float>(mesh_.vertices[v][1]);
    p.z = static_cast<float>(mesh_.vertices[v][2]);
    if constexpr (pcl::traits::has_normal<PointT>::value) {
      p.normal_x = mesh_.normals[v][0];
      p.normal_y = mesh_.normals[v][1];
      p.normal_z = mesh_.normals[v][2];
    }
    if constexpr (pcl::traits::has_curvature<PointT>::value) p.curvature = variation[v];
    if constexpr (pcl::traits::has_color<PointT>::value) {
      if (mesh_.colors.empty()) continue;
      p.r = mesh_.colors[v][0];
      p.g = mesh_.colors[v][1];
      p.b = mesh_.colors[v][2];
      p.a = 255;
    }
  }
  points.is_dense = true;
  polygons = polygonsOf(mesh_);
}

}  // namespace pcl_slim

#define PCL_SLIM_INSTANTIATE_SLIMReconstruction(PointT) \
  template class PCL_SLIM_EXPORT pcl_slim::SLIMReconstruction<PointT>;
