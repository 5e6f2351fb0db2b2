// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PCLPointCloud2.h>
#include <pcl/PCLPointField.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>

#include <utility>

#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/filters/io/point_message.h"
#include "pcl_slim/filters/io/point_table.h"

// Points of files as PCL's clouds and back; needs PCL's headers and nothing of pcl_slim but io.

namespace pcl_slim {

/** \brief The same points as PCL has them, without a copy of a table that is moved here. is_dense is
 * false: points may have NaN coordinates. */
inline pcl::PCLPointCloud2 toPCL(PointTable table) {
  pcl::PCLPointCloud2 cloud;
  putPoints(std::move(table), false, cloud);
  return cloud;
}

/** \brief The same points without PCL; bytes between a cloud's rows are left out. The header has no
 * place in files. A cloud that contradicts itself stays as it is: checkPointTable() names the
 * defect. */
inline PointTable toPointTable(pcl::PCLPointCloud2 cloud) {
  return takePoints(std::move(cloud));
}

/** \brief A file's points as a cloud of PCL's point types, with the sensor's pose. */
template <typename PointT>
void toPCL(const PointFile& file, pcl::PointCloud<PointT>& cloud) {
  pcl::fromPCLPointCloud2(toPCL(file.cloud), cloud);
  const auto& at = file.sensor_origin;
  const auto& q = file.sensor_orientation;
  cloud.sensor_origin_ = Eigen::Vector4f(at[0], at[1], at[2], 0);
  cloud.sensor_orientation_ = Eigen::Quaternionf(q[0], q[1], q[2], q[3]);
}

/** \brief A cloud of PCL's point types as a file: all of its fields, and the sensor's pose. */
template <typename PointT>
PointFile toPointFile(const pcl::PointCloud<PointT>& cloud) {
  pcl::PCLPointCloud2 fields;
  pcl::toPCLPointCloud2(cloud, fields);
  PointFile file;
  file.cloud = toPointTable(std::move(fields));
  const Eigen::Vector4f& at = cloud.sensor_origin_;
  const Eigen::Quaternionf& q = cloud.sensor_orientation_;
  file.sensor_origin = {at[0], at[1], at[2]};
  file.sensor_orientation = {q.w(), q.x(), q.y(), q.z()};
  return file;
}

}  // namespace pcl_slim
