// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/splat/octree_cloud.h"
#include "scan/input_options.h"

namespace pcl_slim {

/** \brief Where a cloud's normals come from. */
enum class NormalSource { kNothing, kFields, kMesh, kEstimated };

/** \brief A scan as a program works on it: the file with all its fields, and a view of its points.
 *
 * Coordinates are read in the file's own precision, without a copy where their layout is one of
 * CloudView's own. Normals come from the fields normal_x normal_y normal_z or, for a mesh, from its
 * faces, weighted by area; vertices no face names then have none. A closed mesh whose faces face
 * inwards is turned outwards. The places that points were seen from come from the fields vp_x vp_y
 * vp_z, unless all of them are zero.
 */
struct CloudFile {
  PointFile file;
  std::vector<double> xyz;     ///< coordinates, where they could not be used in place
  std::vector<float> normals;  ///< normals, likewise, and those made here
  std::vector<double>
      sensors;  ///< x y z that each point was seen from, or none; view() refers to them
  std::vector<std::uint32_t> frames;  ///< which of several merged frames each is from, likewise
  std::vector<std::uint8_t>
      colors;  ///< blue green red of each point, where no field has them packed
  NormalSource normal_source = NormalSource::kNothing;
  bool double_precision = false;
  bool turned_outwards = false;  ///< the faces are a closed mesh's, which faced inwards in the file
  std::uint64_t num_non_finite = 0;  ///< points with a NaN or infinite coordinate

  std::size_t size() const { return numPoints(file.cloud); }

  /** \brief Where the file's sensor was; 0 where the file gives no finite place. */
  std::array<double, 3> sensor() const;

  /** \brief A view of the points; valid while this object lives and is not changed. */
  CloudView view(bool with_normals = true) const;
};

/** \brief Loads a file of any format of loadPointFile(). A missing, foreign, truncated or
 * coordinate-less file gives an error; one without points does not. */
Result<CloudFile> loadCloudFile(const std::string& path);

/** \brief A cloud of points that are read already. \param[in] name what an error calls them. */
Result<CloudFile> asCloudFile(PointFile file, const std::string& name);

/** \brief The colours of a cloud's points, in its field rgba or rgb where that is packed into four
 * bytes, or those that loading brought to bytes; null without. Valid as long as view() is. */
ColorView colorsOf(const CloudFile& cloud);

/** \brief Replaces the normals by PCL's, from the k nearest neighbours of each point.
 *
 * They point to the viewpoint (world coordinates; none: the points' sensors, or the file's).
 * \param[in] threads 0: all cores. \return an error for a k beyond the number of finite points.
 */
Error estimateNormals(int k, const std::optional<std::array<double, 3>>& viewpoint, int threads,
                      CloudFile& cloud);

/** \brief Appends the points of further registered frames to those of a first one.
 *
 * The points become one row, in the order of the files; the fields vp_x vp_y vp_z have the place
 * that each was seen from: a frame's own fields of these names or, where they are missing or 0, its
 * VIEWPOINT. The field frame has the frames' numbers, from 0 on, unless the frames have a field of
 * that name. \return an error for a frame that cannot be read, has other fields than the first, or
 * has faces. O(points).
 * \param[in] name of the first frame's file, for messages. \param[in] others further files, read as
 * input says
 * \param[out] numbers of the frame of each point
 */
Error mergeFrames(const std::string& name, const std::vector<std::string>& others,
                  const InputOptions& input, PointFile& first, std::vector<std::uint32_t>& numbers);

/** \brief Numbers the frames of a cloud by the values of a field, in ascending order.
 * \return an error where there is no such field or one of its values is not finite. O(points log
 * frames). */
Error framesByField(const PointTable& cloud, const std::string& field,
                    std::vector<std::uint32_t>& numbers);

/** \brief A copy of a point file in which these fields can be written as real numbers.
 *
 * Fields keep their order, bytes and types; a named one of a whole-number type becomes type,
 * one that is not there is added at the end as type, with zeros. \param[in] type
 * kFloat32 or FLOAT64. O(bytes of the cloud).
 */
PointFile withRealFields(const PointFile& file, const std::vector<std::string>& names,
                         std::uint8_t type);

/** \brief Writes one field of type FLOAT32 or FLOAT64, point by point; from several threads if
 * they write different points. */
class FieldWriter {
 public:
  /** \param[in,out] cloud must have the field and outlive this object. */
  FieldWriter(PointTable& cloud, const std::string& name);

  void set(std::size_t point, double value) const;

 private:
  unsigned char* first_;
  std::size_t step_;
  bool double_;
};

}  // namespace pcl_slim
