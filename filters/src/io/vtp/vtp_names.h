// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PCLPointField.h>

#include <string>

#include "io/scalar_type.h"

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

}  // namespace pcl_slim
