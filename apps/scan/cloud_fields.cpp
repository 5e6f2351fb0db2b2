// SPDX-License-Identifier: BSD-3-Clause
#include "scan/cloud_fields.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace pcl_slim {

namespace {

bool
isReal(const pcl::PCLPointField& field)
{
  return field.datatype == pcl::PCLPointField::FLOAT32 ||
         field.datatype == pcl::PCLPointField::FLOAT64;
}

std::size_t
realSize(std::uint8_t type)
{
  return type == pcl::PCLPointField::FLOAT64 ? sizeof(double) : sizeof(float);
}

/** Bytes of a field, with all its elements. */
std::size_t
fieldBytes(const pcl::PCLPointField& field)
{
  static constexpr std::size_t kSize[] = {0, 1, 1, 2, 2, 4, 4, 4, 8, 8, 8, 1};
  const std::size_t size = field.datatype < std::size(kSize) ? kSize[field.datatype] : 0;
  return size * std::max<std::size_t>(field.count, 1);
}

void
storeReal(unsigned char* at, bool is_double, double value)
{
  if (is_double) {
    std::memcpy(at, &value, sizeof(value));
    return;
  }
  const auto narrow = static_cast<float>(value);
  std::memcpy(at, &narrow, sizeof(narrow));
}

/** Copies one field of every point to its place in another layout, changing its type if need be. */
void
moveField(const pcl::PCLPointCloud2& from, const pcl::PCLPointField& source,
          const pcl::PCLPointField& target, pcl::PCLPointCloud2& to)
{
  const std::size_t bytes = fieldBytes(source);
  for (std::size_t i = 0; i < numPoints(from); ++i) {
    unsigned char* at = to.data.data() + i * to.point_step + target.offset;
    if (source.datatype == target.datatype) {
      std::memcpy(at, from.data.data() + i * from.point_step + source.offset, bytes);
    } else {
      const bool is_double = target.datatype == pcl::PCLPointField::FLOAT64;
      storeReal(at, is_double, fieldValue(from, i, source));
    }
  }
}

}  // namespace

PointFile
withRealFields(const PointFile& file, const std::vector<std::string>& names, std::uint8_t type)
{
  const pcl::PCLPointCloud2& from = file.cloud;
  std::vector<pcl::PCLPointField> fields = from.fields;
  bool same = true;
  for (const std::string& name : names) {
    const int i = findField(from, name);
    if (i >= 0 && isReal(from.fields[static_cast<std::size_t>(i)])) continue;
    if (i < 0) fields.emplace_back();
    pcl::PCLPointField& field = i < 0 ? fields.back() : fields[static_cast<std::size_t>(i)];
    field.name = name;
    field.datatype = type;
    field.count = 1;
    same = false;
  }
  if (same) return file;

  PointFile made;
  made.sensor_origin = file.sensor_origin;
  made.sensor_orientation = file.sensor_orientation;
  made.comments = file.comments;
  made.face_begin = file.face_begin;
  made.face_vertices = file.face_vertices;
  made.las_head = file.las_head;
  made.las_tail = file.las_tail;
  pcl::PCLPointCloud2& to = made.cloud;
  to.header = from.header;
  to.width = from.width;
  to.height = from.height;
  to.is_bigendian = from.is_bigendian;
  to.is_dense = from.is_dense;
  std::size_t step = 0;
  for (pcl::PCLPointField& field : fields) {
    field.offset = static_cast<pcl::uindex_t>(step);
    step += fieldBytes(field);
  }
  to.fields = std::move(fields);
  to.point_step = static_cast<pcl::uindex_t>(step);
  to.row_step = static_cast<pcl::uindex_t>(step * to.width);
  to.data.assign(step * numPoints(from), 0);
  for (std::size_t k = 0; k < from.fields.size(); ++k) {
    moveField(from, from.fields[k], to.fields[k], to);
  }
  return made;
}

FieldWriter::FieldWriter(pcl::PCLPointCloud2& cloud, const std::string& name)
    : step_(cloud.point_step)
{
  const auto& field = cloud.fields[static_cast<std::size_t>(findField(cloud, name))];
  first_ = cloud.data.data() + field.offset;
  double_ = realSize(field.datatype) == sizeof(double);
}

void
FieldWriter::set(std::size_t point, double value) const
{
  storeReal(first_ + point * step_, double_, value);
}

}  // namespace pcl_slim
