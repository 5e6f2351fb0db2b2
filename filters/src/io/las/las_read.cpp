// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstring>

#include "io/las/las_header.h"
#include "io/point_formats.h"
#include "io/scalar_type.h"

namespace pcl_slim {

namespace {

/** A run of bytes to copy, or bits to take out of one. */
struct Move {
  std::size_t from = 0, to = 0, bytes = 0;
  int shift = 0, bits = 0;
};

/** The fields of the cloud, and how a record fills them. A point's bytes are a multiple of 8, so that
 * coordinates can be used in place. */
std::vector<Move>
layOut(const LasHeader& header, pcl::PCLPointCloud2& cloud)
{
  std::vector<Move> moves;
  for (const char* axis : {"x", "y", "z"}) addField(cloud, axis, kFloat64);
  for (const LasItem& item : lasItems(header.format)) {
    moves.push_back({item.offset, cloud.point_step, scalarSize(item.type), item.shift, item.bits});
    addField(cloud, item.name, item.type);
  }
  std::size_t from = lasRecordBytes(header.format);
  for (const LasExtra& extra : header.extras) {
    moves.push_back({from, cloud.point_step, extra.bytes()});
    addField(cloud, extra.name, extra.type, extra.count);
    from += extra.bytes();
  }
  cloud.point_step = (cloud.point_step + 7) / 8 * 8;
  cloud.width = static_cast<pcl::uindex_t>(header.points);
  cloud.height = 1;
  cloud.row_step = static_cast<pcl::uindex_t>(cloud.point_step * header.points);
  cloud.is_bigendian = 0;
  cloud.is_dense = 1;
  return moves;
}

void
readRecord(const unsigned char* record, const LasHeader& header, const std::vector<Move>& moves,
           std::uint8_t* point)
{
  double xyz[3];
  for (std::size_t a = 0; a < 3; ++a) {
    xyz[a] = getLas<std::int32_t>(record + 4 * a) * header.scale[a] + header.offset[a];
  }
  std::memcpy(point, xyz, sizeof(xyz));
  for (const Move& move : moves) {
    if (move.bits == 0) {
      std::memcpy(point + move.to, record + move.from, move.bytes);
    } else {
      const int value = record[move.from] >> move.shift;
      point[move.to] = static_cast<std::uint8_t>(value & ((1 << move.bits) - 1));
    }
  }
}

}  // namespace

Result<PointFile>
parseLas(const std::vector<unsigned char>& bytes)
{
  const Result<LasHeader> header = parseLasHeader(bytes, bytes.size());
  if (!header) return header.error();
  PointFile file;
  const std::vector<Move> moves = layOut(*header, file.cloud);
  const auto points = static_cast<std::size_t>(header->points);
  file.cloud.data.resize(points * file.cloud.point_step);
  const unsigned char* record = bytes.data() + header->points_at;
  std::uint8_t* point = file.cloud.data.data();
  for (std::size_t i = 0; i < points; ++i) {
    readRecord(record, *header, moves, point);
    record += header->record_bytes;
    point += file.cloud.point_step;
  }
  const auto begin = bytes.begin();
  const std::size_t end = header->points_at + points * header->record_bytes;
  file.las_head.assign(begin, begin + static_cast<std::ptrdiff_t>(header->points_at));
  file.las_tail.assign(begin + static_cast<std::ptrdiff_t>(end), bytes.end());
  return file;
}

}  // namespace pcl_slim
