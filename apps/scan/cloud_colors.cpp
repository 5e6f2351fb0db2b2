// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "scan/cloud_file.h"

namespace pcl_slim {

namespace {

/** A field of colours that is packed into four bytes, or null. */
const pcl::PCLPointField*
packedField(const pcl::PCLPointCloud2& points)
{
  for (const char* name : {"rgba", "rgb"}) {
    const int i = findField(points, name);
    if (i < 0) continue;
    const pcl::PCLPointField& field = points.fields[static_cast<std::size_t>(i)];
    if (field.datatype == pcl::PCLPointField::FLOAT32 ||
        field.datatype == pcl::PCLPointField::UINT32 || field.datatype == pcl::PCLPointField::INT32)
      return &field;
  }
  return nullptr;
}

/** The fields of blue, green and red, or nothing. */
std::vector<const pcl::PCLPointField*>
channelFields(const pcl::PCLPointCloud2& points)
{
  std::vector<const pcl::PCLPointField*> fields;
  for (const auto& names : {std::array<const char*, 3>{"blue", "green", "red"},
                            std::array<const char*, 3>{"b", "g", "r"}}) {
    fields.clear();
    for (const char* name : names) {
      const int i = findField(points, name);
      if (i >= 0) fields.push_back(&points.fields[static_cast<std::size_t>(i)]);
    }
    if (fields.size() == 3) return fields;
  }
  return {};
}

double
whiteOf(double largest, bool fractions)
{
  if (fractions && largest <= 1.0) return 1.0;
  return largest <= 255.0 ? 255.0 : std::max(largest, 65535.0);
}

}  // namespace

void
adoptColors(CloudFile& cloud)
{
  const pcl::PCLPointCloud2& points = cloud.file.cloud;
  const auto fields = channelFields(points);
  if (fields.empty() || packedField(points) != nullptr) return;
  double largest = 0;
  bool fractions = false;
  for (const pcl::PCLPointField* field : fields) {
    fractions = fractions || field->datatype == pcl::PCLPointField::FLOAT32 ||
                field->datatype == pcl::PCLPointField::FLOAT64;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const double value = fieldValue(points, i, *field);
      if (std::isfinite(value)) largest = std::max(largest, value);
    }
  }
  const double white = whiteOf(largest, fractions);
  cloud.colors.resize(3 * cloud.size());
  for (std::size_t i = 0; i < cloud.colors.size(); ++i) {
    const double share = fieldValue(points, i / 3, *fields[i % 3]) / white;
    if (share > 0)
      cloud.colors[i] = static_cast<std::uint8_t>(std::lround(255 * std::min(share, 1.0)));
  }
}

ColorView
colorsOf(const CloudFile& cloud)
{
  const pcl::PCLPointCloud2& points = cloud.file.cloud;
  if (const auto* field = packedField(points)) {
    return {points.data.data() + field->offset, points.point_step};
  }
  if (cloud.colors.empty()) return {};
  return {cloud.colors.data(), 3};
}

}  // namespace pcl_slim
