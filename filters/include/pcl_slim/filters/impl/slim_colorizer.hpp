// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/common/io.h>

#include <utility>
#include <vector>

#include "pcl_slim/filters/cloud_description.h"
#include "pcl_slim/filters/impl/color_view.hpp"
#include "pcl_slim/filters/slim_colorizer.h"
#include "pcl_slim/query/surface_probe.h"

#ifndef PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/cloud_description.hpp"
#endif

namespace pcl_slim {

constexpr double kColorReach = 0.5;  ///< [radii] a leaf farther from a point does not colour it

/** Writes the colour of a point. */
template <typename PointT>
void setColor(PointT& point, const std::array<std::uint8_t, 3>& rgb) {
  static_assert(pcl::traits::has_color<PointT>::value, "the output needs a field rgb or rgba");
  point.r = rgb[0];
  point.g = rgb[1];
  point.b = rgb[2];
}

template <typename PointInT, typename PointOutT>
bool SLIMColorizer<PointInT, PointOutT>::colorize(PointCloudOut& output) {
  const auto input = input_;
  const bool in_place = static_cast<const void*>(input.get()) == &output;
  if (!in_place) output = PointCloudOut();
  clearResults();
  const auto refuse = [&](const Error& error) {
    output = PointCloudOut();
    return fail(error.code, error.message);
  };
  const pcl::IndicesConstPtr indices = use_indices_ ? indices_ : nullptr;
  const Result<DescribedCloud> cloud =
      describeCloud<PointInT>({input, indices, normals_, {}, 0, sensors_, frames_}, params_);
  if (!cloud) return refuse(cloud.error());
  const SurfaceConstPtr given = given_surface_;
  const ColorView colors = colorsOfPoints(*input);
  if (given && !given->hasColors())
    return refuse(badInput("the surface has no colours: fit it to a coloured cloud, or paint it"));
  if (!given && colors.bgr == nullptr) {
    return refuse(
        badInput("the cloud has no colours to fit: call setSurface() with a coloured surface"));
  }
  // Points beyond what a smoothing moves, as registration leaves them, have colours too; others are
  // projected as a smoothing does, which keeps the sheets of thin parts apart.
  ProjectionParams wide;
  wide.reach = kColorReach;
  CloudProjection far, near;
  if (!project(cloud->view, cloud->view, params_, wide, far, colors) ||
      !projectMore(cloud->view, {}, near)) {
    output = PointCloudOut();
    return false;
  }
  PointCloudOut colored;
  const bool done = guarded("the colouring", "use fewer points", [&]() -> Error {
    write(*input, indices.get(), given ? *given : *fitted_surface_, far, near, colored);
    return {};
  });
  output = done ? std::move(colored) : PointCloudOut();
  return done;
}

template <typename PointInT, typename PointOutT>
void SLIMColorizer<PointInT, PointOutT>::write(
    const pcl::PointCloud<PointInT>& input, const pcl::Indices* indices, const SLIMSurface& surface,
    const CloudProjection& far, const CloudProjection& near, PointCloudOut& output) const {
  if (indices != nullptr)
    pcl::copyPointCloud(input, *indices, output);
  else
    pcl::copyPointCloud(input, output);
  if (far.statistics().non_finite > 0) output.is_dense = false;
  std::vector<std::size_t> supported;
  std::vector<Vector3> places;
  std::vector<std::array<float, 3>> normals;
  for (std::size_t i = 0; i < far.size(); ++i) {
    const CloudProjection& projection = near.isSupported(i) ? near : far;
    if (!projection.isSupported(i)) {
      if constexpr (!pcl::traits::has_color<PointInT>::value) setColor(output[i], {255, 255, 255});
      continue;
    }
    supported.push_back(i);
    places.push_back(projection.point(i).position);
    normals.push_back(projection.surfaceNormal(i));
  }
  const auto colors = surfaceColors(surface, places, normals, params_.threads);
  for (std::size_t k = 0; k < supported.size(); ++k) setColor(output[supported[k]], colors[k]);
}

}  // namespace pcl_slim

#define PCL_SLIM_INSTANTIATE_SLIMColorizer(In, Out) \
  template class PCL_SLIM_EXPORT pcl_slim::SLIMColorizer<In, Out>;
