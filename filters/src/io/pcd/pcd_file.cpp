// SPDX-License-Identifier: BSD-3-Clause
#include "io/point_formats.h"

#include <algorithm>
#include <cstring>

#include "io/pcd/lzf.h"
#include "io/pcd/pcd_header.h"
#include "io/scalar_type.h"

namespace pcl_slim {

namespace {

Error
truncated(const std::string& unit, std::size_t have, std::size_t want)
{
  return badInput("the PCD file is truncated: " + std::to_string(have) + " of " +
                  std::to_string(want) + " " + unit + "; copy it again");
}

Error
readAscii(const std::uint8_t* payload, std::size_t size, const PcdHeader& header,
          pcl::PCLPointCloud2& cloud)
{
  // Every value takes a character and a separator: no allocation for a header that only boasts.
  std::size_t values = 0;
  for (const PcdColumn& column : header.columns) values += column.count;
  if (values > 0 && header.points > (size / 2 + 1) / values)
    return truncated("points", 0, header.points);
  cloud.data.resize(header.points * cloud.point_step);
  TextScanner scanner(payload, size);
  std::uint8_t* at = cloud.data.data();
  for (std::size_t i = 0; i < header.points; ++i) {
    for (const PcdColumn& column : header.columns) {
      for (std::size_t k = 0; k < column.count; ++k) {
        const char *begin = nullptr, *end = nullptr;
        if (!scanner.nextWord(begin, end)) return truncated("points", i, header.points);
        if (column.isPadding()) continue;
        if (!parseScalar(begin, end, scalarType(column), at)) {
          return badInput("field '" + column.name + "' of point " + std::to_string(i) +
                          " of the PCD file is not a number of its type: mend '" +
                          std::string(begin, end) + "'");
        }
        at += column.size;
      }
    }
  }
  return {};
}

/** Copies columns out of rows (row by row data) or out of column-major data. */
void
copyColumns(const PcdHeader& header, const std::uint8_t* source, bool column_major,
            pcl::PCLPointCloud2& cloud)
{
  const std::size_t file_step = header.step();
  std::size_t file_offset = 0, offset = 0;
  for (const PcdColumn& column : header.columns) {
    const std::size_t width = column.bytes();
    const std::uint8_t* from = source + file_offset * (column_major ? header.points : 1);
    const std::size_t step = column_major ? width : file_step;
    file_offset += width;
    if (column.isPadding()) continue;
    for (std::size_t i = 0; i < header.points; ++i) {
      std::memcpy(cloud.data.data() + i * cloud.point_step + offset, from + i * step, width);
    }
    offset += width;
  }
}

Error
readBinary(const std::uint8_t* payload, std::size_t size, const PcdHeader& header,
           pcl::PCLPointCloud2& cloud)
{
  const std::size_t step = header.step();
  if (step != 0 && header.points > size / step)
    return truncated("points", size / step, header.points);
  cloud.data.resize(header.points * cloud.point_step);
  if (step == cloud.point_step) {
    std::copy(payload, payload + header.points * step, cloud.data.begin());
  } else {
    copyColumns(header, payload, false, cloud);
  }
  return {};
}

Error
readCompressed(const std::uint8_t* payload, std::size_t size, const PcdHeader& header,
               pcl::PCLPointCloud2& cloud)
{
  const std::size_t step = header.step();
  std::uint32_t compressed = 0, plain = 0;
  if (header.points == 0) return {};
  if (size < 8) return truncated("bytes of compressed data", size, 8);
  std::memcpy(&compressed, payload, 4);
  std::memcpy(&plain, payload + 4, 4);
  if (compressed > size - 8) return truncated("bytes of compressed data", size - 8, compressed);
  if (plain != header.points * step) {
    return badInput(
        "the PCD file's compressed data do not hold the points its header announces; copy it "
        "again");
  }
  std::vector<std::uint8_t> columns(plain);
  if (!detail::decodeLzf(payload + 8, compressed, columns.data(), plain)) {
    return badInput("the PCD file's compressed data are corrupted; copy it again");
  }
  cloud.data.resize(header.points * cloud.point_step);
  copyColumns(header, columns.data(), true, cloud);
  return {};
}

}  // namespace

Result<PointFile>
parsePcd(const std::vector<unsigned char>& bytes)
{
  PointFile file;
  PcdHeader header;
  if (Error error = parsePcdHeader(bytes, header, file)) return error;
  describeFields(header, file.cloud);
  const std::uint8_t* payload = bytes.data() + header.bytes;
  const std::size_t size = bytes.size() - header.bytes;
  Error error;
  if (header.data == "ascii")
    error = readAscii(payload, size, header, file.cloud);
  else if (header.data == "binary")
    error = readBinary(payload, size, header, file.cloud);
  else if (header.data == "binary_compressed")
    error = readCompressed(payload, size, header, file.cloud);
  else
    error = badInput("the PCD data form '" + header.data +
                     "' is unknown; use ascii, binary or binary_compressed");
  if (error) return error;
  return file;
}

std::vector<unsigned char>
formatPcd(const PointFile& file)
{
  const pcl::PCLPointCloud2& cloud = file.cloud;
  const std::string header = formatPcdHeader(file);
  std::vector<unsigned char> bytes(header.begin(), header.end());
  std::size_t step = 0;
  for (const auto& field : cloud.fields) {
    step += scalarSize(field.datatype) * std::max<std::size_t>(field.count, 1);
  }
  const std::size_t n = numPoints(cloud), start = bytes.size();
  if (n == 0) return bytes;
  bytes.resize(start + n * step);
  std::size_t offset = start;
  for (const auto& field : cloud.fields) {
    const std::size_t width = scalarSize(field.datatype) * std::max<std::size_t>(field.count, 1);
    const std::uint8_t* from = cloud.data.data() + field.offset;
    for (std::size_t i = 0; i < n; ++i) {
      std::memcpy(bytes.data() + offset + i * step, from + i * cloud.point_step, width);
    }
    offset += width;
  }
  return bytes;
}

}  // namespace pcl_slim
