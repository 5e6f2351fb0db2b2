// SPDX-License-Identifier: BSD-3-Clause
#include "scan/cloud_file.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

namespace {

const std::vector<std::string> kSensor = {"vp_x", "vp_y", "vp_z"};
constexpr const char* kFrame = "frame";

/** Whether a frame's points have sensors of their own: fields that are not all 0. */
bool hasOwnSensors(const PointFile& frame) {
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

void fill(const std::string& name, double value, PointTable& cloud) {
  const FieldWriter field(cloud, name);
  for (std::size_t i = 0; i < numPoints(cloud); ++i) field.set(i, value);
}

/** The frame with its sensor and its number in fields. */
PointFile withOrigin(const PointFile& frame, std::uint32_t number) {
  std::vector<std::string> fields = kSensor;
  const bool has_number = findField(frame.cloud, kFrame) >= 0;
  if (!has_number) fields.emplace_back(kFrame);
  PointFile made = withRealFields(frame, fields, kFloat32);
  if (!has_number) fill(kFrame, number, made.cloud);
  if (hasOwnSensors(frame)) return made;
  for (std::size_t a = 0; a < 3; ++a) fill(kSensor[a], frame.sensor_origin[a], made.cloud);
  return made;
}

/** Why a frame's points cannot follow those of the first one. */
Error checkFrame(const std::string& first_name, const PointFile& first, const std::string& name,
                 const PointFile& frame) {
  if (frame.numFaces() > 0 || first.numFaces() > 0) {
    return {ErrorCode::kBadInput, "'" + (frame.numFaces() > 0 ? name : first_name) +
                                      "' has faces: -frames merges points; name files without"};
  }
  if (!isFinite(frame.sensor_origin))
    return {ErrorCode::kBadInput, "'" + name + "' has a VIEWPOINT that is not finite; correct it"};
  const auto& fields = frame.cloud.fields;
  const auto& expected = first.cloud.fields;
  const auto same = [](const PointField& a, const PointField& b) {
    return a.name == b.name && a.datatype == b.datatype && a.count == b.count &&
           a.offset == b.offset;
  };
  if (frame.cloud.point_step == first.cloud.point_step &&
      std::equal(fields.begin(), fields.end(), expected.begin(), expected.end(), same))
    return {};
  return {ErrorCode::kBadInput, "'" + name + "' has other fields than '" + first_name +
                                    "'; give frames of the same fields and types"};
}

void setOneRow(std::size_t points, PointTable& cloud) {
  cloud.width = static_cast<std::uint32_t>(points);
  cloud.height = 1;
}

void append(const PointTable& frame, PointTable& merged) {
  const std::size_t points = numPoints(merged) + numPoints(frame);
  merged.data.insert(merged.data.end(), frame.data.begin(), frame.data.end());
  setOneRow(points, merged);
}

}  // namespace

Error mergeFrames(const std::string& name, const std::vector<std::string>& others,
                  const InputOptions& input, PointFile& first,
                  std::vector<std::uint32_t>& numbers) {
  if (Error error = checkFrame(name, first, name, first)) return error;
  PointFile merged = withOrigin(first, 0);
  setOneRow(numPoints(merged.cloud), merged.cloud);
  numbers.assign(numPoints(merged.cloud), 0);
  std::uint32_t number = 0;
  for (const std::string& other : others) {
    Result<PointFile> frame = loadPoints(other, input);
    if (!frame) return frame.error();
    const PointFile placed = withOrigin(*frame, ++number);
    if (Error error = checkFrame(name, merged, other, placed)) return error;
    append(placed.cloud, merged.cloud);
    numbers.resize(numPoints(merged.cloud), number);
  }
  first = std::move(merged);
  return {};
}

Error framesByField(const PointTable& cloud, const std::string& field,
                    std::vector<std::uint32_t>& numbers) {
  const int found = findField(cloud, field);
  if (found < 0) {
    return {ErrorCode::kBadArgument, "-frame_field: the scan has no field '" + field +
                                         "'; name the one that has the frames' numbers"};
  }
  const auto value = [&](std::size_t i) {
    return fieldValue(cloud, i, cloud.fields[static_cast<std::size_t>(found)]);
  };
  std::map<double, std::uint32_t> frames;
  for (std::size_t i = 0; i < numPoints(cloud); ++i) {
    if (!std::isfinite(value(i))) {
      return {ErrorCode::kBadInput, "the field '" + field + "' of point " + std::to_string(i) +
                                        " is not finite; give every point a frame's number"};
    }
    frames[value(i)] = 0;
  }
  std::uint32_t next = 0;
  for (auto& [number, frame] : frames) frame = next++;
  numbers.resize(numPoints(cloud));
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = frames[value(i)];
  return {};
}

}  // namespace pcl_slim
