// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PCLPointCloud2.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"

namespace pcl_slim {

/** \brief A point file as it stands on disk: every field in its own type, nothing narrowed.
 *
 * PCL's own readers narrow nothing either for PCD, but refuse double properties of PLY files and
 * print instead of reporting; these read both formats alike and return one sentence when a file
 * cannot be used. PLY names become PCL's (nx: normal_x; uchar red green blue: rgb).
 */
struct PointFile {
  pcl::PCLPointCloud2 cloud;
  Eigen::Vector4f sensor_origin = Eigen::Vector4f::Zero();
  Eigen::Quaternionf sensor_orientation = Eigen::Quaternionf::Identity();
  std::vector<std::string> comments;  ///< text of the header's comment lines, in order
  std::vector<std::string>
      left_out;  ///< what the file held beside this, in words: "element 'edge'"
  std::vector<std::uint32_t> face_begin;  ///< PLY faces: number of faces + 1 offsets, or empty
  std::vector<std::uint32_t>
      face_vertices;  ///< vertices of face i: [face_begin[i], face_begin[i+1])

  std::size_t numFaces() const { return face_begin.empty() ? 0 : face_begin.size() - 1; }
};

/** \brief Reads .pcd (ascii, binary, binary_compressed) or .ply (ascii, binary of either order).
 *
 * A missing, foreign, truncated or self-contradicting file gives an error; one without points
 * is read and has none. Of a PLY file, elements other than vertices and faces, lists of vertices, and all
 * of faces but their vertices are passed over, and named in left_out.
 */
Result<PointFile>
loadPointFile(const std::string& path);

/** \brief Writes .pcd (binary) or .ply (binary_little_endian) by extension, with comments and faces.
 *
 * Fields go out in their order and type, so that loading and saving gives the same bytes again.
 * PCD keeps no faces. \return an error for another extension or when the file cannot be written.
 */
Error
savePointFile(const std::string& path, const PointFile& file);

/** \brief Index of a field by name in cloud.fields, or -1. */
int
findField(const pcl::PCLPointCloud2& cloud, const std::string& name);

/** \brief Value of the first element of a field of one point, whatever its type, as double. */
double
fieldValue(const pcl::PCLPointCloud2& cloud, std::size_t point, const pcl::PCLPointField& field);

/** \brief Number of points: width times height. */
std::size_t
numPoints(const pcl::PCLPointCloud2& cloud);

}  // namespace pcl_slim
