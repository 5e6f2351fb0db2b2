// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/table_fields.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace pcl_slim {

namespace {

bool isReal(const PointField& field) {
  return field.datatype == kFloat32 || field.datatype == kFloat64;
}

/** Bytes of a field, with all its elements. */
std::size_t fieldBytes(const PointField& field) {
  return scalarSize(field.datatype) * std::max<std::size_t>(field.count, 1);
}

void storeReal(unsigned char* at, bool is_double, double value) {
  if (is_double) {
    std::memcpy(at, &value, sizeof(value));
    return;
  }
  const float narrow = finiteFloat(value);
  std::memcpy(at, &narrow, sizeof(narrow));
}

/** Copies one field of every point to its place in another layout, changing its type if need be. */
void moveField(const PointTable& from, const PointField& source, const PointField& target,
               PointTable& to) {
  const std::size_t bytes = fieldBytes(source);
  for (std::size_t i = 0; i < numPoints(from); ++i) {
    unsigned char* at = to.data.data() + i * to.point_step + target.offset;
    if (source.datatype == target.datatype) {
      std::memcpy(at, from.data.data() + i * from.point_step + source.offset, bytes);
    } else {
      storeReal(at, target.datatype == kFloat64, fieldValue(from, i, source));
    }
  }
}

/** The fields of a table and those to add, each with its type, one behind the other. */
std::vector<PointField> fieldsWith(const PointTable& points, const std::vector<std::string>& names,
                                   std::uint8_t type) {
  std::vector<PointField> fields = points.fields;
  for (const std::string& name : names) {
    const int i = findField(points, name);
    if (i >= 0 && isReal(points.fields[static_cast<std::size_t>(i)])) continue;
    if (i < 0) fields.emplace_back();
    PointField& field = i < 0 ? fields.back() : fields[static_cast<std::size_t>(i)];
    field.name = name;
    field.datatype = type;
    field.count = 1;
  }
  std::size_t step = 0;
  for (PointField& field : fields) {
    field.offset = static_cast<std::uint32_t>(step);
    step += fieldBytes(field);
  }
  return fields;
}

}  // namespace

bool hasRealFields(const PointTable& points, const std::vector<std::string>& names) {
  return std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    const int i = findField(points, name);
    return i >= 0 && isReal(points.fields[static_cast<std::size_t>(i)]);
  });
}

PointTable withRealFields(const PointTable& points, const std::vector<std::string>& names,
                          std::uint8_t type) {
  if (hasRealFields(points, names)) return points;
  PointTable made;
  made.width = points.width;
  made.height = points.height;
  made.fields = fieldsWith(points, names, type);
  const PointField& last = made.fields.back();
  made.point_step = last.offset + static_cast<std::uint32_t>(fieldBytes(last));
  made.data.assign(made.point_step * numPoints(points), 0);
  for (std::size_t k = 0; k < points.fields.size(); ++k)
    moveField(points, points.fields[k], made.fields[k], made);
  return made;
}

PointTable withRealFields(PointTable&& points, const std::vector<std::string>& names,
                          std::uint8_t type) {
  if (hasRealFields(points, names)) return std::move(points);
  return withRealFields(std::as_const(points), names, type);
}

FieldWriter::FieldWriter(PointTable& points, const std::string& name) : step_(points.point_step) {
  const PointField& field = points.fields[static_cast<std::size_t>(findField(points, name))];
  first_ = points.data.data() + field.offset;
  double_ = field.datatype == kFloat64;
}

void FieldWriter::set(std::size_t point, double value) const {
  storeReal(first_ + point * step_, double_, value);
}

}  // namespace pcl_slim
