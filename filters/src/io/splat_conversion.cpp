// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/splat_conversion.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "io/scalar_type.h"
#include "pcl_slim/cloud/store_frame.h"

namespace pcl_slim {

std::array<double, 3>
splatShift(const SplatSet& splats)
{
  if (splats.empty()) return {};
  std::array<double, 3> low, high;
  const std::vector<float>* const columns[3] = {&splats.x, &splats.y, &splats.z};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [least, most] = std::minmax_element(columns[a]->begin(), columns[a]->end());
    low[a] = splats.origin[a] + *least;
    high[a] = splats.origin[a] + *most;
  }
  return fileShift(low, high);
}

void
toPCL(const SplatSet& splats, const std::array<double, 3>& shift,
      pcl::PointCloud<pcl::PointSurfel>& cloud)
{
  cloud.resize(splats.size());
  cloud.width = static_cast<std::uint32_t>(splats.size());
  cloud.height = 1;
  cloud.is_dense = true;
  std::array<double, 3> offset;
  for (std::size_t a = 0; a < 3; ++a) offset[a] = splats.origin[a] - shift[a];
  for (std::size_t i = 0; i < splats.size(); ++i) {
    pcl::PointSurfel& p = cloud[i];
    p.x = static_cast<float>(offset[0] + splats.x[i]);
    p.y = static_cast<float>(offset[1] + splats.y[i]);
    p.z = static_cast<float>(offset[2] + splats.z[i]);
    p.normal_x = splats.nx[i];
    p.normal_y = splats.ny[i];
    p.normal_z = splats.nz[i];
    p.rgba = 0xff000000u | splats.rgb[i];
    p.radius = splats.radius[i];
    p.confidence = splats.confidence[i];
    p.curvature = splats.normal_variance[i];
  }
}

PointFile
toPointFile(const SplatSet& splats, const std::array<double, 3>& shift)
{
  PointFile file;
  pcl::PCLPointCloud2& cloud = file.cloud;
  for (const char* name : {"x", "y", "z", "normal_x", "normal_y", "normal_z"}) {
    addField(cloud, name, kFloat32);
  }
  addField(cloud, "rgba", kUInt32);
  for (const char* name : {"radius", "confidence", "curvature"}) {
    addField(cloud, name, kFloat32);
  }
  if (!splats.gradient.empty()) {
    for (const char* channel : {"red", "green", "blue"}) {
      for (const char* axis : {"_x", "_y", "_z"}) {
        addField(cloud, std::string(channel) + axis, kFloat32);
      }
    }
  }
  cloud.width = static_cast<std::uint32_t>(splats.size());
  cloud.height = 1;
  cloud.is_dense = 1;
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data.resize(std::size_t{cloud.point_step} * splats.size());
  pcl::PointCloud<pcl::PointSurfel> surfels;
  toPCL(splats, shift, surfels);
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const pcl::PointSurfel& p = surfels[i];
    const float before[6] = {p.x, p.y, p.z, p.normal_x, p.normal_y, p.normal_z};
    const float after[3] = {p.radius, p.confidence, p.curvature};
    unsigned char* at = cloud.data.data() + i * cloud.point_step;
    std::memcpy(at, before, sizeof(before));
    std::memcpy(at + 24, &p.rgba, 4);
    std::memcpy(at + 28, after, sizeof(after));
    if (!splats.gradient.empty()) std::memcpy(at + 40, splats.gradient[i].data(), 36);
  }
  file.comments = {"pcl_slim version 1", "pcl_slim kind splats",
                   "pcl_slim shift " + formatScalar(shift[0]) + " " + formatScalar(shift[1]) + " " +
                       formatScalar(shift[2])};
  return file;
}

}  // namespace pcl_slim
