// SPDX-License-Identifier: BSD-3-Clause
#include "scan/merge_frames.h"

#include <algorithm>
#include <array>
#include <set>

#include "scan/cloud_fields.h"

namespace pcl_slim {

namespace {

const std::vector<std::string> kSensor = {"vp_x", "vp_y", "vp_z"};

/** Whether a frame's points have sensors of their own: fields that are not all 0. */
bool
hasOwnSensors(const PointFile& frame)
{
  return std::any_of(kSensor.begin(), kSensor.end(), [&](const std::string& name) {
    const int field = findField(frame.cloud, name);
    if (field < 0) return false;
    for (std::size_t i = 0; i < numPoints(frame.cloud); ++i) {
      if (fieldValue(frame.cloud, i, frame.cloud.fields[static_cast<std::size_t>(field)]) != 0)
        return true;
    }
    return false;
  });
}

/** The frame with its sensor in fields. */
PointFile
withSensor(const PointFile& frame)
{
  PointFile made = withRealFields(frame, kSensor, pcl::PCLPointField::FLOAT32);
  if (hasOwnSensors(frame)) return made;
  for (int a = 0; a < 3; ++a) {
    const FieldWriter field(made.cloud, kSensor[static_cast<std::size_t>(a)]);
    for (std::size_t i = 0; i < numPoints(made.cloud); ++i) field.set(i, frame.sensor_origin[a]);
  }
  return made;
}

/** Why a frame's points cannot follow those of the first one. */
Error
checkFrame(const std::string& first_name, const PointFile& first, const std::string& name,
           const PointFile& frame)
{
  if (frame.numFaces() > 0 || first.numFaces() > 0) {
    return {ErrorCode::kBadInput, "'" + (frame.numFaces() > 0 ? name : first_name) +
                                      "' has faces: -frames merges points; name files without"};
  }
  if (!frame.sensor_origin.head<3>().allFinite())
    return {ErrorCode::kBadInput, "'" + name + "' has a VIEWPOINT that is not finite; correct it"};
  const auto& fields = frame.cloud.fields;
  const auto& expected = first.cloud.fields;
  const auto same = [](const pcl::PCLPointField& a, const pcl::PCLPointField& b) {
    return a.name == b.name && a.datatype == b.datatype && a.count == b.count &&
           a.offset == b.offset;
  };
  if (frame.cloud.point_step == first.cloud.point_step &&
      frame.cloud.is_bigendian == first.cloud.is_bigendian &&
      std::equal(fields.begin(), fields.end(), expected.begin(), expected.end(), same))
    return {};
  return {ErrorCode::kBadInput, "'" + name + "' has other fields than '" + first_name +
                                    "'; give frames of the same fields and types"};
}

void
setOneRow(std::size_t points, pcl::PCLPointCloud2& cloud)
{
  cloud.width = static_cast<std::uint32_t>(points);
  cloud.height = 1;
  cloud.row_step = cloud.width * cloud.point_step;
}

void
append(const pcl::PCLPointCloud2& frame, pcl::PCLPointCloud2& merged)
{
  const std::size_t points = numPoints(merged) + numPoints(frame);
  merged.data.insert(merged.data.end(), frame.data.begin(), frame.data.end());
  merged.is_dense = merged.is_dense && frame.is_dense;
  setOneRow(points, merged);
}

}  // namespace

Error
mergeFrames(const std::string& name, const std::vector<std::string>& others, PointFile& first,
            std::size_t& places)
{
  std::set<std::array<float, 3>> sensors;
  std::size_t with_own = 0;
  const auto count = [&](const PointFile& frame) {
    const auto& at = frame.sensor_origin;
    if (hasOwnSensors(frame))
      ++with_own;
    else
      sensors.insert({at[0], at[1], at[2]});
  };
  if (Error error = checkFrame(name, first, name, first)) return error;
  count(first);
  PointFile merged = withSensor(first);
  setOneRow(numPoints(merged.cloud), merged.cloud);
  for (const std::string& other : others) {
    Result<PointFile> frame = loadPointFile(other);
    if (!frame) return frame.error();
    count(*frame);
    const PointFile placed = withSensor(*frame);
    if (Error error = checkFrame(name, merged, other, placed)) return error;
    append(placed.cloud, merged.cloud);
  }
  places = sensors.size() + with_own;
  first = std::move(merged);
  return {};
}

}  // namespace pcl_slim
