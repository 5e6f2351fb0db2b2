// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PCLPointCloud2.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/filters/io/point_table.h"

namespace pcl_slim {

constexpr const char* kPosition[3] = {"x", "y", "z"};

/** Three fields of a cloud, of type float or double. */
class RealTriple {
 public:
  RealTriple(const pcl::PCLPointCloud2& cloud, const char* const (&names)[3]) {
    for (const char* name : names) {
      const int i = findField(cloud, name);
      if (i < 0) return;
      const pcl::PCLPointField& field = cloud.fields[static_cast<std::size_t>(i)];
      const bool is_double = field.datatype == pcl::PCLPointField::FLOAT64;
      if (!is_double && field.datatype != pcl::PCLPointField::FLOAT32) return;
      fields_.push_back({field.offset, is_double});
    }
  }

  bool found() const { return fields_.size() == 3; }

  Vector3 read(const pcl::PCLPointCloud2& cloud, std::size_t i) const {
    Vector3 value{};
    for (std::size_t a = 0; a < 3; ++a) {
      const auto* at = cloud.data.data() + i * cloud.point_step + fields_[a].offset;
      float single = 0;
      if (fields_[a].is_double) {
        std::memcpy(&value[a], at, sizeof(double));
        continue;
      }
      std::memcpy(&single, at, sizeof(single));
      value[a] = single;
    }
    return value;
  }

  void write(const Vector3& value, std::size_t i, pcl::PCLPointCloud2& cloud) const {
    for (std::size_t a = 0; a < 3; ++a) {
      auto* at = cloud.data.data() + i * cloud.point_step + fields_[a].offset;
      const auto single = static_cast<float>(value[a]);
      if (fields_[a].is_double)
        std::memcpy(at, &value[a], sizeof(double));
      else
        std::memcpy(at, &single, sizeof(single));
    }
  }

 private:
  struct Place {
    std::size_t offset;
    bool is_double;
  };
  std::vector<Place> fields_;
};

/** No error for vertices whose places can be read. \param[in] what the mesh is in a sentence: "the
 * input mesh" */
inline Error checkVertices(const pcl::PCLPointCloud2& cloud, const RealTriple& xyz,
                           const std::string& what) {
  if (numPoints(cloud) == 0) {
    return {ErrorCode::kBadInput, what + " has no vertices; give one that has"};
  }
  if (!xyz.found()) {
    return {ErrorCode::kBadInput,
            what + " has no fields x y z of type float or double; give it such"};
  }
  if (cloud.data.size() < numPoints(cloud) * cloud.point_step) {
    return {ErrorCode::kBadInput, what + " has less data than vertices; make it again"};
  }
  return {};
}

}  // namespace pcl_slim
