// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/point_file.h"

#include "io/pcd/pcd_file.h"
#include "io/ply/ply_file.h"
#include "io/scalar_type.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

Result<PointFile>
loadPointFile(const std::string& path)
{
  const std::string extension = lowerExtension(path);
  if (extension != ".pcd" && extension != ".ply") {
    return Error{ErrorCode::kBadArgument,
                 "cannot tell the format of '" + path + "'; name a .pcd or .ply file"};
  }
  const Result<std::vector<unsigned char>> bytes = readFile(path);
  if (!bytes) return bytes.error();
  if (bytes->empty())
    return Error{ErrorCode::kBadInput, "'" + path + "' is empty (0 bytes); copy it again"};
  Result<PointFile> file = extension == ".pcd" ? parsePcd(*bytes) : parsePly(*bytes);
  if (file) return file;
  return Error{file.error().code, "'" + path + "': " + file.error().message};
}

Error
savePointFile(const std::string& path, const PointFile& file)
{
  const std::string extension = lowerExtension(path);
  if (extension == ".pcd") {
    const std::vector<unsigned char> bytes = formatPcd(file);
    return writeFile(path, bytes.data(), bytes.size());
  }
  if (extension == ".ply") {
    const Result<std::vector<unsigned char>> bytes = formatPly(file);
    return bytes ? writeFile(path, bytes->data(), bytes->size()) : bytes.error();
  }
  return {ErrorCode::kBadArgument,
          "cannot tell the format of '" + path + "'; name a .pcd or .ply file"};
}

int
findField(const pcl::PCLPointCloud2& cloud, const std::string& name)
{
  for (std::size_t i = 0; i < cloud.fields.size(); ++i) {
    if (cloud.fields[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

double
fieldValue(const pcl::PCLPointCloud2& cloud, std::size_t point, const pcl::PCLPointField& field)
{
  return readScalar(cloud.data.data() + point * cloud.point_step + field.offset, field.datatype);
}

std::size_t
numPoints(const pcl::PCLPointCloud2& cloud)
{
  return static_cast<std::size_t>(cloud.width) * cloud.height;
}

}  // namespace pcl_slim
