// SPDX-License-Identifier: BSD-3-Clause
// Replaces vtp_file.cpp in a build without VTK.
#include "io/triangles/mesh_formats.h"
#include "io/vtp/crest_vtp.h"
#include "io/vtp/vtp_file.h"

namespace pcl_slim {

Error
checkVtp(const std::string& path)
{
  return {ErrorCode::kBadArgument,
          "cannot use '" + path + "': this build has no VTP (PCL_SLIM_WITH_VTP); name a .ply file"};
}

Error
saveVtp(const std::string& path, const PointFile&)
{
  return checkVtp(path);
}

Result<std::vector<VtpColumn>>
vtpColumns(const PointFile&)
{
  return checkVtp("*.vtp");
}

Result<PointFile>
parseVtp(const std::vector<unsigned char>&)
{
  return checkVtp("*.vtp");
}

Error
saveCrestVtp(const std::string& path, const CrestLines&)
{
  return checkVtp(path);
}

Error
saveMeshVtp(const std::string& path, const TriangleMesh&)
{
  return checkVtp(path);
}

}  // namespace pcl_slim
