// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/point_file.h"

#include "io/point_formats.h"
#include "io/scalar_type.h"
#include "io/vtp/vtp_file.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace {

using Bytes = std::vector<unsigned char>;

struct Format {
  const char* extension;
  Result<PointFile> (*parse)(const Bytes& bytes);
};

constexpr Format kFormats[] = {{".pcd", parsePcd},
                               {".ply", parsePly},
                               {".las", parseLas},
                               {".xyz", [](const Bytes& bytes) { return parseText(bytes, false); }},
                               {".txt", [](const Bytes& bytes) { return parseText(bytes, false); }},
                               {".asc", [](const Bytes& bytes) { return parseText(bytes, false); }},
                               {".csv", [](const Bytes& bytes) { return parseText(bytes, false); }},
                               {".pts", [](const Bytes& bytes) { return parseText(bytes, true); }},
                               {".obj", parseObj},
                               {".off", parseOff},
                               {".stl", parseStl},
                               {".vtp", parseVtp}};

/** What to do with a file that is not read, or not in this build. */
Error
refused(const std::string& path, const std::string& extension)
{
  const std::string stem = path.substr(0, path.size() - extension.size());
  if (extension == ".vtp") return checkVtp(path);
  if (path == "-" || path == "/dev/stdin") {
    return {ErrorCode::kBadArgument,
            "a pipe has no extension to tell its format by; give it a name: mkfifo scan.pcd"};
  }
  if (extension == ".laz") {
    return {ErrorCode::kBadArgument, "'" + path + "' is compressed; convert it: laszip -i '" +
                                         path + "' -o '" + stem + ".las'"};
  }
  if (extension == ".e57") {
    return {ErrorCode::kBadArgument, "'" + path +
                                         "' is not read as it is; convert it: pdal translate '" +
                                         path + "' '" + stem + ".las'"};
  }
  return {ErrorCode::kBadArgument,
          "cannot tell the format of '" + path +
              "'; name a .pcd, .ply, .las, .xyz, .txt, .asc, .csv, .pts, .obj, .off, .stl or "
              ".vtp file"};
}

Result<const Format*>
formatOf(const std::string& path)
{
  const std::string extension = lowerExtension(path);
  for (const Format& format : kFormats) {
    const bool missing = extension == ".vtp" && checkVtp(path);
    if (extension == format.extension && !missing) return &format;
  }
  return refused(path, extension);
}

}  // namespace

Error
checkPointFileExtension(const std::string& path)
{
  const auto format = formatOf(path);
  return format ? Error() : format.error();
}

Result<PointFile>
loadPointFile(const std::string& path)
{
  const auto format = formatOf(path);
  if (!format) return format.error();
  const Result<Bytes> bytes = readFile(path);
  if (!bytes) return bytes.error();
  if (bytes->empty())
    return Error{ErrorCode::kBadInput, "'" + path + "' is empty (0 bytes); copy it again"};
  Result<PointFile> file = (*format)->parse(*bytes);
  if (file) return file;
  return Error{file.error().code, "'" + path + "': " + file.error().message};
}

Error
savePointFile(const std::string& path, const PointFile& file)
{
  const std::string extension = lowerExtension(path);
  if (extension == ".pcd") {
    const Bytes bytes = formatPcd(file);
    return writeFile(path, bytes.data(), bytes.size());
  }
  if (extension == ".ply" || extension == ".las") {
    const Result<Bytes> bytes = extension == ".ply" ? formatPly(file) : formatLas(file);
    return bytes ? writeFile(path, bytes->data(), bytes->size()) : bytes.error();
  }
  if (extension == ".vtp") return saveVtp(path, file);
  return {ErrorCode::kBadArgument,
          "cannot tell the format of '" + path + "'; name a .pcd, .ply, .las or .vtp file"};
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
