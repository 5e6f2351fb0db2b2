// SPDX-License-Identifier: BSD-3-Clause
// Replaces vtp_write.cpp, vtp_markup.cpp and vtp_points.cpp in a build without VTK.
#include "io/vtp/vtp.h"

namespace pcl_slim {

Error checkVtp(const std::string& path) {
  return {ErrorCode::kBadArgument,
          "cannot use '" + path + "': this build has no VTP (PCL_SLIM_WITH_VTP); name a .ply file"};
}

Error saveVtp(const std::string& path, const PointFile&) {
  return checkVtp(path);
}

Result<std::vector<VtpColumn>> vtpColumns(const PointFile&) {
  return checkVtp("*.vtp");
}

Result<PointFile> parseVtp(const std::vector<unsigned char>&) {
  return checkVtp("*.vtp");
}

Error saveCrestVtp(const std::string& path, const CrestLines&) {
  return checkVtp(path);
}

Error saveMeshVtp(const std::string& path, const TriangleMesh&, bool) {
  return checkVtp(path);
}

}  // namespace pcl_slim
