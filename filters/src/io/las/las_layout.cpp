// SPDX-License-Identifier: BSD-3-Clause
#include "io/las/las_layout.h"

#include "io/scalar_type.h"

namespace pcl_slim {

namespace {

/** What follows a format's core. */
struct Groups {
  bool gps_time, color, near_infrared, wave_packet;
};

constexpr Groups kGroups[kMostLasFormat + 1] = {
    {false, false, false, false}, {true, false, false, false}, {false, true, false, false},
    {true, true, false, false},   {true, false, false, true},  {true, true, false, true},
    {true, false, false, false},  {true, true, false, false},  {true, true, true, false},
    {true, false, false, true},   {true, true, true, true}};

/** Formats 0 to 5. */
std::vector<LasItem>
oldCore()
{
  return {{"intensity", kUInt16, 12},
          {"return_number", kUInt8, 14, 0, 3},
          {"number_of_returns", kUInt8, 14, 3, 3},
          {"scan_direction_flag", kUInt8, 14, 6, 1},
          {"edge_of_flight_line", kUInt8, 14, 7, 1},
          {"classification", kUInt8, 15, 0, 5},
          {"synthetic", kUInt8, 15, 5, 1},
          {"key_point", kUInt8, 15, 6, 1},
          {"withheld", kUInt8, 15, 7, 1},
          {"scan_angle_rank", kInt8, 16},
          {"user_data", kUInt8, 17},
          {"point_source_id", kUInt16, 18}};
}

/** Formats 6 to 10. */
std::vector<LasItem>
newCore()
{
  return {{"intensity", kUInt16, 12},
          {"return_number", kUInt8, 14, 0, 4},
          {"number_of_returns", kUInt8, 14, 4, 4},
          {"synthetic", kUInt8, 15, 0, 1},
          {"key_point", kUInt8, 15, 1, 1},
          {"withheld", kUInt8, 15, 2, 1},
          {"overlap", kUInt8, 15, 3, 1},
          {"scanner_channel", kUInt8, 15, 4, 2},
          {"scan_direction_flag", kUInt8, 15, 6, 1},
          {"edge_of_flight_line", kUInt8, 15, 7, 1},
          {"classification", kUInt8, 16},
          {"user_data", kUInt8, 17},
          {"scan_angle", kInt16, 18},
          {"point_source_id", kUInt16, 20}};
}

/** Appends values one after another. */
void
append(std::vector<LasItem>& items, std::size_t& offset, std::uint8_t type,
       std::initializer_list<const char*> names)
{
  for (const char* name : names) {
    items.push_back({name, type, offset});
    offset += scalarSize(type);
  }
}

/** The values, and the bytes of a record. */
std::size_t
layOut(int format, std::vector<LasItem>& items)
{
  const Groups& groups = kGroups[format];
  items = format < 6 ? oldCore() : newCore();
  std::size_t offset = format < 6 ? 20 : 22;
  if (groups.gps_time) append(items, offset, kFloat64, {"gps_time"});
  if (groups.color) append(items, offset, kUInt16, {"red", "green", "blue"});
  if (groups.near_infrared) append(items, offset, kUInt16, {"nir"});
  if (groups.wave_packet) {
    append(items, offset, kUInt8, {"wave_descriptor"});
    append(items, offset, kUInt64, {"wave_offset"});
    append(items, offset, kUInt32, {"wave_bytes"});
    append(items, offset, kFloat32, {"wave_location", "wave_x", "wave_y", "wave_z"});
  }
  return offset;
}

}  // namespace

std::vector<LasItem>
lasItems(int format)
{
  std::vector<LasItem> items;
  layOut(format, items);
  return items;
}

std::size_t
lasRecordBytes(int format)
{
  std::vector<LasItem> items;
  return layOut(format, items);
}

}  // namespace pcl_slim
