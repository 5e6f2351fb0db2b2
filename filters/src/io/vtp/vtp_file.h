// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PCLPointField.h>
#include <string>
#include <vector>

#include "io/scalar_type.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

inline constexpr const char* kVtpCommentArray = "pcl_slim";  ///< of the field data
inline constexpr const char* kVtpNormalArray = "Normals";
inline constexpr const char* kVtpColorArray = "RGB";    ///< three bytes of the field rgb or rgba
inline constexpr const char* kVtpAlphaArray = "alpha";  ///< the fourth
inline constexpr const char* kVtpCoordinates[3] = {"x", "y", "z"};
inline constexpr const char* kVtpNormals[3] = {"normal_x", "normal_y", "normal_z"};

inline bool
isNameOf(const char* const (&names)[3], const std::string& name)
{
  return name == names[0] || name == names[1] || name == names[2];
}

/** Whether a field packs a colour into four bytes. */
inline bool
isPackedColor(const pcl::PCLPointField& field)
{
  return (field.name == "rgb" || field.name == "rgba") && scalarSize(field.datatype) == 4 &&
         field.count <= 1;
}

/** No error where this build has VTK's reader and writer; otherwise names what to give instead of
 * path. The functions below give the same error then. */
Error
checkVtp(const std::string& path);

/** Writes points as VTK's XML PolyData, bit for bit: "Normals" for the normals, "RGB" (and "alpha", unless
 * it is 0 in a field rgb) for a packed colour, for each other field an array of its name, type and
 * count, comments as strings of the field data. Faces become polygons; without faces each point that
 * has finite coordinates is a vertex cell. Rows of an organised cloud and the sensor are not kept. */
Error
saveVtp(const std::string& path, const PointFile& file);

/** An array of points as saveVtp() writes it. */
struct VtpColumn {
  std::string name;
  std::uint8_t type;  ///< ScalarType
  std::size_t components;
};

/** The arrays that saveVtp() writes for points, without their coordinates. */
Result<std::vector<VtpColumn>>
vtpColumns(const PointFile& file);

/** Reads what saveVtp() or VTK has written: points, their arrays as fields, and polygons. */
Result<PointFile>
parseVtp(const std::vector<unsigned char>& bytes);

}  // namespace pcl_slim
